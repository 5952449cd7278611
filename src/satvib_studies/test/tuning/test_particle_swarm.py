# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Particle swarm: known minima, the box, and that an interruption changes nothing."""

import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from satvib_common.errors import SatvibError
from satvib_studies.tuning.particle_swarm import CHI, ParticleSwarm, SwarmSettings


def sphere(x):
    return np.sum((x - 0.3) ** 2, axis=1)


def rosenbrock(x):
    return np.sum(100.0 * (x[:, 1:] - x[:, :-1] ** 2) ** 2 + (1.0 - x[:, :-1]) ** 2, axis=1)


def rastrigin(x):
    return np.sum(x * x - 10.0 * np.cos(2.0 * math.pi * x) + 10.0, axis=1)


def ackley(x):
    a = np.exp(-0.2 * np.sqrt(np.mean(x * x, axis=1)))
    return 20.0 - 20.0 * a + math.e - np.exp(np.mean(np.cos(2.0 * math.pi * x), axis=1))


@pytest.mark.parametrize(
    ('function', 'half', 'n', 'limit'),
    [
        (sphere, 5.0, 6, 1e-6),
        (rosenbrock, 2.0, 3, 1e-3),
        (rastrigin, 5.12, 3, 1e-3),
        (ackley, 30.0, 5, 1e-3),
    ],
)
def test_known_minima_are_found_in_the_median_of_seeds(function, half, n, limit):
    """The minimum of each function is 0 by its definition; the limits are far below the next local minimum."""
    found = [
        ParticleSwarm([-half] * n, [half] * n, SwarmSettings(seed=seed, budget=12_000))
        .run(function)
        .cost
        for seed in range(5)
    ]
    assert np.median(found) < limit


def test_constriction_is_that_of_clerc_and_kennedy():
    """The published value for phi = 4.1 is 0.7298 (four digits)."""
    assert pytest.approx(0.7298, abs=5e-5) == CHI


@settings(max_examples=25, deadline=None)
@given(st.integers(0, 1000), st.floats(-100.0, 100.0), st.floats(0.01, 50.0), st.floats(0.05, 1.0))
def test_the_swarm_never_leaves_its_box(seed, low, width, limit):
    """By definition of reflecting bounds, and so do velocities of their clamp; the optimum is outside the box."""
    upper = low + width
    swarm = ParticleSwarm(
        [low] * 3, [upper] * 3, SwarmSettings(seed=seed, particles=8, velocity_limit=limit)
    )
    for _ in range(20):
        swarm.step(lambda x: np.sum(x, axis=1))
        assert (swarm.position >= low).all()
        assert (swarm.position <= upper).all()
        assert (np.abs(swarm.velocity) <= limit * (upper - low) * (1.0 + 1e-12)).all()


def test_the_whole_swarm_is_one_call():
    """Counted: one call per step, each with all particles."""
    calls = []

    def counted(x):
        calls.append(x.shape)
        return sphere(x)

    result = ParticleSwarm(
        [-1.0, -1.0], [1.0, 1.0], SwarmSettings(particles=10, budget=95, patience=0)
    ).run(counted)
    assert calls == [(10, 2)] * 9
    assert result.evaluations == 90
    assert result.reason == 'budget'


def test_an_interrupted_search_ends_like_one_that_was_not(tmp_path: Path):
    """The uninterrupted run is the truth, bit for bit, over several restarts of the swarm."""
    chosen = SwarmSettings(seed=3, particles=8, budget=1600, stagnation=4, patience=0)
    box = [-5.12] * 3, [5.12] * 3
    whole = ParticleSwarm(*box, chosen).run(rastrigin)
    file = tmp_path / 'swarm.npz'
    ParticleSwarm(*box, chosen.replace(budget=800)).run(rastrigin, checkpoint=file)
    resumed = ParticleSwarm(*box, chosen).run(rastrigin, checkpoint=file)
    assert np.array_equal(whole.history, resumed.history)
    assert np.array_equal(whole.position, resumed.position)
    assert whole.cost == resumed.cost


