# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of a search: how the cost fell, and what the gains make of the transmission from source to payload."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
from satvib_common.arrays import Array
from satvib_common.levels import decibel
from satvib_common.signals.integrator import leaky_integrator
from satvib_plant_sim.responses.all_struts import rig_response
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.tuning.search import Tuned


def closed_transmission(rig: Rig, gains: Array, corner: float, frequency: Array) -> Array:
    """Give |a/a_d| (f, modes) from the source along z to the payload's modes under the modal law, at (f,) Hz.

    Args:
        rig: the rig.
        gains: (3, modes) P, I, D.
        corner: Hz, of the integrators.
        frequency: Hz.
    """
    n, modes = rig.struts.count, payload_modes(rig)
    T, mode = modes.strut, modes.mode
    along = 2 if rig.struts.each else 0
    r = rig_response(rig, frequency)
    b, a = leaky_integrator(corner, rig.acquisition.period)
    z = np.exp(-2j * math.pi * frequency * rig.acquisition.period)
    H = (np.polyval(b[::-1], z) / np.polyval(a[::-1], z))[:, None]
    C = T @ ((gains[2] + gains[0] * H + gains[1] * H * H)[:, :, None] * mode)
    S = np.linalg.inv(np.eye(n) + r.read_voltage @ C)
    read, true = (source[:, :, along : along + 1] for source in (r.read_source, r.true_source))
    u = -C @ S @ read
    found: Array = np.abs(mode @ (true + r.true_voltage @ u))[:, :, 0]
    return found


def draw(found: Tuned, path: Path) -> None:
    """Draw the figure."""
    from satvib_experiment.report.style import OPEN, STRUTS, figure

    rig, history = found.rig, found.result.history
    half = 0.5 * rig.acquisition.sample_rate
    frequency = np.geomspace(0.5, 0.95 * half, 400)
    names = payload_modes(rig).names
    heave = names.index('z') if 'z' in names else 0
    cases = (
        ('0 V', np.zeros_like(found.untuned), OPEN),
        ('untuned', found.untuned, STRUTS[1]),
        ('tuned', found.result.position, STRUTS[0]),
    )
    with figure(path, 1, 2, size=(10.0, 3.8)) as (_, axes):
        left, right = axes[0]
        left.step(history[:, 0], history[:, 1], where='post', color=STRUTS[0])
        start = float(found.cost(found.untuned[None])[0])
        left.axhline(start, color=STRUTS[1], lw=1.0, ls='--', label='untuned')
        left.set_yscale('log')
        left.set_xlabel('evaluations')
        left.set_title('best cost')
        left.legend()
        for label, gains, color in cases:
            for i, plant in enumerate(found.cost.plants):
                w = closed_transmission(
                    plant, gains.reshape(3, -1), found.settings.cost.corner, frequency
                )[:, heave]
                right.plot(
                    frequency, decibel(w), color=color, lw=1.5 if i == 0 else 0.5,
                    alpha=1.0 if i == 0 else 0.5, label=label if i == 0 else None,
                )  # fmt: skip
        right.set_xscale('log')
        right.set_xlabel('frequency in Hz')
        right.set_title(f'source to payload ({names[heave]}), dB; thin: the perturbed plants')
        right.legend()
