# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What sourcing the built workspace changes, kept in one file, so that a command need not source it again."""

import shlex
import subprocess

from workspace.base import ENVIRONMENT, INHERITED, ROOT, SetupError, write_whole


def write_environment(base: dict[str, str]) -> None:
    """Source `install/setup.bash` and write what it changed to `.cache/environment.sh`.

    Args:
        base: the environment to source it in.

    Raises:
        SetupError: it cannot be sourced.
    """
    script = f'. {shlex.quote(str(ROOT / "install" / "setup.bash"))} >/dev/null && env -0'
    done = subprocess.run(
        ['bash', '-c', script],
        env=base,
        cwd=ROOT,
        capture_output=True,
        check=False,
        pass_fds=INHERITED,
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
    write_whole(ENVIRONMENT, '# Made by tools/bootstrap.py\n' + '\n'.join(sorted(lines)) + '\n')
