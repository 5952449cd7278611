# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The hexapod: its modes against the closed form, a wheel run-up in arc seconds, and the figure of its page.

./satvib shell -c 'python benchmarks/hexapod.py --figure FILE.png'
"""

import argparse
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from satvib_common.arrays import Array
from satvib_experiment.report.style import OPEN, STRUTS, figure
from satvib_experiment.scenario.scenario import load_scenario
from satvib_experiment.twin.closed_loop import simulate
from satvib_plant_sim.physics.mechanics import mechanics
from satvib_plant_sim.physics.modes import modal_frequencies
from satvib_plant_sim.rig.rig import Rig, load_rig

ARC_SECOND = np.pi / 180.0 / 3600.0
RUNS = {'0 V': ('controller.law=off', OPEN), 'velocity_feedback': ('', STRUTS[0])}


def closed_form(rig: Rig, edge: float = 0.25) -> Array:
    """Modes of a cubic platform with equal struts, Hz (Geng and Haynes 1994)."""
    stiffness = np.array([2.0, 2.0, 2.0, edge**2 / 2, edge**2 / 2, 2 * edge**2])
    inertia = np.array([*[rig.payload.mass] * 3, *(rig.payload.inertia_tensor or ())[:3]])
    found: Array = np.sqrt(rig.struts.stiffness * stiffness / inertia) / (2 * np.pi)
    return found


def tilt(rig: Rig, stroke: Array) -> Array:
    """Tilts rx, ry of the payload (samples, 2), rad, from strokes (samples, 6), m; the lower plate is at rest."""
    motion: Array = stroke @ np.linalg.pinv(mechanics(rig).S).T
    return motion[:, 3:5]


def draw_geometry(ax: Axes, rig: Rig) -> None:
    """Draw the struts as they are seen from the side and a little from above."""
    view = np.array([[0.94, -0.34, 0.0], [0.10, 0.28, 0.95]])
    feet = np.array([strut.foot for strut in rig.struts.each])
    heads = np.array([strut.head for strut in rig.struts.each])
    for ends, color, label in ((feet, '#999999', 'lower plate'), (heads, '#222222', 'payload')):
        corners = np.unique(ends.round(9), axis=0)
        order = np.argsort(np.arctan2(corners[:, 1], corners[:, 0]))
        loop = corners[[*order, order[0]]] @ view.T
        ax.fill(loop[:, 0], loop[:, 1], color=color, alpha=0.15)
        ax.plot(loop[:, 0], loop[:, 1], color=color, label=label)
    for i, (foot, head) in enumerate(zip(feet, heads, strict=True)):
        line = np.array([foot, head]) @ view.T
        ax.plot(line[:, 0], line[:, 1], color=STRUTS[i], lw=3.0, solid_capstyle='round')
        middle = line.mean(axis=0)
        ax.annotate(str(i + 1), middle, fontsize=9, ha='center', va='center',
                    bbox={'boxstyle': 'circle,pad=0.2', 'fc': 'white', 'ec': STRUTS[i]})  # fmt: skip
    ax.set_aspect('equal')
    ax.set_axis_off()
    ax.legend(loc='upper right')
    ax.set_title('hexapod_6dof')


def main() -> None:
    """Print the figures, and draw."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--figure', type=Path, help='file of the figure; none is drawn without it')
    options = parser.parse_args()
    rig = load_rig('hexapod_6dof')
    alike = load_rig('hexapod_6dof', {'struts.stiffness_scale': [1.0] * 6})
    print('closed form, equal struts, Hz ', np.sort(closed_form(alike)).round(4))
    print('equal struts, Hz              ', modal_frequencies(alike).round(4))
    print('as it is, Hz                  ', modal_frequencies(rig).round(4))
    runs = {}
    for name, (change, _) in RUNS.items():
        run = simulate(load_scenario('hexapod_6dof_wheel', [change] if change else []))
        runs[name] = run
        angle = np.hypot(*tilt(rig, run.get('truth', 'stroke')).T)
        window = run.window(28.0, 38.0)
        rms = float(np.sqrt(np.mean(angle[window] ** 2))) / ARC_SECOND
        print(
            f'{name:20s} line of sight, second run-up: {rms:.2f} arc seconds RMS, largest '
            f'{angle[window].max() / ARC_SECOND:.2f}; {1e6 * rms * ARC_SECOND:.1f} microradians RMS'
        )
    if options.figure is None:
        return
    with figure(options.figure, 1, 2, size=(10.0, 3.8)) as (_, axes):
        left, right = axes[0]
        draw_geometry(left, rig)
        for name, run in runs.items():
            angle = tilt(rig, run.get('truth', 'stroke')) / ARC_SECOND
            right.plot(run.time, np.hypot(*angle.T), color=RUNS[name][1], lw=0.8, label=name)
        # before that the coils excite the struts for identification
        right.set_xlim(14.0, 40.0)
        right.set_ylim(0.0, 200.0)
        right.axvspan(14.0, 24.0, color='#F2F2F2', zorder=0)
        right.set_xlabel('time in s')
        right.set_title('line of sight while a wheel runs up twice, arc seconds')
        right.legend()


if __name__ == '__main__':
    main()
