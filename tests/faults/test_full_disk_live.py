# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A disk that is full before, during and after a recording. Truth: a real file system of a few megabytes, which is in
memory and seen by the processes of the test alone, and the readers of rosbags."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
# own names for users and mounts; a small file system; then the program
IN_A_SMALL_DISK = 'mount -t tmpfs -o size="$1" none "$2" && cd "$2" && shift 2 && exec "$@"'


def small_disk_is_possible() -> bool:
    if shutil.which('unshare') is None:
        return False
    words = ['unshare', '-Urm', 'mount', '-t', 'tmpfs', 'none', '/mnt']
    return subprocess.run(words, capture_output=True, check=False).returncode == 0


pytestmark = pytest.mark.skipif(
    not small_disk_is_possible(), reason='this machine lets no user mount a file system of his own'
)


def on_a_small_disk(tmp_path, size, program, *arguments):
    """Run a Python program in a folder on a disk of that size; gives what ended."""
    place = tmp_path / 'disk'
    place.mkdir()
    shell = ['unshare', '-Urm', 'sh', '-c', IN_A_SMALL_DISK, 'sh', size, str(place)]
    environment = os.environ | {'SATVIB_TRACEBACK': ''}
    return subprocess.run(
        [*shell, sys.executable, '-c', program, *map(str, arguments)],
        capture_output=True, text=True, timeout=240, check=False, env=environment,
    )  # fmt: skip


RECORD = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from rosbags.highlevel import AnyReader
from satvib_bringup.recorder.bag_sink import BagSink
from satvib_common.errors import RunError
from test_bag_sink import channel, serialized

sink, made, k = BagSink(Path('bag'), {}), channel(), 0
others, said = Path('others').open('wb'), ''
while not said:
    sink.put(made, k * 10_000_000, serialized(k))
    k += 1
    if k % 100 == 0:
        others.write(bytes(100_000))
        others.flush()
    # no further than the bag is written
    while not said and sink.written < k - 100:
        try:
            sink.check()
        except RunError as error:
            said = str(error)
try:
    sink.close()
except RunError:
    pass
with AnyReader([Path('bag')]) as reader:
    found = [reader.deserialize(raw, c.msgtype).sequence for c, _, raw in reader.messages()]
print(said)
print(found == list(range(sink.written)), sink.written > 1000)
"""


def test_a_recording_ends_whole_before_the_disk_is_full(tmp_path):
    """Another program fills the disk. The bag has its index and metadata.yaml, and every message that was written."""
    tests = ROOT / 'src' / 'satvib_bringup' / 'test' / 'recorder'
    done = on_a_small_disk(tmp_path, '24m', RECORD, tests)
    assert done.returncode == 0, done.stderr
    said, facts = done.stdout.splitlines()
    assert said.startswith('bag: the disk is full (')
    assert facts == 'True True'


CLOSE = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
from rosbags.highlevel import AnyReader
from satvib_bringup.recorder.bag_sink import BagSink
from satvib_bringup.recorder.salvage import is_finished, salvage
from satvib_common.errors import RunError
from test_bag_sink import channel, serialized

sink, made = BagSink(Path('bag'), {}), channel()
for k in range(3000):
    sink.put(made, k * 10_000_000, serialized(k))
file = next(Path('bag').glob('*.mcap'))
while sink.written < 3000 or file.stat().st_size < 3000 * 20:
    pass
for size in (65536, 4096, 512, 1):
    try:
        with open(f'others_{size}', 'wb', buffering=0) as others:
            while True:
                others.write(bytes(size))
    except OSError:
        pass
try:
    sink.close()
    print('nothing was said')
except RunError as error:
    print(error)
for others in Path().glob('others_*'):
    others.unlink()
saved = is_finished(Path('bag')) or salvage(Path('bag'), {})
with AnyReader([Path('bag')]) as reader:
    found = [reader.deserialize(raw, c.msgtype).sequence for c, _, raw in reader.messages()]
print(found == list(range(len(found))), len(found) > 1000)
"""


