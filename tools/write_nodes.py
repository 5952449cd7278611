# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Write docs/nodes.md from the nodes themselves: each is made, and asked for its topics, services and parameters.

. .cache/environment.sh && python tools/write_nodes.py            # write the page
. .cache/environment.sh && python tools/write_nodes.py --check    # exit code 1 when the page is not current

It needs the built workspace. What a node says on diagnostics and what ends it are sentences of this file.
"""

import dataclasses
import importlib
import os
import re
import sys
import tempfile
import typing
from pathlib import Path
from typing import Any, NamedTuple

import yaml
from made_page import write_or_compare
from source_tree import ROOT

PAGE = ROOT / 'docs' / 'nodes.md'
HEAD = """# Nodes

Every node of satvib: what it subscribes to, what it publishes, its services, its parameters, what it says on
`/diagnostics`, and what ends it. This page is written by `tools/write_nodes.py`, which makes each node and asks it.

All nodes are lifecycle nodes that start themselves (parameter `autostart`, default true). All have the services
`~/stop` (a safe state, latched) and `~/reset`: `./satvib call /strut_1/strut_controller/reset` calls one. All report
once a second on `/diagnostics`. A name without a leading slash is in the namespace of the node, and `strut_i/` stands
for every strut. A type without a package is one of satvib_msgs. The nodes of a strut live in its namespace, so
`../schedule` is the schedule of the namespace above: `/schedule` for `/strut_1`, `/rig_a/schedule` for
`/rig_a/strut_1`.

| quality of service | means |
|---|---|
| whole | reliable, transient local: a reader that comes late gets what was said before, up to the depth |
| new | reliable, volatile: a reader begins with the next message |
| best effort | what is lost is lost |

Publishers offer *whole* unless the table says otherwise; any reader fits them. A reader asks for *whole* where it must
have every sample (in lockstep), and for *new* in real time. `qos_overrides` parameters change what a publisher offers.

A node that waits says for what: on `/diagnostics` (WARN) and every 5 s in its log. It names the topic in full. Where
there is no source but a topic of that name elsewhere, it names that one too: it is in another namespace than its graph.

The topics `acceleration`, `voltage`, `identified_model` and `schedule` have one writer. Where there are two, every node
at the topic names both in its log and on `/diagnostics`. When both speak, a controller latches 0 V (two plants, two
identifiers), so does `plant_sim` or `daq_bridge` (two controllers), and another schedule is refused. The reason
of the latch has the full names. Where one node alone publishes there, each message twice or out of order, it is named.

A parameter that is not live (column *live*) is refused in a running node, with the reason that stands there. So is the
start of a gain that adapts. Every change that is taken is one line in the log, with the value before and after. Where a
value does not act as it stands, the line and the answer say what does: a gain beyond the bounds of the model, or before
there is a model.

