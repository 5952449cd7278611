# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The centralized scheme of a scenario: gains from a file, geometry from the rig.

scheme: centralized
centralized: {file: gains.yaml}        # or the gains themselves: gains_p, gains_i, gains_d

The controllers of the struts take a file too, `controller: {file: notch.yaml}`.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_plant_sim.rig.any_rig import AnyRig
from satvib_plant_sim.rig.rig import Rig

if TYPE_CHECKING:
    from satvib_control.laws.centralized.parameters import CentralizedParameters

# settings of a strut's controller that say which law it has
_OF_STRUTS = ('law',)


def take_gains(data: dict[str, Any], path: Path) -> None:
    """Put what `centralized.file` and `controller.file` hold in their places; what stands beside them wins.

    Args:
        data: mapping of a scenario, which changes.
        path: of the scenario, to which a relative name refers.

    Raises:
        SatvibError: the file is not one of that section.
    """
    for name in ('centralized', 'controller'):
        section = data.get(name)
        if isinstance(section, Mapping) and 'file' in section:
            data[name] = _with_file(name, section, path)


def _with_file(name: str, section: Mapping[str, Any], path: Path) -> dict[str, Any]:
    own = dict(section)
    given = str(own.pop('file'))
    beside = path.parent / given
    file = beside if beside.exists() else Path(given)
    found = load_yaml(file)
    gains = found.get(name) if isinstance(found, Mapping) else None
    if not isinstance(gains, Mapping):
        raise SatvibError(f'{file}: no gains in it, the key {name} is expected')
    return {**gains, **own}


def geometry_of(rig: AnyRig, where: str) -> dict[str, Any]:
    """Give what the centralized law knows of a rig: how many struts, and where they stand.

    Raises:
        SatvibError: a rig of identified models, which have no places.
    """
    if not isinstance(rig, Rig):
        raise SatvibError(
            f'{where}: scheme: centralized needs a rig with a geometry; {rig.name} is one of '
            'identified models'
        )
    if not rig.struts.each:
        return {'struts': rig.struts.count, 'strut_angles': rig.struts.angles}
    from satvib_plant_sim.rig.payload_shapes import payload_modes

    shapes = payload_modes(rig).strut
    return {'struts': rig.struts.count, 'strut_shapes': [float(v) for v in shapes.ravel()]}


def centralized_parameters(
    name: str,
    rig: AnyRig,
    controller: Mapping[str, Any],
    centralized: Mapping[str, Any],
    shared: Mapping[str, Any],
) -> CentralizedParameters:
    """Give the parameters of the centralized controller of a scenario.

    Args:
        name: of the scenario.
        rig: gives the places of the struts.
        controller: parameters that both schemes have.
        centralized: parameters of this scheme, over those.
        shared: what all nodes of the loop have.

    Raises:
        SatvibError: a parameter does not fit, or the rig has no geometry.
    """
    from satvib_control.laws.centralized.parameters import CentralizedParameters

    own = geometry_of(rig, f'scenario {name}')
    common = {k: v for k, v in controller.items() if k not in _OF_STRUTS}
    return CentralizedParameters.from_mapping(
        {**common, **centralized, **shared, **own}, f'scenario {name}: centralized'
    )
