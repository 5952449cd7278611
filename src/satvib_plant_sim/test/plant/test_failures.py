# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Failures: one at sample 0 is the failed rig, a later one keeps the motion, and bits do not depend on the batch."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_plant_sim.disturbance import make_disturbance
from satvib_plant_sim.nodes.parameters import PlantParameters
from satvib_plant_sim.nodes.realtime_commands import Commands
from satvib_plant_sim.plant.failing_plant import FailingPlant, make_failing_plant
from satvib_plant_sim.plant.failures import Failure, check_failures
from satvib_plant_sim.plant.plant import Plant
from satvib_plant_sim.rig.rig import load_rig

RIG = load_rig('soft_3dof')
TONE = make_disturbance({'kind': 'sine', 'frequency': 9.0, 'amplitude': 0.5})


def failure(kind, time=0.0, **more):
    return Failure.from_mapping({'kind': kind, 'time': time, **more})


def voltages(count, shape=(3,), seed=1):
    return np.random.default_rng(seed).uniform(-2.0, 2.0, (count, *shape))


def drive(plant, u):
    """Readings and truths under voltages (samples, *shape, struts)."""
    read, true = [], []
    for v in u:
        read.append(plant.sample().upper)
        true.append(plant.advance(v).upper)
    return np.array(read), np.array(true)


def same(one, other):
    return np.array_equal(one.view(np.int64), other.view(np.int64))


@pytest.mark.parametrize(
    ('failed', 'changes'),
    [
        ({'kind': 'actuator_lost', 'strut': 2}, {'coil.force_scale.1': 0.0}),
        (
            {'kind': 'rig_changed', 'changes': {'payload.mass': 12.0}},
            {'payload.mass': 12.0},
        ),
        (
            {'kind': 'rig_changed', 'changes': {'struts.stiffness_scale.0': 0.5}},
            {'struts.stiffness_scale.0': 0.5},
        ),
        (
            {'kind': 'rig_changed', 'changes': {'acquisition.input_delay': 0.0173}},
            {'acquisition.input_delay': 0.0173},
        ),
        (
            {
                'kind': 'rig_changed',
                'changes': {'accelerometer.scale': [-1.0, 1.0, 0.5, 1.0, 1.0, 2.0]},
            },
            {'accelerometer.scale': [-1.0, 1.0, 0.5, 1.0, 1.0, 2.0]},
        ),
        (
            {'kind': 'rig_changed', 'changes': {'acquisition.periods_late': [0, 2, 1]}},
            {'acquisition.periods_late': [0, 2, 1]},
        ),
        (
            {'kind': 'rig_changed', 'changes': {'accelerometer.range': 0.5}},
            {'accelerometer.range': 0.5},
        ),
    ],
)
def test_a_failure_at_the_beginning_is_the_failed_rig(failed, changes):
    """Truth: the plant of a rig that is built like that, bit for bit; the source shakes as it was set up."""
    u = voltages(120)
    quiet = make_disturbance(None)
    plant = make_failing_plant(RIG, quiet, 3, [failure(time=0.0, **failed)])
    wanted = Plant(load_rig('soft_3dof', changes), quiet, 3)
    for a, b in zip(drive(plant, u), drive(wanted, u), strict=True):
        assert same(a, b)


def test_a_change_keeps_the_motion():
    """Truth: mechanics: strokes are continuous when the payload changes, their steps stay small."""
    plant = make_failing_plant(
        RIG, TONE, 3, [failure('rig_changed', 1.0, changes={'payload.mass': 12.0})]
    )
    strokes = []
    for _ in range(300):
        plant.sample()
        strokes.append(plant.advance(np.zeros(3)).stroke)
    steps = np.abs(np.diff(strokes, axis=0)).max(axis=1)
    assert steps[195:205].max() < 1.3 * steps[150:190].max()
    # and the change does something: the resonance moves from 9 Hz to 7.8 Hz
    level = np.abs(strokes)
    assert level[280:].max() < 0.9 * level[150:200].max()


