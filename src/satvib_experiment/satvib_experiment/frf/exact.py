# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What measured responses are compared with: the rig's exact response, with the law's feedback where it is linear."""

from collections.abc import Iterable

import numpy as np
from satvib_common.arrays import Array, Complex
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_common.signals.integrator import leaky_integrator
from satvib_control.laws.base import BasicLaw
from satvib_control.laws.model_reference.law import ModelReference
from satvib_control.laws.registry import make_law
from satvib_ident.models.iir_model import IirModel
from satvib_plant_sim.disturbance.base import UPWARD
from satvib_plant_sim.responses.all_struts import sampled_rig
from satvib_plant_sim.responses.transmission import plate_responses
from satvib_plant_sim.rig.rig import Rig

from satvib_experiment.analysis.windows import Span
from satvib_experiment.frf.how import base_directions
from satvib_experiment.recording.recording import Recording

_DIGITS = 9  # of a direction, by which two are one


def identified_model(recording: Recording) -> IirModel | None:
    """Give the last model of every strut, (struts,); None where one has none."""
    if not recording.has('model', 'a'):
        return None
    row = _last_models(recording)
    if row is None:
        return None
    struts = np.arange(len(recording.struts))
    a, b = (recording.get('model', name)[row, struts] for name in ('a', 'b'))
    if not (np.isfinite(a).all() and np.isfinite(b).all()):
        return None
    delay = int(np.max(recording.get('model', 'delay'))) if recording.has('model', 'delay') else 1
    return IirModel(a, b, delay, recording.sample_period)


def _last_models(recording: Recording) -> Array | None:
    """Rows (struts,) of the last models."""
    present = recording.get('model', 'present')
    if not present.any(axis=0).all():
        return None
    return np.asarray(len(present) - 1 - np.argmax(present[::-1], axis=0))


def law_feedback(recording: Recording, frequency: Array) -> Complex | None:
    """Give C (f, n, n) in V per m/s^2 of a run's law, u = -C y; None for a law that is not linear or not known.

    Args:
        recording: a run with its scenario.
        frequency: (f,) Hz.
    """
    scenario, struts = recording.scenario, len(recording.struts)
    if scenario is None:
        return None
    rate = 1.0 / recording.sample_period
    try:
        p = scenario.controller_parameters(rate, struts=struts)
        law = make_law(p.law, p, recording.sample_period, (struts,))
    except SatvibError:  # a law of one's own that is not here
        return None
    omega = 2.0 * np.pi * np.asarray(frequency) * recording.sample_period
    if hasattr(law, 'response_matrix'):
        return np.asarray(law.response_matrix(omega))
    if isinstance(law, ModelReference):
        own = _pid(recording, omega, p.velocity_corner)
        return None if own is None else np.asarray(own[:, :, None] * np.eye(struts))
    if not (isinstance(law, BasicLaw) and law.fixed_filter and recording.has('model', 'a')):
        return None
    _give_model(law, recording)
    own = law.response(np.broadcast_to(omega, (struts, omega.size)))
    return np.asarray(np.moveaxis(own, -1, 0)[:, :, None] * np.eye(struts))


def _pid(recording: Recording, omega: Array, corner: float) -> Complex | None:
    """Give C (f, n) of adaptive PID with the gains at the end of a run; None where they still move in CONTROL."""
    control = recording.phase == Phase.CONTROL
    if not control.any() or not recording.has('state', 'kp'):
        return None
    gains = np.stack([recording.get('state', name)[control] for name in ('kp', 'ki', 'kd')])
    if not np.isfinite(gains).all() or not (gains == gains[:, -1:]).all():
        return None
    kp, ki, kd = gains[:, -1]
    dt = recording.sample_period
    turn = np.exp(-1j * omega)
    b, a = leaky_integrator(corner, dt)
    velocity = np.polyval(b[::-1], turn) / np.polyval(a[::-1], turn)
    change = (1.0 - turn) / dt
    return np.asarray(kp + velocity[:, None] * ki + change[:, None] * kd)


def _give_model(law: BasicLaw, recording: Recording) -> None:
    """Give a law the last models of a run, where they were trusted."""
    model, row = identified_model(recording), None
    if model is None:
        return
    row, struts = _last_models(recording), np.arange(len(recording.struts))
    trusted = recording.get('model', 'converged')[row, struts]
    count = model.a.shape[-1] + model.b.shape[-1]
    covariance = recording.get('model', 'covariance')[row, struts].reshape(-1, count, count)
    law.set_model(model, np.asarray(trusted, dtype=bool), covariance)


def base_direction(
    recording: Recording, spans: Iterable[Span]
) -> tuple[tuple[float, ...] | None, str]:
    """Give the direction in which the base of a run moved in some spans of s, as `exact_plates` takes it.

    Returns:
        The direction and an empty text, or None and why it is not known, for people. Struts on a circle have one
        direction, whatever moved the base.
    """
    rig, scenario = recording.rig, recording.scenario
    if not (isinstance(rig, Rig) and rig.struts.each):
        return UPWARD, ''
    if scenario is None or not scenario.disturbance:
        return None, 'it is not known in which direction the base moved'
    disturbance = scenario.make_disturbance()
    each = [d for span in spans for d in base_directions(disturbance, *span)]
    found = {tuple(round(v, _DIGITS) for v in d): d for d in each}
    if len(found) == 1:
        return each[0], ''
    return None, (
        f'the base moved in {len(found)} directions'
        if found
        else 'what shook the rig did not move its base'
    )


def exact_plates(
    recording: Recording,
    frequency: Array,
    closed: bool,
    direction: tuple[float, ...] = UPWARD,
) -> tuple[Complex, Complex] | None:
    """Give the accelerations of upper and lower plate (f, n) per m/s^2 of the source; None where they are not known.

    Args:
        recording: a run whose rig is known.
        frequency: (f,) Hz.
        closed: with the law's feedback.
        direction: of listed struts: in which the source moves the base, see `plate_responses`.
    """
    rig = recording.rig
    if not isinstance(rig, Rig):
        return None
    feedback = law_feedback(recording, frequency) if closed else None
    if closed and feedback is None:
        return None
    return plate_responses(rig, frequency, feedback, direction=direction)


def exact_paths(recording: Recording, frequency: Array) -> Complex | None:
    """Give the readings per voltage (f, n, n), m/s^2 per V; None where the rig is not known."""
    rig = recording.rig
    return sampled_rig(rig).response(frequency) if isinstance(rig, Rig) else None
