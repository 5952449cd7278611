# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The rules of the layout, checked over the source. Truth of all tests: the rules in docs/architecture.md."""

import ast
import re
import subprocess
from collections import Counter
from pathlib import Path

import pytest
from source_tree import PACKAGES, ROOT, Module, circles, modules, tracked_texts

MODULES = modules()
SOURCES = sorted(p for p in (ROOT / 'src').rglob('*.py') if 'test' not in p.relative_to(ROOT).parts)
DOORS = [m for m in MODULES.values() if m.is_door]
MOST_MODULES = 12  # in one folder, without __init__.py
# rooms that know ROS: their own names anywhere in the path, or this very room
ROS_ROOMS = ('nodes', 'live')
ROS_ROOM = 'satvib_common.ros'
# what belongs to ROS: the client library, the messages, and satvib's own helpers of nodes
ROS_MODULES = (
    'rclpy',
    'launch',
    'launch_ros',
    'lifecycle_msgs',
    'std_srvs',
    'satvib_msgs',
    ROS_ROOM,
)
MAY_IMPORT = {
    'satvib_common': set(),
    'satvib_ident': {'satvib_common'},
    'satvib_control': {'satvib_common', 'satvib_ident'},
    'satvib_plant_sim': {'satvib_common'},
    'satvib_daq_bridge': {'satvib_common', 'satvib_plant_sim'},
    'satvib_experiment': {'satvib_common', 'satvib_ident', 'satvib_control', 'satvib_plant_sim'},
    'satvib_studies': set(PACKAGES) - {'satvib_daq_bridge', 'satvib_bringup'},
    'satvib_bringup': set(PACKAGES),
}
# the control laws know these parts of identification and nothing else of it
SHARED_IDENTIFICATION = (
    'satvib_ident.models.iir_model',
    'satvib_ident.excitation',
    'satvib_ident.models.model_file',
)


def knows_ros(name: str) -> bool:
    """Whether a module may know ROS."""
    return bool(set(name.split('.')) & set(ROS_ROOMS)) or f'{name}.'.startswith(f'{ROS_ROOM}.')


def of_ros(module: str) -> bool:
    """Whether an imported module belongs to ROS."""
    return any(f'{module}.'.startswith(f'{known}.') for known in ROS_MODULES) or module.split('.')[
        0
    ].endswith('_msgs')


@pytest.mark.parametrize('path', SOURCES, ids=lambda p: str(p.relative_to(ROOT / 'src')))
def test_a_source_file_keeps_the_rules(path):
    """SPDX header, length, ROS in its rooms only, packages in one direction."""
    lines = path.read_text(encoding='utf-8').splitlines()
    assert lines[0].startswith('# SPDX-FileCopyrightText:'), 'SPDX header'
    assert lines[1] == '# SPDX-License-Identifier: Apache-2.0', 'SPDX header'
    limit = 200 if path.name.endswith('_node.py') else 400
    assert len(lines) <= limit, f'{len(lines)} lines, at most {limit}'
    module = next((m for m in MODULES.values() if m.path == path), None)
    if module is None:  # setup.py and launch files
        return
    for item in module.imports:
        top = item.module.split('.')[0]
        where = f'{path.name}:{item.line}: {item.module}'
        assert knows_ros(module.name) or not of_ros(item.module), f'{where} knows ROS'
        if top in MAY_IMPORT and top != module.package:
            assert top in MAY_IMPORT[module.package], f'{where}: against the direction'
            if module.package == 'satvib_control' and top == 'satvib_ident':
                assert item.module.startswith(SHARED_IDENTIFICATION), f'{where} is not shared'


def test_modules_import_each_other_without_a_circle():
    """Strongly connected components of what modules import when they are loaded."""
    assert circles(MODULES) == []


def test_no_import_inside_a_function_hides_a_circle():
    """The same with the imports that run later."""
    assert circles(MODULES, ('module', 'function')) == []


