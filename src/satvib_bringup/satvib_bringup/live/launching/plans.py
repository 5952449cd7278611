# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What each launch file starts, from the one description of the graph. Plain data: nothing here knows launch.

| plan | starts | ends when |
|---|---|---|
| simulation | the graph of a scenario, with the node `schedule` | the plant has ended |
| centralized | the same of a scenario with one controller for all struts | the plant has ended |
| hardware | the same with `daq_bridge` in the place of the plant, in real time | the bridge has ended |
| strut | controller and identifier of one strut, as on a module of the rig | Ctrl-C |
| replay | a record and an identifier that hears it | the record is over |
| record | the recorder | Ctrl-C |
"""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime
from pathlib import Path

from satvib_common.errors import SatvibError
from satvib_experiment.scenario.scenario import load_scenario

from satvib_bringup.live.graph import Graph, graph_of, with_bridge
from satvib_bringup.live.launching.member import Member, member_of, member_of_node, of_strut
from satvib_bringup.live.process import COMPOSITIONS, Stage, processes_of

Values = Mapping[str, str]
Arguments = dict[str, tuple[str | None, str]]  # name: default (None: must be given), what it is

_EVERY: Arguments = {
    'namespace': ('', 'namespace above all nodes, as in rig_a; empty: none'),
    'params_file': (
        '',
        'ROS parameter file whose values win over those of the scenario; empty: none',
    ),
    'log_level': ('info', 'debug, info, warn, error or fatal'),
}
_SCENARIO: Arguments = {
    'scenario': ('paper_3dof', 'name of a scenario, or path of its YAML file'),
    'overrides': ('', "changes, separated by spaces: 'seed=7 controller.law=velocity_feedback'"),
}
_COMPOSITION: Arguments = {
    'composition': ('', 'separate, strut or single; empty: as the scenario says'),
}
_BAG: Arguments = {
    'record': ('false', 'true: record a bag'),
    'bag': (
        '',
        'folder of the bag, which must be new; empty with record:=true: satvib-DATE-TIME here',
    ),
}
_REALTIME: Arguments = {
    'realtime': ('false', 'true: at the pace of the clock instead of in lockstep'),
}


@dataclass(frozen=True)
class Plan:
    """What one launch file does.

    Attributes:
        members: gives its processes for the values of its arguments; raises SatvibError.
        arguments: what it takes.
    """

    members: Callable[[Values], Sequence[Member]]
    arguments: Arguments = field(default_factory=dict)

    def placed_members(self, values: Values) -> list[Member]:
        """The processes in their namespace, with the parameter file and the log level.

        Raises:
            SatvibError: what is given does not fit.
        """
        found = []
        # launch itself would find it when some processes have been started
        if not re.fullmatch(r'/?([A-Za-z_]\w*(/[A-Za-z_]\w*)*/?)?', values['namespace']):
            raise SatvibError(f'namespace: {values["namespace"]!r} is no name of ROS')
        if values['params_file'] and not Path(values['params_file']).is_file():
            raise SatvibError(f'params_file: {values["params_file"]}: no such file')
        for member in self.members(values):
            more = ['--log-level', values['log_level']]
            if values['params_file']:
                if not member.name:
                    # rcl drops `-p node:name:=value` where a file has a section with the full name of the node
                    raise SatvibError(
                        'params_file: give composition:=separate, where each node has its process'
                    )
                more += ['--params-file', str(Path(values['params_file']).resolve())]
            found.append(member.below(values['namespace']).with_ros_arguments(*more))
        return found


def simulation(values: Values) -> list[Member]:
    """The graph of a scenario."""
    bag, composition = _bag(values), values['composition']
    realtime = _switch(values, 'realtime')
    graph = graph_of(
        load_scenario(values['scenario'], _overrides(values)), realtime, bag, composition
    )
    if not graph.processes:
        return [_single(values, bag)]
    return [*_processes(graph), _schedule(values, realtime, bag is not None, composition)]


def centralized(values: Values) -> list[Member]:
    """The graph of a scenario with one controller for all struts."""
    scenario = load_scenario(values['scenario'], _overrides(values))
    if scenario.scheme != 'centralized':
        raise SatvibError(
            f'scenario {scenario.name}: its scheme is {scenario.scheme}; use simulation.launch.py, '
            'or a scenario such as paper_3dof_centralized'
        )
    return simulation(values)


def hardware(values: Values) -> list[Member]:
    """The graph of a scenario on real hardware."""
    bag, composition = _bag(values), values['composition']
    channels = Path(values['channels']).resolve()
    if not channels.is_file():
        raise SatvibError(f'channels: {values["channels"]}: no such file')
    if composition == 'single':
        raise SatvibError('composition: daq_bridge has a process of its own; use separate or strut')
    scenario = load_scenario(values['scenario'], _overrides(values))
    graph = with_bridge(graph_of(scenario, True, bag, composition or 'separate'), str(channels))
    schedule = _schedule(values, True, bag is not None, composition or 'separate', str(channels))
    return [*_processes(graph), schedule]


def strut(values: Values) -> list[Member]:
    """Controller and identifier of one strut."""
    scenario = load_scenario(values['scenario'], _overrides(values))
    graph = graph_of(scenario, _switch(values, 'realtime'))
    composition = values['composition'] or 'strut'
    if composition not in COMPOSITIONS[:2]:
        raise SatvibError(f'composition: {composition!r} is not one of separate, strut')
    nodes = of_strut(graph.nodes, values['strut'])
    if not nodes:
        raise SatvibError(f'strut: {values["strut"]!r} is not one of {", ".join(graph.struts)}')
    return [member_of(process) for process in processes_of(nodes, composition)]


def replay(values: Values) -> list[Member]:
    """A record, an identifier, and a recorder where one is asked for."""
    name = values['strut']
    record = {'file': str(Path(values['file']).resolve()), 'strut': name}
    record |= {key: values[key] for key in ('input', 'output')}
    record_figures = {
        'sample_rate': _number(values, 'sample_rate'),
        'speed': _number(values, 'speed'),
    }
    identifier = {
        'lockstep': _number(values, 'speed') == 0.0,
        'sample_rate': _number(values, 'sample_rate'),
        'poles': _count(values, 'poles'),
        'coefficients': _count(values, 'coefficients'),
        'delay': _count(values, 'delay'),
        'bias': values['bias'],
    }
    members = [
        member_of_node(
            'satvib_ident', 'strut_identifier', identifier, namespace=f'/{name}', stage=Stage.IDENTIFIER
        ),
        member_of_node(
            'satvib_bringup', 'replay', record | record_figures, stage=Stage.SOURCE, ends=True
        ),
    ]  # fmt: skip
    bag = _bag(values)
    return [*members, _recorder(bag, [name])] if bag is not None else members


def record(values: Values) -> list[Member]:
    """The recorder of a graph that somebody else has started."""
    return [_recorder(Path(values['bag']) if values['bag'] else None, values['struts'].split())]


PLANS = {
    'simulation': Plan(simulation, _SCENARIO | _REALTIME | _COMPOSITION | _BAG | _EVERY),
    'centralized': Plan(
        centralized,
        _SCENARIO
        | {'scenario': ('paper_3dof_centralized', _SCENARIO['scenario'][1])}
        | _REALTIME
        | _COMPOSITION
        | _BAG
        | _EVERY,
    ),
    'hardware': Plan(
        hardware,
        {'channels': (None, 'path of the channels file, see docs/hardware.md')}
        | _SCENARIO
        | _COMPOSITION
        | _BAG
        | _EVERY,
    ),
    'strut': Plan(
        strut,
        {'strut': ('strut_1', 'name of the strut, which is its namespace')}
        | _SCENARIO
        | _REALTIME
        | {'composition': ('strut', 'strut: one process; separate: two')}
        | _EVERY,
    ),
    'replay': Plan(
        replay,
        {
            'file': (None, 'text file of columns, or a bag of satvib'),
            'input': ('input', 'column of the input'),
            'output': ('output', 'column of the output'),
            'sample_rate': ('100.0', 'Hz, of a text file; a bag needs the one that it has'),
            'speed': ('0.0', 'times real time; 0: as fast as the identifier follows'),
            'strut': ('strut_1', 'strut as which it is published; of a bag, the strut that is read'),
            'poles': ('2', 'order of the denominator'),
            'coefficients': ('3', 'of the numerator'),
            'delay': ('0', 'samples; 0 for columns of the same instant, 1 for a bag'),
            'bias': ('none', 'none, calibrate or estimate'),
        }
        | _BAG
        | _EVERY,
    ),
    'record': Plan(
        record,
        {
            'bag': ('', 'folder of the bag, which must be new; empty: satvib-DATE-TIME here'),
            'struts': ('', "names, separated by spaces: 'strut_1 strut_2'; empty: as the schedule says"),
        }
        | _EVERY,
    ),
}  # fmt: skip


def _processes(graph: Graph) -> list[Member]:
    found = [member_of(process) for process in graph.processes]
    # the report for `satvib run` would be a file beside the bag
    return [
        m.with_ros_arguments('-p', 'report:=""') if m.executable == 'recorder' else m for m in found
    ]


def _schedule(
    values: Values, realtime: bool, recorded: bool, composition: str, channels: str = ''
) -> Member:
    given = {
        'scenario': values['scenario'],
        'realtime': realtime,
        'recorded': recorded,
        'composition': composition,
        'channels': channels,
    }
    overrides = _overrides(values)
    return member_of_node(
        'satvib_bringup', 'schedule', given | ({'overrides': overrides} if overrides else {})
    )


def _single(values: Values, bag: Path | None) -> Member:
    if values['namespace'].strip('/') or values['params_file']:
        raise SatvibError('composition single: namespace and params_file need separate or strut')
    words = [values['scenario'], *(f'--set={change}' for change in _overrides(values))]
    words += ['--realtime'] if _switch(values, 'realtime') else []
    words += [f'--bag={bag}'] if bag else []
    return Member('satvib_bringup', 'single', arguments=tuple(words), ends=True)


def _recorder(bag: Path | None, struts: Sequence[str]) -> Member:
    given: dict[str, object] = {'folder': str(bag)} if bag else {}
    if struts:
        given['struts'] = list(struts)
    return member_of_node('satvib_bringup', 'recorder', given, stage=Stage.RECORDER)


def _bag(values: Values) -> Path | None:
    if values['bag']:
        return Path(values['bag']).resolve()
    if not _switch(values, 'record'):
        return None
    return Path(f'satvib-{datetime.now().astimezone():%Y%m%d-%H%M%S}').resolve()


def _overrides(values: Values) -> list[str]:
    return values['overrides'].split()


def _switch(values: Values, name: str) -> bool:
    if values[name].lower() not in {'true', 'false'}:
        raise SatvibError(f'{name}: {values[name]!r} is not true or false')
    return values[name].lower() == 'true'


def _number(values: Values, name: str) -> float:
    try:
        return float(values[name])
    except ValueError:
        raise SatvibError(f'{name}: {values[name]!r} is not a number') from None


def _count(values: Values, name: str) -> int:
    if not values[name].isdecimal():
        raise SatvibError(f'{name}: {values[name]!r} is not a whole number')
    return int(values[name])
