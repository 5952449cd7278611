# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Kill set-up at random moments, and look whether the next one is good.

    .venv/bin/python tools/kill_setup.py --times 20 --seed 1
    .venv/bin/python tools/kill_setup.py --small      # src/ with messages and satvib_common only

In a clone that is thrown away: a part of the workspace, drawn at random, is removed; set-up begins; all its processes
are killed at a drawn moment; set-up runs again to its end. Good is: exit code 0, every file of every installed package
as its RECORD says, every package and message of `src/` can be imported, and no file of a build is left half written
(a build from nothing gives the same list of installed files).
"""

import argparse
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
PARTS = {
    'environment': ('.venv',),
    'build': ('build', 'install', '.cache/build'),
    'kernels': ('.cache/kernels-demo', '.cache/kernels-all'),
    'all': ('.venv', 'build', 'install', 'log', '.cache'),
}
CHECK = """
import base64, hashlib, importlib, pathlib, sys
from importlib.metadata import distributions
for d in distributions(path=[p for p in sys.path if '.venv' in p]):
    for f in d.files or []:
        if f.hash and not str(f).endswith(('.cmake', '.pyc')):  # repaired, and written anew, on this machine
            data = f.locate().read_bytes()
            found = base64.urlsafe_b64encode(hashlib.new(f.hash.mode, data).digest()).rstrip(b'=').decode()
            assert found == f.hash.value, f
for package in pathlib.Path('src').iterdir():
    importlib.import_module(package.name)
from satvib_msgs.msg import Schedule
Schedule.__class__.__import_type_support__()
"""


def main() -> int:
    """Do it.

    Returns:
        the number of set-ups that were not good.
    """
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else '')
    parser.add_argument('--times', type=int, default=20)
    parser.add_argument('--seed', type=int, default=1)
    parser.add_argument('--small', action='store_true')
    given = parser.parse_args()
    dice = random.Random(given.seed)
    with tempfile.TemporaryDirectory() as folder:
        clone = Path(folder) / 'satvib'
        subprocess.run(['git', 'clone', '--quiet', str(ROOT), str(clone)], check=True)
        if given.small:
            for package in (clone / 'src').iterdir():
                if package.name not in {'satvib_msgs', 'satvib_common'}:
                    shutil.rmtree(package)
        whole = set_up(clone)
        listing = installed(clone)
        print(f'undisturbed: {whole:.0f} s, {len(listing)} installed files')
        took = dict.fromkeys(PARTS, whole)
        bad = 0
        number = 0
        while number < given.times:
            part = dice.choice(sorted(PARTS))
            for name in PARTS[part]:
                remove(clone / name, keep_uv=part == 'all')
            moment = dice.uniform(0.0, took[part])
            lasted = set_up(clone, kill_after=moment)
            if lasted >= 0.0:  # it had ended before: that is how long this part takes
                took[part] = lasted
                continue
            number += 1
            lasted = set_up(clone)
            good = check(clone) and installed(clone) == listing
            bad += not good
            print(
                f'{number:2}: {part} removed, killed after {moment:.1f} s, '
                f'next set-up {lasted:.0f} s: {"good" if good else "NOT GOOD"}',
                flush=True,
            )
    print(f'{given.times - bad} of {given.times} set-ups good')
    return bad


def set_up(clone: Path, kill_after: float | None = None) -> float:
    """Run set-up; gives its seconds, negative when it was killed."""
    began = time.monotonic()
    command = [
        sys.executable,
        '-IS',
        str(clone / 'tools/bootstrap.py'),
        'shell' if small(clone) else 'demo',
    ]
    log = clone / 'set-up.log'
    with log.open('w') as sink:
        process = subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=sink, stderr=sink, start_new_session=True
        )
        try:
            process.wait(timeout=kill_after)
        except subprocess.TimeoutExpired:
            os.killpg(process.pid, signal.SIGKILL)
            process.wait()
            return -1.0
    if process.returncode:
        print(log.read_text())
    return time.monotonic() - began


def small(clone: Path) -> bool:
    """Whether the clone has no nodes, and so no demo."""
    return not (clone / 'src/satvib_bringup').exists()


def check(clone: Path) -> bool:
    """Whether all that is installed is whole, and can be imported."""
    script = '. .cache/environment.sh && exec .venv/bin/python -c "$0"'
    done = subprocess.run(
        ['bash', '-c', script, CHECK], cwd=clone, capture_output=True, text=True, check=False
    )
    if done.returncode:
        print(done.stderr)
    return done.returncode == 0


def installed(clone: Path) -> list[str]:
    """Name all files and links of the install tree."""
    return sorted(
        str(path.relative_to(clone))
        for path in (clone / 'install').rglob('*')
        if '__pycache__' not in path.parts
    )


def remove(path: Path, keep_uv: bool) -> None:
    """Remove a file or folder; of `.cache` the fetched uv may stay."""
    if path.name == '.cache' and keep_uv:
        for inner in path.iterdir():
            if inner.name != 'uv':
                remove(inner, keep_uv=False)
    elif path.is_dir():
        shutil.rmtree(path)
    else:
        path.unlink(missing_ok=True)


if __name__ == '__main__':
    sys.exit(main())
