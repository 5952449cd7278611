# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""TDMS files of LabVIEW and other programs of National Instruments (.tdms), by npTDMS.

A channel is `group/channel`, or its own name where no other group has it. Unit and sample period are properties of a
channel: `unit_string` and `wf_increment`.
"""

import logging
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.records.formats.channels import Channel, Channels
from satvib_common.records.formats.kinds import TDMS, needs, one_line


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the channels of a file; they can be loaded inside the `with`.

    Args:
        path: the file.
        recover: read what is there of a file that is cut.

    Raises:
        SatvibError: npTDMS is missing, or the file is damaged or cut.
    """
    with needs(path, TDMS.what, 'nptdms'):
        from nptdms import TdmsFile
        from nptdms.log import log_manager
    log_manager.set_level(logging.CRITICAL)  # what is wrong is said here, in one line
    with ExitStack() as stack:
        with one_line(path, TDMS.what):
            # by the open file: an index that lies beside it may be of another file
            source = stack.enter_context(path.open('rb'))
            file = stack.enter_context(TdmsFile.open(source))
            status = file.file_status
            lost = _lost(status.channel_statuses or {})
            found = [_channel(path, c) for g in file.groups() for c in g.channels()]
            missed = [lost.get(c.path, 0) for g in file.groups() for c in g.channels()]
        what = 'the last segment is cut or was not closed'
        if status.incomplete_final_segment and not recover:
            raise SatvibError(f'{path}: {what}; --recover reads what is there')
        notes = [f'{what}; what is there is used'] if status.incomplete_final_segment else []
        yield Channels(_shortened(found, missed), notes=notes)


def _lost(statuses: Mapping[str, Any]) -> dict[str, int]:
    """How many samples of each channel are missed at the end of a file that is cut."""
    return {path: s.expected_length - s.read_length for path, s in statuses.items()}


def _shortened(found: list[Channel], missed: list[int]) -> list[Channel]:
    """Let channels that were of one length end together, where a cut left more of one than of the other."""
    whole = [c.size + n for c, n in zip(found, missed, strict=True)]
    ends = {n: min(c.size for c, m in zip(found, whole, strict=True) if m == n) for n in whole}
    return [replace(c, size=ends[n]) for c, n in zip(found, whole, strict=True)]


def _channel(path: Path, channel: Any) -> Channel:
    name = f'{channel.group_name}/{channel.name}'
    with one_line(path, TDMS.what, f'channel {name}'):
        size = len(channel)
        if not 0 <= size <= path.stat().st_size:
            raise SatvibError(
                f'{path}: damaged: channel {name} has {size} samples, the file fewer bytes'
            )
        reason = '' if channel.dtype.kind in 'buifM' else 'holds no numbers'
        properties = channel.properties
        return Channel(
            name=name,
            short=channel.name,
            group=channel.group_name,
            size=size,
            load=_loader(path, name, channel),
            unit=str(properties.get('unit_string', '') or ''),
            period=_number(properties.get('wf_increment')),
            start=_number(properties.get('wf_start_offset')),
            reason=reason,
        )


def _loader(path: Path, name: str, channel: Any) -> Callable[[], Any]:
    def load() -> Any:
        with one_line(path, TDMS.what, f'channel {name}'):
            return channel[:]

    return load


def _number(value: Any) -> float:
    return float(value) if isinstance(value, int | float) and value > 0.0 else 0.0
