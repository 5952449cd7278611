# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Every law for ten minutes of what is worst for it: no drift of the mean voltage, no growth of its gains.

Worst is what keeps a law learning and its integrators busy: vibration at the mode for damping, random vibration for
what adapts, a wheel with harmonics for what seeks tones, 10 mg of sensor noise and quantization on the paper's rig.
CONTROL is cut into ten blocks; the first is for learning. Truth: every path has a zero at 0 Hz and a calibrated bias,
so the mean voltage is 0. Tolerance: 5 standard errors, as the scatter of the blocks' means tells, and 0.01 V (0.05 %
of the limit) for a scatter that is nothing; the same for the later half less the earlier one, which is the drift. So
that the scatter hides nothing it stays below 0.25 V in blocks of a minute, and, as means of noise do, below that times
the root of what they are shorter: twice integrated, 10 mg of the lower sensor wander. The mean itself may be 0.05 V: a
calibration of 1 s with 10 mg at 100 Hz leaves a bias of 0.01 m/s^2, five times that through a weight of 1 V s^2/m at
0 Hz. Gains: the mean over blocks of the largest in each, later half against the earlier one, grows by a quarter at
most. The short form is thirty seconds.
"""

import numpy as np
import pytest
from satvib_common.phases import Phase
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop

RANDOM = 'disturbance={kind: random, rms: 0.7, low: 2.0, high: 50.0, start: 6.0}'
WHEEL = (
    'disturbance={kind: reaction_wheel, start: 6.0, speed: 12.0, harmonics: [1.0, 2.0], '
    'coefficients: [1.4e-4, 0.35e-4]}'
)
MODE = 'disturbance={kind: sine, frequency: 9.0, amplitude: 0.5, start: 6.0}'
PAPER = ('rig=paper_3dof', 'identifier={poles: 4, coefficients: 5}', 'controller.excitation=chirp')
SOFT = (
    'rig=soft_3dof', 'identifier={poles: 6, coefficients: 7}', 'controller.excitation=squares',
    'controller.excitation_amplitude=2.0', 'controller.reference_voltage=1.0',
)  # fmt: skip
CASES = {
    'velocity_feedback': (*SOFT, MODE, 'controller.velocity_gain=2000'),
    'model_reference': (*SOFT, RANDOM, 'controller.adapt_in_control=true'),
    'feedforward': (*PAPER, RANDOM),
    # at its step of 0.1 it learns for a minute
    'feedforward, fxlms': (
        *PAPER,
        RANDOM,
        'controller.feedforward_method=fxlms',
        'controller.feedforward_step=0.5',
    ),
    'feedforward, filtered_u': (*PAPER, RANDOM, 'controller.feedforward_method=filtered_u'),
    'narrowband': (*PAPER, WHEEL),
    'velocity_feedback+feedforward': (*SOFT, RANDOM),
    'velocity_feedback+narrowband': (*SOFT, WHEEL),
    'narrowband+feedforward': (*PAPER, WHEEL),
}
GAINS = ('kp', 'ki', 'kd', 'weight_norm')
BLOCKS, START = 10, 10.0
PHASES = (
    'phases=[{phase: CALIBRATE}, {phase: IDENTIFY, start: 1}, {phase: ADAPT, start: 4}, '
    f'{{phase: STANDBY, start: 6}}, {{phase: CONTROL, start: {START}}}]'
)


def blocks(name, seconds):
    """Mean voltage (blocks, struts) and largest gains (gains, blocks, struts) over CONTROL in ten equal blocks."""
    end = START + seconds
    scenario = load_scenario(
        'clean_3dof',
        [
            *CASES[name], f'controller.law={name.split(",")[0]}', 'analysis={}', f'duration={end}',
            PHASES,
        ],
    )  # fmt: skip
    loop = ClosedLoop(scenario)
    first = loop.plan.first_of(Phase.CONTROL)
    size = (loop.plan.end - first) // BLOCKS
    mean = np.zeros((BLOCKS, loop.plant.struts))
    gains = np.zeros((len(GAINS), BLOCKS, loop.plant.struts))
    for step in loop.steps():
        block = (step.sequence - first) // size
        if step.phase is Phase.CONTROL and block < BLOCKS:
            mean[block] += step.output.voltage / size
            for i, gain in enumerate(GAINS):
                value = np.abs(getattr(step.output.state, gain))
                gains[i, block] = np.fmax(gains[i, block], value)
    return mean, gains, step.output


@pytest.mark.parametrize('seconds', [30.0, pytest.param(600.0, marks=pytest.mark.long)])
@pytest.mark.parametrize('name', CASES)
def test_nothing_drifts_and_nothing_grows(name, seconds):
    """The bars are in the module's page."""
    mean, gains, last = blocks(name, seconds)
    assert not last.fault.any()
    early, late = mean[1:5], mean[5:]
    error = 5.0 * mean[1:].std(axis=0, ddof=1)
    assert np.all(np.abs(mean[1:].mean(axis=0)) < error / 3.0 + 0.05), mean
    drift = late.mean(axis=0) - early.mean(axis=0)
    assert np.all(np.abs(drift) < error * np.sqrt(1.0 / 4.0 + 1.0 / 5.0) + 0.01), mean
    assert np.all(mean[1:].std(axis=0) < 0.25 * np.sqrt(60.0 * BLOCKS / seconds)), mean
    assert np.all(gains[:, 5:].mean(axis=1) <= 1.25 * gains[:, 1:5].mean(axis=1)), gains
    if not name.startswith('narrowband'):
        assert np.all(gains.max(axis=(0, 1)) > 0.0)  # something did act
    assert np.all(np.abs(last.voltage) <= 20.0)
