# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The identifier as a whole: bias, alignment, breaks in the record, verdicts."""

from pathlib import Path

import numpy as np
import pytest
from satvib_common.errors import SatvibError
from satvib_common.phases import Phase
from satvib_ident.excitation import make_excitation
from satvib_ident.identifier import FIGURES, IdentifierCore
from satvib_ident.models.iir_model import IirModel
from satvib_ident.parameters import ESTIMATORS, FORGETTING, IdentifierParameters

PLANT = IirModel([-0.460, 0.158], [0.6, -1.0, 0.3], 1, 0.01)


def phase(k):
    return Phase.CALIBRATE if k < 100 else Phase.IDENTIFY if k < 300 else Phase.ADAPT


@pytest.fixture
def record():
    """A paper-like run: record(name, noise, bias, delay, shape) -> upper, voltage as step() wants it; 350 samples."""

    def make(name='prbs', noise=0.0, bias=0.3, delay=1, shape=(), amplitude=5.0, seed=0, **options):
        signal = make_excitation(name, amplitude=amplitude, dt=0.01, **options)
        u = np.concatenate([np.zeros(100), signal.samples(200), np.zeros(50)])
        y = IirModel(PLANT.a, PLANT.b, delay, 0.01).simulate(u) + bias
        y = y + noise * np.random.default_rng([71, seed]).normal(size=(*shape, 350))
        return y, np.broadcast_to(np.append(np.zeros(delay), u)[:350], y.shape)

    return make


def run(core, y, u, first=0, last=None):
    out = None
    for k in range(first, y.shape[-1] if last is None else last):
        out = core.step(k, phase(k), y[..., k], u[..., k])
    return out


@pytest.mark.parametrize('delay', [0, 1, 3])
@pytest.mark.parametrize('name', ['squares', 'prbs', 'multisine'])
def test_a_plant_without_noise_gives_back_its_five_parameters(record, name, delay):
    """Truth: the parameters that made the record (1e-6), with a bias of 0.3 m/s^2 that CALIBRATE takes off exactly."""
    core = IdentifierCore(IdentifierParameters(delay=delay))
    out = run(core, *record(name, delay=delay))
    np.testing.assert_allclose(out.model().theta, PLANT.theta, atol=1e-6)
    assert (out.delay, out.dt, out.sequence) == (delay, 0.01, 349)
    assert float(out.bias) == pytest.approx(0.3, abs=1e-12)
    assert bool(out.converged)
    assert out.reason == ''


def test_the_bias_is_frozen_when_calibration_ends(record):
    """Truth: the mean of the first 100 samples; later samples, far away from it, change no bit of it."""
    y, u = record(noise=0.1)
    core = IdentifierCore(IdentifierParameters())
    out = run(core, y, u, last=101)
    expected = float(out.bias)
    assert expected == pytest.approx(np.mean(y[:100]), abs=1e-12)
    assert float(run(core, y + 100.0, u, first=101).bias) == expected


def test_without_calibration_no_bias_is_taken_off(record):
    """Truth: 'none' leaves the output as it is: with a bias of 0 the plant comes back, with 0.3 it does not."""
    for bias, good in ((0.0, True), (0.3, False)):
        out = run(IdentifierCore(IdentifierParameters(bias='none')), *record(bias=bias))
        assert np.allclose(out.model().theta, PLANT.theta, atol=1e-6) is good
        assert float(out.bias) == 0.0


def test_estimates_move_in_their_phases_only(record):
    """Truth: the same bits at the end of IDENTIFY and 50 samples into ADAPT; with ADAPT added they move on."""
    y, u = record(noise=0.05)
    core = IdentifierCore(IdentifierParameters())
    before = run(core, y, u, last=300)
    after = run(core, y, u, first=300)
    assert np.array_equal(before.a, after.a)
    assert np.isnan(after.prediction_error)
    assert np.isfinite(before.prediction_error)
    both = IdentifierParameters(estimate_in=('IDENTIFY', 'ADAPT'))
    assert not np.array_equal(run(IdentifierCore(both), y, u).a, before.a)


