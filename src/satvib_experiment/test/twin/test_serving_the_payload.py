# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Law narrowband serving the payload between the samples, on the paper's rig: steps at 100 Hz.

Truth: the best periodic command, by least squares on the simulated plant, leaves -5.84 dB of true RMS at 10 Hz and
-3.76 dB at 6.5 Hz (`satvib_plant_sim`, test_images.py). The limit of 0.4 dB is for sensors of 10 mg.
"""

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.evaluation import evaluate
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import ClosedLoop, simulate, simulate_open_loop


def true_rms(frequency, serve):
    settings = [f'disturbance.frequency={frequency}', f'controller.narrowband_serve={serve}']
    run = simulate(load_scenario('paper_3dof_narrowband', settings))
    return evaluate(run, simulate_open_loop(run)).attenuation_open_loop['true_rms']


@pytest.mark.parametrize(('frequency', 'best'), [(10.0, -5.84), (6.5, -3.76)])
def test_the_payload_is_served(frequency, best):
    payload = true_rms(frequency, 'payload')
    assert np.all(payload < best + 0.4)
    assert np.all(true_rms(frequency, 'samples') > payload + 1.5)


def test_a_rig_of_identified_models_has_no_payload(tmp_path):
    rig = tmp_path / 'rig.yaml'
    rig.write_text(
        'plant: iir\nacquisition: {sample_rate: 100.0}\n'
        'models:\n  - {delay: 1, a: [-0.46, 0.158], b: [0.061, -0.103, 0.033]}\n'
    )
    with pytest.raises(SatvibError, match='narrowband_serve'):
        load_scenario(
            'paper_3dof_narrowband', [f'rig={rig}', 'controller.narrowband_serve=payload']
        )


def test_a_batch_of_different_rigs_is_refused():
    """Truth: a trial has the bits of its single run; the weights are those of its own rig."""
    settings = ['controller.narrowband_serve=payload']
    rigs = [f'rig.payload.mass={mass}' for mass in (9.0, 10.0)]
    scenarios = [load_scenario('paper_3dof_narrowband', [*settings, rig]) for rig in rigs]
    with pytest.raises(SatvibError, match='narrowband_serve'):
        ClosedLoop(scenarios)
