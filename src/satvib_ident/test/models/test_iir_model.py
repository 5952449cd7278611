# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The model: conversions, responses, records, files."""

import numpy as np
import pytest
import scipy.signal
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_ident.models.iir_model import IirModel
from satvib_ident.models.model_file import load_model, save_model
from satvib_ident.models.polynomials import inside, pole_modulus


def test_the_papers_print_is_tustin_at_100_hz(paper):
    """Truth: the paper prints -104 +- 80.3i, 131 rad/s, 0.79; exact algebra gives -104.08 +- 80.15i (+-0.005)."""
    pole = paper.to_continuous('tustin').poles()[0]
    assert pole.real == pytest.approx(-104.08, abs=0.005)
    assert abs(pole.imag) == pytest.approx(80.15, abs=0.005)
    assert float(paper.natural_frequency()) == pytest.approx(131.4, abs=0.05)
    assert float(paper.damping()) == pytest.approx(0.792, abs=5e-4)


def test_zero_order_hold_of_the_same_print(paper):
    """Truth: ln(z)/T of the printed denominator, -92.3 +- 95.4i, 132.7 rad/s, 0.695 (one unit of the last digit)."""
    pole = paper.to_continuous('zoh').poles()[0]
    assert pole.real == pytest.approx(-92.3, abs=0.05)
    assert abs(pole.imag) == pytest.approx(95.4, abs=0.05)
    assert float(paper.natural_frequency('zoh')) == pytest.approx(132.7, abs=0.05)
    assert float(paper.damping('zoh')) == pytest.approx(0.695, abs=5e-4)


