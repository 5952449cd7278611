# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Make the workspace ready: virtual environment, ROS 2 prefix, colcon build. Standard library only.

Every step leaves a stamp of what it was made from and is skipped while that is unchanged. Two ways to ROS 2 Jazzy:

* a sourced installation (ROS_DISTRO is set): the virtual environment sits on top of it and adds Python tools only;
* none: the pinned ROS 2 wheels make the virtual environment itself the ROS prefix.
"""

import contextlib
import fcntl
import hashlib
import os
import re
import shlex
import shutil
import subprocess
import sys
import sysconfig
import time
from collections.abc import Iterable, Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
VENV = ROOT / '.venv'
CACHE = ROOT / '.cache'
ENVIRONMENT = CACHE / 'environment.sh'
SUPPORTED = ((3, 11), (3, 13))
# what a build depends on besides Python modules, which are linked in
BUILD_FILES = ('package.xml', 'setup.py', 'setup.cfg', 'CMakeLists.txt')
BUILD_SUFFIXES = ('.msg', '.srv', '.action', '.yaml', '.xml', '.launch.py')

# what the prefix of the wheels sets besides paths
OURS = (
    '_ROS_WHEELS_BOOTSTRAP_COMPLETE', 'ROS_DISTRO', 'ROS_VERSION', 'ROS_PYTHON_VERSION',
    'RMW_IMPLEMENTATION', 'ROS_AUTOMATIC_DISCOVERY_RANGE',
)  # fmt: skip


class SetupError(Exception):
    """What is missing and how to get it, in one line."""


def main() -> int:
    """Bring the workspace up to date; say nothing when it is."""
    try:
        with alone():
            own_ros = sourced_ros()
            check_machine(own_ros)
            make_environment(own_ros)
            make_prefix(own_ros)
            build(own_ros)
            warm_kernels()
    except SetupError as error:
        print(f'satvib: {error}', file=sys.stderr)
        return 2
    except OSError as error:
        print(f'satvib: {error.filename or ROOT}: {error.strerror}', file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print('satvib: set-up interrupted; run the command again to go on', file=sys.stderr)
        return 130
    return 0


@contextlib.contextmanager
def alone() -> Iterator[None]:
    """Let one set-up at a time work on the workspace; a second terminal waits for the first."""
    CACHE.mkdir(exist_ok=True)
    with (CACHE / 'lock').open('w') as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            say('another set-up is at work here; waiting for it')
            fcntl.flock(lock, fcntl.LOCK_EX)
        yield


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
    return stamp.is_file() and stamp.read_text() == wanted


def run(command: list[str], log: str, env: dict[str, str] | None = None) -> None:
    """Run a command quietly; on failure show the end of what it said.

    Raises:
        SetupError: the command failed.
    """
    folder = CACHE / 'log'
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f'{log}.log'
    with path.open('wb') as sink:
        code = subprocess.run(
            command, cwd=ROOT, env=env, stdout=sink, stderr=subprocess.STDOUT, check=False
        ).returncode
    if code:
        lines = path.read_text(errors='replace').strip().splitlines()
        sys.stderr.write('\n'.join(lines[-25:]) + '\n')
        raise SetupError(f'{log} failed (exit code {code}); all of it is in {path}')


def sourced_ros() -> bool:
    """Whether the caller has sourced a ROS 2 installation of its own.

    Raises:
        SetupError: one is sourced, but not Jazzy.
    """
    if os.environ.get('_ROS_WHEELS_BOOTSTRAP_COMPLETE') or 'ROS_DISTRO' not in os.environ:
        return False
    distro = os.environ['ROS_DISTRO']
    if distro != 'jazzy':
        raise SetupError(
            f'ROS 2 {distro} is sourced, jazzy is needed; open a shell without it, and satvib '
            'brings its own'
        )
    return True


def check_machine(own_ros: bool) -> None:
    """Say in one line what is missing.

    Raises:
        SetupError: naming the missing part and what to install.
    """
    low, high = SUPPORTED
    if not low <= sys.version_info[:2] <= high:
        raise SetupError(
            f'Python {sys.version_info[0]}.{sys.version_info[1]} is too old or too new: '
            f'{low[0]}.{low[1]} to {high[0]}.{high[1]} is needed; name one in SATVIB_PYTHON'
        )
    if sys.platform != 'linux' or os.uname().machine != 'x86_64':
        if not own_ros:
            raise SetupError(
                'the ROS 2 wheels exist for Linux on x86-64 only; source a ROS 2 Jazzy '
                'installation first'
            )
    try:
        import ensurepip  # noqa: F401
        import venv  # noqa: F401
    except ImportError:
        raise SetupError(
            'the Python module venv is missing; on Debian: apt install python3-venv'
        ) from None
    for tool, package in (('g++', 'g++'), ('make', 'make')):
        if shutil.which(tool) is None:
            raise SetupError(f'{tool} is missing; on Debian: apt install {package}')
    header = Path(sysconfig.get_paths()['include']) / 'Python.h'
    if not header.is_file():
        raise SetupError(f'{header} is missing; on Debian: apt install python3-dev')


def make_environment(own_ros: bool) -> None:
    """Create .venv and install the locked requirements."""
    names = ['overlay.lock'] if own_ros else ['ros.lock', 'satvib.lock']
    locks = [ROOT / 'requirements' / name for name in names]
    stamp = VENV / 'satvib-requirements'
    interpreter = VENV / 'bin' / 'python'
    wanted = digest(locks, sys.version, str(VENV))
    if is_current(stamp, wanted):
        return
    started = time.monotonic()
    if not interpreter.exists() or not is_same_python(interpreter):
        say(f'making the virtual environment {VENV.name}')
        arguments = ['--clear', '--system-site-packages'] if own_ros else ['--clear']
        run([sys.executable, '-m', 'venv', *arguments, str(VENV)], 'virtual environment')
    say('installing the locked requirements (about a minute the first time)')
    stamp.unlink(missing_ok=True)
    command = [
        str(interpreter),
        '-m',
        'pip',
        'install',
        '--disable-pip-version-check',
        '--no-input',
    ]
    for lock in locks:
        command += ['--require-hashes', '-r', str(lock)]
    run(command, 'installing requirements')
    stamp.write_text(wanted)
    say(f'requirements installed in {time.monotonic() - started:.0f} s')


def is_same_python(interpreter: Path) -> bool:
    """Whether an environment belongs to the Python that runs this."""
    asked = subprocess.run(
        [str(interpreter), '-c', 'import sys; print(sys.version)'],
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    return asked.returncode == 0 and asked.stdout.strip() == sys.version


def make_prefix(own_ros: bool) -> None:
    """Turn the wheels' environment into a ROS prefix: repair CMake paths, write set-up files."""
    if own_ros:
        return
    requirements = (VENV / 'satvib-requirements').read_text()
    wanted = digest([Path(__file__).resolve()], requirements)
    stamp = VENV / 'satvib-prefix'
    if is_current(stamp, wanted):
        return
    repair_cmake_paths()
    write_setup_files()
    stamp.write_text(wanted)


