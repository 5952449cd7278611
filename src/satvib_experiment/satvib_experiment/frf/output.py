# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Measured frequency responses as files: frf.json with the figures of merit, frf.csv with every line."""

import csv
import json
import math
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
from satvib_common.arrays import Array
from satvib_common.errors import SatvibError

from satvib_experiment.frf.curve import OPEN, SURE, TRANSMISSIBILITY, Curve
from satvib_experiment.frf.merit import BEYOND, LEAST, TRUSTED, Merit, merit_of

FORMAT = 'satvib frf 1'
COLUMNS = (
    'quantity', 'loop', 'output', 'input', 'frequency', 'magnitude', 'magnitude_low', 'magnitude_high',
    'phase', 'phase_band', 'coherence', 'exact_magnitude', 'exact_phase', 'model_magnitude', 'model_phase',
)  # fmt: skip


def plain_curve(curve: Curve) -> dict[str, Any]:
    """Give the figures of a curve as plain data; what is not known is None."""
    merit = merit_of(curve.measured) if curve.quantity == TRANSMISSIBILITY else None
    if merit is not None and curve.is_cross:
        merit = replace(
            merit, isolation_from=None, roll_off=None, roll_off_from=None, roll_off_to=None
        )
    deviation = curve.deviation()
    coherence = curve.measured.coherence
    known = coherence[np.isfinite(coherence)]
    least = int(np.nanargmin(coherence)) if known.size else None
    return {
        'quantity': curve.quantity,
        'loop': curve.loop,
        'output': curve.output,
        'input': curve.input,
        'merit': asdict(merit) if merit else None,
        'coherence': float(np.median(known)) if known.size else None,
        'coherence_least': None if least is None else float(coherence[least]),
        'coherence_least_frequency': (
            None if least is None else float(curve.measured.frequency[least])
        ),
        'lines': int(curve.measured.frequency.size),
        'lowest': float(curve.measured.frequency[0]),
        'highest': float(curve.measured.frequency[-1]),
        'averages': curve.measured.averages,
        'confidence': curve.measured.confidence,
        'method': curve.measured.method,
        'deviation_db': deviation[0] if deviation else None,
        'deviation_degrees': deviation[1] if deviation else None,
        'unknown': _unknown(curve, merit),
    }


def _unknown(curve: Curve, merit: Merit | None) -> dict[str, str]:
    """Say of each figure that is not known why it is not."""
    reasons: dict[str, str] = {}
    highest = float(curve.measured.frequency[-1])
    if curve.quantity != TRANSMISSIBILITY:
        pass
    elif merit is None:
        few = f'no line has a coherence of {TRUSTED:g}'
        reasons |= {'peak': few, 'isolation_from': few, 'roll_off': few}
    elif curve.is_cross:
        cross = 'the base does not move in that way alone, so 0 dB means nothing'
        reasons |= {'isolation_from': cross, 'roll_off': cross}
    elif merit.isolation_from is None:
        loud = f'the payload moves more than the base up to the end of the band, {highest:.3g} Hz'
        reasons |= {'isolation_from': loud, 'roll_off': loud}
    elif merit.roll_off is None:
        begins = BEYOND * merit.isolation_from
        reasons['roll_off'] = (
            f'it is fitted to {LEAST} lines or more of a coherence of {TRUSTED:g}, from {begins:.3g} Hz on, '
            f'over half an octave; up to {highest:.3g} Hz there are fewer'
        )
    if curve.exact is None:
        law = '' if curve.loop == OPEN else 'the law is no filter with fixed coefficients, '
        reasons['deviation'] = (
            f'{law}the rig is not known or is made of models, or the base moves in several directions'
        )
    elif curve.deviation() is None:
        reasons['deviation'] = f'no line has a coherence above {SURE:g}'
    return reasons


def frf_mapping(
    curves: Sequence[Curve],
    source: str,
    notes: Sequence[str] = (),
    coupling: tuple[list[float], Array] | None = None,
    shortfalls: Sequence[str] = (),
    warnings: Sequence[str] = (),
) -> dict[str, Any]:
    """Give what frf.json holds."""
    return {
        'format': FORMAT,
        'source': source,
        'curves': [plain_curve(curve) for curve in curves],
        'coupling': _plain_coupling(*coupling) if coupling else None,
        'shortfalls': list(shortfalls),
        'warnings': list(warnings),
        'notes': list(notes),
    }


def _plain_coupling(frequency: list[float], ratio: Array) -> dict[str, Any]:
    """Give the coupling as plain data; a ratio to a strut that does not move is None."""
    rows = [[value if math.isfinite(value) else None for value in row] for row in ratio.tolist()]
    return {'frequency': frequency, 'ratio': rows}


def write_frf(curves: Sequence[Curve], mapping: dict[str, Any], folder: Path) -> None:
    """Write frf.json and frf.csv into a folder.

    Raises:
        SatvibError: one of them exists already or cannot be written.
    """
    for name in ('frf.json', 'frf.csv'):
        path = folder / name
        try:
            with path.open('x', encoding='utf-8', newline='') as sink:
                if name == 'frf.json':
                    json.dump(mapping, sink, indent=1, allow_nan=False)
                    sink.write('\n')
                else:
                    rows = csv.writer(sink, lineterminator='\n')
                    rows.writerow(COLUMNS)
                    for curve in curves:
                        rows.writerows(_lines(curve))
        except FileExistsError:
            raise SatvibError(f'{path}: exists already, not overwritten') from None
        except OSError as error:
            raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None


def _lines(curve: Curve) -> list[list[str]]:
    """Rows of the table; frequencies in Hz, phases in degrees, magnitudes in the unit of the quantity."""
    m = curve.measured
    low, high = m.band
    columns = [
        m.frequency, m.magnitude, low, high, np.degrees(np.angle(m.value)), m.phase_band, m.coherence,
    ]  # fmt: skip
    for other in (curve.exact, curve.model):
        unknown = np.full(m.frequency.size, np.nan)
        columns += (
            [unknown, unknown] if other is None else [np.abs(other), np.degrees(np.angle(other))]
        )
    names = [curve.quantity, curve.loop, curve.output, curve.input]
    return [
        [*names, *(f'{v:.8g}' if math.isfinite(v) else '' for v in row)]
        for row in zip(*columns, strict=True)
    ]
