# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""State of algorithms has names that belong to one module. Truth of all tests: rule 7 of docs/architecture.md."""

import ast

import pytest
from source_tree import PACKAGES, Module, modules, target

MODULES = modules()


def _constants(module: Module) -> dict[str, object]:
    """Names bound to plain numbers at a module's top level; a run `A, B = range(2)` counts as numbers."""
    found: dict[str, object] = {}
    for statement in module.tree.body:
        if not isinstance(statement, ast.Assign):
            continue
        for aim in statement.targets:
            names = aim.elts if isinstance(aim, ast.Tuple) else [aim]
            value = statement.value
            values = value.elts if isinstance(value, ast.Tuple) else [value] * len(names)
            for name, one in zip(names, values, strict=False):
                number = isinstance(one, ast.Constant) and type(one.value) in {int, float}
                row = isinstance(one, ast.Call) and ast.unparse(one.func) == 'range'
                if isinstance(name, ast.Name) and (number or row):
                    found[name.id] = one
    return found


@pytest.mark.parametrize('package', PACKAGES)
def test_no_module_uses_the_slots_of_another(package):
    """A number imported from another module is no place in an array: that is what enums are for.

    Sizes and offsets (`x[:SIZE]`, `x[OFFSET + i]`) are no places.
    """
    found = []
    for module in (m for m in MODULES.values() if m.package == package):
        slots = {}
        for item in module.imports:
            at = target(item, MODULES)
            if at is not None and item.name in _constants(MODULES[at]):
                slots[item.alias or item.name] = at
        for node in ast.walk(module.tree):
            if isinstance(node, ast.Subscript):
                index = node.slice.elts if isinstance(node.slice, ast.Tuple) else [node.slice]
                used = {n.id for n in index if isinstance(n, ast.Name)}
                found += [
                    f'{module.name}:{node.lineno}: {name} of {slots[name]}'
                    for name in sorted(used & set(slots))
                ]
    assert found == []


@pytest.mark.parametrize('package', PACKAGES)
def test_states_are_enums_and_no_rows_of_numbers(package):
    """`A, B, C = range(3)` and `A, B = 0.0, 1.0` at the top of a module are an enum without its name."""
    found = [
        f'{module.name}:{statement.lineno}'
        for module in MODULES.values()
        if module.package == package
        for statement in module.tree.body
        if isinstance(statement, ast.Assign)
        and isinstance(statement.targets[0], ast.Tuple)
        and set(_constants(module)) & {getattr(n, 'id', '') for n in statement.targets[0].elts}
        and _consecutive(statement.value)
    ]
    assert found == []


def _consecutive(value: ast.expr) -> bool:
    """A range, or 0, 1, 2 and so on; other numbers may be those of a library or a device."""
    if isinstance(value, ast.Call):
        return True
    numbers = [n.value for n in getattr(value, 'elts', []) if isinstance(n, ast.Constant)]
    return len(numbers) > 1 and numbers == list(range(len(numbers)))
