# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a setting in a run says of itself: refused, moved, not yet in use; and a voltage limit that is turned down.

Truth: what the loop then does, sample by sample.
"""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_control.laws.model_reference.law import MOVED
from satvib_control.laws.reasons import text_of

RATE = 200.0
CONTROL = PhasePlan((Phase.CONTROL,), (0,))
PID = {'law': 'model_reference', 'adapted_gains': ()}


@pytest.fixture
def run(make_isolator, make_loop, settings):
    """A function: a loop in CONTROL that has its model, or not."""

    def make(known=True, **given):
        plant = make_isolator(RATE)
        loop = make_loop(settings(sample_rate=RATE, **given), plant, CONTROL, (), None)
        loop.identified = None
        if known:
            loop.core.set_model(plant)
        loop.step(0.1)
        return loop

    return make


def tell(loop, **new):
    """Set as a node does; what is said of it."""
    loop.core.apply(loop.core.parameters.changed(new))
    return loop.core.effect_of(frozenset(new))


@pytest.mark.parametrize('gain', ['kp', 'ki', 'kd'])
def test_the_start_of_a_gain_that_adapts_is_refused_in_a_run(settings, gain):
    """Truth: the schema; a gain that does not adapt can be set, and any value at the start."""
    name = f'gain_{gain[1:]}'
    p = settings(adapted_gains=(gain,))
    with pytest.raises(SatvibError, match=rf'^{name}: {gain} adapts \(adapted_gains\)'):
        p.changed({name: 0.1})
    assert p.changed({name: getattr(p, name), 'adaptation_rate': 1.0}).adaptation_rate == 1.0
    assert getattr(settings(adapted_gains=(gain,), **{name: 0.1}), name) == 0.1
    assert getattr(settings(adapted_gains=()).changed({name: 0.1}), name) == 0.1


@pytest.mark.parametrize('name', ['gain_p', 'gain_i', 'gain_d'])
def test_a_gain_beyond_its_bounds_is_said_with_the_values_in_use(run, name):
    """Truth: the gains that the state shows. A gain within them is not mentioned, and the reason goes."""
    loop = run(**PID)
    said = tell(loop, **{name: 1e4})
    state, reason = (out := loop.step(0.1)[1]).state, out.reason_text()
    used = ', '.join(f'{gain} {float(getattr(state, gain)):.4g}' for gain in ('kp', 'ki', 'kd'))
    assert said == f'moved to the bounds of the identified model: {used}'
    assert reason == text_of(MOVED)
    assert max(abs(float(getattr(state, g))) for g in ('kp', 'ki', 'kd')) < 1e4
    assert not tell(loop, **{name: 1e-6})
    out = loop.step(0.1)[1]
    assert float(getattr(out.state, f'k{name[-1]}')) == pytest.approx(1e-6, rel=1e-12)
    assert out.reason_text() != text_of(MOVED)


@pytest.mark.parametrize(
    ('law', 'new'),
    [
        (PID, {'gain_i': 5.0}),
        ({'law': 'narrowband'}, {'narrowband_settling': 0.2}),
        ({'law': 'feedforward', 'feedforward_struts': 1}, {'feedforward_leak': 0.01}),
        ({'law': 'velocity_feedback+narrowband'}, {'narrowband_settling': 0.2}),
    ],
)
def test_a_setting_that_waits_for_a_model_says_so(run, law, new):
    """Truth: 0 V until the model is there. With a model nothing is said."""
    said = tell(run(known=False, **law), **new)
    assert said == 'acts when a trusted model is taken; until then 0 V'
    assert not tell(run(**law), **new)


def test_velocity_feedback_says_which_gain_is_in_use(run):
    """Truth: the gain that the state shows: the fallback gain without a model, the bound of the model with it."""
    for known, why in ((False, 'no identified model'), (True, 'reduced to the bound')):
        loop = run(known=known, law='velocity_feedback')
        said = tell(loop, velocity_gain=1e6)
        assert why in said
        assert said.endswith(f': {float(loop.step(0.1)[1].state.ki):.4g} V/(m/s) in use')
        assert not tell(loop, voltage_limit=19.0)  # of which no law says anything


@pytest.mark.parametrize('phase', list(Phase))
@pytest.mark.parametrize('slew', [0.0, 100.0])
def test_a_voltage_limit_turned_down_holds_from_the_next_sample_on(
    make_isolator, make_loop, settings, phase, slew
):
    """Truth: the limit. The excitation keeps its shape, and has its own amplitude when the limit is up again."""
    plant, plan = make_isolator(RATE), PhasePlan((phase,), (0,))
    p = settings(sample_rate=RATE, law='velocity_feedback', excitation='multisine', slew_limit=slew)
    told, untold = (make_loop(p, plant, plan, (), plant) for _ in range(2))
    push = 30.0 * np.sin(0.3 * np.arange(400))
    before = [[float(loop.step(d)[1].voltage) for d in push] for loop in (told, untold)]
    said = tell(told, voltage_limit=0.5)
    assert said == 'the excitation of IDENTIFY is 0.5 V at most, too'
    after = [[float(loop.step(d)[1].voltage) for d in push] for loop in (told, untold)]
    assert before[0] == before[1]
    assert np.max(np.abs(after[0])) <= 0.5
    if phase in {Phase.IDENTIFY, Phase.CONTROL}:
        assert np.max(np.abs(before[0])) > 1.0
        assert np.max(np.abs(after[0])) > 0.1
    if phase is Phase.IDENTIFY and not slew:
        np.testing.assert_allclose(after[0], 0.05 * np.array(after[1]), rtol=1e-12)
    assert not tell(told, voltage_limit=20.0)
    if phase is Phase.IDENTIFY and not slew:
        assert told.step()[1].voltage == untold.step()[1].voltage


def test_at_the_start_the_limit_is_at_least_the_excitation(settings):
    """Truth: the schema; what can be turned down in a run is a contradiction at the start."""
    with pytest.raises(
        SatvibError, match=r'^excitation_amplitude: 10\.0 V is more than voltage_limit'
    ):
        settings(voltage_limit=5.0)
