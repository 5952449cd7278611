# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of a search: how the cost fell, and what the gains make of the transmission from source to payload."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.levels import decibel
from satvib_common.signals.integrator import leaky_integrator
from satvib_plant_sim.responses.all_struts import rig_response
from satvib_plant_sim.rig.payload_shapes import payload_modes
from satvib_plant_sim.rig.rig import Rig

from satvib_studies.tuning.search import Tuned


def modal_law(rig: Rig, gains: Array, corner: float, frequency: Array) -> Complex:
    """Give C (f, n, n) of the modal law, u = -C y, at (f,) Hz.

    Args:
        rig: the rig.
        gains: (3, modes) P, I, D.
        corner: Hz, of the integrators.
        frequency: Hz.
    """
    modes = payload_modes(rig)
    T, mode = modes.strut, modes.mode
    b, a = leaky_integrator(corner, rig.acquisition.period)
    z = np.exp(-2j * math.pi * frequency * rig.acquisition.period)
    H = (np.polyval(b[::-1], z) / np.polyval(a[::-1], z))[:, None]
    found: Complex = T @ ((gains[2] + gains[0] * H + gains[1] * H * H)[:, :, None] * mode)
    return found


def transmission(rig: Rig, law: Complex, frequency: Array) -> Array:
    """Give |a/a_d| (f, modes) from the source along z to the payload's modes at (f,) Hz.

    Args:
        rig: the rig.
        law: (f, n, n) C, u = -C y.
        frequency: Hz.
    """
    n, mode = rig.struts.count, payload_modes(rig).mode
    along = 2 if rig.struts.each else 0
    r = rig_response(rig, frequency)
    S = np.linalg.inv(np.eye(n) + r.read_voltage @ law)
    read, true = (source[:, :, along : along + 1] for source in (r.read_source, r.true_source))
    u = -law @ S @ read
    found: Array = np.abs(mode @ (true + r.true_voltage @ u))[:, :, 0]
    return found


def closed_transmission(rig: Rig, gains: Array, corner: float, frequency: Array) -> Array:
    """Give |a/a_d| (f, modes) under the modal law; the arguments are those of `modal_law`."""
    return transmission(rig, modal_law(rig, gains, corner, frequency), frequency)


def draw(found: Tuned, path: Path) -> None:
    """Draw the figure of the centralized law's gains."""
    corner, frequency = found.settings.cost.corner, frequencies(found.rig)
    laws = {
        label: modal_law(found.rig, gains.reshape(3, -1), corner, frequency)
        for label, gains in (
            ('0 V', np.zeros_like(found.untuned)),
            ('untuned', found.untuned),
            ('tuned', found.result.position),
        )
    }
    start = float(found.cost(found.untuned[None])[0])
    draw_search(path, found.cost.plants, found.result.history, start, frequency, laws)


def frequencies(rig: Rig) -> Array:
    """Give the frequencies at which a figure shows a rig, Hz."""
    return np.asarray(np.geomspace(0.5, 0.475 * rig.acquisition.sample_rate, 400))


def draw_search(
    path: Path, plants: Sequence[Rig], history: Array, start: float, frequency: Array, laws: dict[str, Complex]
) -> None:  # fmt: skip
    """Draw how the cost fell from `start`, and what each law C (f, n, n) makes of the transmission of each plant."""
    from satvib_experiment.report.style import OPEN, STRUTS, figure

    names = payload_modes(plants[0]).names
    heave = names.index('z') if 'z' in names else 0
    with figure(path, 1, 2, size=(10.0, 3.8)) as (_, axes):
        left, right = axes[0]
        left.step(history[:, 0], history[:, 1], where='post', color=STRUTS[0])
        left.axhline(start, color=STRUTS[1], lw=1.0, ls='--', label='untuned')
        left.set_yscale('log')
        left.set_xlabel('evaluations')
        left.set_title('best cost')
        left.legend()
        for (label, law), color in zip(laws.items(), (OPEN, STRUTS[1], STRUTS[0]), strict=True):
            for i, plant in enumerate(plants):
                w = transmission(plant, law, frequency)[:, heave]
                right.plot(
                    frequency, decibel(w), color=color, lw=1.5 if i == 0 else 0.5,
                    alpha=1.0 if i == 0 else 0.5, label=label if i == 0 else None,
                )  # fmt: skip
        right.set_xscale('log')
        right.set_xlabel('frequency in Hz')
        right.set_title(f'source to payload ({names[heave]}), dB; thin: the perturbed plants')
        right.legend()
