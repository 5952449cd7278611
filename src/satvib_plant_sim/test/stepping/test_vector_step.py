# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The written-down machine code against the plain loop."""

import math
from fractions import Fraction

import numpy as np
import pytest
from satvib_common.kernels.deferred import for_compiler
from satvib_plant_sim.physics.state import Size
from satvib_plant_sim.rig.rig import load_rig
from satvib_plant_sim.stepping.design import layout_of
from satvib_plant_sim.stepping.discretize import discretize
from satvib_plant_sim.stepping.fine_step import any_step
from satvib_plant_sim.stepping.vector_step import fma, order, vector_step

CIRCLE = {n: layout_of(Size(struts=n, plate=1, payload=1)) for n in (1, 3)}
SIX = layout_of(Size(struts=6, plate=6, payload=6))


@pytest.mark.parametrize('layout', [*CIRCLE.values(), SIX], ids=['1', '3', '6'])
@pytest.mark.parametrize('stages', [2, 3, 5])
def test_vector_step_has_the_bits_of_the_plain_loop(layout, stages):
    """Truth: `any_step`, the same sums written as a plain loop; equal in every bit, over 200 random steps."""
    rng = np.random.default_rng([1, layout.state, stages])
    size, rows = layout.state, layout.rows(stages)
    step = rng.normal(size=(layout.driving, rows))
    step[size + layout.inputs :] = 0.0
    chain = rng.normal(size=(stages, stages))
    # as a kernel has them: compiled
    fast, loop = for_compiler(vector_step(layout, stages)), for_compiler(any_step)
    used = [*range(size), *range(layout.driving, rows)]
    for _ in range(200):
        x = rng.normal(size=rows) * 10.0 ** rng.integers(-8, 8, rows)
        y, plain = np.zeros(rows), np.zeros(rows)
        fast(step, chain, x, y)
        loop(step, chain, x, plain, size, layout.inputs)
        assert y[used].tobytes() == plain[used].tobytes()


def test_the_plain_loop_is_the_matrix_product():
    """Truth: numpy's product of a rig's own arrays, summed with math.fsum; 1e-13 of the largest term."""
    design = discretize(load_rig('paper_3dof')).arrays
    rng = np.random.default_rng(2)
    layout = CIRCLE[3]
    stages, size, driving = len(design.chain), layout.state, layout.driving
    x = rng.normal(size=layout.rows(stages))
    x[size + layout.inputs] = 0.0
    step = design.step.copy()
    step[size : size + 2] = rng.normal(size=(2, step.shape[1]))
    y = np.zeros_like(x)
    for_compiler(any_step)(step, design.chain, x, y, size, layout.inputs)
    for r in (*range(size), *range(driving, len(x))):
        terms = [step[c, r] * x[c] for c in order(layout)]
        if r >= driving:
            p, lane = divmod(r - driving, layout.lanes)
            terms += [
                design.chain[p, q] * x[driving + layout.lanes * q + lane] for q in range(stages)
            ]
        assert abs(y[r] - math.fsum(terms)) <= 1e-13 * max(map(abs, terms))


def test_fma_rounds_once():
    """Truth: exact rational arithmetic, rounded once by float(); equal in every bit where two roundings differ."""
    rng = np.random.default_rng(3)
    a, b = rng.normal(size=300), rng.normal(size=300)
    c = -a * b  # what is left is the rounding error of the product alone
    exact = [
        float(Fraction(x) * Fraction(y) + Fraction(z)) for x, y, z in zip(a, b, c, strict=True)
    ]
    compiled = for_compiler(fma)
    found = [compiled(x, y, z) for x, y, z in zip(a, b, c, strict=True)]
    assert found == exact
    assert any(value != 0.0 for value in found)