def test_nothing_differs_before_a_failure_and_something_after():
    """Truth: the plant without failures, bit for bit up to the failure's sample."""
    u = voltages(200)
    wanted = drive(Plant(RIG, TONE, 3), u)
    cases = {
        'actuator_lost': {'strut': 1},
        'sensor_lost': {'strut': 1},
        'rig_changed': {'changes': {'payload.mass': 6.0}},
        'disturbance_changed': {'disturbance': {'kind': 'sine', 'frequency': 5.0, 'amplitude': 1}},
        'controller_killed': {},
    }
    for kind, more in cases.items():
        got = drive(make_failing_plant(RIG, TONE, 3, [failure(kind, 0.5, **more)]), u)
        assert same(got[0][:100], wanted[0][:100]), kind
        assert same(got[1][:100], wanted[1][:100]), kind
        assert not same(got[0][100:], wanted[0][100:]), kind


def test_a_lost_sensor_is_blind_and_the_motion_goes_on():
    """Truth: the plant without failures, for everything but the lost reading."""
    u = voltages(60)
    read, true = drive(make_failing_plant(RIG, TONE, 3, [failure('sensor_lost', 0.2, strut=3)]), u)
    wanted = drive(Plant(RIG, TONE, 3), u)
    assert same(true, wanted[1])
    assert np.isnan(read[40:, 2]).all()
    assert np.isfinite(read[:40]).all()
    assert same(np.ascontiguousarray(read[:, :2]), np.ascontiguousarray(wanted[0][:, :2]))


def test_a_changed_disturbance_is_the_new_one():
    """Truth: a plant with the new disturbance from the beginning; a second later both are in the same steady state.

    5 % damping: a second leaves exp(-2.8) of a difference of 5 m/s^2; four leave 1e-5 of it.
    """
    new = {'kind': 'sine', 'frequency': 12.0, 'amplitude': 0.5}
    plant = make_failing_plant(RIG, TONE, 3, [failure('disturbance_changed', 1.0, disturbance=new)])
    u = np.zeros((1200, 3))
    got, wanted = drive(plant, u)[1], drive(Plant(RIG, make_disturbance(new), 3), u)[1]
    assert got[1000:] == pytest.approx(wanted[1000:], abs=2e-3)


def test_a_killed_controller_is_held_and_silenced_as_the_board_does():
    """Truth: `Commands`, the board's own rule in real time, told the same voltages at the samples."""
    u = voltages(100) + 3.0
    plant = FailingPlant(Plant(RIG, TONE, 3), [[failure('controller_killed', 0.2, strut=2)]])
    board = Commands(['strut_1', 'strut_2', 'strut_3'], 0.05, plant.dt)
    at_terminals = []
    for k, v in enumerate(u):
        plant.sample()
        plant.advance(v)
        for strut in range(3):
            if strut != 1 or k < 40:
                board.take(strut, k, v[strut], k * plant.dt, 0.0, k)
        # the board looks when the period is over; half a period avoids a tie of floats
        wanted, _ = board.period_over((k + 0.5) * plant.dt)
        at_terminals.append((plant.terminal_voltage.copy(), wanted.copy()))
    got, wanted = (2.0 * np.round(np.array(x), 12) for x in zip(*at_terminals, strict=True))
    # the rig's amplifier has gain 2 and 16 bits in +-10 V
    got, wanted = got / 2.0, wanted / 2.0
    scale = np.median(got[:40, 0] / wanted[:40, 0])
    assert got == pytest.approx(scale * wanted, abs=2e-3)
    assert (got[65:, 1] == 0.0).all()
    assert plant.dead.tolist() == [False, True, False]


