# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Excitation signals: limits, spectra, struts that do not disturb one another, and the designer."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_ident.excitation import SIGNALS, make_excitation
from satvib_ident.excitation.designer import ExcitationTask, design_excitation
from satvib_ident.excitation.multisine import Multisine
from satvib_ident.excitation.prbs import TAPS, Prbs


@settings(max_examples=40, deadline=None)
@given(
    st.sampled_from(list(SIGNALS)),
    st.floats(0.0, 20.0),
    st.sampled_from([50.0, 100.0, 200.0, 1000.0]),
    st.integers(0, 2),
    st.integers(0, 5),
)
def test_no_signal_exceeds_its_amplitude_and_each_repeats_itself(
    name, amplitude, rate, strut, seed
):
    """Truth: |u| <= amplitude (1e-12 of it), and two objects of one description give the same bits."""
    options = {'high': 0.4 * rate} if 'high' in SIGNALS[name].__dataclass_fields__ else {}
    make = [
        make_excitation(name, amplitude=amplitude, dt=1 / rate, strut=strut, seed=seed, **options)
        for _ in range(2)
    ]
    u = make[0].samples(300)
    assert np.abs(u).max() <= amplitude * (1 + 1e-12)
    assert np.array_equal(u, make[1].samples(300))
    assert u[123] == make[0].at(123)


def test_the_papers_squares():
    """Truth: by hand at 100 Hz, amplitude 2: over the quarters of a second the signs of 1 Hz and 2 Hz are ++, +-, -+,
    --, which add to 2, 0, 0 and -2 V.
    """
    u = make_excitation('squares', amplitude=2.0, dt=0.01).samples(200)
    expected = np.repeat([2.0, 0.0, 0.0, -2.0], 25)
    assert np.array_equal(u, np.tile(expected, 2))


def test_sines_are_sines():
    """Truth: the formula (1e-12)."""
    u = make_excitation('sines', amplitude=3.0, dt=0.01, frequencies=[1.0, 2.0]).samples(100)
    t = np.arange(100) * 0.01
    np.testing.assert_allclose(u, 1.5 * (np.sin(2 * np.pi * t) + np.sin(4 * np.pi * t)), atol=1e-12)


@pytest.mark.parametrize('order', [o for o in TAPS if o <= 12])
def test_a_prbs_is_of_maximal_length(order):
    """Truth: the autocorrelation of such a sequence is N at 0 and -1 elsewhere, exactly."""
    bits = np.array(Prbs(amplitude=1.0, dt=0.01, order=order).bits, dtype=float)
    spectrum = np.fft.fft(bits)
    r = np.round(np.fft.ifft(np.abs(spectrum) ** 2).real, 6)
    assert r[0] == 2**order - 1
    assert (r[1:] == -1.0).all()


def test_a_prbs_holds_each_bit_for_its_clock():
    """Truth: with a clock of 5, changes happen at multiples of 5 only, and somewhere there."""
    u = make_excitation('prbs', amplitude=1.0, dt=0.01, clock=5).samples(500)
    changes = np.flatnonzero(np.diff(u)) + 1
    assert changes.size > 20
    assert (changes % 5 == 0).all()


def test_the_crest_factor_of_a_multisine_is_low():
    """Truth: peak over RMS, by numpy; 1.5 and below is what the literature reports, random phases give 2.5 to 3.5."""
    u = make_excitation('multisine', amplitude=1.0, dt=0.01, struts=1, low=1.0, high=25.0).samples(
        200
    )
    assert np.abs(u).max() / u.std() < 1.5


def test_a_multisine_has_equal_lines_in_its_band_and_none_elsewhere():
    """Truth: the discrete Fourier transform of one period (1e-12)."""
    signal = Multisine(amplitude=1.0, dt=0.01, struts=1, low=2.0, high=20.0, period=2.0)
    lines = np.abs(np.fft.rfft(signal.samples(200)))
    inside = lines[4:41]
    np.testing.assert_allclose(inside, inside[0], rtol=1e-12)
    assert np.delete(lines, np.arange(4, 41)).max() < 1e-12 * inside[0]


def test_multisines_of_different_struts_are_orthogonal_at_every_lag():
    """Truth: no common line, so the circular cross-correlation over a period is 0 (1e-12 of the power)."""
    u = [
        make_excitation('multisine', amplitude=1.0, dt=0.01, strut=s).samples(200) for s in range(3)
    ]
    for i, j in ((0, 1), (0, 2), (1, 2)):
        cross = np.fft.irfft(np.fft.rfft(u[i]) * np.conj(np.fft.rfft(u[j])), 200)
        assert np.abs(cross).max() < 1e-12 * np.sum(u[i] ** 2)


@pytest.mark.parametrize('name', list(SIGNALS))
def test_struts_get_different_signals(name):
    """Truth: over 2 s no pair correlates by more than 0.6 at lag 0."""
    u = [make_excitation(name, amplitude=1.0, dt=0.01, strut=s).samples(200) for s in range(3)]
    assert np.abs(np.corrcoef(u) - np.eye(3)).max() < 0.6


