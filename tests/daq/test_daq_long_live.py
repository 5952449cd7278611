# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The serial line over time, and how fast the terminals come to 0 V. The long forms want a machine of their own.

Truth: the counts of both ends of the line; the emulator's terminals, on the monotonic clock of this machine.
"""

import importlib.util
import sys
from pathlib import Path

import pytest

BENCHMARKS = Path(__file__).resolve().parent.parent.parent / 'benchmarks'
LOST = ('samples lost', 'frames rejected', 'rejected by device', 'dropped by device')


def benchmark(name):
    """A benchmark as a module."""
    spec = importlib.util.spec_from_file_location(name, BENCHMARKS / f'{name}.py')
    module = sys.modules[name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run_for(stand, seconds, rate):
    """Drive for so long; gives the last figures."""
    stand.write_channels(rig='clean_3dof')
    stand.start_emulator(rig='clean_3dof')
    stand.start_bridge(wait_for_schedule=False, sample_rate=rate)
    stand.start_answerers()
    stand.until_state('IDLE')
    stand.drive()
    stand.until(
        lambda: int(stand.latest.get('sequence', 0)) >= seconds * rate, 'the end', 10 * seconds + 60
    )
    return stand.latest


def assert_nothing_lost(figures):
    for name in LOST:
        assert float(figures[name]) == 0.0, f'{name}: {figures}'


def test_no_frame_is_lost_in_three_seconds(stand):
    assert_nothing_lost(run_for(stand, 3, 200.0))


@pytest.mark.long
@pytest.mark.timeout(900)
def test_no_frame_is_lost_in_five_minutes(stand):
    assert_nothing_lost(run_for(stand, 300, 200.0))


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_every_kill_is_0_v_within_60_ms(stand, monkeypatch):
    """Twenty times each; benchmarks/daq_kill.py prints the figures."""
    kill = benchmark('daq_kill')
    profiles = (
        BENCHMARKS.parent / 'src/satvib_common/satvib_common/transport/closed.xml'
    ).read_text()
    quick = stand.folder / 'profiles.xml'
    quick.write_text(profiles.replace('<leaseDuration><sec>20<', '<leaseDuration><sec>2<'))
    monkeypatch.setenv('FASTRTPS_DEFAULT_PROFILES_FILE', str(quick))
    stand.write_channels()
    stand.start_emulator()
    for name, victims in kill.VICTIMS.items():
        times = [kill.measure(stand, victims, 200.0, 0.0)[0] for _ in range(20)]
        print(f'{name}: worst {max(times):.1f} ms')
        assert max(times) < 60.0, f'{name}: {times}'


@pytest.mark.long
@pytest.mark.timeout(900)
def test_the_papers_scenario_is_that_of_plant_sim(stand, tmp_path_factory):
    """Attenuations through bridge, serial line and emulator within 1 dB of plant_sim in real time."""
    run = benchmark('daq_scenario')
    scenario = run.load_scenario('paper_3dof', [])
    graph = run.graph_of(scenario, realtime=True)
    through = run.through_bridge(scenario, graph, stand, {}, 0.05)
    for child in list(stand.children):
        stand.end(child)
    plain = type(stand)(tmp_path_factory.mktemp('plant'))
    try:
        beside = run.through_plant(graph, plain)
    finally:
        plain.close()
    found, expected = (run.attenuations(scenario, graph, kept) for kept in (through, beside))
    for kind in expected:
        assert found[kind] == pytest.approx(expected[kind], abs=1.0), kind