def test_bits_do_not_depend_on_the_batch():
    """Truth: each trial alone, bit for bit; every kind of failure at its own time, and one trial without."""
    lists = [
        [failure('actuator_lost', 0.1, strut=1)],
        [],
        [failure('sensor_lost', 0.15, strut=2), failure('controller_killed', 0.2, strut=2)],
        [failure('rig_changed', 0.2, changes={'payload.mass': 7.0, 'coil.force_constant': 8.0})],
        [
            failure(
                'disturbance_changed', 0.1,
                disturbance={'kind': 'random', 'low': 2, 'high': 30, 'rms': 1},
            )
        ],
        [failure('controller_killed', 0.1)],
    ]  # fmt: skip
    u = voltages(120, (len(lists), 3))
    seeds = [4, 5, 6, 7, 8, 9]
    batch = drive(make_failing_plant([RIG] * 6, [TONE] * 6, seeds, lists), u)
    for i, each in enumerate(lists):
        single = drive(make_failing_plant(RIG, TONE, seeds[i], each), u[:, i])
        for a, b in zip(single, batch, strict=True):
            assert same(a, np.ascontiguousarray(b[:, i])), i


def test_without_failures_there_is_no_wrapper():
    """The plant itself, so that nothing is paid for what does not happen."""
    assert type(make_failing_plant(RIG, TONE, 1, [])) is Plant
    assert type(make_failing_plant([RIG, RIG], TONE, [1, 2], [[], []])) is Plant


BAD = {
    "kind: 'broken' is not one of": {'kind': 'broken', 'time': 1.0},
    'time: missing': {'kind': 'sensor_lost', 'strut': 1},
    'strut: missing, sensor_lost needs it': {'kind': 'sensor_lost', 'time': 1.0},
    'changes: missing': {'kind': 'rig_changed', 'time': 1.0},
    'strut: rig_changed has no such key': {
        'kind': 'rig_changed', 'time': 1.0, 'strut': 1, 'changes': {'payload.mass': 1.0},
    },
    'only payload, struts, coil, accelerometer.range': {
        'kind': 'rig_changed', 'time': 1.0, 'changes': {'acquisition.sample_rate': 100.0},
    },
    'frequency: missing': {
        'kind': 'disturbance_changed', 'time': 1.0, 'disturbance': {'kind': 'sine', 'amplitude': 1},
    },
    'time: -1.0 is less than 0.0 s': {'kind': 'controller_killed', 'time': -1.0},
}  # fmt: skip


@pytest.mark.parametrize('told', BAD)
def test_a_wrong_failure_is_refused_in_one_line(told):
    """The message names the key."""
    with pytest.raises(SatvibError) as caught:
        Failure.from_mapping(BAD[told], 'failures[0]')
    assert told in str(caught.value)
    assert '\n' not in str(caught.value)


def test_failures_that_do_not_fit_the_run_are_refused():
    """Struts and keys that are not there, times after the end, and text that is no list."""
    cases = {
        r'failures\[0\].strut: 4, but soft_3dof has 3': failure('sensor_lost', 1.0, strut=4),
        r'failures\[0\].time: 30.0 s, the run ends at 20': failure('controller_killed', 30.0),
        r'failures\[0\].changes: payload.mess: no such key': failure(
            'rig_changed', 1.0, changes={'payload.mess': 3.0}
        ),
    }
    for told, wrong in cases.items():
        with pytest.raises(SatvibError, match=told):
            check_failures([wrong], RIG, 20.0)
    with pytest.raises(SatvibError, match='a list is expected'):
        PlantParameters(failures='{kind: sensor_lost}')
    assert PlantParameters(failures='[{kind: controller_killed, time: 2}]').make_failures()


def test_a_latency_that_grows_in_a_run_keeps_what_is_on_its_way():
    """Truth: while the voltage is 0 nobody can tell, so the plant that had the longer latency from the beginning."""
    u = np.concatenate([np.zeros((40, 3)), voltages(80)])
    changes = {'acquisition.input_delay': 0.0173}
    changed = make_failing_plant(
        RIG, TONE, 3, [failure('rig_changed', time=20 * RIG.acquisition.period, changes=changes)]
    )
    wanted = Plant(load_rig('soft_3dof', changes), TONE, 3)
    for one, other in zip(drive(changed, u), drive(wanted, u), strict=True):
        assert same(one, other)


