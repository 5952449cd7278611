# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A scenario through daq_bridge on the serial link, beside the same scenario in plant_sim, both in real time.

    ./satvib shell -c 'python benchmarks/daq_scenario.py paper_3dof'

Real nodes over real DDS; the emulator holds the same rig, disturbance and seed as plant_sim. The attenuations are those
of Eq. (42) from what the plant really did, tone and RMS, and from the samples of the loop. --duration makes a long run
of CONTROL out of it, for counting lost frames.
"""

import argparse
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from satvib_bringup.live.graph import Graph, graph_of
from satvib_bringup.live.process import Stage
from satvib_bringup.live.schedule_message import graph_schedule
from satvib_common.levels import decibel
from satvib_common.phases import Phase
from satvib_common.ros.qos import offered, wanted
from satvib_experiment.analysis.levels import tone_level
from satvib_experiment.recording.unpack import truth_samples
from satvib_experiment.scenario.scenario import Scenario, load_scenario

from satvib_msgs.msg import ControllerState, Schedule, StrutAcceleration, StrutTruth

ROOT = Path(__file__).resolve().parent.parent
sys.path.insert(0, str(ROOT / 'tests' / 'daq'))

from stand import Stand  # noqa: E402 - it lives with the tests


def prepare(stand: Stand, graph: Graph) -> dict[str, Any]:
    """Start identifiers and controllers, and ears on the samples; gives where they are kept."""
    stand.join()
    kept: dict[str, Any] = {
        'acceleration': {s: {} for s in graph.struts},
        'truth': {s: {} for s in graph.struts},
        'reasons': {s: {} for s in graph.struts},
    }
    for strut in graph.struts:
        for topic, kind in (('acceleration', StrutAcceleration), ('truth', StrutTruth)):
            store = kept[topic][strut]
            stand.node.create_subscription(
                kind,
                f'/{strut}/{topic}',
                lambda m, s=store: s.__setitem__(m.sequence, m),
                wanted(whole=True),
            )
        reasons = kept['reasons'][strut]
        stand.node.create_subscription(
            ControllerState,
            f'/{strut}/controller_state',
            lambda m, s=reasons: s.setdefault((m.phase, m.reason), m.sequence),
            wanted(whole=True),
        )
    kept['schedule'] = stand.node.create_publisher(Schedule, '/schedule', offered(1))
    modules = {'strut_controller': 'satvib_control', 'strut_identifier': 'satvib_ident'}
    for process in graph.processes:
        if process.stage in {Stage.CONTROLLER, Stage.IDENTIFIER}:
            name = process.full_name.replace('/', '.')
            parameters = stand.folder / f'{name}.yaml'
            parameters.write_text(process.parameter_file())
            module = f'{modules[process.executable]}.nodes.{process.executable}_node'
            stand.start(name, ['-m', module, *process.arguments(parameters)])
    return kept


def begin(stand: Stand, graph: Graph, kept: dict[str, Any]) -> None:
    """Wait until every reader is there, and publish the schedule."""
    readers = 2 * len(graph.struts) + 1
    topics = [f'/{s}/acceleration' for s in graph.struts]
    stand.until(
        lambda: stand.node.count_subscribers('/schedule') >= readers, 'readers of the schedule'
    )
    stand.until(lambda: all(stand.node.count_publishers(t) for t in topics), 'publishers')
    stand.until(
        lambda: all(stand.node.count_publishers(f'/{s}/voltage') for s in graph.struts),
        'controllers',
    )
    stand.hurry()
    now = stand.node.get_clock().now().to_msg()
    kept['schedule'].publish(graph_schedule(graph, now))


def finish(stand: Stand, source: str, limit: float) -> int:
    """Take part until the source ends; gives its exit code."""
    child = stand.children[source]
    stand.until(lambda: child.poll() is not None, f'the end of {source}', limit)
    return int(child.returncode)


def through_bridge(
    scenario: Scenario, graph: Graph, stand: Stand, options: dict[str, Any], timeout: float
) -> dict[str, Any]:
    """Run with daq_bridge and the emulator."""
    rig = scenario.load_rig()
    truth = stand.folder / 'truth.npz'
    changes = [
        x for k, v in scenario.rig_overrides.items() for x in ('--set', f'{k}={json.dumps(v)}')
    ]
    stand.start_emulator(
        '--disturbance', json.dumps(scenario.disturbance or {'kind': 'none'}), '--seed', str(scenario.seed),
        '--truth', str(truth), *changes, rig=scenario.rig,
    )  # fmt: skip
    stand.write_channels(
        rig=scenario.rig,
        overrides=scenario.rig_overrides,
        options={'hold': rig.acquisition.hold, **options},
    )
    stand.start_bridge(
        sample_rate=rig.acquisition.sample_rate, command_timeout=timeout,
    )  # fmt: skip
    stand.until_state('IDLE')
    kept = prepare(stand, graph)
    begin(stand, graph, kept)
    stand.until_armed()
    code = finish(stand, 'bridge', graph.plan.end * graph.sample_period + 60.0)
    stand.end('emulator')
    with np.load(truth) as saved:
        start = int(saved['begun_at'])
        kept['upper'] = saved['upper'][start:].astype(float)
    return kept | {
        'code': code,
        'states': list(stand.states),
        'figures': dict(stand.latest),
        'said': stand.said('bridge').splitlines()[-1],
    }


def through_plant(graph: Graph, stand: Stand) -> dict[str, Any]:
    """Run with plant_sim in real time."""
    (plant,) = [p for p in graph.processes if p.stage == Stage.SOURCE]
    parameters = stand.folder / 'plant.yaml'
    parameters.write_text(plant.parameter_file())
    stand.start(
        'plant', ['-m', 'satvib_plant_sim.nodes.plant_sim_node', *plant.arguments(parameters)]
    )
    kept = prepare(stand, graph)
    begin(stand, graph, kept)
    code = finish(stand, 'plant', graph.plan.end * graph.sample_period + 60.0)
    columns = []
    for strut in graph.struts:
        messages = kept['truth'][strut]
        blocks = (messages[k] for k in sorted(messages))
        columns.append(np.array([s.upper for block in blocks for s in truth_samples(block)]))
    kept['upper'] = np.stack(columns, axis=1)
    return kept | {'code': code, 'said': stand.said('plant').splitlines()[-1]}


def attenuations(scenario: Scenario, graph: Graph, kept: dict[str, Any]) -> dict[str, list[float]]:
    """Attenuation of each strut in dB: true tone, true RMS, measured RMS."""
    period = graph.sample_period
    windows = [
        tuple(round(t / period) for t in w)
        for w in (scenario.analysis.uncontrolled, scenario.analysis.controlled)
    ]
    frequencies = [float(scenario.disturbance['frequency'])]
    found: dict[str, list[float]] = {'true_tone': [], 'true_rms': [], 'measured_rms': []}
    for i, strut in enumerate(graph.struts):
        measured = kept['acceleration'][strut]
        levels: dict[str, list[float]] = {k: [] for k in found}
        for first, last in windows:
            fine = kept['upper'][first:last, i, :]
            levels['true_tone'].append(
                float(tone_level(fine.ravel(), period / fine.shape[1], frequencies))
            )
            levels['true_rms'].append(float(np.std(fine)))
            levels['measured_rms'].append(
                float(np.std([m.upper for k, m in measured.items() if first <= k < last]))
            )
        for kind, (before, after) in levels.items():
            found[kind].append(float(decibel(after, before)))
    return found


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('scenario', nargs='?', default='paper_3dof')
    parser.add_argument('--set', action='append', default=[], metavar='KEY=VALUE')
    parser.add_argument('--timeout', type=float, default=0.05, help='command_timeout, s')
    parser.add_argument('--priority', type=int, default=0)
    parser.add_argument('--bridge-only', action='store_true')
    given = parser.parse_args()
    os.environ.setdefault('ROS_DOMAIN_ID', '94')
    os.environ.setdefault(
        'FASTRTPS_DEFAULT_PROFILES_FILE',
        str(ROOT / 'src/satvib_common/satvib_common/transport/closed.xml'),
    )
    scenario = load_scenario(given.scenario, given.set)
    graph = graph_of(scenario, realtime=True)
    results = {}
    for name in ('bridge',) if given.bridge_only else ('plant', 'bridge'):
        with tempfile.TemporaryDirectory() as folder:
            stand = Stand(Path(folder), given.priority)
            try:
                if name == 'plant':
                    kept = through_plant(graph, stand)
                else:
                    kept = through_bridge(scenario, graph, stand, {}, given.timeout)
                print(name, kept['code'], kept['said'])
                samples = {len(v) for v in kept['acceleration'].values()}
                print(f'  samples received per strut: {samples} of {graph.plan.end}')
                for key in ('states', 'figures'):
                    if key in kept:
                        print(f'  {key}: {kept[key]}')
                for strut, reasons in kept['reasons'].items():
                    lines = [
                        f'{k * graph.sample_period:.2f} s {Phase(phase).name}: {why or "well"}'
                        for (phase, why), k in reasons.items()
                    ]
                    print(f'  {strut}: {"; ".join(lines)}')
                results[name] = attenuations(scenario, graph, kept)
                for kind, values in results[name].items():
                    print(f'  {kind}: {", ".join(f"{v:.2f}" for v in values)} dB', flush=True)
            finally:
                stand.close()
    if len(results) == 2:
        for kind in results['plant']:
            difference = np.subtract(results['bridge'][kind], results['plant'][kind])
            print(f'{kind}: bridge - plant_sim {", ".join(f"{d:+.2f}" for d in difference)} dB')
    return 0


if __name__ == '__main__':
    sys.exit(main())
