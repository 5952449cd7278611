# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The runs of a judgement: for each law on each rig one batch of the offline twin for the base, one for the wheel."""

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from satvib_common.arrays import Array
from satvib_common.phases import Phase
from satvib_common.process.parallel import cores, run_in_processes
from satvib_experiment.analysis.line_of_sight import ARC_SECONDS, line_of_sight
from satvib_experiment.frf.curve import Curve
from satvib_experiment.frf.transmission import transmissibilities
from satvib_experiment.recording.recording import Recording
from satvib_experiment.twin.closed_loop import simulate_batch

from satvib_studies.isolation.cases import OPEN, Isolation

_KEPT = ('acceleration', 'voltage.voltage', 'state.reason', 'truth.stroke')


@dataclass(frozen=True)
class LawFound:
    """What became of a law on a rig.

    Attributes:
        rig, law: names; `law` may be 'open'.
        curves: seed by seed: the transmissibilities of struts and motions.
        sight: (seeds,) line of sight while the wheel runs up, arc seconds RMS.
        base_voltage, wheel_voltage: (seeds,) V RMS of all struts while it was measured.
        base_reasons, wheel_reasons: what controllers said in CONTROL, and for which share of it.
    """

    rig: str
    law: str
    curves: list[list[Curve]]
    sight: Array
    base_voltage: Array
    wheel_voltage: Array
    base_reasons: dict[str, float]
    wheel_reasons: dict[str, float]


def run_law(isolation: Isolation, rig: str, law: str) -> LawFound:
    """Measure one law on one rig.

    Raises:
        SatvibError: a scenario that is none.
    """
    base = simulate_batch(isolation.measured(rig, law), keep=_KEPT)
    curves = [transmissibilities(run, isolation.frf) for run in base]
    volts, said = _voltage(base), _reasons(base)
    del base
    wheel = simulate_batch(isolation.wheels(rig, law), keep=_KEPT)
    return LawFound(
        rig=rig,
        law=law,
        curves=curves,
        sight=np.array([_sight(run) for run in wheel]),
        base_voltage=volts,
        wheel_voltage=_voltage(wheel),
        base_reasons=said,
        wheel_reasons=_reasons(wheel),
    )


def _sight(run: Recording) -> float:
    assert run.scenario is not None
    settings = run.scenario.analysis
    start, stop = settings.controlled
    found = line_of_sight(run, (start, stop), settings.line_of_sight_from)
    return float('nan') if found is None else found.true * ARC_SECONDS


def _voltage(runs: Sequence[Recording]) -> Array:
    found = []
    for run in runs:
        span = run.scenario.analysis.controlled if run.scenario else ()
        window = run.window(*span) if span else slice(0, 0)
        voltage = run.get('voltage', 'voltage')[window]
        found.append(float(np.sqrt(np.mean(voltage**2))) if voltage.size else 0.0)
    return np.array(found)


def _reasons(runs: Sequence[Recording]) -> dict[str, float]:
    counts: Counter[str] = Counter()
    total = 0
    for run in runs:
        spoken = run.get('state', 'reason')[run.phase == Phase.CONTROL].ravel()
        total += spoken.size
        counts.update(str(text) for text in spoken.tolist())
    return {text: n / total for text, n in counts.most_common() if text}


def run_isolation(
    isolation: Isolation, rigs: Sequence[str], laws: Sequence[str], jobs: int | None = None
) -> Iterator[LawFound]:
    """Measure laws, and the open loop, on rigs; gives them as they are done.

    Args:
        isolation: what is judged.
        rigs, laws: names of it.
        jobs: processes; all cores if None. The results do not depend on it.

    Raises:
        SatvibError: a scenario that is none, or a law that cannot be measured because its process dies each time.
    """
    wanted = [(rig, law) for rig in rigs for law in (OPEN, *laws)]
    jobs = min(jobs or cores(), len(wanted))
    if jobs == 1:
        yield from (run_law(isolation, *each) for each in wanted)
        return
    done = run_in_processes(
        run_law,
        lambda i: (isolation, *wanted[i]),
        range(len(wanted)),
        jobs,
        called=lambda i: 'rig {}, law {}'.format(*wanted[i]),
        advice='fewer processes need less: --jobs 1',
    )
    for _, found in done:
        yield found
