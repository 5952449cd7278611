# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized law and its core: modes, what stops all struts, and bits that do not depend on the batch."""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase, PhasePlan
from satvib_common.signals.integrator import leaky_integrator
from satvib_common.struts.motions import strut_matrix
from satvib_control.core.centralized import CentralizedCore, _CommonWatch, make_core
from satvib_control.core.controller import ControllerCore
from satvib_control.core.faults import LOST_LONG
from satvib_control.laws.centralized.law import BLIND, Centralized
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.nodes.sample_gatherer import SampleGatherer
from satvib_control.parameters import ControllerParameters
from scipy.signal import lfilter

RATE = 200.0
NOW = PhasePlan((Phase.CONTROL,), (0,))


def parameters(**changes):
    return CentralizedParameters(
        **({'sample_rate': RATE, 'switch_on_time': 0.0, 'watch_loudness': 1000.0} | changes)
    )


def answers(core, upper):
    """Voltages (samples, *shape) to accelerations (samples, *shape)."""
    zero = np.zeros(upper.shape[1:])
    return np.array([core.step(k, NOW, y, zero).voltage for k, y in enumerate(upper)])


def test_equal_gains_are_a_pid_at_every_strut():
    """Truth: SciPy's lfilter with the integrator's coefficients, strut by strut; 1e-12 of the largest voltage."""
    y = np.random.default_rng(1).normal(size=(400, 3))
    g = {'gains_p': (30.0,) * 3, 'gains_i': (200.0,) * 3, 'gains_d': (0.4,) * 3}
    got = answers(CentralizedCore(parameters(voltage_limit=1e3, **g)), y)
    b, a = leaky_integrator(parameters().velocity_corner, 1.0 / RATE)
    v = lfilter(b, a, y, axis=0)
    x = lfilter(b, a, v, axis=0)
    assert got == pytest.approx(-(30.0 * v + 200.0 * x + 0.4 * y), abs=1e-11)


def test_each_mode_has_its_own_gain():
    """Truth: the law's definition: a pure tilt meets the gain of the tilt alone, whatever heave has."""
    angles = (90.0, 210.0, 330.0)
    signal = np.sin(np.arange(300) * 0.3)
    p = parameters(gains_p=(5.0, 40.0, 7.0), gains_i=(0.0,) * 3, gains_d=(1.0, 0.0, 2.0))
    b, a = leaky_integrator(p.velocity_corner, 1.0 / RATE)
    v = lfilter(b, a, signal)
    for mode, wanted in enumerate((5.0 * v + 1.0 * signal, 40.0 * v, 7.0 * v + 2.0 * signal)):
        shape = strut_matrix(angles)[:, mode]
        got = answers(CentralizedCore(p), signal[:, None] * shape)
        assert got == pytest.approx(-wanted[:, None] * shape, abs=1e-11)


def test_listed_struts_have_a_gain_for_each_motion():
    """Truth: the law's definition with numpy's pseudo-inverse: five struts, three motions; 1e-11.

    What no motion explains is left alone. Gains that are all 0 may be left out.
    """
    shapes = np.random.default_rng(2).normal(size=(5, 3))
    signal = np.sin(np.arange(200) * 0.3)
    p = parameters(
        struts=5, strut_shapes=tuple(shapes.ravel()), gains_p=(5.0, 40.0, 7.0), voltage_limit=1e3
    )
    assert p.modes == 3
    b, a = leaky_integrator(p.velocity_corner, 1.0 / RATE)
    v = lfilter(b, a, signal)
    for mode, gain in enumerate(p.gains_p):
        shape = shapes[:, mode]
        got = answers(CentralizedCore(p, (5,)), signal[:, None] * shape)
        assert got == pytest.approx(-gain * v[:, None] * shape, abs=1e-11)
    # orthogonal to every motion
    apart = np.linalg.svd(shapes)[0][:, 3:].sum(axis=1)
    assert answers(CentralizedCore(p, (5,)), signal[:, None] * apart) == pytest.approx(
        0.0, abs=1e-11
    )
    with pytest.raises(SatvibError, match='gains_p: 2 values for 3 motions'):
        p.replace(gains_p=(1.0, 2.0))
    with pytest.raises(SatvibError, match='strut_shapes: 14 numbers are no rows for 5 struts'):
        p.replace(strut_shapes=tuple(shapes.ravel()[:14]))


def test_bits_do_not_depend_on_the_batch():
    """Truth: the single run, bit for bit, with a lost sensor and a voltage at its limit among the trials."""
    y = np.random.default_rng(2).normal(size=(300, 5, 3)) * np.array([1, 5, 50, 1, 2])[:, None]
    y[100:107, 1, 2] = np.nan
    y[50:, 3, 0] = np.nan
    p = parameters(gains_p=(60.0, 50.0, 40.0), gains_d=(0.5,) * 3, watch_loudness=4.0)
    batch = answers(CentralizedCore(p, (5, 3)), y)
    for trial in range(5):
        single = answers(CentralizedCore(p, (3,)), y[:, trial])
        assert np.array_equal(single.view(np.int64), batch[:, trial].view(np.int64))


