# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of the house, checked over the source. Truth: docs/architecture.md."""

import ast
import re
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
SOURCES = sorted(p for p in (ROOT / 'src').rglob('*.py') if 'test' not in p.relative_to(ROOT).parts)
# nodes, and the parts of theirs that fill messages
SHELL = ('_node.py', '_messages.py')
MATHEMATICS = {'satvib_ident', 'satvib_control', 'satvib_plant_sim', 'satvib_daq_bridge'}
# dependencies point one way: bringup -> {plant_sim, daq_bridge, control, ident} -> common -> msgs
MAY_IMPORT = {
    'satvib_common': {'satvib_msgs'},
    'satvib_ident': {'satvib_common', 'satvib_msgs'},
    'satvib_control': {'satvib_common', 'satvib_msgs', 'satvib_ident'},
    'satvib_plant_sim': {'satvib_common', 'satvib_msgs'},
    'satvib_daq_bridge': {'satvib_common', 'satvib_msgs', 'satvib_plant_sim'},
}
# the control laws know these parts of identification and nothing else of it
SHARED_IDENTIFICATION = (
    'satvib_ident.models.iir_model',
    'satvib_ident.excitation',
    'satvib_ident.models.model_file',
)


def imports(path):
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom) and node.module:
            yield node.module


def package(path):
    return path.relative_to(ROOT / 'src').parts[0]


@pytest.mark.parametrize('path', SOURCES, ids=lambda p: str(p.relative_to(ROOT / 'src')))
def test_a_source_file_keeps_the_rules(path):
    text = path.read_text()
    lines = text.splitlines()
    assert lines[0].startswith('# SPDX-FileCopyrightText:'), 'SPDX header'
    assert lines[1] == '# SPDX-License-Identifier: Apache-2.0', 'SPDX header'
    limit = 200 if path.name.endswith('_node.py') else 400
    assert len(lines) <= limit, f'{len(lines)} lines, at most {limit}'
    name = package(path)
    for module in imports(path):
        top = module.split('.')[0]
        if name in MATHEMATICS and not path.name.endswith('_node.py'):
            assert top != 'rclpy', 'mathematics never imports rclpy'
        if name in MATHEMATICS and not path.name.endswith(SHELL):
            assert not top.endswith('_msgs'), 'mathematics knows no messages'
            assert not module.startswith('satvib_common.ros'), 'mathematics knows no node helpers'
        if top.startswith('satvib_') and top != name and name in MAY_IMPORT:
            assert top in MAY_IMPORT[name], f'{name} may not import {top}'
        if name == 'satvib_control' and top == 'satvib_ident':
            assert module.startswith(SHARED_IDENTIFICATION), f'control may not import {module}'


def test_only_compiled_functions_have_no_types():
    """Numba gives a compiled function its types; for any other they are written down. See pyproject.toml."""
    compiled = ('njit', 'kernel', 'intrinsic')
    found = []
    for path in SOURCES:
        tree = ast.parse(path.read_text())
        inside = {
            id(part)
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef)
            and any(ast.unparse(d).startswith(compiled) for d in node.decorator_list)
            for part in ast.walk(node)
        }
        found += [
            f'{path.relative_to(ROOT)}:{node.lineno}: {node.name}'
            for node in ast.walk(tree)
            if isinstance(node, ast.FunctionDef) and node.returns is None and id(node) not in inside
        ]
    assert not found


def test_messages_put_the_header_first_and_explain_every_field():
    """Every field stands under a comment; the first field is the header."""
    for path in sorted((ROOT / 'src/satvib_msgs/msg').glob('*.msg')):
        lines = [line.strip() for line in path.read_text().splitlines()]
        fields = [
            (i, line) for i, line in enumerate(lines) if line and '=' not in line and line[0] != '#'
        ]
        assert fields[0][1] == 'std_msgs/Header header', path.name
        commented = False
        for i, line in enumerate(lines):
            if not line:
                commented = False
            elif line[0] == '#':
                commented = True
            elif '=' not in line:
                assert commented, f'{path.name}:{i + 1}: {line} has no comment'


def test_no_tracked_file_names_a_path_of_one_machine():
    """A path of one machine in a file means that it works on one machine."""
    listed = subprocess.run(
        ['git', 'ls-files', '-z'], cwd=ROOT, capture_output=True, text=True, check=False
    )
    if listed.returncode:
        pytest.skip('not a git checkout')
    found = []
    for name in filter(None, listed.stdout.split('\0')):
        path = ROOT / name
        if path.suffix in {'.png', '.lock'} or not path.is_file():
            continue
        text = path.read_text(errors='ignore')
        found += [f'{name}: {m}' for m in re.findall(r'(?<![\w.$}])/(?:home|root|work)/\w+', text)]
    assert not found