def test_the_search_for_circles_finds_one(tmp_path):
    """Truth: three files written here, a -> b -> c -> a through a function, and d outside of it."""
    sources = {
        'a': 'from satvib_common.b import x',
        'b': 'import satvib_common.c',
        'c': 'def later():\n    from satvib_common import a',
        'd': 'from satvib_common.a import y',
    }
    made = {
        f'satvib_common.{name}': Module(tmp_path, f'satvib_common.{name}', ast.parse(text))
        for name, text in sources.items()
    }
    assert circles(made) == []
    assert circles(made, ('module', 'function')) == [
        ['satvib_common.a', 'satvib_common.b', 'satvib_common.c']
    ]


def test_a_folder_holds_few_modules():
    """At most twelve, so that a folder can be read at a glance."""
    sizes = Counter(m.room for m in MODULES.values() if not m.is_door)
    assert {room: n for room, n in sizes.items() if n > MOST_MODULES} == {}


def test_every_folder_of_modules_is_a_room_with_a_door():
    """A folder with Python files has an `__init__.py`."""
    assert {m.room for m in MODULES.values()} - {m.name for m in DOORS} == set()


@pytest.mark.parametrize('package', PACKAGES)
def test_tests_mirror_the_rooms(package):
    """A folder of tests has the name of the room that it tests."""
    tests = ROOT / 'src' / package / 'test'
    rooms = {m.room.replace('.', '/') for m in MODULES.values() if m.package == package}
    folders = {p.parent.relative_to(tests).as_posix() for p in tests.rglob('test_*.py')}
    assert {f for f in folders if f != '.' and f'{package}/{f}' not in rooms} == set()


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


@pytest.fixture(scope='module')
def texts() -> dict[str, str]:
    """Every tracked text file by its path."""
    found = tracked_texts()
    if found is None:
        pytest.skip('not a git checkout')
    return found


def test_no_tracked_file_names_a_path_of_one_machine(texts):
    """A path of one machine in a file means that it works on one machine."""
    found = [
        f'{name}: {match}'
        for name, text in texts.items()
        for match in re.findall(r'(?<![\w.$}])/(?:home|root|work)/\w+', text)
    ]
    assert found == []


def test_every_dotted_name_of_satvib_exists(texts):
    """A dotted name in any tracked file, also in prose, strings and YAML, leads to a module or to a name in one."""
    own = '|'.join(PACKAGES)
    found = []
    for name, text in texts.items():
        if name == 'tests/test_architecture.py' or name == 'docs/decisions/0009-doors.md':
            continue
        for match in re.finditer(rf'(?<![\w/.])(?:{own})(?:\.[A-Za-z_]\w*)+', text):
            if not _exists(match[0].split('.')):
                line = text.count('\n', 0, match.start()) + 1
                found.append(f'{name}:{line}: {match[0]}')
    assert found == []


def _exists(parts: list[str]) -> bool:
    """Whether a dotted name is a module, a name of one, or a file of a package's data."""
    for cut in range(len(parts), 0, -1):
        module = MODULES.get('.'.join(parts[:cut]))
        if module is not None:
            return cut == len(parts) or parts[cut].startswith('__') or parts[cut] in _names(module)
    return False


def _names(module: Module) -> set[str]:
    found = {i.alias or (i.name or i.module.split('.')[0]) for i in module.imports}
    for node in ast.walk(module.tree):
        if isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.add(node.name)
        elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            found.add(node.id)
    return found


def test_every_path_of_a_file_exists(texts):
    """A path from the root of the project in any tracked file leads to something."""
    tops = 'src|docs|tests|benchmarks|tools|requirements'
    found = []
    for name, text in texts.items():
        for match in re.finditer(rf'(?<![\w/.-])(?:{tops})/[\w./-]*\w(?![\w*])', text):
            path = match[0]
            if not any(
                (ROOT / end).exists() for end in (path, f'{path}.py', Path(name).parent / path)
            ):
                line = text.count('\n', 0, match.start()) + 1
                found.append(f'{name}:{line}: {path}')
    assert found == []


def test_the_list_of_tracked_files_is_what_git_says(texts):
    """Truth: `git ls-files` here and now, and this very file among the texts."""
    listed = subprocess.run(
        ['git', 'ls-files'], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.split('\n')
    assert set(texts) <= set(listed)
    assert 'tests/test_architecture.py' in texts
