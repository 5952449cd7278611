# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The law state_space: a linear controller for one strut or for all, and what its states do at a limit."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_control.core.centralized import CentralizedCore
from satvib_control.core.controller import ControllerCore
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.laws.registry import make_law
from satvib_control.laws.state_space.law import BLIND
from satvib_control.laws.state_space.matrices import Matrices, response
from satvib_control.parameters import ControllerParameters
from scipy.signal import lfilter

RATE = 200.0
NOW = PhasePlan((Phase.CONTROL,), (0,))
COMMON = {
    'sample_rate': RATE, 'switch_on_time': 0.0, 'watch_loudness': 1000.0, 'law': 'state_space', 'voltage_limit': 1e3,
}  # fmt: skip


def drawn(states, channels, seed=1, e=0.0):
    """A stable controller."""
    draw = np.random.default_rng(seed)
    A = draw.normal(size=(states, states))
    A *= 0.8 / np.abs(np.linalg.eigvals(A)).max()
    shapes = ((states, channels), (channels, states), (channels, channels), (states, channels))
    B, C, D, E = (draw.normal(size=shape) for shape in shapes)
    return Matrices(A, B, C, D, e * E)


def exact(matrices):
    """The parameters of a controller with all digits."""
    return {
        f'state_space_{n.lower()}': tuple(m.ravel().tolist()) for n, m in matrices._asdict().items()
    }


def answers(core, upper):
    """Voltages (samples, *shape) to accelerations (samples, *shape)."""
    zero = np.zeros(upper.shape[1:])
    return np.array([core.step(k, NOW, y, zero).voltage for k, y in enumerate(upper)])


def test_one_strut_is_a_digital_filter():
    """Truth: SciPy's lfilter with b and a of the same filter in canonical form; 1e-12 of the largest voltage."""
    b, a = np.array([0.7, -0.2, 0.1]), np.array([1.0, -1.5, 0.7])
    matrices = Matrices(
        A=np.array([[1.5, -0.7], [1.0, 0.0]]),
        B=np.array([[1.0], [0.0]]),
        C=(b[1:] - a[1:] * b[0])[None],
        D=np.array([[b[0]]]),
        E=np.zeros((2, 1)),
    )
    y = np.random.default_rng(2).normal(size=(500, 3))
    for polarity in (1.0, -1.0):
        p = ControllerParameters(**COMMON, **exact(matrices), velocity_polarity=polarity)
        got = answers(ControllerCore(p, (3,)), y)
        truth = polarity * lfilter(b, a, y, axis=0)
        assert np.abs(got - truth).max() < 1e-12 * np.abs(truth).max()


@pytest.mark.parametrize('limit', [1e3, 0.8])
def test_all_struts_at_once_with_and_without_a_limit(limit):
    """Truth: the equations with NumPy's products, the voltage clipped there too; 1e-10."""
    m = drawn(5, 3, e=0.1)
    p = CentralizedParameters(
        **COMMON | {'voltage_limit': limit, 'excitation_amplitude': 0.5}, **exact(m)
    )
    y = np.random.default_rng(3).normal(size=(300, 3))
    got = answers(CentralizedCore(p), y)
    x, truth = np.zeros(5), []
    for sample in y:
        truth.append(np.clip(m.C @ x + m.D @ sample, -limit, limit))
        x = m.A @ x + m.B @ sample + m.E @ truth[-1]
    assert got == pytest.approx(np.array(truth), abs=1e-10)
    assert (np.abs(got) == limit).any() == (limit == 0.8)


def test_the_response_is_that_of_the_samples():
    """Truth: the DFT of the impulse response, whose tail is below 1e-12; with E as well."""
    m = drawn(4, 2, seed=5, e=0.1)
    A, B = m.linear()
    assert np.abs(np.linalg.eigvals(A)).max() < 0.97
    omega = np.array([0.0, 0.1, 1.0, 3.0])
    found = response(m, omega)
    total, state = np.broadcast_to(m.D, (4, 2, 2)).astype(complex), B
    for k in range(1, 1500):
        total = total + np.exp(-1j * omega * k)[:, None, None] * (m.C @ state)
        state = A @ state
    assert found == pytest.approx(total, abs=1e-9)


def test_a_law_beside_it_knows_its_response():
    """Truth: C of u = -C y from the matrices; the polarity turns it."""
    m = drawn(3, 1, seed=6)
    p = ControllerParameters(**COMMON, **exact(m), velocity_polarity=-1.0)
    law = make_law('state_space', p, 1.0 / RATE, (2,))
    omega = np.array([[0.1, 0.2], [0.3, 0.4]])
    assert law.response(omega) == pytest.approx(response(m, omega)[..., 0, 0])