@pytest.mark.parametrize(('method', 'theirs'), [('tustin', 'bilinear'), ('zoh', 'zoh')])
@pytest.mark.parametrize('order', [1, 2, 3, 4])
def test_conversion_is_the_inverse_of_scipys_discretization(method, theirs, order):
    """Truth: scipy.signal.cont2discrete of our G(s) gives the model back (1e-8 relative)."""
    generator = np.random.default_rng([3, order])
    pairs = 0.7 * np.exp(1j * generator.uniform(0.2, 1.2, order // 2))
    a = np.real(np.poly(np.concatenate([pairs, pairs.conj(), [0.5] * (order % 2)])))[1:]
    model = IirModel(a, generator.normal(size=order + 1), 0, 0.02)
    g = model.to_continuous(method)
    top, bottom, _ = scipy.signal.cont2discrete((g.numerator, g.denominator), 0.02, theirs)
    np.testing.assert_allclose(bottom[1:], model.a, rtol=1e-8, atol=1e-10)
    np.testing.assert_allclose(top[0], model.b, rtol=1e-8, atol=1e-10)


def test_conversion_of_a_batch_equals_that_of_its_items():
    """Truth: each item by itself, to the last bit of numpy's polynomials (1e-12)."""
    a = np.array([[-0.46, 0.158], [-1.2, 0.5]])
    b = np.array([[0.061, -0.103, 0.033], [0.1, 0.2, -0.1]])
    whole = IirModel(a, b, 1, 0.01)
    for method in ('tustin', 'zoh'):
        for i in range(2):
            one = whole[i].to_continuous(method)
            np.testing.assert_allclose(
                whole.to_continuous(method).denominator[i], one.denominator, rtol=1e-12
            )
            assert one.dead_time == pytest.approx(0.01)


@pytest.mark.parametrize(
    ('a', 'b', 'method', 'message'),
    [
        ([0.5], [1.0], 'zoh', 'negative real axis'),
        ([-0.5], [1.0, 2.0, 3.0], 'zoh', 'use tustin'),
        ([1.0], [1.0], 'tustin', 'z = -1'),
        ([-0.5], [1.0], 'euler', 'euler'),
    ],
)
def test_what_has_no_continuous_equivalent_is_refused_by_name(a, b, method, message):
    """Truth: the logarithm of a negative pole, and the bilinear map of z = -1, do not exist."""
    with pytest.raises(SatvibError, match=message):
        IirModel(a, b, 0, 0.01).to_continuous(method)


def test_frequency_response_equals_scipys(paper):
    """Truth: scipy.signal.freqz times z^-delay (1e-12)."""
    f = np.array([0.5, 3.0, 10.0, 40.0])
    model = IirModel(paper.a, paper.b, 2, 0.01)
    _, h = scipy.signal.freqz(paper.b, paper.denominator, 2 * np.pi * f * 0.01)
    expected = h * np.exp(-2j * np.pi * f * 0.01 * 2)
    np.testing.assert_allclose(model.frequency_response(f), expected, rtol=1e-12)
    assert model.frequency_response(10.0) == pytest.approx(expected[2], rel=1e-12)
    assert float(paper.steady_gain()) == pytest.approx(-0.009 / 0.698, rel=1e-12)


def test_simulation_and_prediction_equal_scipys_filter(paper):
    """Truth: scipy.signal.lfilter from rest; on the model's own output prediction is simulation (1e-12)."""
    generator = np.random.default_rng([4])
    u = generator.normal(size=(3, 200))
    model = IirModel(paper.a, paper.b, 1, 0.01)
    late = np.concatenate([np.zeros((3, 1)), u[:, :-1]], axis=1)
    expected = scipy.signal.lfilter(paper.b, paper.denominator, late)
    y = model.simulate(u)
    np.testing.assert_allclose(y, expected, rtol=0, atol=1e-12)
    np.testing.assert_allclose(model.predict(y, u), y, rtol=0, atol=1e-12)


def test_a_free_run_may_start_from_measured_samples(paper):
    """Truth: a record cut in the middle runs on as it was, given the inputs' past and n outputs (1e-12)."""
    generator = np.random.default_rng([5])
    u = generator.normal(size=100)
    y = paper.simulate(u)
    cut = paper.simulate(u[48:], start=y[48:52])
    np.testing.assert_allclose(cut, y[48:], rtol=0, atol=1e-12)


def test_polarity_is_the_sign_at_once_or_at_a_frequency(paper):
    """Truth: b1 = 0.061 > 0; at 10 Hz Re G < 0 (by freqz); both turn with the sign of b."""
    assert float(paper.polarity()) == 1.0
    assert float(paper.polarity(10.0)) == -1.0
    other = IirModel(paper.a, -paper.b, 1, 0.01)
    assert (float(other.polarity()), float(other.polarity(10.0))) == (-1.0, 1.0)
    assert float(IirModel([0.1], [0.0, -2.0], 0, 0.01).instantaneous_gain()) == -2.0
    assert float(IirModel([0.1], [0.0], 0, 0.01).polarity()) == 0.0


def test_zeros_count_those_at_infinity():
    """Truth: 0 + 1 z^-1 - 0.5 z^-2 has one finite zero at 0.5 and one at infinity."""
    zeros = IirModel([0.0], [0.0, 1.0, -0.5], 0, 1.0).zeros()
    assert zeros[np.isfinite(zeros)] == pytest.approx([0.5])
    assert np.isinf(zeros).sum() == 1


@settings(max_examples=60, deadline=None)
@given(st.lists(st.floats(-3, 3), min_size=1, max_size=8))
def test_pole_modulus_equals_the_largest_root(a):
    """Truth: numpy's roots; of a multiple root they are themselves good to eps^(1/n) only."""
    a = np.array(a)
    expected = np.max(np.abs(np.roots(np.concatenate([[1.0], a])))) if a.any() else 0.0
    multiple = 20 * np.finfo(float).eps ** (1 / len(a))
    assert float(pole_modulus(a)) == pytest.approx(expected, abs=multiple * (1 + expected))


def test_stability_of_a_batch():
    """Truth: by construction of the roots, 0.9 and 1.1; a coefficient that is not a number is not stable."""
    model = IirModel([[-0.9], [-1.1], [np.nan]], [1.0], 0, 1.0)
    assert model.is_stable().tolist() == [True, False, False]
    assert np.isnan(model.poles()[2]).all()


def test_a_model_survives_its_file_to_the_last_bit(tmp_path, paper):
    """Truth: the numbers that went in; a second write is refused."""
    odd = IirModel(paper.a / 3.0, paper.b / 7.0, 2, 1 / 3.0)
    save_model(tmp_path / 'm.yaml', odd, {'record': 'none'})
    back = load_model(tmp_path / 'm.yaml')
    assert back.a.tobytes() == odd.a.tobytes()
    assert back.b.tobytes() == odd.b.tobytes()
    assert (back.delay, back.dt) == (2, 1 / 3.0)
    with pytest.raises(SatvibError, match='exists already, not overwritten'):
        save_model(tmp_path / 'm.yaml', odd)


@pytest.mark.parametrize(
    ('text', 'message'),
    [
        ('format: something', 'is not a model file'),
        ('format: satvib-model-1\nmodel: {a: [1], b: [1], delay: 0}', 'sample_period: missing'),
        (
            'format: satvib-model-1\nmodel: {a: [1], b: [1], delay: 0, sample_period: 1, c: 2}',
            'c: no such key',
        ),
        (
            'format: satvib-model-1\nmodel: {a: [x], b: [1], delay: 0, sample_period: 1}',
            'not numbers',
        ),
        (
            'format: satvib-model-1\nmodel: {a: [.nan], b: [1], delay: 0, sample_period: 1}',
            'not finite',
        ),
        (
            'format: satvib-model-1\nmodel: {a: [1], b: [1], delay: -1, sample_period: 1}',
            'delay: -1',
        ),
        (
            'format: satvib-model-1\nmodel: {a: [1], b: [1], delay: 0, sample_period: 0}',
            'dt: 0',
        ),
    ],
)
def test_a_broken_file_is_refused_by_name(tmp_path, text, message):
    """Truth: each file has one fault, which the message names with the file."""
    path = tmp_path / 'm.yaml'
    path.write_text(text)
    with pytest.raises(SatvibError, match=message) as caught:
        load_model(path)
    assert 'm.yaml' in str(caught.value)
    assert '\n' not in str(caught.value)


def test_roots_inside_a_circle():
    """Truth: numpy.roots; random polynomials of one to five roots, none nearer to the circle than 1e-6."""
    generator = np.random.default_rng([16])
    seen = set()
    for n in (1, 2, 3, 5):
        for _ in range(200):
            a = generator.normal(size=n) * generator.choice([0.2, 0.6, 2.0])
            largest = np.abs(np.roots(np.append(1.0, a))).max()
            if abs(largest - 0.995) < 1e-6:
                continue
            assert inside(a, 0.995) == (largest < 0.995)
            seen.add((n, bool(largest < 0.995)))
    assert len(seen) == 8
    assert not inside(np.array([np.nan, 0.0]), 0.995)
