# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Experiments that measure frequency responses: made from a scenario, run by the twin or as a live graph.

The base run keeps what a scenario does until its law acts (CALIBRATE, IDENTIFY, ADAPT), at rest. Then the base moves:
in STANDBY with 0 V, which is the open loop, and in CONTROL, which is the closed loop. The coil run excites one coil
after the other in IDENTIFY, while nothing else moves. Both are ordinary scenarios.
"""

import math
from dataclasses import dataclass
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.schema import Schema, param
from satvib_plant_sim.rig.any_rig import AnyRig, strut_count
from satvib_plant_sim.rig.rig import Rig

from satvib_experiment.scenario.scenario import AnalysisSettings, PhaseStep, Scenario

SIGNALS = ('multisine', 'random', 'swept', 'stepped')
_KEPT = ('CALIBRATE', 'IDENTIFY', 'ADAPT')
# a measurement hears at least so much of the base for each unit of its sensors' noise
_ABOVE_NOISE = 10.0
_LEVEL = 1.0  # m/s^2
_HIGHEST = 100.0  # Hz, where nothing else is asked for
# the law is measured as it is: the vibration watch would take it off where the closed loop is louder than the open one
_NEVER = 1000.0  # dB
_OF_RATE = 0.4  # of the sample rate
_COIL_AT_REST = 1.0  # s of CALIBRATE


@dataclass(frozen=True, kw_only=True)
class MeasurementSettings(Schema):
    """What moves, how, and for how long."""

    signal: str = param('multisine', 'what moves the base or drives a coil', choices=SIGNALS)
    low: float = param(1.0, 'lower edge of the band', unit='Hz', above=0.0)
    high: float | None = param(
        None, f'upper edge; none: {_OF_RATE:g} of the sample rate, at most {_HIGHEST:g} Hz',
        unit='Hz', above=0.0,
    )  # fmt: skip
    duration: float = param(60.0, 'of each stretch that is measured', unit='s', above=0.0)
    settle: float = param(10.0, 'before each stretch, not measured', unit='s', minimum=0.0)
    period: float = param(10.0, 'multisine: time after which it repeats', unit='s', above=0.0)
    steps: int = param(30, 'stepped: frequencies', minimum=2)
    level: float | None = param(
        None, f'of the base, RMS; none: {_LEVEL:g}, or {_ABOVE_NOISE:g} times the noise of the '
        'sensors', unit='m/s^2', above=0.0,
    )  # fmt: skip
    coil_level: float | None = param(
        None, 'of a coil, peak; none: as the scenario excites it', unit='V', above=0.0
    )

    direction: tuple[float, ...] = param(
        (), 'of the base: factors along x, y, z, or along and about them; none: along z'
    )

    def check(self) -> None:
        """Refuse an empty band, and too few periods."""
        if self.high is not None and self.high <= self.low:
            raise SatvibError(f'high: {self.high} Hz is not above low, {self.low} Hz')
        if self.signal == 'multisine' and self.duration < 3.0 * self.period:
            raise SatvibError(
                f'duration: {self.duration:g} s hold fewer than three periods of {self.period:g} s'
            )

    def edge(self, rig: AnyRig) -> float:
        """Give the upper edge of the band for a rig, Hz.

        Raises:
            SatvibError: the rig's sample rate does not carry the band.
        """
        rate = rig.acquisition.sample_rate
        high = min(_OF_RATE * rate, _HIGHEST) if self.high is None else self.high
        if not self.low < high < 0.5 * rate:
            raise SatvibError(
                f'high: {high:g} Hz is not between low, {self.low:g} Hz, and half the sample rate, {0.5 * rate:g} Hz'
            )
        return high


def base_scenario(
    scenario: Scenario,
    settings: MeasurementSettings,
    law: str = '',
    loops: tuple[str, ...] = ('open', 'closed'),
) -> Scenario:
    """Give the experiment that moves the base, open and closed loop.

    Args:
        scenario: whose rig, identification and law are measured.
        settings: see `MeasurementSettings`.
        law: in the place of the scenario's.
        loops: the stretches that are measured: 'open', 'closed' or both. One alone begins when the base does.

    Raises:
        SatvibError: a band that rig and signal do not have.
    """
    s, rig = settings, scenario.load_rig()
    phases, now = _before_control(scenario)
    steps, end = [*phases], now
    spans: dict[str, Any] = {}
    for loop, phase, window in (
        ('open', 'STANDBY', 'uncontrolled'),
        ('closed', 'CONTROL', 'controlled'),
    ):
        if loop in loops:
            steps.append(PhaseStep(phase=phase, start=end))
            spans[window] = (end + s.settle, end + s.settle + s.duration)
            end = spans[window][1]
    changes: dict[str, Any] = {'watch_loudness': _NEVER} | ({'law': law} if law else {})
    return scenario.replace(
        name=f'{scenario.name}_measure',
        description=f'Frequency responses of {scenario.name}: {s.signal} on the base, {" and ".join(loops)} loop.',
        duration=end,
        phases=tuple(steps),
        disturbance=_base_signal(s, rig, now, tuple(span[0] for span in spans.values())),
        failures=(),
        controller=scenario.controller | changes,
        analysis=AnalysisSettings(**spans),
    )


def _before_control(scenario: Scenario) -> tuple[list[PhaseStep], float]:
    """Give the phases in which models and gains are found, one after the other, and when they end, s."""
    steps = [*scenario.phases]
    ends = [*(step.start for step in steps[1:]), scenario.duration]
    kept: list[PhaseStep] = []
    now = 0.0
    for step, end in zip(steps, ends, strict=True):
        if step.phase == 'CONTROL':
            break
        if step.phase in _KEPT:
            kept.append(PhaseStep(phase=step.phase, start=now))
            now = round(now + end - step.start, 9)
    if not kept:
        kept, now = [PhaseStep(phase='CALIBRATE', start=0.0)], _COIL_AT_REST
    return kept, now


def _base_signal(
    s: MeasurementSettings, rig: AnyRig, start: float, measured: tuple[float, ...]
) -> dict[str, Any]:
    """Give the disturbance; a sweep and a stepped sine begin again with each stretch that is measured."""
    high = s.edge(rig)
    level = s.level or max(_LEVEL, _ABOVE_NOISE * _noise(rig))
    given = {'direction': list(s.direction)} if s.direction else {}
    if s.signal == 'multisine':
        band = {'rms': level, 'low': s.low, 'high': high, 'period': s.period}
        return {'kind': 'multisine', 'start': start, **band, **given}
    if s.signal == 'random':
        band = {'rms': level, 'low': s.low, 'high': high}
        return {'kind': 'random', 'start': start, **band, **given}
    ends = {
        **given,
        'amplitude': math.sqrt(2.0) * level,
        'frequency': s.low,
        'end_frequency': high,
    }
    own = (
        {'kind': 'sweep', 'duration': s.duration, 'shape': 'log', **ends}
        if s.signal == 'swept'
        else {'kind': 'stepped_sine', 'steps': s.steps, 'dwell': s.duration / s.steps, **ends}
    )
    terms = [own | {'start': t, 'stop': t + s.duration} for t in measured]
    return {'kind': 'sum', 'terms': terms}


def _noise(rig: AnyRig) -> float:
    return rig.accelerometer.noise_rms if isinstance(rig, Rig) else rig.noise_rms


def coil_scenario(scenario: Scenario, settings: MeasurementSettings) -> Scenario:
    """Give the experiment that drives one coil after the other, with nothing else moving.

    Raises:
        SatvibError: a band that rig and signal do not have.
    """
    s, rig = settings, scenario.load_rig()
    own = scenario.controller
    turn = s.settle + s.duration
    names = {'multisine': 'multisine', 'random': 'random', 'swept': 'chirp'}
    if s.signal not in names:
        raise SatvibError(
            f'signal: {s.signal} moves the base; a coil is driven by {", ".join(names)} '
            '(--excite base leaves the coils out)'
        )
    options = [f'turn={turn:g}', f'low={s.low:g}', f'high={s.edge(rig):g}']
    if s.signal == 'multisine':
        options += [f'period={s.period:g}', 'interleave=false']
    if s.signal == 'swept':
        options += [f'period={turn:g}']
    kept = {k: own[k] for k in ('voltage_limit', 'slew_limit', 'bias_limit') if k in own}
    end = _COIL_AT_REST + strut_count(rig) * turn
    level = {'excitation_amplitude': s.coil_level} if s.coil_level else {}
    level = level or {k: own[k] for k in ('excitation_amplitude',) if k in own}
    return scenario.replace(
        name=f'{scenario.name}_coils',
        description=f'Frequency responses of {scenario.name}: {s.signal} on one coil after the other.',
        duration=end,
        phases=(
            PhaseStep(phase='CALIBRATE', start=0.0),
            PhaseStep(phase='IDENTIFY', start=_COIL_AT_REST),
        ),
        disturbance={},
        failures=(),
        scheme='decentralized',
        centralized={},
        supervisor=False,
        controller=kept
        | level
        | {'law': 'off', 'excitation': names[s.signal], 'excitation_options': options},
        analysis=AnalysisSettings(),
    )
