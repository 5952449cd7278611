# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Figures of frequency responses: what can be read from their axes.

Truth: the curves that are drawn.
"""

from contextlib import contextmanager
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from satvib_experiment.frf import figures
from satvib_experiment.frf.curve import OPEN, PATH, TRANSMISSIBILITY, Curve
from satvib_ident.frequency.response import FrequencyResponse

F = np.geomspace(1.0, 80.0, 60)


@pytest.fixture
def drawn(monkeypatch):
    """The figures that were drawn, by name: title and axes."""
    found, real = {}, figures.figure

    @contextmanager
    def watched(path, *sizes, **options):
        with real(path, *sizes, **options) as (canvas, axes):
            yield canvas, axes
        found[path.stem] = canvas.get_suptitle(), axes

    monkeypatch.setattr(figures, 'figure', watched)
    return found


def curve(output, size, quantity=TRANSMISSIBILITY, source='base', loop=OPEN):
    """A curve of a level of its own, 1 % beside what is exact, that falls by 70 dB."""
    exact = size * (F / F[0]) ** -1.84 * np.exp(-0.03j * F)
    measured = FrequencyResponse(
        F, 1.01 * exact, np.linspace(1.0, 0.93, F.size), np.full(F.size, 1e-5), 16, 0.95, 'H1'
    )
    return Curve(quantity, loop, output, source, measured, exact, 1.1 * exact)


def test_panels_side_by_side_have_one_axis_and_nothing_is_cut(drawn, tmp_path):
    """Four outputs, so that there are two rows of panels."""
    curves = [curve(f'strut_{i}', 2.0**i) for i in range(4)]
    figures.draw_figures(curves, tmp_path, 'soft · seed 3')
    title, axes = drawn['transmissibility']
    assert title == 'soft · seed 3'
    shown = [axes[0, 0], axes[0, 1], axes[0, 2], axes[3, 0]]
    limits = {ax.get_ylim() for ax in shown}
    assert len(limits) == 1
    ((low, high),) = limits
    levels = np.concatenate([c.measured.decibels for c in curves])
    assert low < levels.min()
    assert high > levels.max()
    assert not axes[3, 1].get_visible()


def test_lines_that_lie_on_each_other_are_told_apart(drawn, tmp_path):
    """What is compared is thinner than what is measured, and drawn later; the exact one is dashed."""
    figures.draw_figures([curve('strut_1', 1.0, PATH, 'strut_1')], tmp_path)
    _, axes = drawn['paths']
    for ax in axes[:2, 0]:
        wide, model, exact = ax.get_lines()[:3]
        assert wide.get_linewidth() > model.get_linewidth() > exact.get_linewidth()
        assert wide.get_zorder() <= model.get_zorder() < exact.get_zorder()
        assert exact.is_dashed()
        assert not model.is_dashed()


def test_the_axis_of_the_coherence_shows_the_last_thousandth(drawn, tmp_path):
    """0.9, 0.99 and 0.999 stand at even distances; a coherence of 1 is inside, one that is not known is a gap."""
    known = curve('strut_1', 1.0)
    coherence = known.measured.coherence.copy()
    coherence[3] = np.nan
    figures.draw_figures(
        [replace(known, measured=replace(known.measured, coherence=coherence))], tmp_path
    )
    _, axes = drawn['transmissibility']
    ax = axes[2, 0]
    places = ax.transData.transform([(10.0, c) for c in (0.0, 0.9, 0.99, 0.999)])[:, 1]
    assert_allclose(np.diff(places), places[1] - places[0], rtol=1e-6)
    line = ax.get_lines()[0].get_ydata()
    assert ax.get_ylim()[0] <= np.nanmin(line)
    assert np.nanmax(line) <= ax.get_ylim()[1]
    assert np.flatnonzero(np.isnan(line)).tolist() == [3]


def test_what_is_noise_is_not_drawn(drawn, tmp_path):
    """A coherence below 0.5 leaves a gap in magnitude and phase, and its level does not set the axis."""
    known = curve('strut_1', 1.0)
    coherence, value = known.measured.coherence.copy(), known.measured.value.copy()
    coherence[20:30] = 0.4
    value[25] *= 1e-4
    noisy = replace(known.measured, coherence=coherence, value=value)
    figures.draw_figures([replace(known, measured=noisy)], tmp_path)
    _, axes = drawn['transmissibility']
    for ax in axes[:2, 0]:
        line = ax.get_lines()[0].get_ydata()
        assert np.flatnonzero(np.isnan(line)).tolist() == [*range(20, 30)]
    assert axes[0, 0].get_ylim()[0] > -75.0
