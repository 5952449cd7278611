# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Processor time and memory of processes, from /proc."""

import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

_TICK = os.sysconf('SC_CLK_TCK')


@dataclass(frozen=True)
class Usage:
    """Of one process: processor time in s, resident memory in MB."""

    cpu: float
    memory: float


def usage_of(pids: Mapping[str, int]) -> dict[str, Usage]:
    """Give the usage of processes by name; those that have ended are left out."""
    found = {}
    for name, pid in pids.items():
        try:
            fields = Path(f'/proc/{pid}/stat').read_text().rpartition(')')[2].split()
            status = Path(f'/proc/{pid}/status').read_text()
        except OSError:
            continue
        resident = next((line for line in status.splitlines() if line.startswith('VmRSS')), '')
        memory = int(resident.split()[1]) / 1024.0 if resident else 0.0
        found[name] = Usage((int(fields[11]) + int(fields[12])) / _TICK, memory)
    return found


def children_of(parent: int, folder: Path) -> dict[str, int]:
    """Give the processes whose command line names a folder, by the node or executable that they run."""
    found = {'runner': parent}
    for path in Path('/proc').glob('[0-9]*/cmdline'):
        try:
            words = path.read_bytes().decode().split('\0')
        except OSError:
            continue
        pid = int(path.parent.name)
        if (
            pid == parent
            or not any(str(folder) in word for word in words)
            or '--ros-args' not in words
        ):
            continue
        named = dict(
            word.split(':=', 1) for word in words if word.startswith(('__ns:=', '__node:='))
        )
        name = f'{named.get("__ns", "")}/{named.get("__node", "strut")}'.lstrip('/')
        found[name] = pid
    return found