def repair_cmake_paths() -> None:
    """Replace the paths of the machine that built the wheels by those of this one."""
    version = f'{sys.version_info[0]}.{sys.version_info[1]}'
    tag = version.replace('.', '')
    foreign = f'/opt/python/cp{tag}-cp{tag}'
    site = VENV / 'lib' / f'python{version}' / 'site-packages'
    for path in (VENV / 'share').rglob('*.cmake'):
        before = path.read_text()
        after = (
            before.replace(f'{foreign}/include/python{version}', sysconfig.get_paths()['include'])
            .replace(f'{foreign}/lib/python{version}/site-packages', str(site))
            .replace(foreign, str(VENV))
        )
        if re.search(r'/opt/python/', after):
            raise SetupError(f'{path} still names the path of another machine')
        if after != before:
            # a new file in its place: the old one may be a hard link into an installer's cache
            fresh = path.with_suffix('.cmake.new')
            fresh.write_text(after)
            fresh.replace(path)


def write_setup_files() -> None:
    """Write local_setup and setup for sh and bash, as every ROS prefix has them."""
    text = (
        '# Made by tools/bootstrap.py: makes this virtual environment a ROS 2 prefix.\n'
        f'_satvib_venv={shlex.quote(str(VENV))}\n'
        '_satvib_add() { eval "case \\":\\$$1:\\" in *\\":$2:\\"*) ;; '
        '*) export $1=\\"$2\\${$1:+:\\$$1}\\" ;; esac"; }\n'
        '_satvib_add AMENT_PREFIX_PATH "$_satvib_venv"\n'
        '_satvib_add CMAKE_PREFIX_PATH "$_satvib_venv"\n'
        '_satvib_add PATH "$_satvib_venv/bin"\n'
        'for _satvib_dir in "$_satvib_venv/lib" "$_satvib_venv"/lib/python3*/site-packages/ros_*.libs; do\n'
        '  [ -d "$_satvib_dir" ] && _satvib_add LD_LIBRARY_PATH "$_satvib_dir"\n'
        'done\n'
        'unset -f _satvib_add; unset _satvib_dir _satvib_venv\n'
        'export ROS_DISTRO=jazzy ROS_VERSION=2 ROS_PYTHON_VERSION=3\n'
        'export _ROS_WHEELS_BOOTSTRAP_COMPLETE=1\n'
        'export RMW_IMPLEMENTATION="${RMW_IMPLEMENTATION:-rmw_fastrtps_cpp}"\n'
        'export ROS_AUTOMATIC_DISCOVERY_RANGE="${ROS_AUTOMATIC_DISCOVERY_RANGE:-LOCALHOST}"\n'
    )
    for name in ('local_setup.sh', 'local_setup.bash', 'setup.sh', 'setup.bash'):
        (VENV / name).write_text(text)