@pytest.mark.parametrize('hole', [np.nan, np.inf, -np.inf])
def test_a_sample_that_is_not_a_number_is_counted_and_poisons_nothing(record, hole):
    """Truth: without noise the plant still comes back (1e-6); the hole and its 2 (output) or 3 (input) samples in the
    regressor are not used, nor is the sample itself.
    """
    y, u = (x.copy() for x in record())
    whole = run(IdentifierCore(IdentifierParameters()), y, u)
    y[150], u[220] = hole, hole
    core = IdentifierCore(IdentifierParameters())
    out = run(core, y, u)
    np.testing.assert_allclose(out.model().theta, PLANT.theta, atol=1e-6)
    assert int(core.counters['accelerations not finite']) == 1
    assert int(core.counters['voltages not known']) == 1
    assert int(whole.updates - out.updates) == 3 + 3


def test_a_gap_empties_the_regressor(record):
    """Truth: 40 samples lost: counted, the plant still comes back (1e-6), 3 samples after the gap are not used."""
    y, u = record()
    core = IdentifierCore(IdentifierParameters())
    whole = run(IdentifierCore(IdentifierParameters()), y, u)
    run(core, y, u, last=160)
    out = run(core, y, u, first=200)
    np.testing.assert_allclose(out.model().theta, PLANT.theta, atol=1e-6)
    assert core.counters['lost samples'] == 40
    assert int(whole.updates - out.updates) == 40 + 2


def test_a_restart_of_the_source_starts_over(record):
    """Truth: after a restart the result has the same bits as that of a new identifier."""
    y, u = record(noise=0.05)
    core = IdentifierCore(IdentifierParameters(forgetting='variable_rate'))
    run(core, y + 1.0, -u, last=330)
    again = run(core, y, u)
    new = run(IdentifierCore(IdentifierParameters(forgetting='variable_rate')), y, u)
    assert core.counters['restarts of the source'] == 1
    for name in ('a', 'b', 'covariance', 'bias', 'updates', 'whiteness', 'model_error'):
        assert np.array_equal(getattr(again, name), getattr(new, name), equal_nan=True)


def test_a_repeated_sample_changes_nothing(record):
    """Truth: the same bits with and without the repeat, whatever it holds."""
    y, u = record(noise=0.05)
    core, plain = IdentifierCore(IdentifierParameters()), IdentifierCore(IdentifierParameters())
    run(core, y, u, last=200)
    again = core.step(199, Phase.IDENTIFY, np.asarray(1e6), np.asarray(1e6))
    assert again.sequence == 199
    assert core.counters['repeated samples'] == 1
    assert np.array_equal(run(core, y, u, first=200).a, run(plain, y, u).a)


def test_noise_alone_teaches_nothing(record):
    """Truth: half a second after the excitation the estimate stands still to the last bit, noise or not."""
    y, u = record(noise=0.3)
    y, u = np.append(y, y[-50:]), np.append(u, np.zeros(50))
    parameters = IdentifierParameters(estimate_in=('IDENTIFY', 'ADAPT'))
    core = IdentifierCore(parameters)
    before = run(core, y, u, last=352)
    after = run(core, y, u, first=352)
    assert np.array_equal(before.a, after.a)
    assert int(after.updates) == int(before.updates)
    assert int(before.updates) == 250