def test_a_disk_that_is_full_when_the_bag_is_closed_loses_little(tmp_path):
    """Not one byte is left for the index. That is said, and the messages are read when there is room again."""
    tests = ROOT / 'src' / 'satvib_bringup' / 'test' / 'recorder'
    done = on_a_small_disk(tmp_path, '24m', CLOSE, tests)
    assert done.returncode == 0, done.stderr
    said, facts = done.stdout.splitlines()
    assert said.startswith('bag: ')
    assert 'No space left' in said or 'the disk is full' in said
    assert facts == 'True True'


COMMAND = """
import sys
from pathlib import Path
from satvib_bringup.cli.main import main

full = Path('others').open('wb', buffering=0)
try:
    while True:
        full.write(bytes(65536))
except OSError:
    pass
sys.argv[0] = 'satvib'
main()
"""


@pytest.mark.parametrize(
    'words',
    [
        pytest.param(('run', 'quick_3dof'), marks=pytest.mark.long),
        ('simulate', 'quick_3dof'),
    ],
    ids=lambda words: words[0],
)
def test_a_full_disk_is_one_line(domain, tmp_path, words):  # noqa: ARG001
    done = on_a_small_disk(tmp_path, '1m', COMMAND, *words)
    assert done.returncode == 2, done.stderr
    assert 'defect' not in done.stderr
    assert done.stderr.count('\n') == 1, done.stderr
    assert any(text in done.stderr for text in ('No space left', 'make room', 'room')), done.stderr


AT_THE_END = """
import sys, threading
from pathlib import Path
from satvib_bringup.cli.main import main

def fill():
    # the bag, or the record of a simulated run, is whole; now the report is written
    while not (any(Path('run').rglob('metadata.yaml')) or any(Path('run').rglob('recording.npz'))):
        pause.wait(0.01)
    others = Path('others').open('wb', buffering=0)
    try:
        while True:
            others.write(bytes(65536))
    except OSError:
        pass

pause = threading.Event()
threading.Thread(target=fill, daemon=True).start()
sys.argv[0] = 'satvib'
main()
"""


@pytest.mark.long
@pytest.mark.parametrize('word', ['run', 'simulate'])
def test_a_disk_that_is_full_when_the_report_is_written_is_one_line(domain, tmp_path, word):  # noqa: ARG001
    """The run was good, its report is not there: exit code 1 or 2, one line, and what was recorded can be read."""
    done = on_a_small_disk(tmp_path, '60m', AT_THE_END, word, 'quick_3dof', '--folder', 'run')
    assert done.returncode in {1, 2}, done.stderr
    assert 'defect' not in done.stderr
    assert done.stderr.count('\n') == 1, done.stderr
    assert 'No space left' in done.stderr


RUN = """
import sys, threading
from pathlib import Path
from satvib_bringup.live.run import run_experiment
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.scenario.scenario import load_scenario

others = Path('others').open('wb', buffering=0)

def fill(progress):
    try:
        while progress.time > 1.0:
            others.write(bytes(65536))
    except OSError:
        pass

scenario = load_scenario('soft_3dof', ['duration=600'])
outcome = run_experiment(scenario, Path('run'), progress=fill, composition='strut')
print(outcome.success, outcome.exit_code, outcome.message)
others.close()
Path('others').unlink()
print(len(read_recording(Path('run')).get('acceleration', 'upper')) > 100)
print(sorted(p.name for p in Path('run').iterdir() if p.name.startswith('.')))
"""


def test_a_disk_that_fills_during_a_run_ends_it_and_loses_little(domain, tmp_path):  # noqa: ARG001
    """The reason is told, nothing hidden is left, and what was recorded can be read when there is room again."""
    done = on_a_small_disk(tmp_path, '40m', RUN)
    assert done.returncode == 0, done.stderr
    said, there, hidden = done.stdout.splitlines()
    assert said.startswith('False 1 ')
    assert 'recorder' in said
    assert 'the disk is full' in said or 'No space left' in said
    assert (there, hidden) == ('True', '[]')