def late(time, *periods):
    return failure('rig_changed', time, changes={'acquisition.periods_late': list(periods)})


def test_bits_do_not_depend_on_the_latency_of_other_trials():
    """Truth: each trial alone, bit for bit; latencies of a batch grow and shrink at different times."""
    lists = [
        [late(0.05, 3, 3, 3)],
        [late(0.1, 2, 2, 2)],
        [late(0.02, 3, 0, 1), late(0.12, 3, 2, 0), late(0.125, 3, 3, 3)],
        [late(0.03, 1, 1, 1), late(0.2, 0, 0, 0), late(0.205, 2, 2, 2)],
        [],
    ]
    u = voltages(80, (len(lists), 3))
    batch = drive(make_failing_plant([RIG] * 5, [TONE] * 5, [1, 2, 3, 4, 5], lists), u)
    for i, each in enumerate(lists):
        single = drive(make_failing_plant(RIG, TONE, i + 1, each), u[:, i])
        for a, b in zip(single, batch, strict=True):
            assert same(a, np.ascontiguousarray(b[:, i])), i


def test_a_latency_that_grows_holds_the_last_voltage():
    """Struts 1 and 2 grow by 2 and 1 samples under strut 3, which is 3 late all the time.

    Truth: the voltages moved by hand; what has arrived is held until the next one arrives, never an older one.
    """
    u, k = voltages(60), 30
    moved = u.copy()
    moved[:, 2] = np.concatenate([np.zeros(3), u[:-3, 2]])
    for strut, periods in ((0, 2), (1, 1)):
        sent = np.arange(60)
        sent[k:] = np.maximum(sent[k:] - periods, k - 1)
        moved[:, strut] = u[sent, strut]
    first = load_rig('soft_3dof', {'acquisition.periods_late': [0, 0, 3]})
    changed = make_failing_plant(first, TONE, 3, [late(k * RIG.acquisition.period, 2, 1, 3)])
    for one, other in zip(drive(changed, u), drive(Plant(RIG, TONE, 3), moved), strict=True):
        assert same(one, other)


@pytest.mark.parametrize('delay', [0.0, 0.004, 0.0173])
def test_voltages_on_their_way_arrive_in_order_when_the_latency_changes(delay):
    """Truth: a voltage that stays the same is the same whenever it arrives, whatever the latency is."""
    steady = np.full((120, 3), 1.0)
    failures = [
        failure(
            'rig_changed',
            time=60 * RIG.acquisition.period,
            changes={'acquisition.input_delay': delay},
        )
    ]
    changed = drive(make_failing_plant(RIG, TONE, 3, failures), steady)
    unchanged = drive(Plant(RIG, TONE, 3), steady)
    for one, other in zip(changed, unchanged, strict=True):
        np.testing.assert_allclose(one, other, atol=1e-9)


def test_what_cannot_change_in_a_run_is_refused():
    """The noise of a sensor and the anti-alias filter are drawn and designed before the run."""
    for key in ('accelerometer.noise_rms', 'acquisition.filter_corner', 'shaker.mass'):
        with pytest.raises(SatvibError, match=key):
            failure('rig_changed', changes={key: 1.0})


def test_a_strut_whose_voltage_is_late_gets_what_the_others_got_before():
    """Truth: the voltages moved by hand, two samples for strut 2, none for the others."""
    u = voltages(80)
    moved = u.copy()
    moved[:, 1] = np.concatenate([np.zeros(2), u[:-2, 1]])
    moved_by_the_rig = drive(
        Plant(load_rig('soft_3dof', {'acquisition.periods_late': [0, 2, 0]}), TONE, 3), u
    )
    for one, other in zip(moved_by_the_rig, drive(Plant(RIG, TONE, 3), moved), strict=True):
        assert same(one, other)
