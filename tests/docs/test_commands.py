# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every command line of README and docs is one that the programs accept.

Truth: the parsers of the commands, the schemas of the nodes, and the arguments of the launch files. Commands with their
output, in blocks ```console, are run by test_sessions_live.py.
"""

import importlib
import itertools
import re
import shlex

import click
import pytest
import typer
from satvib_bringup.cli.main import app
from satvib_bringup.live.launching.plans import PLANS
from satvib_common.files.yaml_file import parse_yaml
from source_tree import ROOT

PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding='utf-8')
    for path in [*sorted(ROOT.glob('*.md')), *sorted((ROOT / 'docs').rglob('*.md'))]
}
# of the script `satvib` itself
SCRIPT = {'test', 'shell'}
SCHEMAS = {
    'plant_sim': ('satvib_plant_sim.nodes.parameters', 'PlantParameters'),
    'strut_controller': ('satvib_control.parameters', 'ControllerParameters'),
    'centralized_controller': (
        'satvib_control.laws.centralized.parameters',
        'CentralizedParameters',
    ),
    'supervisor': ('satvib_control.supervision.parameters', 'SupervisorParameters'),
    'strut_identifier': ('satvib_ident.parameters', 'IdentifierParameters'),
    'daq_bridge': ('satvib_daq_bridge.parameters', 'BridgeParameters'),
    'replay': ('satvib_bringup.nodes.replay_record', 'ReplayParameters'),
    'recorder': ('satvib_bringup.recorder.topic_recorder', 'RecorderParameters'),
}


def commands():
    """Every command line in a block, with its page; a line that ends with a backslash goes on."""
    found = []
    for page, text in PAGES.items():
        lines = text.replace('\\\n', ' ').splitlines()
        for line in lines:
            match = re.match(r'(?:\s{4,}|\$ |\s*)((?:\w+=\S+ )*(?:\./satvib|ros2) .+)$', line)
            if match:
                words = shlex.split(match[1].rstrip('& '), comments=True)
                while '=' in words[0]:
                    words.pop(0)
                found.append(pytest.param(page, words, id=f'{page}: {" ".join(words[:4])}'))
    return found


COMMANDS = commands()


def test_there_are_commands_of_every_kind():
    """Truth: README has nodes, launch files and commands."""
    kinds = {' '.join(c.values[1][:2]) for c in COMMANDS if c.values[0] == 'README.md'}
    assert {'./satvib run', './satvib node', 'ros2 run', 'ros2 launch', 'ros2 bag'} <= kinds


@pytest.fixture(autouse=True)
def my_laws(tmp_path, monkeypatch):
    """The law that the tutorial tells the reader to save, in the reader's folder."""
    page = (ROOT / 'docs' / 'tutorials' / 'your_law.md').read_text()
    (code,) = re.findall(r'^```python\n(.*?)^```', page, re.DOTALL | re.MULTILINE)
    (tmp_path / 'my_laws.py').write_text(code)
    monkeypatch.syspath_prepend(str(tmp_path))


@pytest.mark.parametrize(('page', 'words'), COMMANDS)
def test_a_command_is_accepted(page, words):  # noqa: ARG001
    program, verb, *rest = words
    if program == './satvib':
        accepted_by_satvib(verb, rest)
    elif verb == 'run':
        accepted_by_a_node(rest)
    elif verb == 'launch':
        package, name, *arguments = rest
        assert package == 'satvib_bringup'
        plan = PLANS[name.removesuffix('.launch.py')]
        known = {*plan.arguments, '--show-args'}
        assert {a.partition(':=')[0] for a in arguments} <= known
        assert (ROOT / 'src/satvib_bringup/launch' / name).is_file()


def accepted_by_satvib(verb, rest):
    """Parse with the command's own parser, without running it."""
    if verb in SCRIPT or verb == '--help':
        return
    group = typer.main.get_command(app)
    command = group.get_command(click.Context(group), verb)
    assert command is not None, verb
    while isinstance(command, click.Group) and rest and not rest[0].startswith('-'):
        inner = command.get_command(click.Context(command), rest[0])
        assert inner is not None, rest[0]
        command, rest = inner, rest[1:]
    given = [w for w in rest if w != '...']
    context = command.make_context(verb, list(given))
    if verb == 'node' and given:
        accepted_by_a_node([*given[:2], *context.args])


def accepted_by_a_node(rest):
    """The executable is there, and its parameters pass its schema."""
    package, executable, *arguments = rest
    starts = (ROOT / 'src' / package / 'setup.py').read_text()
    assert f"'{executable} = {package}." in starts, executable
    given = {}
    for flag, value in itertools.pairwise(arguments):
        if flag == '-p':
            name, _, text = value.partition(':=')
            given[name.rpartition(':')[2]] = parse_yaml(text, name)
    if executable in SCHEMAS:
        module, name = SCHEMAS[executable]
        schema = getattr(importlib.import_module(module), name)
        if executable == 'daq_bridge':
            given.setdefault('channels', 'my_rig.yaml')
        if isinstance(given.get('disturbance'), dict):
            given['disturbance'] = str(given['disturbance'])
        given.pop('autostart', None)
        if not (executable == 'replay' and 'file' not in given):
            schema.from_mapping(given)
