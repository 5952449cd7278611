# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Set-up may die anywhere: the next call goes on, or says in one line what is wrong and what to do.

Truth: the RECORD files of the installed packages, and a shell in the workspace that finds colcon. The workspace of
these tests is small: the tools, the locks of ROS, no packages in `src/`. The whole one is killed twenty times by
`tools/kill_setup`.
"""

import os
import random
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from lock_files import ROOT

SEED = 11
SURROUNDINGS = {'HOME': '/proc/nobody', 'LC_ALL': 'C', 'XDG_CACHE_HOME': '', 'UV_CACHE_DIR': ''}
CHECK = """
import base64, hashlib, sys
from importlib.metadata import distributions
for d in distributions():
    assert d.files, d
    for f in d.files:
        if f.hash and not str(f).endswith(('.cmake', '.pyc')):  # repaired, and written anew, on this machine
            data = f.locate().read_bytes()
            found = base64.urlsafe_b64encode(hashlib.new(f.hash.mode, data).digest()).rstrip(b'=').decode()
            assert found == f.hash.value, f
import colcon_core, rclpy
"""


class Workspace:
    """A small workspace in a folder."""

    def __init__(self, root):
        self.root = root
        for name in ('tools', 'requirements'):
            shutil.copytree(ROOT / name, root / name, ignore=shutil.ignore_patterns('__pycache__'))
        shutil.copy(ROOT / 'satvib', root)
        (root / 'requirements/satvib.lock').write_text('')
        (root / 'src').mkdir()
        # one uv is as good as another
        if (ROOT / '.cache/uv').is_dir():
            shutil.copytree(ROOT / '.cache/uv', root / '.cache/uv')

    def start(self, code='true', **more):
        env = {k: v for k, v in os.environ.items() if not k.startswith(('ROS_', '_ROS', 'AMENT_'))}
        env['SATVIB_PYTHON'] = sys.executable
        return subprocess.Popen(
            [self.root / 'satvib', 'shell', '-c', code],
            env=env | more,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def good(self, **more):
        """Set up, and look at every installed file."""
        process = self.start(
            f"python -c '{CHECK.replace(chr(39), chr(34))}' && colcon --help", **more
        )
        said, _ = process.communicate(timeout=280)
        assert process.returncode == 0, said
        return said

    def forget(self):
        for name in ('.venv', 'build', 'install'):
            shutil.rmtree(self.root / name, ignore_errors=True)


@pytest.fixture
def workspace(tmp_path):
    root = tmp_path / 'ein Ordner mit Ümläuten'
    root.mkdir()
    return Workspace(root)


def in_two_terminals(workspace, **surroundings):
    """Set up from two terminals at once, one of which waits; gives how many s it took."""
    began = time.monotonic()
    terminals = [workspace.start(**surroundings) for _ in range(2)]
    said = [terminal.communicate(timeout=280)[0] for terminal in terminals]
    assert [terminal.returncode for terminal in terminals] == [0, 0], said
    assert sum('waiting for it' in text for text in said) == 1, said
    return time.monotonic() - began


def die(workspace, limit, **surroundings):
    """Begin to set up; killed after `limit` s."""
    process = workspace.start(**surroundings)
    try:
        process.wait(timeout=limit)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()


def move(workspace, new):
    workspace.root.rename(new)
    workspace.root = new


def take_python_away(workspace):
    for link in (workspace.root / '.venv/bin').glob('python*'):
        if link.is_symlink():
            link.unlink()
            link.symlink_to('/usr/bin/python-that-is-gone')


@pytest.mark.timeout(900)
def test_two_terminals_then_moved_then_dead_then_without_a_python(workspace, tmp_path):
    """The short form of the next two: what is moved is set up again, and dies meanwhile.

    In a folder with spaces and umlauts, in a locale that has none, with a home that cannot be written.
    """
    lasted = in_two_terminals(workspace, **SURROUNDINGS)
    assert (workspace.root / '.cache/uv-cache').is_dir()
    move(workspace, tmp_path / 'moved')
    die(workspace, random.Random(SEED).uniform(0.05, 0.8) * lasted, **SURROUNDINGS)
    workspace.good(**SURROUNDINGS)
    assert str(workspace.root) in (workspace.root / '.venv/bin/pip').read_text()
    take_python_away(workspace)
    process = workspace.start(**SURROUNDINGS)
    assert process.stdout is not None
    said = []
    for line in process.stdout:
        said.append(line)
        if 'making the virtual environment' in line:
            break
    else:
        pytest.fail(''.join(said))
    os.killpg(process.pid, signal.SIGKILL)  # how it goes on is above
    process.communicate()


@pytest.mark.long
@pytest.mark.timeout(900)
def test_two_terminals_a_read_only_home_and_two_deaths(workspace):
    """In a folder with spaces and umlauts, in a locale that has none."""
    lasted = in_two_terminals(workspace, **SURROUNDINGS)
    workspace.good(**SURROUNDINGS)
    assert (workspace.root / '.cache/uv-cache').is_dir()
    dice = random.Random(SEED)
    for _ in range(2):
        workspace.forget()
        die(workspace, dice.uniform(0.05, 0.8) * lasted, **SURROUNDINGS)
        workspace.good(**SURROUNDINGS)


@pytest.mark.long
@pytest.mark.timeout(900)
def test_a_moved_repository_and_a_python_that_is_gone(workspace, tmp_path):
    workspace.good()
    move(workspace, tmp_path / 'moved')
    workspace.good()
    assert str(workspace.root) in (workspace.root / '.venv/bin/pip').read_text()
    take_python_away(workspace)
    assert 'making the virtual environment' in workspace.good()


@pytest.mark.parametrize('uv', ['there', 'missing'])
def test_without_a_network_one_line_says_what_to_do(workspace, uv, tmp_path):
    if uv == 'missing':
        shutil.rmtree(workspace.root / '.cache/uv', ignore_errors=True)
    nothing = {
        'PIP_CONFIG_FILE': os.devnull,
        'PIP_INDEX_URL': 'https://127.0.0.1:9/simple',
        'PIP_EXTRA_INDEX_URL': '',
        'PIP_FIND_LINKS': '',
        'UV_CACHE_DIR': str(tmp_path / 'empty'),
    }
    process = workspace.start(**nothing)
    said, _ = process.communicate(timeout=120)
    assert process.returncode == 2, said
    last = said.strip().splitlines()[-1]
    assert 'cannot be reached: check network and proxy, then run the command again' in last
    assert 'Traceback' not in said


def test_a_full_disk_is_named_as_such(monkeypatch, tmp_path):
    """Truth: the kernel's own word, from a device that is always full."""
    from workspace import base, steps

    monkeypatch.setattr(base, 'CACHE', tmp_path)
    with pytest.raises(base.SetupError, match='the disk is full: make room'):
        base.run(['bash', '-c', 'echo text > /dev/full'], 'writing')
    with pytest.raises(OSError, match='No space') as caught:
        Path('/dev/full').write_text('text')
    assert 'the disk is full: make room' in steps.advice(caught.value)


