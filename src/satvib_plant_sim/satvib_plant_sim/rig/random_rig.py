# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Random rigs around a nominal one. Three studies need three different spreads; all of them are here.

| value | `random_parts` | `random_build` | `random_payload` |
|---|---|---|---|
| payload mass | | +-30 % | +-30 % |
| stiffness, common | | +-20 % | +-30 % |
| stiffness, each strut | +-5 % | +-10 % | |
| damping | +-30 % | +-30 % | |
| force constant | +-10 % each coil | +-10 % each coil | +-10 % |
| resistance, inductance | | | +-12.5 %, +-30 % |
| latency | | 0 to +1 ms | +-1 ms |

All values are uniform. A rig depends on the state of the generator alone, so the caller's seed decides which rig it is.
"""

from collections.abc import Sequence

import numpy as np
from satvib_common.arrays import Array

from satvib_plant_sim.rig.rig import Rig


def random_parts(rig: Rig, draw: np.random.Generator) -> Rig:
    """Give a rig whose parts differ from the nominal ones within their tolerances."""
    size = _factors(rig)
    stiffness, force = draw.uniform(-0.05, 0.05, size), draw.uniform(-0.1, 0.1, size)
    damping = rig.struts.damping * (1.0 + 0.3 * draw.uniform(-1.0, 1.0))
    return rig.replace(
        struts=rig.struts.replace(
            stiffness_scale=_scaled(rig.struts.stiffness_scale, 1.0 + stiffness),
            damping=float(damping),
        ),
        coil=rig.coil.replace(force_scale=_scaled(rig.coil.force_scale, 1.0 + force)),
    )


def random_build(rig: Rig, draw: np.random.Generator) -> Rig:
    """Give another rig that is built from the same drawing, with another payload."""

    def spread(part: float, size: int) -> Array:
        factors: Array = 1.0 + part * draw.uniform(-1.0, 1.0, size)
        return factors

    payload, common, damping = (float(spread(part, 1)[0]) for part in (0.3, 0.2, 0.3))
    own, force = spread(0.1, _factors(rig)), spread(0.1, _factors(rig))
    late = float(draw.uniform(0.0, 1e-3))
    inertia, tensor = rig.payload.inertia, rig.payload.inertia_tensor
    common_scale = [s * common for s in rig.struts.stiffness_scale]
    return rig.replace(
        payload=rig.payload.replace(
            mass=rig.payload.mass * payload,
            inertia=None if inertia is None else inertia * payload,
            inertia_tensor=None if tensor is None else tuple(t * payload for t in tensor),
        ),
        struts=rig.struts.replace(
            stiffness_scale=_scaled(common_scale, own), damping=rig.struts.damping * damping
        ),
        coil=rig.coil.replace(force_scale=_scaled(rig.coil.force_scale, force)),
        acquisition=rig.acquisition.replace(input_delay=rig.acquisition.input_delay + late),
    )


def random_payload(rig: Rig, draw: np.random.Generator) -> Rig:
    """Give a rig with another payload, other springs, another coil and another latency; its struts are alike."""

    def about(value: float, part: float) -> float:
        return value * (1.0 + part * (2.0 * float(draw.random()) - 1.0))

    mass, tensor = about(rig.payload.mass, 0.3), rig.payload.inertia_tensor
    payload = rig.payload.replace(
        mass=mass,
        inertia_tensor=None
        if tensor is None
        else tuple(t * (mass / rig.payload.mass) for t in tensor),
    )
    struts = rig.struts.replace(stiffness=about(rig.struts.stiffness, 0.3))
    coil = rig.coil.replace(
        force_constant=about(rig.coil.force_constant, 0.1),
        resistance=about(rig.coil.resistance, 0.125),
        inductance=about(rig.coil.inductance, 0.3),
    )
    late = rig.acquisition.input_delay + 1e-3 * (2.0 * float(draw.random()) - 1.0)
    acquisition = rig.acquisition.replace(input_delay=max(late, 0.0))
    return rig.replace(payload=payload, struts=struts, coil=coil, acquisition=acquisition)


def _factors(rig: Rig) -> int:
    """How many factors are drawn for the struts: three also where there is one strut."""
    return max(rig.struts.count, 3)


def _scaled(scale: Sequence[float], factors: Array) -> tuple[float, ...]:
    """Multiply the factors of each strut; `scale` may be longer than the rig has struts, or shorter than three."""
    return tuple(float(s * f) for s, f in zip(scale, factors, strict=False))
