# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What stands in frf.json."""

import json

import numpy as np
from satvib_experiment.frf.curve import OPEN, PATH, Curve
from satvib_experiment.frf.output import frf_mapping, write_frf
from satvib_experiment.frf.paths import coupling
from satvib_ident.frequency.response import FrequencyResponse

STRUTS = ('strut_1', 'strut_2')


def path(output, coil, size):
    f = np.arange(1.0, 6.0)
    known = np.ones(5) if size else np.full(5, np.nan)
    found = FrequencyResponse(f, np.full(5, size, complex), known, 0.1 * known, 8.0, 0.95, 'H1')
    return Curve(PATH, OPEN, output, coil, found)


def test_the_coupling_to_a_sensor_that_shows_nothing_is_not_known(tmp_path):
    """Truth: a ratio to 0 is no number, and JSON has no name for it; the sensor of strut 2 is dead."""
    curves = [
        path(output, coil, 0.5 * (output == 'strut_1')) for coil in STRUTS for output in STRUTS
    ]
    write_frf(curves, frf_mapping(curves, 'a run', coupling=coupling(curves, STRUTS)), tmp_path)
    read = json.loads((tmp_path / 'frf.json').read_text(encoding='utf-8'))
    assert read['coupling']['ratio'] == [[1.0, None], [0.0, None]]
