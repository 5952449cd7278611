# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What every law does when its inputs are bad: refused or degraded by name, 0 V or what remains, never a wrong voltage.

Truth of all tests: by hand, from the promises in docs/laws.md. Bad settings are in test_controller.py, a node that gets
messages that do not fit in tests/test_live_nodes.py, orders that do not fit in satvib_ident's test_identifier.py.
"""

import math

import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_ident.models.iir_model import IirModel

RATE = 200.0
PLAN = PhasePlan(
    (Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.STANDBY, Phase.CONTROL),
    (0, 100, 300, 500, 600),
)
COUNT = 2000
NEEDS_MODEL = ('model_reference', 'narrowband', 'feedforward', 'narrowband+feedforward')
ALL = (
    'velocity_feedback', *NEEDS_MODEL, 'velocity_feedback+feedforward', 'velocity_feedback+narrowband',
)  # fmt: skip
UNSTABLE = 'the identified model is not stable: not taken'


def waves():
    """A tone of 10 Hz from the end of ADAPT on, at the payload and, ahead of it, at the lower plate; (COUNT,) each."""
    t = np.arange(COUNT) / RATE
    on = t >= PLAN.first[3] / RATE
    return on * np.sin(2 * np.pi * 10.0 * t), on * np.sin(2 * np.pi * 10.0 * t + 0.8)


def controlled(voltage):
    """The part in CONTROL, without the fading in."""
    return voltage[PLAN.first[4] + 100 :]


@pytest.mark.parametrize('law', NEEDS_MODEL)
def test_a_law_without_its_model_gives_0_v_and_says_so(make_isolator, make_loop, settings, law):
    """The reason that the identifier gave is shown."""
    p = settings(sample_rate=RATE, law=law)
    loop = make_loop(p, make_isolator(RATE), PLAN, trusted=False)
    _, u = loop.run(COUNT, *waves())
    assert not controlled(u).any()
    loop.core.set_model(loop.identified, False, 'the input excites order 2')
    _, out = loop.step(1.0, 1.0)
    assert out.voltage == 0.0
    assert out.reason_text() == 'the input excites order 2'


@pytest.mark.parametrize('other', ['feedforward', 'narrowband'])
def test_in_a_sum_without_a_model_the_fallback_gain_remains(
    make_isolator, make_loop, settings, other
):
    """The sum is the voltage of velocity_feedback alone, not above the fallback gain; no tolerance but rounding."""
    sums = []
    for law in ('velocity_feedback', f'velocity_feedback+{other}'):
        p = settings(sample_rate=RATE, law=law, velocity_gain=1e4)
        loop = make_loop(p, make_isolator(RATE), PLAN, trusted=False)
        sums.append(loop.run(COUNT, *waves())[1])
        _, out = loop.step()
        assert 'no identified model' in out.reason_text()
        assert float(out.state.ki) == p.velocity_fallback_gain
    assert controlled(sums[0]).any()
    np.testing.assert_allclose(sums[1], sums[0], rtol=0.0, atol=1e-9)


@pytest.mark.parametrize('law', NEEDS_MODEL)
def test_an_unstable_model_is_not_taken(make_isolator, make_loop, settings, law):
    """Nor does it displace a good one: the voltages after it are those of a run that never saw it."""
    bad = IirModel([-1.2, 0.0, 0.0, 0.0], [1.0, 0.0, 0.0, 0.0], 1, 1.0 / RATE)
    p = settings(sample_rate=RATE, law=law)
    loop = make_loop(p, make_isolator(RATE), PLAN, identified=bad)
    _, u = loop.run(COUNT, *waves())
    assert not controlled(u).any()
    assert loop.step()[1].reason_text() == UNSTABLE
    voltages = []
    for spoil in (False, True):
        loop = make_loop(p, make_isolator(RATE), PLAN)
        first = loop.run(COUNT // 2, *(wave[: COUNT // 2] for wave in waves()))[1]
        if spoil:
            loop.core.set_model(bad)
            assert loop.step()[1].reason_text() == UNSTABLE
        else:
            loop.step()
        rest = loop.run(100)[1]
        voltages.append(np.concatenate([first, rest]))
    assert np.array_equal(*voltages)


@pytest.mark.parametrize('law', ALL)
def test_a_model_of_other_orders_is_taken_over_in_the_run(make_isolator, make_loop, settings, law):
    """The same response with two poles and zeros more that cancel: finite, no fault, and as well as before.

    model_reference begins at its first gain, for it was adapted on another parametrization: no worse than open loop.
    """
    model = make_isolator(RATE)
    more = [1.0, -0.5, 0.06]
    same = IirModel(
        np.convolve(np.append(1.0, model.a), more)[1:], np.convolve(model.b, more), 1, model.dt
    )
    loop = make_loop(settings(sample_rate=RATE, law=law), model, PLAN)
    d, low = waves()
    y, _ = loop.run(1300, d[:1300], low[:1300])
    before = np.sqrt(np.mean(y[-200:] ** 2))
    loop.core.set_model(same)
    y, u = loop.run(700, d[1300:], low[1300:])
    assert np.isfinite(u).all()
    assert np.abs(u).max() < 20.0
    bar = np.sqrt(0.5) if law == 'model_reference' else before
    assert np.sqrt(np.mean(y[-200:] ** 2)) < 1.05 * bar + 1e-3
    assert not loop.step()[1].fault


def test_a_gain_outside_its_bounds_is_brought_inside_by_name(make_isolator, make_loop, settings):
    """The gain that is used is the bound of the model, and both signs of a wild wish stay inside."""
    p = settings(sample_rate=RATE, law='velocity_feedback', velocity_gain=1e6)
    loop = make_loop(p, make_isolator(RATE), PLAN)
    loop.run(COUNT, *waves())
    state = loop.step()[1].state
    assert float(state.ki_min) <= float(state.ki) <= float(state.ki_max) < 1e4
    assert (
        loop.step()[1].reason_text() == 'the gain is reduced to the bound of the identified model'
    )
    for wish in (1e6, -1e6):
        p = settings(sample_rate=RATE, law='model_reference', gain_i=wish)
        loop = make_loop(p, make_isolator(RATE), PLAN)
        y, _ = loop.run(COUNT, *waves())
        state = loop.step()[1].state
        assert float(state.ki_min) <= float(state.ki) <= float(state.ki_max)
        assert np.abs(y[-200:]).max() < 2.0


@pytest.mark.parametrize('law', ['feedforward', 'velocity_feedback+feedforward'])
def test_a_missing_lower_sensor_ends_feedforward_alone(make_isolator, make_loop, settings, law):
    """From the NaN on: 0 V of feedforward, by name; of the sum what velocity_feedback gives alone, 2 s later.

    By then (1 + w t) exp(-w t) = 1.4 % of the difference in its integrator's state (w = 2 pi 0.5 Hz) is left: 1e-4 V.
    The vibration watch would measure the open loop anew meanwhile, so it is off.
    """
    p = settings(sample_rate=RATE, law=law, velocity_gain=30.0, watch_loudness=1000.0)
    loop = make_loop(p, make_isolator(RATE), PLAN)
    d, low = waves()
    _, u = loop.run(1400, d[:1400], low[:1400])
    assert np.abs(u[-100:]).max() > 0.1
    _, u = loop.run(600, d[1400:], np.full(600, np.nan))
    assert loop.step(0.0, np.nan)[1].reason_text() == (
        'feedforward: the lower acceleration is missing: 0 V'
    )
    if law == 'feedforward':
        assert not u.any()
        return
    alone = make_loop(p.replace(law='velocity_feedback'), make_isolator(RATE), PLAN)
    _, ours = alone.run(COUNT, d, low)
    np.testing.assert_allclose(u[-200:], ours[-200:], rtol=0.0, atol=1e-4)


@pytest.mark.parametrize('shape', [(), (3,)])
@pytest.mark.parametrize('absurd', [math.inf, -1e300, 1.01e4, math.nan])
def test_a_reading_that_no_sensor_gives_is_missing(shape, absurd):
    """Truth: the largest reading that is possible, 10^4 m/s^2."""
    from types import SimpleNamespace

    from satvib_control.core.reception import readings_of

    sample = SimpleNamespace(upper=absurd, lower=-1e4, upper_clipped=True, lower_clipped=False)
    found = readings_of([sample] * (3 if shape else 1), shape)
    upper, lower, up, low = (np.asarray(f) for f in found)
    assert upper.shape == lower.shape == up.shape == low.shape == shape
    assert np.isnan(upper).all()
    assert (lower == -1e4).all()
    assert up.all()
    assert not low.any()