def build_inputs() -> list[Path]:
    """Files that colcon turns into the install tree."""
    found = []
    for path in (ROOT / 'src').rglob('*'):
        if '__pycache__' in path.parts or path.name.startswith('.'):
            continue
        if path.name in BUILD_FILES or path.name.endswith(BUILD_SUFFIXES):
            found.append(path)
    return found


def build(own_ros: bool) -> None:
    """Build the workspace when something that colcon installs has changed."""
    requirements = (VENV / 'satvib-requirements').read_text()
    wanted = digest(build_inputs(), requirements, str(ROOT))
    stamp = CACHE / 'build'
    if is_current(stamp, wanted) and ENVIRONMENT.is_file():
        return
    started = time.monotonic()
    say('building the workspace')
    stamp.unlink(missing_ok=True)
    underlay = '' if own_ros else f'. {shlex.quote(str(VENV / "setup.bash"))} && '
    activate = f'export PATH={shlex.quote(str(VENV / "bin"))}:"$PATH" && '
    python = VENV / 'bin' / 'python'
    colcon = (
        f'{underlay}{activate}exec {shlex.quote(str(python))} -m colcon build --symlink-install '
        f'--cmake-args -DBUILD_TESTING=OFF -DPython3_EXECUTABLE={shlex.quote(str(python))}'
    )
    run(['bash', '-c', colcon], 'colcon build', clean_environment())
    write_environment()
    stamp.parent.mkdir(exist_ok=True)
    stamp.write_text(wanted)
    say(f'workspace built in {time.monotonic() - started:.0f} s')


def clean_environment() -> dict[str, str]:
    """Give the caller's environment without an overlay of this very workspace."""
    drop = {'COLCON_PREFIX_PATH', 'COLCON_CURRENT_PREFIX', 'VIRTUAL_ENV', 'PYTHONHOME'}
    env = {k: v for k, v in os.environ.items() if k not in drop}
    for key in ('AMENT_PREFIX_PATH', 'CMAKE_PREFIX_PATH', 'PYTHONPATH', 'LD_LIBRARY_PATH', 'PATH'):
        # build, too: colcon puts the packages' sources on the path from there; and the prefix below the workspace
        own = (str(ROOT / 'install'), str(ROOT / 'build'), str(VENV))
        parts = [p for p in env.get(key, '').split(':') if p and not p.startswith(own)]
        env.pop(key, None)
        if parts:
            env[key] = ':'.join(parts)
    if OURS[0] in env:  # our own prefix, sourced by the caller: build afresh
        for key in OURS:
            env.pop(key, None)
    return env


def write_environment() -> None:
    """Keep what sourcing the workspace changes, so that a command need not source it again."""
    script = f'. {shlex.quote(str(ROOT / "install" / "setup.bash"))} >/dev/null && env -0'
    base = clean_environment()
    done = subprocess.run(
        ['bash', '-c', script], env=base, cwd=ROOT, capture_output=True, check=False
    )
    if done.returncode:
        raise SetupError(f'install/setup.bash cannot be sourced: {done.stderr.decode().strip()}')
    lines = []
    for entry in done.stdout.decode().split('\0'):
        name, _, value = entry.partition('=')
        if not name or name in {'_', 'SHLVL', 'PWD', 'OLDPWD'} or base.get(name) == value:
            continue
        old = base.get(name, '')
        if name.endswith('PATH'):  # a path that grows: keep what the caller has now
            value = value.removesuffix(old).removesuffix(':')
            lines.append(f'export {name}={shlex.quote(value)}"${{{name}:+:${name}}}"')
        elif name.startswith('_') or (name.startswith('ROS_') and 'RANGE' not in name):
            lines.append(f'export {name}={shlex.quote(value)}')
        else:  # a choice that is the caller's
            lines.append(f'export {name}="${{{name}:-{value}}}"')
    ENVIRONMENT.parent.mkdir(exist_ok=True)
    ENVIRONMENT.write_text('# Made by tools/bootstrap.py\n' + '\n'.join(sorted(lines)) + '\n')


def warm_kernels() -> None:
    """Compile the numerical kernels once, before nine processes want them at the same time."""
    sources = [
        path
        for path in (ROOT / 'src').rglob('*.py')
        if 'kernel(' in path.read_text(errors='replace') and 'test' not in path.parts
    ]
    wanted = digest(sources, (VENV / 'satvib-requirements').read_text())
    stamp = CACHE / 'kernels'
    if is_current(stamp, wanted):
        return
    say('compiling the numerical kernels')
    modules = [
        '.'.join(path.relative_to(ROOT / 'src').parts[1:])[: -len('.py')] for path in sources
    ]
    code = 'import importlib\nfor m in ' + repr(sorted(modules)) + ': importlib.import_module(m)'
    script = f'. {shlex.quote(str(ENVIRONMENT))} && exec {shlex.quote(str(VENV / "bin" / "python"))} -c "$0"'
    run(['bash', '-c', script, code], 'compiling kernels')
    stamp.write_text(wanted)


if __name__ == '__main__':
    sys.exit(main())
