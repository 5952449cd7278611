# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The experiment that measures frequency responses, through the live graph."""

import numpy as np
from satvib_experiment.recording.recording import differences

SHORT = (
    'duration=27.0', 'controller.excitation_options=[turn=5, low=2, high=80, period=1, interleave=false]',
    'phases.2.start=16.0', 'phases.3.start=21.0', 'disturbance.start=16.0', 'disturbance.period=1.0',
    'disturbance.low=2.0', 'analysis.uncontrolled=[18.0, 21.0]', 'analysis.controlled=[23.0, 27.0]',
)  # fmt: skip


def test_a_live_measurement_is_that_of_the_twin(tmp_path, domain):  # noqa: ARG001
    """Lockstep, one process. Truth: the offline twin, bit for bit; the responses of the bag are those of the twin.

    And the exact response of the rig: 0.3 dB at coherence above 0.99, with one second of settling of a mode that is
    5 % damped.
    """
    from satvib_bringup.live.run import run_experiment
    from satvib_experiment.frf.measure import measure_recording
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.scenario.scenario import load_scenario
    from satvib_experiment.twin.closed_loop import simulate
    from satvib_ident.frequency import FrfSettings

    scenario = load_scenario('soft_3dof_measure', list(SHORT))
    outcome = run_experiment(scenario, tmp_path / 'run', composition='single')
    assert outcome.success, outcome.message
    live, twin = read_recording(outcome.bag), simulate(scenario)
    assert differences(live, twin) == []
    both = [measure_recording(run, FrfSettings()) for run in (live, twin)]
    names = [(c.quantity, c.loop, c.output, c.input) for c in both[0].curves]
    assert len(names) == 2 * 6 + 9
    assert names == [(c.quantity, c.loop, c.output, c.input) for c in both[1].curves]
    for one, other in zip(*(m.curves for m in both), strict=True):
        assert np.array_equal(one.measured.value, other.measured.value)
        assert np.array_equal(one.measured.radius, other.measured.radius)
        deviation = one.deviation()
        if deviation is not None and one.output.startswith('strut'):
            assert deviation[0] < 0.3, (one.loop, one.output, one.input)