def test_bits_do_not_depend_on_the_batch():
    """Truth: the single run, bit for bit, with a lost sensor among the trials, for both controllers."""
    y = np.random.default_rng(4).normal(size=(200, 4, 3))
    y[100:107, 1, 2] = np.nan
    together = CentralizedParameters(**COMMON, **exact(drawn(6, 3, e=0.1)))
    alone = ControllerParameters(**COMMON, **exact(drawn(6, 1, e=0.1)))
    for core, p in ((CentralizedCore, together), (ControllerCore, alone)):
        batch = answers(core(p, (4, 3)), y)
        for trial in range(4):
            single = answers(core(p, (3,)), y[:, trial])
            assert np.array_equal(single.view(np.int64), batch[:, trial].view(np.int64))


def test_a_lost_sensor_takes_all_voltages_or_its_own():
    """Truth: what the law says: all readings are needed together, and one strut knows only its own."""
    y = np.random.default_rng(7).normal(size=(40, 3))
    y[20:25, 1] = np.nan
    whole = CentralizedCore(CentralizedParameters(**COMMON, **exact(drawn(4, 3))))
    parts = ControllerCore(ControllerParameters(**COMMON, **exact(drawn(4, 1))), (3,))
    for k in range(40):
        lost = 20 <= k < 25
        out = whole.step(k, NOW, y[k], np.zeros(3))
        assert (out.voltage == 0.0).all() == lost
        assert (out.reason[[0, 2]] == BLIND).all() == lost
        out = parts.step(k, NOW, y[k], np.zeros(3))
        assert (out.voltage[[0, 2]] != 0.0).all()
        assert (out.voltage[1] == 0.0) == lost


def test_reset_begins_at_rest():
    """Truth: a core that has heard nothing before."""
    p = CentralizedParameters(**COMMON, **exact(drawn(4, 3, e=0.1)))
    y = np.random.default_rng(8).normal(size=(30, 3))
    used, fresh = (make_law('state_space', p, 1.0 / RATE, (3,)) for _ in range(2))
    from satvib_control.laws.base import LawInput

    def step(law, sample):
        zero = np.zeros(3)
        x = LawInput(0, sample, zero, zero, zero > 0.0, zero == 0.0)
        return law.step(x, Phase.CONTROL)

    for sample in y:
        step(used, sample)
    used.reset([True, False, False])
    assert np.array_equal(step(used, y[0]), step(fresh, y[0]))


def test_it_can_be_a_part_of_a_sum():
    """Truth: both laws alone, without a model that could change a gain; 1e-12."""
    m = drawn(3, 1, seed=9)
    y = np.random.default_rng(10).normal(size=(100, 3))
    found = [
        answers(ControllerCore(ControllerParameters(**COMMON | {'law': law}, **exact(m)), (3,)), y)
        for law in ('velocity_feedback', 'state_space', 'velocity_feedback+state_space')
    ]
    assert found[2] == pytest.approx(found[0] + found[1], abs=1e-12)


ONE = {'state_space_a': (0.5,), 'state_space_b': (1.0,), 'state_space_c': (1.0,)}
BAD = {
    'nothing': ({}, 'state_space_b: 0 numbers; a row of 1 for each state is expected'),
    'a': (
        ONE | {'state_space_a': (0.5, 0.1)},
        'state_space_a: 2 numbers; 1 rows of 1 are expected for 1 states',
    ),
    'c': (ONE | {'state_space_c': ()}, 'state_space_c: 0 numbers'),
    'd': (ONE | {'state_space_d': (1.0, 2.0)}, 'state_space_d: 2 numbers'),
    'e': (ONE | {'state_space_e': (1.0, 2.0)}, 'state_space_e: 2 numbers'),
    'number': (
        ONE | {'state_space_a': (float('nan'),)},
        'state_space_a: nan is not a finite number',
    ),
    'unstable': (
        ONE | {'state_space_a': (1.0,)},
        'state_space_a: its largest pole has the magnitude 1;',
    ),
}


@pytest.mark.parametrize('case', BAD)
def test_bad_matrices_are_refused_by_name(case):
    """Truth: one line that names the first parameter that is wrong."""
    given, said = BAD[case]
    with pytest.raises(SatvibError) as refused:
        ControllerParameters(**COMMON, **given)
    assert said in str(refused.value)
    assert '\n' not in str(refused.value)


def test_a_controller_of_all_struts_is_refused_what_is_of_one():
    """Truth: three readings make rows of three; without the law nothing is checked."""
    with pytest.raises(SatvibError, match='state_space_b: 1 numbers; a row of 3'):
        CentralizedParameters(**COMMON, **ONE)
    assert CentralizedParameters(**COMMON | {'law': 'centralized'}, **ONE).law == 'centralized'
    p = CentralizedParameters(**COMMON, **exact(drawn(2, 3)))
    with pytest.raises(SatvibError, match='set scheme: centralized'):
        make_law('state_space', p, 1.0 / RATE, (2,))
