# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A file of each format, written by another library, gives the samples and the model of the CSV.

Truth: the CSV with all digits of the same record. Every bit is the same; of formats with fewer bits, half of the last
one, and the model within 10 times of that.
"""

import numpy as np
import pytest
from satvib_common.records.record import column_record
from satvib_ident.offline.order_search import identify

ORDER = [(2, 3, 0)]


def model_of(record):
    return identify(record.y, record.u, record.dt, ORDER).model


def test_the_samples_are_those_of_the_csv(written, case, csv_file):
    truth = column_record(csv_file, 'u', 'y')
    found = column_record(written, *case.columns, units=case.units)
    assert found.dt == truth.dt == 1.0 / 128.0
    size = 16.0 if case.tolerance else 0.0
    np.testing.assert_allclose(found.u, truth.u, rtol=0.0, atol=case.tolerance * size)
    np.testing.assert_allclose(found.y, truth.y, rtol=0.0, atol=case.tolerance * size)


def test_the_model_is_that_of_the_csv(written, case, csv_file):
    truth = model_of(column_record(csv_file, 'u', 'y'))
    found = model_of(column_record(written, *case.columns, units=case.units))
    np.testing.assert_allclose(found.a, truth.a, rtol=0.0, atol=160.0 * case.tolerance)
    np.testing.assert_allclose(found.b, truth.b, rtol=0.0, atol=160.0 * case.tolerance)
    assert truth.a[0] == pytest.approx(-1.5, abs=2e-3)  # the plant itself


def test_the_command_gives_that_model_too(written, case, csv_file, tmp_path, monkeypatch):
    """The reader that the command uses is this one: same model, exit code 0."""
    from satvib_bringup.cli import main
    from satvib_ident.models.model_file import load_model

    models = []
    units = [('--input-unit', case.units[0]), ('--output-unit', case.units[1])]
    said = [word for pair in units if pair[1] for word in pair]
    for file, columns, more in ((csv_file, ('u', 'y'), []), (written, case.columns, said)):
        saved = tmp_path / f'{len(models)}.yaml'
        words = ['--input', columns[0], '--output', columns[1], '--order', '2', '--delay', '0']
        monkeypatch.setattr(
            'sys.argv', ['satvib', 'identify', str(file), *words, *more, '--save', str(saved)]
        )
        with pytest.raises(SystemExit) as ended:
            main.main()
        assert not ended.value.code
        models.append(load_model(saved))
    np.testing.assert_allclose(models[1].a, models[0].a, rtol=0.0, atol=160.0 * case.tolerance)
    np.testing.assert_allclose(models[1].b, models[0].b, rtol=0.0, atol=160.0 * case.tolerance)
