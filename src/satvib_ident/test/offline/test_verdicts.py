# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What is found about a model, from records whose fault is known, and nothing from records without.

Truth everywhere: how the record was made.
"""

import numpy as np
import pytest
from satvib_ident.models.iir_model import IirModel
from satvib_ident.offline.order_search import identify
from satvib_ident.offline.result import Finding

N = 1000
PLANT = IirModel([-1.5, 0.7], [0.0, 1.0, 0.5], 0, 0.01)
ORDERS = [(n, n + 1, 0) for n in range(1, 7)]


def rng(seed):
    return np.random.default_rng([16, seed])


def found(y, u, orders=ORDERS, **options):
    result = identify(y, u, 0.01, orders, **options)
    return result, {f.finding for f in result.findings}


def loop(a, b, controller, dither, noise, samples=N, seed=0):
    """A closed loop y(k) = -a y + b u(k-1..) + e, u = controller(past y, past u) + dither."""
    generator = rng(seed)
    y, u = np.zeros(samples), np.zeros(samples)
    for k in range(samples):
        past = sum(-a[i] * y[k - 1 - i] for i in range(len(a)) if k > i)
        driven = sum(b[i] * u[k - 1 - i] for i in range(len(b)) if k > i)
        y[k] = past + driven + noise * generator.normal()
        u[k] = controller(y, u, k) + dither * generator.choice([-1.0, 1.0])
    return y, u


CONTROLLERS = {
    'proportional': lambda y, _u, k: -0.2 * y[k],
    'delayed': lambda y, _u, k: -0.1 * y[k - 1] if k else 0.0,
    'proportional and differential': lambda y, _u, k: -0.3 * y[k] + 0.1 * (y[k - 1] if k else 0.0),
    'with an integrator': lambda y, u, k: (u[k - 1] - 0.2 * y[k] + 0.15 * y[k - 1]) if k else 0.0,
}


@pytest.mark.parametrize('name', CONTROLLERS)
@pytest.mark.parametrize('delay', [0, 1])
@pytest.mark.parametrize('digits', [None, 5])
def test_pure_feedback_is_a_model_of_the_controller(name, delay, digits):
    y, u = loop([-1.5, 0.7], [1.0, 0.5], CONTROLLERS[name], 0.0, 0.1, 600)
    if digits:
        y, u = np.round(y, digits), np.round(u, digits)
    result, what = found(y, u, [(2, 3, delay)])
    assert Finding.PURE_FEEDBACK in what
    assert not result.trusted
    assert 'dither' in ' '.join(map(str, result.findings))


@pytest.mark.parametrize('name', CONTROLLERS)
def test_a_loop_with_a_dither_is_no_pure_feedback(name):
    """With a dither as large as the noise does, the plant can be found: a1, a2 within 0.1."""
    y, u = loop([-1.5, 0.7], [1.0, 0.5], CONTROLLERS[name], 0.3, 0.1, 2000)
    result, what = found(y, u, [(2, 3, 1)])
    assert what <= {Finding.FEEDBACK}
    np.testing.assert_allclose(result.model.a, [-1.5, 0.7], atol=0.1)


@pytest.mark.parametrize('frequencies', [[5.0], [3.0], [2.0, 7.0]])
@pytest.mark.parametrize('noise', [0.02, 0.0])
@pytest.mark.parametrize('digits', [5, None])
def test_few_sines_excite_too_little(frequencies, noise, digits):
    """F sines excite order 2 F; five parameters and more are asked for."""
    t = 0.01 * np.arange(N)
    u = sum(np.sin(2 * np.pi * f * t) for f in frequencies)
    y = PLANT.simulate(u) + noise * rng(1).normal(size=N)
    if digits:
        u, y = np.round(u, digits), np.round(y, digits)
    result, what = found(y, u, [(2, 3, 0), (3, 4, 0)])
    assert Finding.POOR_EXCITATION in what
    assert f'only order {2 * len(frequencies)} ' in ' '.join(map(str, result.findings))
    assert not result.trusted


@pytest.mark.parametrize('seed', range(3))
@pytest.mark.parametrize('noise', [0.02, 0.3])
@pytest.mark.parametrize('kind', ['prbs', 'random', 'chirp', 'steps'])
def test_a_good_record_is_trusted(seed, noise, kind):
    generator = rng(seed)
    k = np.arange(2 * N)
    u = {
        'prbs': generator.choice([-1.0, 1.0], 2 * N),
        'random': generator.normal(size=2 * N),
        'chirp': np.sin(2 * np.pi * (0.001 + 0.2 * k / (4 * N)) * k),
        'steps': np.repeat(generator.normal(size=N // 4), 8),
    }[kind]
    y = PLANT.simulate(u) + noise * generator.normal(size=2 * N)
    result, what = found(y, u)
    assert result.trusted, result.findings
    assert not what & {Finding.EXACT_FIT, Finding.FEEDBACK}


@pytest.mark.parametrize(
    'plant', [PLANT, IirModel([-0.46, 0.158], [0.061, -0.103, 0.033], 0, 0.01)]
)
def test_a_noise_free_record_is_an_exact_fit_and_trusted(plant):
    u = rng(2).choice([-1.0, 1.0], N)
    result, what = found(plant.simulate(u), u)
    assert what == {Finding.EXACT_FIT}
    assert result.trusted


@pytest.mark.parametrize('noise', [0.002, 0.3])
@pytest.mark.parametrize('dead', [0, 30])
@pytest.mark.parametrize('kind', ['prbs', 'random'])
def test_swapped_columns_are_named(noise, dead, kind):
    u = rng(3).choice([-1.0, 1.0], N) if kind == 'prbs' else rng(3).normal(size=N)
    y = np.concatenate([np.zeros(dead), PLANT.simulate(u)])[:N] + noise * rng(4).normal(size=N)
    result, what = found(u, y)
    assert Finding.SWAPPED in what
    assert not result.trusted


def test_an_output_that_has_nothing_to_do_with_the_input():
    generator = rng(5)
    y = IirModel([-0.9], [1.0], 0, 0.01).simulate(generator.normal(size=N))
    result, what = found(y, generator.choice([-1.0, 1.0], N))
    assert Finding.NO_RESPONSE in what
    assert not result.trusted


@pytest.mark.parametrize('lag', [12, 41, 100])
def test_a_residual_that_answers_to_the_input_is_found_at_any_lag(lag):
    """An echo of the input that no model of these orders can hold."""
    u = rng(6).choice([-1.0, 1.0], N)
    echo = np.concatenate([np.zeros(lag), u])[:N]
    y = PLANT.simulate(u) + 3.0 * echo + 0.05 * rng(7).normal(size=N)
    result, what = found(y, u, [(2, 3, 0)])
    assert Finding.RESIDUAL_ANSWERS in what
    assert not result.trusted
    assert any(
        f'most at lag {at} ' in str(f) for f in result.findings for at in (lag, lag + 1, lag + 2)
    )


@pytest.mark.parametrize('pole', [1.05, 1.2])
def test_an_unstable_plant_in_a_loop(pole):
    """y(k) = pole y(k-1) + u(k-1), held by u = -0.6 y and a dither: the model finds the pole within 0.05."""
    y, u = loop([-pole], [1.0], lambda y, _u, k: -0.6 * y[k], 0.3, 0.1, 2000)
    result, what = found(y, u, [(1, 1, 1), (2, 2, 1)])
    assert Finding.UNSTABLE_IN_LOOP in what
    assert not result.trusted
    assert result.candidates[0].model.a[0] == pytest.approx(-pole, abs=0.05)


def test_all_candidates_unstable_without_a_loop():
    """A record that grows by itself."""
    generator = rng(8)
    u = generator.choice([-1.0, 1.0], 300)
    y = np.zeros(300)
    for k in range(1, 300):
        y[k] = 1.03 * y[k - 1] + u[k - 1] + 0.01 * generator.normal()
    result, what = found(y, u, [(1, 2, 0)])
    assert Finding.ALL_UNSTABLE in what
    assert not result.trusted


def test_a_free_run_below_zero_is_not_trusted():
    """A second part that is another plant."""
    u = rng(9).choice([-1.0, 1.0], N)
    y = PLANT.simulate(u)
    y[N // 2 :] *= -1.0
    result, what = found(y + 0.01 * rng(9).normal(size=N), u, [(2, 3, 0)])
    assert Finding.FREE_RUN_FAILS in what
    assert not result.trusted


@pytest.mark.parametrize('at', [[400], [100, 700]])
@pytest.mark.parametrize('wrong', [12.0, 1e4])
def test_a_few_wrong_samples_that_least_squares_fits(at, wrong):
    """Values that lie within the output, or far out."""
    u = rng(10).choice([-1.0, 1.0], N)
    y = PLANT.simulate(u) + 0.01 * rng(11).normal(size=N)
    y[at] = wrong
    result, what = found(y, u, [(2, 3, 0)])
    assert Finding.FEW_SAMPLES in what
    assert not result.trusted


@pytest.mark.parametrize('finding', Finding)
def test_every_finding_says_what_to_do(finding):
    assert len(finding.advice) > 20
    assert isinstance(finding.trusted, bool)
