# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The linear fine step in vector instructions, written down because the compiler does not find them by itself.

y = step^T x + chains, four rows at a time; each row is one chain of fused multiply-adds, fma(a, b, c) = a b + c rounded
once (IEEE 754), in the order of `order`. A processor without fma computes the very same bits, slowly; so does
`fine_step.any_step`, row by row.
"""

from typing import Any

from satvib_common.kernels.deferred import intrinsic, njit

from satvib_plant_sim.stepping.design import WIDTH, Layout


@intrinsic
def _fused() -> Any:
    from numba import types
    from numba.extending import intrinsic

    @intrinsic
    def fused(typing_context, a, b, c):  # noqa: ARG001
        def generate(context, builder, signature, values):  # noqa: ARG001
            return builder.fma(*values)

        return types.float64(types.float64, types.float64, types.float64), generate

    return fused


@njit
def fma(a, b, c):
    """a b + c, rounded once."""  # noqa: D403
    return _fused(a, b, c)


def order(layout: Layout) -> list[int]:
    """Slots of x in the order in which they are added: what drives first, for it is known before the state is."""
    size = layout.state
    return [*range(size, size + layout.inputs), *range(size)]


def vector_step(layout: Layout, stages: int) -> Any:
    """Make the compiled function (step, chain, x, y) for a layout and sensor chains of some stages.

    `step` is (d, R), `chain` (stages, stages), x and y (R); all of them dense, y not x. Slots of y between the states
    and the chains are filled with nothing of use.
    """

    @intrinsic
    def machine() -> Any:
        from numba import types
        from numba.extending import intrinsic

        @intrinsic
        def one_step(typing_context, step, chain, x, y):  # noqa: ARG001
            def generate(context, builder, signature, values):
                pointers = [
                    context.make_array(kind)(context, builder, value).data
                    for kind, value in zip(signature.args, values, strict=True)
                ]
                _write(builder, pointers, layout, stages)
                return context.get_dummy_value()

            return types.void(step, chain, x, y), generate

        return one_step

    @njit
    def fixed(step, chain, x, y):
        machine(step, chain, x, y)

    return fixed


def _write(builder: Any, pointers: list[Any], layout: Layout, stages: int) -> None:
    """Write the instructions of one step."""
    from llvmlite import ir
    from numba.core import cgutils

    step, chain, x, y = pointers
    driven, lanes, rows = layout.driving, layout.lanes, layout.rows(stages)
    vector = ir.VectorType(ir.DoubleType(), WIDTH)
    nothing = ir.Constant(vector, ir.Undefined)
    first = ir.Constant(ir.VectorType(ir.IntType(32), WIDTH), [0] * WIDTH)
    fused = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(vector, [vector] * 3), f'llvm.fma.v{WIDTH}f64'
    )

    def place(pointer: Any, index: int) -> Any:
        return builder.gep(pointer, [ir.Constant(ir.IntType(64), index)])

    def load(pointer: Any, index: int) -> Any:
        return builder.load(builder.bitcast(place(pointer, index), vector.as_pointer()), align=8)

    def spread(pointer: Any, index: int) -> Any:
        value = builder.load(place(pointer, index))
        one = builder.insert_element(nothing, value, ir.Constant(ir.IntType(32), 0))
        return builder.shuffle_vector(one, nothing, first)

    driving = {c: spread(x, c) for c in order(layout)}
    within = [[spread(chain, p * stages + q) for q in range(stages)] for p in range(stages)]
    past = {r: load(x, r) for r in range(driven, rows, WIDTH)}
    results = []
    chains = range(driven, rows, WIDTH)
    for r in (*range(0, layout.state, WIDTH), *chains):
        lead, *others = order(layout)
        total = builder.fmul(load(step, lead * rows + r), driving[lead])
        for c in others:
            total = builder.call(fused, [load(step, c * rows + r), driving[c], total])
        if r in chains:
            p, lane = divmod(r - driven, lanes)
            for q in range(stages):
                total = builder.call(fused, [within[p][q], past[driven + lanes * q + lane], total])
        results.append((r, total))
    for r, total in results:
        builder.store(total, builder.bitcast(place(y, r), vector.as_pointer()), align=8)
