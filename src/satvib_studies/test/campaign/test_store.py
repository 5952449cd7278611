# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a campaign keeps through interruptions, damage and full disks; a campaign left in peace is the truth."""

import json
import os
import shutil
import subprocess
import sys

import pyarrow.parquet as pq
import pytest
from satvib_common.errors import SatvibError
from satvib_studies.campaign.run import begin, go_on, resume
from satvib_studies.campaign.settings import Campaign
from satvib_studies.campaign.store import Store

PARAMETERS = {'rig.payload.mass': {'kind': 'uniform', 'low': 7.0, 'high': 11.0}}
CAMPAIGN = Campaign(
    name='kept', scenario='quick_3dof', trials=18, chunk=6, parameters=PARAMETERS, seed=3
)
LIMITED = """
import resource, signal, sys
from satvib_bringup.cli.main import main
signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
resource.setrlimit(resource.RLIMIT_FSIZE, (int(sys.argv.pop(1)), resource.RLIM_INFINITY))
main()
"""


class Interrupted(Exception):  # noqa: N818 - stands for a key being pressed
    """Somebody had enough."""


def stop_after(trials):
    def told(done, _):
        if done >= trials:
            raise Interrupted

    return told


def satvib(*words, limit=None):
    """Run the command in a process of its own, with files of at most `limit` bytes."""
    code = 'from satvib_bringup.cli.main import main; main()' if limit is None else LIMITED
    limits = [] if limit is None else [str(limit)]
    env = os.environ | {'PYTHONPATH': os.pathsep.join(p for p in sys.path if p)}
    if limits:
        # Python keeps half a module's bytecode where the rest finds no room, and cannot read it later
        env['PYTHONDONTWRITEBYTECODE'] = '1'
    return subprocess.run(
        [sys.executable, '-c', code, *limits, *map(str, words)],
        env=env, capture_output=True, text=True, timeout=120, check=False,
    )  # fmt: skip


def refused(done, *told):
    """One clear line, exit 2."""
    assert done.returncode == 2, done.stderr
    line = done.stderr.strip()
    assert line.startswith('satvib: ')
    assert '\n' not in line
    for words in told:
        assert words in line
    return True


@pytest.fixture(scope='module')
def wanted(tmp_path_factory):
    """The bytes of the table when nothing goes wrong."""
    folder = tmp_path_factory.mktemp('whole') / 'c'
    go_on(begin(CAMPAIGN, folder), workers=0)
    return (folder / 'trials.parquet').read_bytes()


@pytest.fixture(scope='module')
def begun(tmp_path_factory):
    """Folder of a campaign that was interrupted when 12 of 18 trials were done."""
    folder = tmp_path_factory.mktemp('begun') / 'c'
    with pytest.raises(Interrupted):
        go_on(begin(CAMPAIGN, folder), workers=0, progress=stop_after(12))
    return folder


@pytest.fixture
def interrupted(begun, tmp_path):
    """A copy of it: a campaign goes on wherever its folder lies."""
    folder = tmp_path / 'c'
    shutil.copytree(begun, folder)
    assert Store(folder).trials_done == 12
    return folder


def test_an_interrupted_campaign_goes_on(interrupted, wanted):
    """Truth: the undisturbed campaign; equal bytes, and the finished parts are not run again."""
    (interrupted / 'parts' / '000002.parquet.new').write_bytes(b'half of a part')
    seen = []
    go_on(resume(interrupted), workers=0, progress=lambda done, _: seen.append(done))
    assert seen == [12, 18]
    assert (interrupted / 'trials.parquet').read_bytes() == wanted


def test_a_killed_campaign_goes_on(tmp_path, wanted):
    """Truth: the undisturbed campaign; equal bytes after SIGKILL in the middle."""
    code = (
        'import os, signal, sys\n'
        'from pathlib import Path\n'
        'from satvib_studies.campaign.run import begin, go_on\n'
        'from satvib_studies.campaign.settings import Campaign\n'
        'def told(done, total):\n'
        '    if done >= 6:\n'
        '        os.kill(os.getpid(), signal.SIGKILL)\n'
        'c = Campaign.from_mapping(__import__("json").loads(sys.argv[1]))\n'
        'go_on(begin(c, Path(sys.argv[2])), workers=0, progress=told)\n'
    )
    folder = tmp_path / 'c'
    env = os.environ | {'PYTHONPATH': os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, '-c', code, json.dumps(CAMPAIGN.to_mapping()), str(folder)],
        env=env, check=False, timeout=120,
    )  # fmt: skip
    assert done.returncode == -9
    store = resume(folder)
    assert store.trials_done == 6
    go_on(store, workers=0)
    assert (folder / 'trials.parquet').read_bytes() == wanted


def test_a_full_disk_keeps_what_is_finished(interrupted, wanted):
    """Truth: the undisturbed campaign; a part larger than the room left is refused, then written when there is room."""
    parts = {p.name: p.read_bytes() for p in (interrupted / 'parts').iterdir()}
    done = satvib('campaign', '--resume', interrupted, '--workers', 0, limit=4096)
    assert refused(done, 'cannot be written', '12 of 18 trials are kept', '--resume')
    assert {p.name: p.read_bytes() for p in (interrupted / 'parts').iterdir()} == parts
    go_on(resume(interrupted), workers=0)
    assert (interrupted / 'trials.parquet').read_bytes() == wanted