def test_random_noise_stays_in_its_band():
    """Truth: the spectrum over a full period; clipping at three deviations leaks less than 1 % of the power."""
    signal = make_excitation('random', amplitude=1.0, dt=0.01, low=5.0, high=20.0)
    u = signal.samples(6000)
    power = np.abs(np.fft.rfft(u)) ** 2
    f = np.fft.rfftfreq(6000, 0.01)
    outside = power[(f < 4.99) | (f > 20.01)].sum()
    assert outside < 0.01 * power.sum()


def test_a_chirp_runs_from_low_to_high():
    """Truth: zero crossings: the sweep from 1 to 25 Hz in 2 s makes 26 turns, so 52 of them (+-1 for the ends)."""
    u = make_excitation('chirp', amplitude=1.0, dt=0.001, low=1.0, high=25.0, period=2.0).samples(
        2000
    )
    assert abs(np.sum(np.diff(np.sign(u)) != 0) - 52) <= 1


def test_the_designer_keeps_the_stroke():
    """Truth: the motion of the designed signal by scipy.signal.lsim on the same strut, after eleven periods of
    start-up, stays below the stroke limit and equals the predicted peak (3 %: sampling between the grids).
    """
    import scipy.signal

    task = ExcitationTask(sample_rate=200.0, natural_frequency=9.0, damping=0.05, gain=1.2)
    design = design_excitation(task)
    assert design.limited_by == 'stroke'
    signal = make_excitation(design.name, **design.options)
    fine = np.fft.irfft(
        np.concatenate([np.fft.rfft(signal.values), np.zeros(9 * signal.count // 2)]),
        10 * signal.count,
    )
    u = np.tile(10.0 * fine, 12)
    wn = 2 * np.pi * 9.0
    system = ([1.2], [1.0, 2 * 0.05 * wn, wn * wn])
    _, x, _ = scipy.signal.lsim(system, u, np.arange(len(u)) * signal.dt / 10)
    peak = np.abs(x[-10 * signal.count :]).max()
    assert peak < task.stroke_limit
    assert peak == pytest.approx(design.peak_stroke, rel=0.03)


def test_the_designer_uses_the_voltage_where_the_stroke_allows():
    """Truth: the paper's stiff strut: 16 V (20 V less the margin) move it by about a millimetre of 7.6."""
    task = ExcitationTask(sample_rate=100.0, natural_frequency=20.9, damping=0.79, struts=3)
    design = design_excitation(task)
    assert design.limited_by == 'voltage'
    assert design.options['amplitude'] == pytest.approx(16.0)
    assert design.peak_stroke < 2e-3
    assert design.line_to_noise >= 3.0
    assert (
        design.options['low'] > 1.0
    )  # at 1 Hz a stiff strut's acceleration drowns in 10 mg of noise


def test_the_designer_says_when_noise_hides_everything():
    """Truth: 1000 m/s^2 of noise against an acceleration of a few m/s^2."""
    with pytest.raises(SatvibError, match=r'noise: 1000.0 m/s\^2 hides every line'):
        design_excitation(ExcitationTask(sample_rate=200.0, noise=1000.0))


@pytest.mark.parametrize(
    ('name', 'options', 'message'),
    [
        ('sqares', {}, 'did you mean squares'),
        ('squares', {'frequencies': [60.0]}, '60.0 Hz is not below half the sample rate'),
        ('squares', {'frequencies': []}, 'at least one'),
        ('squares', {'amplitude': -1.0}, 'amplitude: -1.0 is less than 0.0 V'),
        ('prbs', {'clock': 0}, 'clock'),
        ('prbs', {'order': 2}, 'order: 2 is not one of'),
        ('prbs', {'clok': 2}, 'did you mean clock'),
        ('multisine', {'low': 30.0, 'high': 20.0}, 'no multiple'),
        ('multisine', {'low': 1.0, 'high': 1.5}, 'too few for 3 struts'),
        ('random', {'high': 50.0}, 'not below half'),
        ('chirp', {'high': 50.0}, 'not below half'),
    ],
)
def test_bad_settings_are_refused_by_name(name, options, message):
    """Truth: each description has one fault."""
    with pytest.raises(SatvibError, match=message):
        make_excitation(name, **({'amplitude': 1.0, 'dt': 0.01} | options))


def test_struts_take_turns():
    """Truth: the signal itself, from its first sample on in each turn of its strut, and 0 V in the other turns."""
    options = {'amplitude': 2.0, 'dt': 0.01, 'interleave': False}
    plain = [make_excitation('multisine', strut=s, **options).samples(150) for s in range(3)]
    turns = [make_excitation('multisine', strut=s, turn=1.5, **options) for s in range(3)]
    for s, signal in enumerate(turns):
        expected = np.zeros(900)
        expected[150 * s : 150 * (s + 1)] = expected[450 + 150 * s : 600 + 150 * s] = plain[s]
        assert np.array_equal(signal.samples(900), expected)
