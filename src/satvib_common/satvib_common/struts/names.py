# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Names and places of the struts; without NumPy, for those that only list."""


def strut_names(count: int) -> tuple[str, ...]:
    """Give strut_1, strut_2, ...: the names of the struts, which are also their namespaces."""
    return tuple(f'strut_{number}' for number in range(1, count + 1))


def strut_label(name: str) -> str:
    """Give the name of a strut for people: 'Strut 1'."""
    return name.replace('_', ' ').capitalize()


def strut_angles(count: int, first: float, turn: float = 360.0) -> list[float]:
    """Give the angles of struts that are spread evenly, the first at `first`, in the unit of `turn`."""
    return [first + turn * index / count for index in range(count)]
