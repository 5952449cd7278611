# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Plants and loops that the tests share; made with SciPy, apart from the package under test."""

import numpy as np
import pytest
from satvib_common.phases import Phase, PhasePlan
from satvib_control.core.controller import ControllerCore
from satvib_control.parameters import ControllerParameters
from satvib_ident.models.iir_model import IirModel
from scipy.linalg import expm


def isolator(rate, wn=131.0, zeta=0.79, gain=1.18, corner=50.0, latency=0.2):
    """The sampled strut: gain s^2 / (s^2 + 2 zeta wn s + wn^2), a first-order filter, zero-order hold, latency.

    `latency` is a share of the period; exact discretization by the matrix exponential.
    """
    wc = 2.0 * np.pi * corner
    # states: position, velocity, filter
    a = np.array([[0, 1, 0], [-wn * wn, -2 * zeta * wn, 0], [0, 0, -wc]], dtype=float)
    b = np.array([[0.0], [gain], [0.0]])
    a[2, :2] = wc * a[1, :2]
    b[2] = wc * gain
    dt = 1.0 / rate

    def hold(t):
        block = expm(np.block([[a, b], [np.zeros((1, 4))]]) * t)
        return block[:3, :3], block[:3, 3]

    phi, whole = hold(dt)
    _, new = hold(dt * (1.0 - latency))
    old = whole - new
    full = np.zeros((4, 4))
    full[:3, :3], full[:3, 3] = phi, old
    drive = np.append(new, 1.0)
    den = np.poly(full).real
    # numerator from the impulse response: B = A h, exact for a finite order
    h, x = [0.0], drive.copy()
    for _ in range(4):
        h.append(x[2])
        x = full @ x
    num = np.convolve(den, h)[:5]
    return IirModel(den[1:], num[1:], 1, dt)


@pytest.fixture
def make_isolator():
    return isolator


class Loop:
    """y = G u + d, closed by a ControllerCore, for any batch shape; the model is handed over as the graph does."""

    def __init__(self, parameters, model, plan, shape=(), identified=None, trusted=True):
        from satvib_common.signals.iir_filter import IirFilter
        from satvib_control.model_analysis.transfer import model_polynomials

        self.core = ControllerCore(parameters, shape)
        self.plan, self.shape = plan, shape
        self.identified = model if identified is None else identified
        self.trusted = trusted
        self.plant = IirFilter(*model_polynomials(model), shape)
        self.voltage = np.zeros(shape)
        self.k = 0

    def step(self, disturbance=0.0, lower=0.0, clipped=(False, False)):
        """One sample; `clipped`: of the upper and of the lower sensor.

        The plant's numerator begins with the delay, so u(k) is filtered in after y(k) is read.
        """
        # with delay >= 1 the direct term is zero and the filter's state already holds y(k)'s part
        y = self.plant.state[..., 0] + disturbance
        if self.identified is not None and self.plan.is_hand_over(self.k, 0):
            self.core.set_model(self.identified, self.trusted)
        lower = np.broadcast_to(np.asarray(lower, dtype=float), self.shape)
        out = self.core.step(self.k, self.plan, y, lower, None, *clipped)
        self.plant.step(out.voltage)
        self.voltage = out.voltage
        self.k += 1
        return y, out

    def run(self, count, disturbance=None, lower=None):
        """`count` samples; `disturbance` (count, *shape). Gives y and u, (count, *shape)."""
        ys, us = [], []
        for i in range(count):
            d = 0.0 if disturbance is None else disturbance[i]
            low = 0.0 if lower is None else lower[i]
            y, out = self.step(d, low)
            ys.append(np.array(y))
            us.append(np.array(out.voltage))
        return np.array(ys), np.array(us)


@pytest.fixture
def make_loop():
    return Loop


@pytest.fixture
def settings():
    """ControllerParameters from keywords."""
    return ControllerParameters


@pytest.fixture
def paper_plan():
    """The paper's phases: calibrate, identify, adapt, standby, control."""

    def make(rate, starts=(0.0, 1.0, 3.0, 5.0, 6.0), end=10.0):
        phases = (Phase.CALIBRATE, Phase.IDENTIFY, Phase.ADAPT, Phase.STANDBY, Phase.CONTROL)
        return PhasePlan.from_seconds(list(zip(phases, starts, strict=True)), end, rate)

    return make
