# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a bag as bytes, from whatever files there are, and what is to be said about them.

A bag is a folder with metadata.yaml, a folder without it (its recording was cut short), or one file. A file that is cut
short gives what is whole in it, and that is said. A file with damaged bytes is refused, because a value in it may be
wrong without a sign; with `recover` it gives what can be read.
"""

import tempfile
from collections import defaultdict
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path, PurePath
from typing import Any, NamedTuple

import zstandard
from mcap.records import Channel, Message, Metadata, Schema
from satvib_common.errors import SatvibError, printable
from satvib_common.files.yaml_file import load_yaml, parse_yaml

from satvib_experiment.recording.bag.mcap_file import Ending, McapFile, unpacked_zstd
from satvib_experiment.recording.bag.sqlite_file import SqliteFile

RECOVER = '--recover'  # the option of the commands that read bags
ENDINGS = ('.mcap', '.db3', '.mcap.zstd', '.db3.zstd')
_METADATA = 'metadata.yaml'
_MOST_SHRINKING = 1000
_PIECE = 1 << 20
_LARGEST_MESSAGE = 1 << 24  # bytes; ours have a few hundred


class RawMessage(NamedTuple):
    """A message as it was recorded; `time` in ns."""

    topic: str
    time: int
    data: bytes


@dataclass
class BagContent:
    """What was read of a bag.

    Attributes:
        topics: types by topic, of all topics.
        definitions: format and text by type.
        messages: by type, in the order of the recording.
        custom: texts that the recorder left.
        notes: what is to be said about the files.
        is_cut: the recording ends where it was not to end.
    """

    topics: dict[str, set[str]] = field(default_factory=lambda: defaultdict(set))
    definitions: dict[str, tuple[str, str]] = field(default_factory=dict)
    messages: dict[str, list[RawMessage]] = field(default_factory=lambda: defaultdict(list))
    custom: dict[str, str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    is_cut: bool = False


def is_bag_file(path: Path) -> bool:
    """Whether the name of a file is that of a bag."""
    return path.name.endswith(ENDINGS)


def find_bag(path: Path) -> Path:
    """Find the bag that a path means: the bag itself, or a run's folder with the bag inside.

    Raises:
        SatvibError: there is nothing, or no bag.
    """
    if not path.exists():
        raise SatvibError(f'{path}: no such file or folder')
    if path.is_file() and is_bag_file(path):
        return path
    if path.is_dir():
        for folder in (path, path / 'bag'):
            if (folder / _METADATA).is_file() or _files_in(folder):
                return folder
    raise SatvibError(f'{path}: not a bag: neither metadata.yaml nor .mcap nor .db3')


def read_bag(bag: Path, kinds: frozenset[str], recover: bool = False) -> BagContent:
    """Read the messages of some types.

    Args:
        bag: what `find_bag` gave.
        kinds: types of messages.
        recover: read what can be read of damaged files.

    Raises:
        SatvibError: damaged, or not readable.
    """
    content = BagContent()
    about = _metadata(bag, content, recover)
    files = _files(bag, about, content, recover)
    by_message = str(about.get('compression_mode', '')).lower() == 'message'
    endings = []
    with ExitStack() as stack:
        for path in files:
            plain, ending = _plain(path, stack)
            read = _read_mcap if plain.suffix == '.mcap' else _read_sqlite
            own = read(plain, kinds, recover, content)
            endings.append((path, max(ending, own, key=list(Ending).index)))
    for path, ending in endings:
        _tell(path, ending, content, recover, several=len(files) > 1)
    if by_message:
        for messages in content.messages.values():
            messages[:] = [
                m._replace(data=unpacked_zstd(m.data, _LARGEST_MESSAGE)) for m in messages
            ]
    return content


def _tell(path: Path, ending: Ending, content: BagContent, recover: bool, several: bool) -> None:
    """Say how a file ended; refuse one that is damaged."""
    count = sum(len(messages) for messages in content.messages.values())
    name = path.name if several else 'the file'
    if ending is Ending.DAMAGED and not recover:
        raise SatvibError(
            f'{path}: damaged; a value in it may be wrong without a sign. {RECOVER} reads what is left'
        )
    if ending is not Ending.WHOLE and count == 0:
        raise SatvibError(f'{path}: damaged or cut short: no whole message is left in it')
    content.is_cut |= ending is not Ending.WHOLE
    if ending is Ending.CUT:
        content.notes.append(
            f'The recording was cut short: {name} breaks off; its whole messages were read ({count}).'
        )
    elif ending is Ending.DAMAGED:
        content.notes.append(
            f'Bytes of the recording are damaged ({name}); what can be read was read ({count} messages), '
            'and a value may be wrong.'
        )


def _metadata(bag: Path, content: BagContent, recover: bool) -> dict[str, Any]:
    """What metadata.yaml says; empty where there is none."""
    path = bag / _METADATA
    if not bag.is_dir():
        return {}
    if not path.is_file():
        content.notes.append(
            'There is no metadata.yaml: the recording was cut short. Its files were read as they are.'
        )
        return {}
    try:
        whole = load_yaml(path)
        about = whole['rosbag2_bagfile_information']
        if not isinstance(about, dict) or not isinstance(about['relative_file_paths'], list):
            raise TypeError
    except (SatvibError, KeyError, TypeError) as error:
        if recover:
            content.notes.append('metadata.yaml is damaged; the files were read as they are.')
            return {}
        reason = (
            str(error).removeprefix(f'{path}: ')
            if isinstance(error, SatvibError)
            else 'not of a bag'
        )
        raise SatvibError(
            f'{path}: damaged or cut short: {printable(reason, 200)}. {RECOVER} reads the files as they are'
        ) from None
    _take_custom(about.get('custom_data'), content)
    return about


def _take_custom(custom: Any, content: BagContent) -> None:
    if isinstance(custom, dict):
        content.custom |= {
            k: v for k, v in custom.items() if isinstance(k, str) and isinstance(v, str)
        }


def _files(bag: Path, about: dict[str, Any], content: BagContent, recover: bool) -> list[Path]:
    if not bag.is_dir():
        return [bag]
    if not about:
        return _files_in(bag)
    named = [bag / PurePath(str(name)).name for name in about['relative_file_paths']]
    missing = [path.name for path in named if not path.is_file()]
    present = [path for path in named if path.is_file() and is_bag_file(path)]
    if missing and not (recover and present):
        hint = f'; {RECOVER} reads the others' if present else ''
        raise SatvibError(f'{bag}: incomplete: missing: {printable(", ".join(missing), 200)}{hint}')
    if missing:
        content.notes.append(f'Files of the bag are missing: {printable(", ".join(missing), 200)}.')
    if not present:
        raise SatvibError(f'{bag}: no file in it that is known: {", ".join(ENDINGS)}')
    return present


def _files_in(folder: Path) -> list[Path]:
    """Bag files of a folder; those of a split recording in order, name_2 before name_10."""
    if not folder.is_dir():
        return []
    found = [path for path in folder.iterdir() if path.is_file() and is_bag_file(path)]
    return sorted(found, key=lambda path: (len(path.name), path.name))


def _plain(path: Path, stack: ExitStack) -> tuple[Path, Ending]:
    """The file without its compression; as much as there is of one that is cut."""
    if path.suffix != '.zstd':
        return path, Ending.WHOLE
    target = Path(stack.enter_context(tempfile.TemporaryDirectory())) / path.name.removesuffix(
        '.zstd'
    )
    most = _MOST_SHRINKING * (path.stat().st_size + 1000)
    with (
        path.open('rb') as source,
        target.open('wb') as sink,
        zstandard.ZstdDecompressor().stream_reader(source, read_across_frames=True) as pieces,
    ):
        try:
            while piece := pieces.read(_PIECE):
                sink.write(piece)
                if sink.tell() > most:
                    return target, Ending.DAMAGED
        except zstandard.ZstdError:
            return target, Ending.DAMAGED
    return target, Ending.WHOLE


def _read_mcap(path: Path, kinds: frozenset[str], recover: bool, content: BagContent) -> Ending:
    file = McapFile(path, recover)
    schemas: dict[int, Schema] = {}
    channels: dict[int, tuple[str, str]] = {}
    for record in file.records():
        if isinstance(record, Message):
            topic, kind = channels.get(record.channel_id, ('', ''))
            if kind in kinds:
                content.messages[kind].append(RawMessage(topic, record.log_time, record.data))
            elif not kind:
                file.ending = Ending.DAMAGED  # of a channel that nothing is known of
        elif isinstance(record, Schema):
            schemas[record.id] = record
            text = record.data.decode(errors='replace')
            content.definitions.setdefault(record.name, (record.encoding, text))
        elif isinstance(record, Channel):
            schema = schemas.get(record.schema_id)
            kind = schema.name if schema else ''
            channels[record.id] = (record.topic, kind)
            content.topics[record.topic].add(kind or 'unknown')
        elif isinstance(record, Metadata) and record.name == 'rosbag2':
            _take_custom(_inner_custom(record), content)
    return file.ending


def _inner_custom(record: Metadata) -> Any:
    """The custom data of the metadata that stands in the file itself."""
    try:
        about = parse_yaml(record.metadata.get('serialized_metadata', ''), 'metadata')
    except SatvibError:
        return None
    if isinstance(about, dict):
        about = about.get('rosbag2_bagfile_information', about)
    return about.get('custom_data') if isinstance(about, dict) else None


def _read_sqlite(path: Path, kinds: frozenset[str], recover: bool, content: BagContent) -> Ending:
    file = SqliteFile(path, recover)
    for topic, kind, time, data in file.messages(kinds):
        content.messages[kind].append(RawMessage(topic, time, data))
    for topic, kind in file.topics.values():
        content.topics[topic].add(kind)
    for kind, definition in file.definitions.items():
        content.definitions.setdefault(kind, definition)
    return file.ending


def messages_of(content: BagContent, kind: str) -> Iterator[RawMessage]:
    """Messages of one type in order of time."""
    yield from sorted(content.messages.get(kind, ()), key=lambda message: message.time)
