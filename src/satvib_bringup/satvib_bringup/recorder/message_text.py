# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The text of a message's definition, as a bag carries it, and the hash of its type.

A bag that holds the definitions can be read anywhere, without ROS and without satvib. The text is the .msg file, then
for every nested type a line of 80 equals signs, `MSG: package/Name`, and its file.
"""

import re
from functools import cache
from pathlib import Path

from ament_index_python.packages import PackageNotFoundError, get_package_share_directory
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from satvib_common.errors import SatvibError

_FIELD = re.compile(r'^\s*([A-Za-z][\w/]*)(?:<=\d+)?(?:\[[^\]]*\])?\s+[a-zA-Z]\w*')
_BASIC = frozenset(
    {
        *('bool', 'byte', 'char', 'float32', 'float64', 'string', 'wstring'),
        *(f'{sign}int{bits}' for sign in ('', 'u') for bits in (8, 16, 32, 64)),
    }
)
_SEPARATOR = '=' * 80


@cache
def definition(kind: str) -> str:
    """Text of a type such as 'satvib_msgs/msg/Schedule' with all that it nests.

    Raises:
        SatvibError: its package is not installed.
    """
    texts: dict[str, str] = {}
    _collect(kind.replace('/msg/', '/'), texts)
    first, *nested = texts
    parts = [texts[first]]
    parts += [f'{_SEPARATOR}\nMSG: {name}\n{texts[name]}' for name in nested]
    return '\n'.join(parts)


def _collect(name: str, texts: dict[str, str]) -> None:
    if name in texts:
        return
    package, _, short = name.partition('/')
    try:
        path = Path(get_package_share_directory(package), 'msg', f'{short}.msg')
        texts[name] = path.read_text(encoding='utf-8').rstrip('\n')
    except (PackageNotFoundError, OSError):
        raise SatvibError(f'{name}: its definition is not installed') from None
    for line in texts[name].splitlines():
        found = _FIELD.match(line.partition('#')[0])
        if found and found[1] not in _BASIC:
            inner = found[1].replace('/msg/', '/')
            _collect(inner if '/' in inner else f'{package}/{inner}', texts)


@cache
def type_hash(kind: str, text: str) -> str:
    """RIHS01 hash of a type, from the text of its definition."""
    store = get_typestore(Stores.EMPTY)
    store.register(get_types_from_msg(text, kind))
    return store.hash_rihs01(kind)