def test_one_lost_sensor_takes_all_voltages():
    """Truth: three unknowns and two readings. 0 V at once for all, latched for all after the limit, by name."""
    y = np.random.default_rng(3).normal(size=(60, 3))
    y[20:, 1] = np.nan
    core = CentralizedCore(parameters(gains_p=(60.0,) * 3, loss_limit=10))
    for k in range(60):
        out = core.step(k, NOW, y[k], np.zeros(3))
        if k < 20:
            assert (out.voltage != 0.0).all()
        else:
            assert (out.voltage == 0.0).all()
        if 20 <= k < 29:
            assert not out.fault.any()
            assert out.reason[0] == out.reason[2] == BLIND
    assert out.fault.all()
    assert (out.reason == LOST_LONG).all()


def test_a_law_that_diverges_is_taken_off_all_struts():
    """A wrong polarity on a plant y(k+1) = 0.5 u(k): loop gains 6, 3, 1.5 with the voltage
    halved twice, all above 1, so three times the cause; what one strut shows must act for all at once."""
    p = parameters(gains_d=(12.0,) * 3, velocity_polarity=-1.0, watch_loudness=4.0)
    core = CentralizedCore(p)
    y, off = np.array([1e-3, 0.0, 0.0]), []
    for k in range(int(20.0 * RATE)):
        out = core.step(k, NOW, y, np.zeros(3))
        off.append(out.voltage == 0.0)
        y = 0.5 * out.voltage + 1e-3
    assert out.fault.all()
    off = np.array(off)[50:]
    assert (off.all(axis=1) == off.any(axis=1)).all()


def test_a_single_strut_is_one_mode_and_the_law_refuses_less_than_all():
    """Truth: for one strut T is 1. The refusals name what to do."""
    p = parameters(struts=1, gains_p=(10.0,), gains_i=(0.0,), gains_d=(0.0,))
    y = np.random.default_rng(4).normal(size=(50, 1))
    b, a = leaky_integrator(p.velocity_corner, 1.0 / RATE)
    assert answers(CentralizedCore(p, (1,)), y) == pytest.approx(-10.0 * lfilter(b, a, y, axis=0))
    with pytest.raises(SatvibError, match='set scheme: centralized'):
        ControllerCore(ControllerParameters(sample_rate=RATE, law='centralized'))
    with pytest.raises(SatvibError, match='set scheme: centralized'):
        CentralizedCore(parameters(), (2,))
    with pytest.raises(SatvibError, match='gains_p: 1 values for 3 struts'):
        parameters(gains_p=(1.0,))
    assert type(make_core(ControllerParameters(), (3,))) is ControllerCore
    assert type(make_core(parameters(), (3,))) is CentralizedCore


def test_samples_are_gathered_in_any_order_and_old_ones_are_left():
    """Counted by hand: a sample that never gets whole is passed over, and a run that begins again is followed."""
    g: SampleGatherer[str] = SampleGatherer(2)
    assert g.add(0, 0, 'a0') is None
    assert g.add(0, 1, 'a1') is None
    assert g.add(1, 1, 'b1') == ['a1', 'b1']
    assert g.add(1, 0, 'b0') is None
    assert g.add(1, 2, 'b2') is None
    assert g.add(0, 2, 'a2') == ['a2', 'b2']
    assert g.add(0, 0, 'again') is None
    assert g.add(1, 0, 'here') == ['again', 'here']


def test_all_struts_listen_together_and_long_enough():
    """9 Hz that grows by 2 dB/s under a law that leaves 0.6 of it: the open loop has grown, and a pause must say so.

    Truth: fade, ringing and two blocks are 0.9 s; a short look of one strut would end after 0.25 s. All struts have the
    same voltage at each sample, and none is at fault.
    """
    watch = _CommonWatch(parameters(watch_loudness=4.0), 1.0 / RATE, (3,))
    t = np.arange(int(16 * RATE)) / RATE
    still = np.sin(2 * np.pi * 9.0 * t) * 10.0 ** (np.clip(t - 4.0, 0.0, 10.0) / 10.0)
    shares, share = np.zeros((len(t), 3)), np.zeros(3)
    for k, now in enumerate(t):
        acting = bool(now >= 2.0)
        y = still[k] * (1.0 - 0.4 * share) * np.array([1.0, 0.8, 0.6])
        scale, verdict = watch.step(y, share * 5.0, acting, not acting)
        assert not verdict.any()
        share = scale if acting else np.zeros(3)
        shares[k] = share
    shares = shares[int(2.1 * RATE) :]
    assert (shares == shares[:, :1]).all()
    pauses = np.flatnonzero(np.diff((shares[:, 0] < 1.0).astype(int)))
    assert len(pauses) >= 2
    assert np.min(pauses[1::2] - pauses[::2][: len(pauses) // 2]) >= 0.9 * RATE


def test_the_response_of_the_law_is_what_it_does():
    """Truth: the voltages that the law gives to tones at every sensor, in the steady state; 1e-6."""
    p = parameters(
        gains_p=(5.0, 40.0, 7.0),
        gains_i=(90.0, 0.0, 20.0),
        gains_d=(1.0, 0.5, 2.0),
        voltage_limit=1e3,
    )
    law = Centralized(p, 1.0 / RATE, (3,))
    omega = 2.0 * np.pi * 8.0 / RATE
    found = law.response_matrix(np.array([omega]))[0]
    k = np.arange(2000)
    for j in range(3):
        y = np.zeros((2000, 3))
        y[:, j] = np.cos(omega * k)
        u = answers(CentralizedCore(p), y)[1000:]  # 40 periods
        lines = 2.0 / 1000.0 * np.exp(-1j * omega * k[1000:]) @ u
        assert lines == pytest.approx(-found[:, j], rel=1e-6, abs=1e-6)