Exit codes of every node: 0 after SIGINT, SIGTERM or the end of its work; 1 when a run failed; 2 when a person must
correct something. In both cases the last line says what.
"""


class Entry(NamedTuple):
    """A node of the page.

    `start` are parameters that the node needs before it can be made; `says` and `ends` are sentences.
    """

    module: str
    name: str
    executable: str
    namespace: str
    schema: tuple[str, str]
    what: str
    says: str
    ends: str
    start: dict[str, Any]


NODES = (
    Entry(
        'satvib_plant_sim.nodes.plant_sim_node', 'PlantSimNode', 'plant_sim', '/',
        ('satvib_plant_sim.nodes.parameters', 'PlantParameters'),
        'Simulates the isolator and is the clock of the graph.',
        'WARN while it waits or a strut is at 0 V because its commands are missing; ERROR while 0 V is latched, with '
        'the reason: a voltage that is no number, two controllers that answer the samples of one strut, `~/stop`, or '
        'with `after_silence: latch` no fresh voltage. The controller of the strut then names it and its `reset`.',
        'The last sample of the schedule (exit code 0, one line with the counts); in lockstep a voltage that does '
        'not come within `lockstep_timeout`, named (1); a voltage in lockstep that is no number (2).', {},
    ),
    Entry(
        'satvib_control.nodes.strut_controller_node', 'StrutControllerNode', 'strut_controller', '/strut_1',
        ('satvib_control.parameters', 'ControllerParameters'),
        'Answers every acceleration sample of its strut with a coil voltage. `~/hold` means 0 V for a while, '
        '`~/release` ends that.',
        'The reason why the law does not act or is at fault; else phase, law and counts.',
        'Two samples or a schedule of another rate before it acts (2). It goes on when the plant '
        'ends.', {},
    ),
    Entry(
        'satvib_control.nodes.centralized_controller_node', 'CentralizedControllerNode',
        'centralized_controller', '/', ('satvib_control.laws.centralized.parameters', 'CentralizedParameters'),
        'One controller for all struts, in the place of the strut controllers.',
        'As strut_controller, the reasons of all struts together.', 'As strut_controller.', {},
    ),
    Entry(
        'satvib_control.nodes.supervisor_node', 'SupervisorNode', 'supervisor', '/',
        ('satvib_control.supervision.parameters', 'SupervisorParameters'),
        'Hears all struts and holds or stops the one that makes the others loud, by the services of its controller.',
        'What it asked of which strut since the last report, and the strikes of each strut.',
        'In lockstep a controller without these services (1).', {},
    ),
    Entry(
        'satvib_ident.nodes.strut_identifier_node', 'StrutIdentifierNode', 'strut_identifier', '/strut_1',
        ('satvib_ident.parameters', 'IdentifierParameters'),
        'Estimates the model of its strut from acceleration and voltage.',
        'The first check of trust that the model fails; else counts.',
        'Two samples or a schedule of another rate before its run (2).', {},
    ),
    Entry(
        'satvib_daq_bridge.nodes.daq_bridge_node', 'DaqBridgeNode', 'daq_bridge', '/',
        ('satvib_daq_bridge.parameters', 'BridgeParameters'),
        'Real hardware in the place of the plant: [hardware.md](hardware.md). A run begins when the schedule is there '
        'and `~/arm` was called.',
        'Every change of state at once, with its reason; ERROR in FAULT and ESTOP.',
        'The last sample of the schedule (0); a device that cannot be opened, or channels that do not fit (2).',
        {'channels': 'CHANNELS'},
    ),
    Entry(
        'satvib_bringup.nodes.recorder_node', 'RecorderNode', 'recorder', '/',
        ('satvib_bringup.recorder.topic_recorder', 'RecorderParameters'),
        'Writes the schedule, every topic of every strut and /diagnostics to a bag.',
        'Messages received and written.',
        'A disk that is full or a folder that cannot be written (2). On SIGINT it first writes what is on its way.',
        {'folder': 'BAG', 'struts': ['strut_1']},
    ),
    Entry(
        'satvib_bringup.nodes.schedule_node', 'ScheduleNode', 'schedule', '/',
        ('satvib_bringup.nodes.schedule_node', 'ScheduleParameters'),
        'Publishes the schedule of a scenario, which starts a graph. With `realtime` it waits for its nodes.',
        'What it waits for.', 'SIGINT or SIGTERM only: it stays for nodes that start later.', {},
    ),
    Entry(
        'satvib_bringup.nodes.replay_node', 'ReplayNode', 'replay', '/',
        ('satvib_bringup.nodes.replay_record', 'ReplayParameters'),
        'Publishes a measured record as the topics of a strut, for a live identifier.',
        'WARN while no identifier is there; else how far it is.', 'The end of the record (0).',
        {'file': 'RECORD'},
    ),
    Entry(
        'satvib_bringup.nodes.experiment_node', 'ExperimentNode', 'experiment', '/',
        ('satvib_bringup.nodes.experiment_node', 'ExperimentParameters'),
        'The action server `run_experiment`: one scenario as a live graph, recorded and reported, one at a time.',
        'Which goal runs.', 'SIGINT or SIGTERM; a run that is on is ended first.', {},
    ),
)  # fmt: skip
QOS = {('RELIABLE', 'TRANSIENT_LOCAL'): 'whole', ('RELIABLE', 'VOLATILE'): 'new'}
# of every node, named in the head of the page
COMMON = re.compile(
    r'/(rosout|parameter_events|diagnostics)$|transition_event$|/(change_state|get_state|get_available_\w+'
    r'|get_transition_graph|\w*parameters\w*|get_parameter_types|get_type_description|stop|reset|get_logger_levels'
    r'|set_logger_levels)$|/_action/'
)


def page() -> str:
    """The whole page."""
    with tempfile.TemporaryDirectory() as folder:
        return '\n'.join([HEAD, *(section(entry, Path(folder)) for entry in NODES)])


def section(entry: Entry, folder: Path) -> str:
    """One node."""
    package = entry.module.split('.')[0]
    text = [f'## {entry.executable}', '', entry.what, '']
    space = '' if entry.namespace == '/' else f' -r __ns:={entry.namespace}'
    text += [f'    ./satvib node {package} {entry.executable} --ros-args{space}', '']
    text += asked(entry, folder)
    text += [f'**On diagnostics:** {entry.says}', '', f'**What ends it:** {entry.ends}', '']
    text += ['<details><summary>Parameters</summary>', '', *parameters(entry), '', '</details>', '']
    return '\n'.join(text)


def asked(entry: Entry, folder: Path) -> list[str]:
    """Topics, services and actions, from a node that is made, activated and asked."""
    import rclpy
    from rclpy.context import Context
    from rclpy.parameter import Parameter
    from satvib_common.ros.place import placed

    context = Context()
    rclpy.init(context=context)
    made = {k: prepared(v, folder) for k, v in entry.start.items()}
    overrides = [Parameter(k, value=v) for k, v in made.items()]
    with placed(None, context=context, namespace=entry.namespace, parameter_overrides=overrides):
        node = getattr(importlib.import_module(entry.module), entry.name)()
    node.configure_now()
    node.activate_now()
    where = (node.get_name(), node.get_namespace())
    rows = []
    for what, names, infos in (
        ('subscribes', node.get_subscriber_names_and_types_by_node, node.get_subscriptions_info_by_topic),
        ('publishes', node.get_publisher_names_and_types_by_node, node.get_publishers_info_by_topic),
    ):  # fmt: skip
        for name, kinds in names(*where):
            if COMMON.search(name):
                continue
            quality = next(i.qos_profile for i in infos(name) if i.node_name == where[0])
            key = (quality.reliability.name, quality.durability.name)
            rows.append(
                (
                    what,
                    shown(name, where),
                    kinds[0].replace('/msg/', '/'),
                    QOS.get(key, 'best effort'),
                )
            )
    for name, kinds in node.get_service_names_and_types_by_node(*where):
        if not COMMON.search(name):
            rows.append(('service', shown(name, where), kinds[0].replace('/srv/', '/'), ''))
    for name, kinds in rclpy.action.get_action_server_names_and_types_by_node(node, *where):
        rows.append(('action', shown(name, where), kinds[0].replace('/action/', '/'), ''))
    node.trigger_deactivate()
    node.trigger_cleanup()
    node.destroy_node()
    rclpy.try_shutdown(context=context)
    table = ['| | name | type | quality of service |', '|---|---|---|---|']
    rows = [(a, b, c.removeprefix('satvib_msgs/'), d) for a, b, c, d in rows]
    return [*table, *(f'| {a} | `{b}` | `{c}` | {d} |' for a, b, c, d in dict.fromkeys(rows)), '']


def shown(name: str, where: tuple[str, str]) -> str:
    """A name as the head of the page explains it."""
    own = f'{where[1].rstrip("/")}/{where[0]}/'
    if name.startswith(own):
        return f'~/{name.removeprefix(own)}'
    if where[1] != '/':
        above = where[1].rpartition('/')[0]
        inside = name.startswith(f'{where[1]}/')
        return name.removeprefix(f'{where[1]}/') if inside else f'..{name.removeprefix(above)}'
    if name in {'/clock', '/diagnostics'}:
        return name
    return re.sub(r'^strut_\d/', 'strut_i/', name.removeprefix('/'))


def prepared(value: Any, folder: Path) -> Any:
    """What a node needs to be made: files in a folder of this tool."""
    if value == 'BAG':
        return str(folder / 'bag')
    if value == 'RECORD':
        path = folder / 'record.csv'
        path.write_text('input,output\n' + ''.join(f'{k % 7},{k % 5}\n' for k in range(100)))
        return str(path)
    if value == 'CHANNELS':
        from satvib_daq_bridge.simulated.channels_from_rig import channels_of
        from satvib_plant_sim.rig.rig import load_rig

        path = folder / 'channels.yaml'
        path.write_text(yaml.safe_dump(channels_of(load_rig('paper_3dof'))))
        return str(path)
    return value


def parameters(entry: Entry) -> list[str]:
    """Every parameter with type, default, unit, range, and whether it can be set while the node runs."""
    from satvib_common.schema import constraint_of

    module, name = entry.schema
    schema = getattr(importlib.import_module(module), name)
    hints = typing.get_type_hints(schema)
    rows = ['| parameter | default | unit | range | live | what |', '|---|---|---|---|---|---|']
    for field in sorted(dataclasses.fields(schema), key=lambda f: f.name):
        c = constraint_of(field)
        missing = field.default is dataclasses.MISSING
        default = 'must be given' if missing else f'`{plain(field.default, hints[field.name])}`'
        live = f'no: {c.read_only}' if c.read_only else 'yes'
        what = c.description.replace('|', '\\|').replace('\n', ' ')
        rows.append(f'| `{field.name}` | {default} | {c.unit} | {limits(c)} | {live} | {what} |')
    return rows


def plain(value: Any, hint: Any) -> str:
    """A default as YAML."""
    if hint is bool:
        return str(value).lower()
    if isinstance(value, tuple):
        return f'[{", ".join(str(v) for v in value)}]'
    return str(value) if value != '' else "''"


def limits(c: Any) -> str:
    """The range of a parameter."""
    if c.choices is not None:
        return ', '.join(map(str, c.choices))
    parts = []
    for word, bound in (
        ('above', c.above),
        ('from', c.minimum),
        ('to', c.maximum),
        ('below', c.below),
    ):
        if bound is not None:
            parts.append(f'{word} {bound:g}')
    return ' '.join(parts)


def main(arguments: list[str]) -> int:
    """Write the page, or compare it."""
    os.environ.setdefault('ROS_DOMAIN_ID', '101')
    import rclpy.action  # noqa: F401 - looked up by `asked`

    return write_or_compare(PAGE, page(), arguments, 'write_nodes.py')


if __name__ == '__main__':
    sys.exit(main(sys.argv[1:]))