def test_too_little_room_is_said_before_the_first_byte(monkeypatch):
    from workspace import base, machine

    monkeypatch.setattr(machine, 'NEEDED', 10**18)
    with pytest.raises(base.SetupError, match='are needed: make room'):
        machine.check_room()


def test_a_folder_that_cannot_be_written_is_named(monkeypatch, capsys):
    from workspace import lock, steps

    monkeypatch.setattr(steps, 'CACHE', Path('/proc/satvib'))
    monkeypatch.setattr(lock, 'CACHE', Path('/proc/satvib'))
    assert steps.prepare() == 2
    said = capsys.readouterr().err
    assert said.count('\n') == 1
    assert '/proc/satvib' in said


def test_links_to_files_that_are_gone_do_not_stop_the_build(monkeypatch, tmp_path):
    """Truth: setup.py lists a folder with glob, which gives a link whose file is gone, and then cannot copy it."""
    from workspace import build

    (tmp_path / 'kept').touch()
    folder = tmp_path / 'build' / 'package' / 'config'
    folder.mkdir(parents=True)
    (folder / 'kept.xml').symlink_to(tmp_path / 'kept')
    (folder / 'gone.xml').symlink_to(tmp_path / 'gone')
    monkeypatch.setattr(build, 'ROOT', tmp_path)
    build.drop_loose_links()
    assert [path.name for path in folder.glob('*.xml')] == ['kept.xml']
