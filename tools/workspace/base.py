# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every step uses: places, words to the person, commands, stamps.

A stamp is a small file that says from what a step was made. It is written last and in one move, so a step that was
killed has none and is done again.
"""

import hashlib
import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent.parent
VENV = ROOT / '.venv'
CACHE = ROOT / '.cache'
PYTHON = VENV / 'bin' / 'python'
ENVIRONMENT = CACHE / 'environment.sh'
# the descriptor of the lock, which the commands inherit: see lock.py
INHERITED: list[int] = []

# words in a command's output, and what they mean to the person
CAUSES = (
    (
        ('No space left on device', 'Disk quota exceeded', 'os error 28'),
        'the disk is full: make room (about 2 GB), then run the command again',
    ),
    (
        (
            'Temporary failure in name resolution',
            'Name or service not known',
            'dns error',
            'Network is unreachable',
            'Connection refused',
            'Failed to establish a new connection',
            'client error (Connect)',
            'Connection timed out',
            'operation timed out',
            'Read timed out',
            'ReadTimeoutError',
            'ConnectTimeoutError',
            'error sending request',
            'ProxyError',
        ),
        'the package index cannot be reached: check network and proxy, then run the command again',
    ),
    (
        ('CERTIFICATE_VERIFY_FAILED', 'invalid peer certificate'),
        'the certificate of the package index is not accepted: name your own in pip config set global.cert FILE',
    ),
)


class SetupError(Exception):
    """What is missing and how to get it, in one line."""


class CommandError(SetupError):
    """A command failed.

    Attributes:
        output: all that it said.
        cause: what to do, when the output says it; else empty.
    """

    def __init__(self, name: str, code: int, output: str, path: Path) -> None:
        self.output = output
        self.cause = next(
            (text for words, text in CAUSES if any(word in output for word in words)), ''
        )
        if self.cause:
            super().__init__(f'{self.cause} ({name} failed; all of it is in {path})')
        else:
            super().__init__(f'{name} failed (exit code {code}); all of it is in {path}')


def say(text: str) -> None:
    """Tell the person at the terminal, on standard error."""
    print(f'satvib: {text}', file=sys.stderr, flush=True)


def digest(paths: Iterable[Path], *extra: str) -> str:
    """Hash names and contents of files."""
    total = hashlib.sha256()
    for text in extra:
        total.update(text.encode() + b'\0')
    for path in sorted(paths):
        total.update(str(path.relative_to(ROOT)).encode() + b'\0' + path.read_bytes() + b'\0')
    return total.hexdigest()


def is_current(stamp: Path, wanted: str) -> bool:
    """Whether a step was done from exactly these sources."""
    try:
        return stamp.read_text() == wanted
    except (OSError, UnicodeDecodeError):
        return False


def write_whole(path: Path, text: str) -> None:
    """Write a file so that it is there with all of its text, or as it was before."""
    path.parent.mkdir(parents=True, exist_ok=True)
    fresh = path.with_name(f'{path.name}.new')
    fresh.write_text(text)
    fresh.replace(path)


def remove(path: Path) -> None:
    """Remove a file or folder, whatever of it is there.

    Raises:
        OSError: something of it cannot be removed.
    """
    if path.is_dir() and not path.is_symlink():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


def run(command: list[str], name: str, env: dict[str, str] | None = None) -> None:
    """Run a command quietly, in the workspace, its output in `.cache/log/NAME.log`.

    Raises:
        CommandError: the command failed; when its output names no known cause, the end of it was shown.
    """
    path = CACHE / 'log' / f'{name}.log'
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open('wb') as sink:
        code = subprocess.run(
            command,
            cwd=ROOT,
            env=env,
            stdin=subprocess.DEVNULL,
            stdout=sink,
            stderr=subprocess.STDOUT,
            pass_fds=INHERITED,
            check=False,
        ).returncode
    if code:
        raise failed(name, code, path)


def failed(name: str, code: int, path: Path) -> CommandError:
    """Make the error of a command from its log."""
    error = CommandError(name, code, path.read_text(errors='replace'), path)
    if not error.cause:
        sys.stderr.write('\n'.join(error.output.strip().splitlines()[-25:]) + '\n')
    return error


def without(*names: str, **more: str) -> dict[str, str]:
    """Give the caller's environment without some variables, and with others."""
    return {key: value for key, value in os.environ.items() if key not in names} | more