def test_bits_do_not_depend_on_the_shape(record):
    """Truth: a strut alone and the same strut in batches of (4,) and (4, 3) give the same bits in every field."""
    y, u = record(noise=0.1, shape=(4,))
    y, u = y.copy(), u.copy()
    y[2, 170] = np.nan  # a hole in another item
    for estimator, forgetting in (
        ('least_squares', 'variable_rate'),
        ('extended', 'directional'),
        ('instrumental', 'none'),
        ('continuous_least_squares', 'resetting'),
    ):
        p = IdentifierParameters(estimator=estimator, forgetting=forgetting)
        one = run(IdentifierCore(p), y[1], u[1])
        four = run(IdentifierCore(p, (4,)), y, u)
        grid = run(
            IdentifierCore(p, (4, 3)),
            np.repeat(y[:, None], 3, axis=1),
            np.repeat(u[:, None], 3, axis=1),
        )
        for name in (
            'a', 'b', 'covariance', 'standard_deviation', 'noise_variance', 'updates', 'whiteness',
            'excitation_order', 'information_condition', 'response_deviation', 'model_error',
            'pole_modulus', 'converged',
        ):  # fmt: skip
            values = [getattr(x, name) for x in (one, four, grid)]
            assert np.array_equal(values[0], values[1][1], equal_nan=True), name
            assert np.array_equal(values[0], values[2][1, 2], equal_nan=True), name


@pytest.mark.parametrize('estimator', ESTIMATORS)
@pytest.mark.parametrize('forgetting', FORGETTING)
def test_every_choice_runs_and_reports_finite_parameters(record, estimator, forgetting):
    """Truth: finite a and b after a noisy run with a hole in it; what does not go together is refused by name."""
    options = {'estimator': estimator, 'forgetting': forgetting, 'dead_zone': 0.02}
    if estimator == 'continuous_normalized':
        options['initial_covariance'] = 1e3
    if estimator == 'instrumental' and forgetting not in (*FORGETTING[:3], 'dead_zone'):
        with pytest.raises(SatvibError, match='does not go with estimator instrumental'):
            IdentifierParameters(**options)
        return
    y, u = record(noise=0.05)
    y = y.copy()
    y[180] = np.nan
    out = run(IdentifierCore(IdentifierParameters(**options)), y, u)
    assert np.isfinite(out.a).all()
    assert np.isfinite(out.b).all()
    assert int(out.updates) > 50


def test_verdicts_name_what_is_wrong(record):
    """Truth: each record or setting breaks one check of satvib_ident.trust.checks, named first."""
    cases = [
        ({}, record('sines'), 'the input excites order 4, 5 parameters need 5'),
        ({}, record(amplitude=0.0), '0 samples used of 50'),
        ({}, record(noise=3.0, amplitude=1.0), 'response uncertain by'),
        (
            {'trust_deviation': 9.0},
            (record(noise=0.01, delay=4)[0], record()[1]),
            'the residual still answers to the input',
        ),
        (
            {'trust_deviation': 9.0, 'input_hold': 9.0},
            record('sines', noise=0.2, frequencies=[1.0, 2.0, 3.0, 4.0, 5.0]),
            'too little input between 5 and 20 Hz for its noise',
        ),
        ({'trust_pole_modulus': 0.1}, record(), 'unstable: pole modulus 0.397'),
        ({'trust_condition': 1.5}, record(), 'ill-conditioned information'),
        ({'trust_whiteness': 1e-3, 'trust_deviation': 9.0}, record(noise=0.05), 'not white: Q/h'),
        ({}, record(noise=0.01), ''),
    ]
    for options, signals, reason in cases:
        out = run(IdentifierCore(IdentifierParameters(**options)), *signals, last=300)
        assert out.reason == reason if not reason else reason in out.reason
        assert bool(out.converged) is (reason == '')


def test_the_verdict_is_that_of_the_model_it_comes_with(record):
    """Truth: at the last sample of IDENTIFY the reported pole modulus is that of the reported a."""
    out = run(IdentifierCore(IdentifierParameters()), *record(noise=0.2), last=300)
    assert float(out.pole_modulus) == pytest.approx(np.abs(out.model().poles()).max(), rel=1e-9)


