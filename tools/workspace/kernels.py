# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Compiles the numerical kernels once, before nine processes want them at the same time."""

import shlex

from workspace import environment
from workspace.base import (
    CACHE,
    ENVIRONMENT,
    PYTHON,
    ROOT,
    digest,
    is_current,
    run,
    say,
    write_whole,
)


def warm_kernels() -> None:
    """Import every module with kernels, when one of them has changed.

    Raises:
        SetupError: a kernel does not compile.
    """
    sources = [
        path
        for path in (ROOT / 'src').rglob('*.py')
        if 'kernel(' in path.read_text(errors='replace') and 'test' not in path.parts
    ]
    wanted = digest(sources, environment.STAMP.read_text())
    stamp = CACHE / 'kernels'
    if is_current(stamp, wanted):
        return
    say('compiling the numerical kernels')
    modules = [
        '.'.join(path.relative_to(ROOT / 'src').parts[1:])[: -len('.py')] for path in sources
    ]
    code = 'import importlib\nfor m in ' + repr(sorted(modules)) + ': importlib.import_module(m)'
    script = f'. {shlex.quote(str(ENVIRONMENT))} && exec {shlex.quote(str(PYTHON))} -c "$0"'
    run(['bash', '-c', script, code], 'compiling kernels')
    write_whole(stamp, wanted)
