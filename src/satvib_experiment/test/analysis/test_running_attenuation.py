# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Attenuation while a run goes on: one figure for the live graph and for the twin."""

import numpy as np
from satvib_common.phases import Phase
from satvib_experiment.analysis.running_attenuation import RunningAttenuation
from satvib_experiment.analysis.twin_progress import TwinProgress
from satvib_experiment.twin.closed_loop import ClosedLoop


def test_the_reference_is_the_last_standby_with_the_disturbance():
    """Truth: 20 log10 of levels chosen by hand; 1e-12 dB for rounding."""
    running = RunningAttenuation(onset=1.0, sample_period=0.01, struts=2)
    running.add(50, Phase.STANDBY, np.array([9.0, 9.0]))  # before the disturbance
    running.add(99, Phase.CONTROL, np.array([1.0, 1.0]))
    assert np.isnan(running.decibels).all()
    running.add(100, Phase.STANDBY, np.array([2.0, 4.0]))
    running.add(101, Phase.STANDBY, np.array([1.0, 2.0]))
    assert np.isnan(running.decibels).all()
    running.add(102, Phase.ADAPT, np.array([0.1, 0.1]))
    assert np.isnan(running.decibels).all()
    running.add(103, Phase.CONTROL, np.array([0.1, 4.0]))
    np.testing.assert_allclose(running.decibels, [-20.0, 20.0 * np.log10(2.0)], atol=1e-12)


def test_struts_that_are_seen_at_different_samples_have_their_own_figures():
    """Truth: the same samples taken for all struts at once; no tolerance."""
    together = RunningAttenuation(0.0, 0.01, 2)
    apart = RunningAttenuation(0.0, 0.01, 2)
    for k, (phase, level) in enumerate(
        [(Phase.STANDBY, [1.0, 3.0]), (Phase.CONTROL, [0.5, 0.3]), (Phase.CONTROL, [0.4, 0.2])]
    ):
        together.add(k, phase, np.array(level))
        apart.add(k, phase, level[0], 0)
    assert np.isnan(apart.decibels[1])
    apart.add(0, Phase.STANDBY, 3.0, 1)
    apart.add(2, Phase.CONTROL, 0.2, 1)
    np.testing.assert_array_equal(apart.decibels, together.decibels)


def test_the_twin_shows_the_figure_of_its_recording(quick, quick_run):
    """Truth: the recorded running RMS of the scenario, by the definition; no tolerance."""
    shown = []
    follow = TwinProgress(quick, lambda *figure: shown.append(figure))
    for step in ClosedLoop(quick).steps():
        follow(step)
    level, phase = quick_run.get('state', 'upper_rms'), quick_run.phase
    onset = quick.disturbance['start']
    standby = np.flatnonzero((phase == Phase.STANDBY) & (quick_run.time >= onset))
    controlled = [(now, decibels) for seen, now, decibels in shown if seen is Phase.CONTROL]
    assert controlled
    for now, decibels in controlled:
        k = round(now / quick_run.sample_period)
        reference = level[standby[standby < k][-1]]
        np.testing.assert_array_equal(decibels, 20.0 * np.log10(level[k] / reference))