def test_in_a_batch_each_item_has_its_own_verdict(record):
    """Truth: item 0 is excited, item 1 is not."""
    y, u = record(noise=0.01, shape=(2,))
    y, u = y.copy(), u.copy()
    y[1], u[1] = 0.3, 0.0
    out = run(IdentifierCore(IdentifierParameters(), (2,)), y, u)
    assert out.converged.tolist() == [True, False]
    assert out.reasons.tolist() == ['', '0 samples used of 50']
    assert out.reason == '0 samples used of 50'


@pytest.mark.parametrize(
    ('options', 'message'),
    [
        ({'poles': 0}, 'poles: 0 is less than 1'),
        ({'coefficients': 0}, 'coefficients: 0 is less than 1'),
        ({'delay': -1}, 'delay: -1'),
        ({'forgetting_factor': 0.0}, 'forgetting_factor: 0.0 is not above 0.0'),
        ({'forgetting_factor': 1.5}, 'forgetting_factor: 1.5 is more than 1.0'),
        ({'forgetting_factor': float('nan')}, 'forgetting_factor: nan is not a finite number'),
        ({'estimator': 'kalman'}, "estimator: 'kalman' is not one of"),
        ({'forgetting': 'linear'}, "forgetting: 'linear' is not one of"),
        ({'initial_theta': (1.0, 2.0)}, 'initial_theta: 2 numbers; a model of 2 poles'),
        ({'estimate_in': ('IDENTFY',)}, "estimate_in: 'IDENTFY' is not one of"),
        ({'trust_band': (5.0, 60.0)}, 'trust_band'),
        ({'trust_band': (5.0,)}, 'trust_band'),
        ({'reset_threshold': 2.0}, 'reset_threshold: 2.0 is not below reset_covariance'),
        ({'estimator': 'continuous_gradient', 'coefficients': 2}, 'poles [+] 1 = 3'),
        ({'estimator': 'continuous_normalized'}, 'initial_covariance: 1e[+]18 is more than 1e6'),
        ({'estimator': 'continuous_gradient', 'filter_corner': 50.0}, 'filter_corner: 50.0 Hz'),
    ],
)
def test_bad_parameters_are_refused_by_name(options, message):
    """Truth: each set of parameters has one fault."""
    with pytest.raises(SatvibError, match=message):
        IdentifierParameters(**options)


def test_every_figure_has_a_field_in_the_message():
    """Truth: satvib_msgs/IirParameters; four fields are of all items, one of the schedule, and the node
    measures the bias of the lower sensor."""
    text = (Path(__file__).parents[2] / 'satvib_msgs/msg/IirParameters.msg').read_text()
    lines = [line.split() for line in text.splitlines() if line and not line.startswith('#')]
    assert sorted([*FIGURES, 'reason']) == sorted(
        name for _, name in lines[4:] if name not in {'next_sequence', 'bias_lower'}
    )


def test_clipped_samples_are_left_out(record):
    """Truth: the parameters that made the record (1e-6). A sensor that clips the largest readings is marked there;
    without the marks its readings bias the estimate by more than 1e-2."""
    y, u = record('multisine', amplitude=10.0)
    limit = 0.3 + 0.7 * np.abs(y - 0.3).max()
    seen = np.clip(y, -limit, limit)
    ends = np.abs(y) >= limit
    assert 5 < ends.sum() < 100
    marked, plain = IdentifierCore(IdentifierParameters()), IdentifierCore(IdentifierParameters())
    out = None
    for k in range(len(y)):
        out = marked.step(k, phase(k), seen[k], u[k], clipped=ends[k])
    np.testing.assert_allclose(out.model().theta, PLANT.theta, atol=1e-6)
    assert marked.counters['accelerations clipped'] == ends.sum()
    assert marked.counters['accelerations not finite'] == 0
    wrong = run(plain, seen, u).model().theta - PLANT.theta
    assert np.abs(wrong).max() > 1e-2