def test_a_damaged_part_is_named_and_can_be_run_again(interrupted, wanted):
    """Truth: the undisturbed campaign; one flipped bit is seen, nothing is touched, --redo mends it."""
    path = interrupted / 'parts' / '000001.parquet'
    data = bytearray(path.read_bytes())
    data[len(data) // 2] ^= 1
    path.write_bytes(data)
    done = satvib('campaign', '--resume', interrupted, '--workers', 0)
    assert refused(done, '000001.parquet', 'is damaged', '--redo 1')
    assert path.read_bytes() == bytes(data)
    go_on(resume(interrupted, redo=1), workers=0)
    assert (interrupted / 'trials.parquet').read_bytes() == wanted


@pytest.mark.parametrize(
    ('name', 'change', 'told'),
    [
        ('manifest.json', lambda text: text[: len(text) // 2], 'is damaged'),
        ('campaign.json', lambda text: text[: len(text) // 2], 'is damaged'),
        ('campaign.json', lambda text: text.replace('"trials": 18', '"trials": 17'), 'was changed'),
        ('manifest.json', lambda text: text.replace('"digest": "', '"digest": "0'), 'another'),
    ],
)
def test_damaged_books_are_refused(interrupted, name, change, told):
    """Truth: the page on campaigns; one line names the file, the parts stay."""
    path = interrupted / name
    text = path.read_text()
    assert change(text) != text
    path.write_text(change(text))
    with pytest.raises(SatvibError, match=told) as caught:
        resume(interrupted)
    assert name in str(caught.value)
    assert len(list((interrupted / 'parts').iterdir())) == 2


def test_other_software_does_not_go_on(interrupted):
    """Truth: trials of two versions are not of one kind; the message names both."""
    path = interrupted / 'campaign.json'
    path.write_text(path.read_text().replace('"numpy": "', '"numpy": "0.'))
    with pytest.raises(SatvibError, match=r'began with numpy 0\.'):
        resume(interrupted)


def test_a_folder_is_never_overwritten(interrupted):
    """Truth: the house rule; the campaign of before is still there."""
    with pytest.raises(SatvibError, match='exists already'):
        begin(CAMPAIGN, interrupted)
    assert Store(interrupted).trials_done == 12


def test_the_table_holds_what_was_drawn(tmp_path, wanted):
    """Truth: the plan; numbers equal in every bit, one row per trial in order."""
    path = tmp_path / 't.parquet'
    path.write_bytes(wanted)
    table = pq.read_table(path)
    from satvib_studies.campaign.trials import plan_trials

    plan = plan_trials(CAMPAIGN)
    assert table['trial'].to_pylist() == list(range(18))
    assert table['seed'].to_pylist() == plan.seeds
    assert table['p:rig.payload.mass'].to_pylist() == plan.values['rig.payload.mass']


def test_the_command_from_file_to_report(tmp_path):
    """Truth: the files that the page on campaigns names; the worst case's line is in the report and on the terminal."""
    file = tmp_path / 'tiny.yaml'
    file.write_text(
        'scenario: quick_3dof\ntrials: 6\nparameters:\n'
        '  disturbance.frequency: {kind: uniform, low: 8.0, high: 12.0}\n'
    )
    folder = tmp_path / 'out'
    done = satvib('campaign', file, '--workers', 0, '--folder', folder)
    assert done.returncode == 0, done.stderr
    names = {p.name for p in folder.iterdir()}
    assert names == {
        'campaign.json', 'manifest.json', 'trials.parquet', 'summary.json', 'report.html', 'figures',
    }  # fmt: skip
    worst = json.loads((folder / 'summary.json').read_text())['worst'][0]
    assert worst['command'].startswith('./satvib run quick_3dof --set disturbance.frequency=')
    assert worst['command'] in done.stdout
    assert worst['command'] in (folder / 'report.html').read_text()
    again = satvib('campaign', '--resume', folder)
    assert again.returncode == 0, again.stderr


def test_a_bad_file_is_refused_in_one_line(tmp_path):
    """Truth: exit code 2 and one line, and no folder is made."""
    file = tmp_path / 'bad.yaml'
    file.write_text(
        'scenario: quick_3dof\ntrials: 6\nparameters:\n'
        '  rig.payload.mass: {kind: uniform, low: 3.0, high: 1.0}\n'
    )
    done = satvib('campaign', file, '--folder', tmp_path / 'o')
    assert refused(done, 'nothing lies between', 'rig.payload.mass', str(file))
    assert not (tmp_path / 'o').exists()


def test_reading_leaves_no_thread_behind():
    """Truth: the kernel's list of threads. One of Arrow's that works when the process ends aborts it now and then."""
    code = """
import os, pyarrow
from satvib_studies.campaign.report.table import from_bytes, to_bytes
data = to_bytes(pyarrow.table({name: [0.0] * 50000 for name in 'abcdefgh'}))
before = len(os.listdir('/proc/self/task'))
from_bytes(data)
print(len(os.listdir('/proc/self/task')) - before)
"""
    env = os.environ | {'PYTHONPATH': os.pathsep.join(p for p in sys.path if p)}
    done = subprocess.run(
        [sys.executable, '-c', code], env=env, capture_output=True, text=True, check=True
    )
    assert done.stdout.strip() == '0'
