# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""YAML files, read within bounds: what is wrong is one line with the number of the line, at once.

It is YAML as `yaml.safe_load` reads it, merge keys included, with these differences: a key given twice is refused,
1e-3 is a number, `off`, `on`, `yes`, `no` are text, and there are no dates, sets or bytes, which no setting takes. The
bounds are checked before any value is built, so that a small file with nested aliases cannot fill the memory.
"""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from satvib_common.errors import SatvibError, printable

LARGEST_FILE = 1_000_000  # characters
DEEPEST = 50  # levels of nesting
MOST_VALUES = 100_000  # keys and values, with every alias written out
_LARGEST_NUMBER = 1023  # bits; a larger one is no float

_TAG = 'tag:yaml.org,2002:'
_MERGE = f'{_TAG}merge'
_DATE = f'{_TAG}timestamp'
_KNOWN_TAGS = {
    f'{_TAG}{n}' for n in ('str', 'int', 'float', 'bool', 'null', 'seq', 'map', 'merge', 'value')
}
# what PyYAML's constructors raise for a text that only looks like a number or a date
_NO_VALUE = (ValueError, TypeError, KeyError, IndexError, AttributeError, OverflowError)


def _line(node: yaml.Node) -> int:
    return int(node.start_mark.line) + 1


class _Loader(yaml.SafeLoader):
    """The loader; see the module."""

    def __init__(self, text: str) -> None:
        super().__init__(text)
        self._depth = 0
        self._sizes: dict[int, int] = {}

    def compose_node(self, parent: yaml.Node | None, index: int) -> yaml.Node | None:
        """Compose a node; counts what it holds, and refuses what is too deep, too large or no key."""
        self._depth += 1
        if self._depth > DEEPEST:
            line = self.peek_event().start_mark.line + 1  # type: ignore[no-untyped-call]
            raise SatvibError(f'line {line}: nested deeper than {DEEPEST} levels')
        is_alias = self.check_event(yaml.AliasEvent)
        node: yaml.Node | None = super().compose_node(parent, index)
        self._depth -= 1
        if is_alias and id(node) not in self._sizes and node is not None:
            raise SatvibError(f'line {_line(node)}: an alias of what it lies in')
        if node is not None and id(node) not in self._sizes:
            self._sizes[id(node)] = self._size(node)
        return node

    def _size(self, node: yaml.Node) -> int:
        """Number of values in a node whose children are composed."""
        size = 1
        if node.tag not in _KNOWN_TAGS:
            shown = printable(node.tag.removeprefix(_TAG), 40)
            if node.tag == _DATE:
                shown = f'{printable(str(node.value), 40)} is a date, which no setting takes'
                raise SatvibError(f'line {_line(node)}: {shown}; put text in quotes')
            raise SatvibError(f'line {_line(node)}: the tag {shown} is not known here')
        children: list[yaml.Node] = []
        if isinstance(node, yaml.MappingNode):
            self._check_keys(node)
            children = [child for pair in node.value for child in pair]
        elif isinstance(node, yaml.SequenceNode):
            children = node.value
        for child in children:
            size += self._sizes[id(child)]
        if size > MOST_VALUES:
            raise SatvibError(
                f'line {_line(node)}: more than {MOST_VALUES} values, with the aliases written out'
            )
        return size

    def _check_keys(self, node: yaml.MappingNode) -> None:
        """Refuse keys that are no text or number, and keys given twice; merged keys are no repetition."""
        seen: set[Hashable] = set()
        for key_node, _ in node.value:
            if not isinstance(key_node, yaml.ScalarNode):
                raise SatvibError(
                    f'line {_line(key_node)}: a key is expected, not a list or a mapping; braces in '
                    'braces are often a template that was not filled in'
                )
            if key_node.tag == _MERGE:
                continue
            key = self.construct_object(key_node, deep=True)
            if not isinstance(key, Hashable):
                raise SatvibError(f'line {_line(key_node)}: {key_node.value} cannot be a key')
            if key in seen:
                raise SatvibError(f'line {_line(key_node)}: {key} is given twice')
            seen.add(key)

    def construct_object(self, node: yaml.Node, deep: bool = False) -> Any:
        """Construct a value; a text that only looks like a number or a date is refused with its line."""
        try:
            value = super().construct_object(node, deep)
        except _NO_VALUE as error:
            shown = printable(str(node.value), 40)
            raise SatvibError(f'line {_line(node)}: {shown} has no value: {error}') from None
        if type(value) is int and value.bit_length() > _LARGEST_NUMBER:
            raise SatvibError(f'line {_line(node)}: a number of {len(node.value)} digits')
        return _whole_characters(value, node) if isinstance(value, str) else value


def _whole_characters(text: str, node: yaml.Node) -> str:
    """Join pairs of surrogates, as JSON writes them; refuse one alone."""
    if not any('\ud800' <= c <= '\udfff' for c in text):
        return text
    try:
        return text.encode('utf-16', 'surrogatepass').decode('utf-16')
    except UnicodeDecodeError:
        raise SatvibError(
            f'line {_line(node)}: {printable(text, 40)} holds half a character; it cannot be '
            'written to a file, and cannot be part of a folder name'
        ) from None


_Loader.yaml_implicit_resolvers = {
    first: [pair for pair in pairs if first in 'tTfF' or pair[0] != 'tag:yaml.org,2002:bool']
    for first, pairs in yaml.SafeLoader.yaml_implicit_resolvers.items()
}
_Loader.add_implicit_resolver(
    'tag:yaml.org,2002:float',
    re.compile(r'^[-+]?(\d+(\.\d*)?|\.\d+)[eE][-+]?\d+$'),
    list('-+0123456789.'),
)


def parse_yaml(text: str, where: str) -> Any:
    """Parse YAML text; `where` begins the message when it is broken.

    Raises:
        SatvibError: it is not YAML, or beyond the bounds of this module.
    """
    if len(text) > LARGEST_FILE:
        raise SatvibError(f'{where}: longer than {LARGEST_FILE} characters')
    try:
        return yaml.load(text, _Loader)  # noqa: S506 - derived from SafeLoader
    except SatvibError as error:
        raise SatvibError(f'{where}: {error}') from None
    except yaml.reader.ReaderError as error:
        line = text.count('\n', 0, error.position) + 1
        wrong = f'U+{ord(text[error.position]):04X}'
        raise SatvibError(f'{where}: line {line}: not YAML: the character {wrong}') from None
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        at = f'line {mark.line + 1}: ' if mark else ''
        what = ' '.join(filter(None, (error.context, error.problem)))
        raise SatvibError(f'{where}: {at}not YAML: {what}') from None
    except (yaml.YAMLError, *_NO_VALUE) as error:  # the scanner takes \U0FFFFFFF for a character
        raise SatvibError(f'{where}: not YAML: {error}') from None


def load_yaml(path: Path) -> Any:
    """Read and parse a YAML file.

    Raises:
        SatvibError: the file is missing, unreadable, empty, not YAML, or beyond the bounds of this module.
    """
    try:
        with path.open(encoding='utf-8') as source:
            text = source.read(LARGEST_FILE + 1)
    except UnicodeDecodeError as error:
        raise SatvibError(
            f'{path}: not UTF-8 text (byte {error.start}); save it as UTF-8'
        ) from None
    except (OSError, ValueError) as error:  # ValueError: NUL in the path
        reason = getattr(error, 'strerror', None) or error
        raise SatvibError(f'{path}: cannot be read: {reason}') from None
    data = parse_yaml(text, str(path))
    if data is None:
        raise SatvibError(f'{path}: is empty')
    return data
