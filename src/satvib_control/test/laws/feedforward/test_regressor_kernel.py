# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The regressor and its filtered twin, against SciPy."""

import numpy as np
from satvib_control.laws.feedforward.regressor_kernel import (
    Contents,
    RegressorState,
    motion_coefficients,
    response_table,
    run_regressor,
)
from scipy.signal import bilinear, freqz, lfilter

RATE, CORNER = 200.0, 0.5
NUM, DEN = np.array([0.0, 0.6, -0.2]), np.array([1.0, -0.7, 0.3])


def motion_filters():
    """s / (s + w)^2 and s / (s + w)^3 by SciPy's bilinear transform, scaled by 2 pi 10 rad/s."""
    w, scale = 2 * np.pi * CORNER, 2 * np.pi * 10.0
    return (
        bilinear([scale, 0.0], [1.0, 2 * w, w * w], RATE),
        bilinear([scale**2, 0.0], [1.0, 3 * w, 3 * w * w, w**3], RATE),
    )


def test_taps_motion_and_filtered_twins_equal_scipy():
    """Truth: scipy.signal.lfilter and bilinear. 1e-9 of the largest value of each."""
    rng = np.random.default_rng(1)
    lower, applied = rng.standard_normal((2, 400))
    reaction = np.array([0.1, -0.2, 0.05])
    x = lower - lfilter(reaction, [1.0], applied)
    contents = Contents(4, 1, 0)
    state = RegressorState.zeros(contents, reaction=3, path=3, shape=())
    reference, effect = run_regressor(
        lower, applied, np.zeros(400), reaction, NUM, DEN, motion_coefficients(CORNER, 1 / RATE),
        np.array(contents), np.zeros(6), *state,
    )  # fmt: skip
    np.testing.assert_allclose(reference, x, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(effect, lfilter(NUM, DEN, applied), rtol=1e-9, atol=1e-12)
    # the reference passes one more sample of delay than a voltage that is one sample old
    through = lfilter(NUM, DEN, np.concatenate([[0.0], x[:-1]]))
    for row, signal in ((state.regressor, x), (state.filtered, through)):
        np.testing.assert_allclose(row[:4], signal[:-5:-1], rtol=1e-9, atol=1e-12)
        for i, (b, a) in enumerate(motion_filters()):
            full = lfilter(b, a, signal)
            assert abs(row[4 + i] - full[-1]) < 1e-9 * np.abs(full).max()


def test_the_table_holds_the_responses_of_the_regressor():
    """Truth: scipy.signal.freqz of the same filters. 1e-9 relative."""
    f = np.array([0.01, 0.05, 0.2, 0.5])
    table = response_table(Contents(3, 1, 2), CORNER, 1 / RATE, f)
    found = table[..., 0] + 1j * table[..., 1]
    z = np.exp(-2j * np.pi * f)
    wanted = [z**0, z, z**2]
    wanted += [freqz(b, a, 2 * np.pi * f)[1] for b, a in motion_filters()]
    wanted += [z, z**2]
    np.testing.assert_allclose(found, np.stack(wanted, axis=-1), rtol=1e-9, atol=1e-9)


def test_a_constant_reference_gives_no_motion():
    """Truth: both integrators have a zero at z = 1; below 1e-9 after 30 s, whatever the bias."""
    contents = Contents(2, 1, 0)
    state = RegressorState.zeros(contents, reaction=1, path=3, shape=())
    run_regressor(
        np.full(6000, 3.0), np.zeros(6000), np.zeros(6000), np.zeros(1), NUM, DEN,
        motion_coefficients(CORNER, 1 / RATE), np.array(contents), np.zeros(4), *state,
    )  # fmt: skip
    assert np.abs(state.regressor[2:]).max() < 1e-9


def test_one_run_is_the_samples_one_by_one_for_any_batch():
    """Truth: the same kernel, sample by sample and item by item. Exact."""
    rng = np.random.default_rng(2)
    lower, applied, own = rng.standard_normal((3, 2, 3, 50))
    contents = Contents(3, 1, 2)
    rest = (
        np.array([0.1, 0.2]), NUM, DEN, motion_coefficients(CORNER, 1 / RATE), np.array(contents),
        np.array([0.1, 0.2, 0.3, 0.4, 0.5, 0.6, -0.3]),
    )  # fmt: skip

    def empty(shape):
        return RegressorState.zeros(contents, reaction=2, path=3, shape=shape)

    whole = empty((2, 3))
    reference, effect = run_regressor(lower, applied, own, *rest, *whole)
    for i in np.ndindex(2, 3):
        alone = empty(())
        for k in range(50):
            at = slice(k, k + 1)
            r, e = run_regressor(lower[i][at], applied[i][at], own[i][at], *rest, *alone)
            assert r[0] == reference[i][k]
            assert e[0] == effect[i][k]
        for one, all_of_it in zip(alone, whole, strict=True):
            assert np.array_equal(one, all_of_it[i])
