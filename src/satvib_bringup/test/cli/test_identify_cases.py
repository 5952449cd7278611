# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Public reports of records that gave a wrong model: what `satvib identify` makes of each now.

Truth: the page beside each file (how the record was made, or numpy's least squares of it), to the digits that it gives;
the plant is y(k) = 1.5 y(k-1) - 0.7 y(k-2) + u(k-1) + 0.5 u(k-2).
"""

import re
import shutil
from pathlib import Path

import numpy as np
import pytest
from satvib_bringup.cli import main
from satvib_ident.models.model_file import load_model

CASES = Path(__file__).resolve().parents[4].parent / 'shared' / 'cases'
pytestmark = pytest.mark.skipif(not CASES.is_dir(), reason=f'the cases are not at {CASES}')
U_Y = ('--input', 'u', '--output', 'y')
ORDER_2 = (*U_Y, '--order', '2', '--sample-period', '0.01')


@pytest.fixture
def identify(tmp_path, monkeypatch, capsys):
    """Run the command on a case: identify(path, *options) -> exit code, model or None, output in one line, error."""
    monkeypatch.chdir(tmp_path)

    def run(path, *options):
        monkeypatch.setattr(
            'sys.argv', ['satvib', 'identify', str(CASES / path), *options, '--save', 'm.yaml']
        )
        code = 0
        try:
            main.main()
        except SystemExit as ended:
            code = ended.code or 0
        out, err = capsys.readouterr()
        saved = tmp_path / 'm.yaml'
        model = load_model(saved) if saved.exists() else None
        return code, model, ' '.join(out.split()), err

    return run


@pytest.mark.parametrize(
    ('path', 'options', 'a1', 'tolerance'),
    [
        ('csv_decimal_comma_between_commas/ok.csv', ORDER_2, -1.49994, 5e-6),
        ('csv_decimal_comma_between_commas/ok.csv', U_Y, -1.49994, 5e-6),
        ('csv_dropped_samples/dropped_rows.csv', ORDER_2, -1.49987, 5e-6),
        ('csv_latin1_header/latin1.csv', ('--input', 'Kraft', '--output', 'Beschl (m/s²)', '--order', '2'),
         -1.49994, 5e-6),
        ('csv_offset_of_981/gravity.csv', ORDER_2, -1.49994, 5e-6),
        ('csv_offset_of_981/gravity.csv', U_Y, -1.49994, 5e-6),
        ('csv_semicolon_decimal_comma/semi_decimal_comma.csv', ORDER_2, -1.49994, 5e-6),
        ('csv_small_units/s1e-10.csv', ORDER_2, -1.5, 1e-12),
        ('dat_two_columns/rec.dat', ('--input', '1', '--output', '2', '--order', '2'), -1.49994, 5e-6),
        ('lvm_labview_text/rec.lvm', ORDER_2, -1.49994, 5e-6),
        ('name_with_brackets/acc[g].csv', ORDER_2, -1.49994, 5e-6),
        ('identify_long_delay/delay40.csv', (*U_Y, '--order', '2'), -1.496, 5e-4),
        ('identify_long_delay/delay40.csv', (*U_Y, '--order', '2', '--delay', '41'), -1.496, 5e-4),
    ],
)  # fmt: skip
def test_the_right_model(identify, path, options, a1, tolerance):
    code, model, out, err = identify(path, *options)
    assert code == 0, err + out
    assert model.a[0] == pytest.approx(a1, abs=tolerance)
    assert 'nothing found speaks against the model' in out


def test_dropped_rows_are_said_and_left_out(identify):
    """40 gaps; numpy over the 278 complete regressors gives a2 0.69989."""
    _, model, out, _ = identify('csv_dropped_samples/dropped_rows.csv', *U_Y, '--order', '2')
    assert 'jumps over missing samples at 40 places' in out
    assert model.a[1] == pytest.approx(0.69989, abs=5e-6)
    assert model.dt == pytest.approx(0.01)


def test_the_offset_is_said(identify):
    """numpy with a column of ones: a2 0.69995, free run 0.9995."""
    _, model, out, _ = identify('csv_offset_of_981/gravity.csv', *ORDER_2)
    assert model.a[1] == pytest.approx(0.69995, abs=5e-6)
    assert 'offset: constant term' in out
    assert 'free run 0.9995' in out
    assert re.search(r'its mean, 981\.5\d*, is \d+ times its deviation', out)


def test_small_units_hold_both_poles_to_twelve_digits(identify):
    _, model, _, _ = identify('csv_small_units/s1e-10.csv', *ORDER_2)
    np.testing.assert_allclose(model.a, [-1.5, 0.7], atol=1e-12)
    np.testing.assert_allclose(model.b, [0.0, 1.0, 0.5], atol=1e-12)


def test_the_buck_converter(identify):
    """numpy, means of the first half removed, order 1/2, no delay, same split: 0.606; with a column of ones 0.600."""
    code, model, out, _ = identify(
        'data_buck_converter/buck_id.csv',
        '--input',
        'input',
        '--output',
        'y',
        '--sample-period',
        '1e-5',
    )
    assert code == 0
    assert (model.order, model.b.size, model.delay) == (1, 2, 0)
    assert 'means removed 0.6058, constant term 0.6005' in out


def test_the_delay_is_searched_and_the_evidence_printed(identify):
    _, model, out, _ = identify('identify_long_delay/delay40.csv', *U_Y)
    assert model.delay == 41
    assert 'delay 41, searched from 0 to 100: the error is smallest at 41' in out
    assert re.search(r'free run 0\.98\d\d', out)


@pytest.mark.parametrize(
    ('path', 'options', 'message'),
    [
        ('csv_decimal_comma_between_commas/comma_decimal_comma_int.csv', ORDER_2,
         'line 2: the row has 4 cells, the header 3'),
        ('dat_two_columns/rec.dat', ORDER_2, 'there is no header line; give columns by number, 1 to 2'),
    ],
)  # fmt: skip
def test_what_cannot_be_read_is_one_line(identify, path, options, message):
    code, model, _, err = identify(path, *options)
    assert code == 2
    assert model is None
    assert message in err
    assert err.count('\n') == 1


@pytest.mark.parametrize(
    ('path', 'options', 'said'),
    [
        ('identify_one_sine/sine_noise.csv', (*U_Y, '--sample-period', '0.01'),
         'NOT TRUSTED, POOR_EXCITATION: the input excites only order 2'),
        ('identify_pure_feedback/feedback_pure.csv', ORDER_2, 'the regressor of order 2 has rank 3 of 5'),
        ('identify_long_delay/delay40.csv', (*U_Y, '--delay', '0'),
         'NOT TRUSTED, NO_RESPONSE: the input explains nothing of the output within 10 samples'),
        ('csv_decimal_comma_between_commas/ok.csv', ('--input', 'y', '--output', 'u'),
         'SWAPPED'),
    ],
)  # fmt: skip
def test_a_model_that_is_not_to_be_trusted(identify, path, options, said):
    code, model, out, _ = identify(path, *options)
    assert code == 3
    assert model is not None
    assert said in out
    assert 'speaks against the model' not in out


def test_names_with_brackets_are_printed_as_they_are(tmp_path, monkeypatch, capsys):
    path = tmp_path / 'acc[g].csv'
    shutil.copy(CASES / 'name_with_brackets' / 'acc[g].csv', path)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(
        'sys.argv', ['satvib', 'identify', path.name, *ORDER_2, '--save', 'm[b].yaml']
    )
    with pytest.raises(SystemExit) as ended:
        main.main()
    assert not ended.value.code
    out = capsys.readouterr().out
    assert 'acc[g].csv: model 2/3' in out
    assert 'model: m[b].yaml' in out
    assert (tmp_path / 'm[b].yaml').is_file()