def test_a_kill_while_the_checkpoint_is_written_leaves_the_old_one(tmp_path: Path, monkeypatch):
    """The old file is the truth, byte for byte."""
    file = tmp_path / 'swarm.npz'
    swarm = ParticleSwarm([0.0], [1.0], SwarmSettings(particles=4, budget=40))
    swarm.run(sphere, checkpoint=file)
    before = file.read_bytes()

    def full(*_args, **_kwargs):
        raise OSError(28, 'No space left on device')

    monkeypatch.setattr(np, 'savez', full)
    again = ParticleSwarm([0.0], [1.0], SwarmSettings(particles=4, budget=80))
    with pytest.raises(SatvibError, match='cannot be written: No space left'):
        again.run(sphere, checkpoint=file)
    assert file.read_bytes() == before
    assert list(tmp_path.iterdir()) == [file]


def test_checkpoints_that_are_broken_or_of_another_search_are_refused(tmp_path: Path):
    """One line that names the file; the file is left alone."""
    file = tmp_path / 'swarm.npz'
    chosen = SwarmSettings(particles=4, budget=40)
    ParticleSwarm([0.0], [1.0], chosen).run(sphere, checkpoint=file)
    good = file.read_bytes()
    with pytest.raises(SatvibError, match=r'swarm\.npz: a checkpoint of another search, seed'):
        ParticleSwarm([0.0], [1.0], chosen.replace(seed=9)).run(sphere, checkpoint=file)
    with pytest.raises(SatvibError, match='another search, upper'):
        ParticleSwarm([0.0], [2.0], chosen).run(sphere, checkpoint=file)
    for bad in (good[: len(good) // 2], b'', b'PK\x03\x04 nothing', b'text'):
        file.write_bytes(bad)
        with pytest.raises(SatvibError, match=r'swarm\.npz: not a checkpoint') as caught:
            ParticleSwarm([0.0], [1.0], chosen).run(sphere, checkpoint=file)
        assert '\n' not in str(caught.value)
        assert file.read_bytes() == bad


def test_it_stops_at_the_target_and_when_rounds_bring_nothing():
    """A constant cost brings no gain by definition; the sphere passes 1e-2 long before the budget."""
    box = [-1.0, -1.0], [1.0, 1.0]
    flat = ParticleSwarm(*box, SwarmSettings(stagnation=3, patience=2)).run(
        lambda x: np.ones(len(x))
    )
    assert flat.reason == 'tolerance'
    assert flat.evaluations < 1000
    good = ParticleSwarm(*box, SwarmSettings(target=1e-2)).run(sphere)
    assert good.reason == 'target'
    assert good.cost <= 1e-2
    assert (np.diff(good.history[:, 1]) <= 0.0).all()


def test_a_cost_that_is_no_number_is_never_the_best():
    """The only finite region is x > 0; the minimum there is 0.3 in each coordinate."""

    def half(x):
        return np.where((x > 0.0).all(axis=1), sphere(x), np.nan)

    result = ParticleSwarm([-1.0] * 2, [1.0] * 2, SwarmSettings(budget=3000)).run(half)
    assert result.position == pytest.approx([0.3, 0.3], abs=1e-3)


def test_neighbours_on_a_ring_are_the_best_of_three():
    """Counted by hand for six particles."""
    swarm = ParticleSwarm([0.0], [1.0], SwarmSettings(particles=6, neighbours=1))
    swarm.best_cost = np.array([5.0, 1.0, 4.0, 3.0, 6.0, 2.0])
    assert swarm._leaders().tolist() == [1, 1, 1, 3, 5, 5]


def test_a_start_is_part_of_the_first_swarm_and_bad_boxes_are_refused():
    """Its cost bounds the result; boxes that are none are named."""
    swarm = ParticleSwarm(
        [-1.0] * 2, [1.0] * 2, SwarmSettings(particles=4, budget=4), start=[0.3, 0.3]
    )
    assert swarm.run(sphere).cost == 0.0
    with pytest.raises(SatvibError, match='bounds 1 and 0 of coordinate 1'):
        ParticleSwarm([0.0, 1.0], [1.0, 0.0])
    with pytest.raises(SatvibError, match='outside the bounds'):
        ParticleSwarm([0.0], [1.0], start=[2.0])
    with pytest.raises(SatvibError, match='the cost has the shape'):
        ParticleSwarm([0.0], [1.0]).step(lambda x: x)
