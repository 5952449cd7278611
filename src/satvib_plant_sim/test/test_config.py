# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parameter files that come with the package are the ones that people start from: they must load."""

from pathlib import Path

import pytest
from satvib_common.files.yaml_file import load_yaml
from satvib_plant_sim.nodes.parameters import PlantParameters

FILES = sorted((Path(__file__).resolve().parents[1] / 'config').glob('*.yaml'))


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.name)
def test_a_parameter_file_loads(path):
    """Truth: the schema. Every key is known and every value has its default, which the file documents."""
    values = load_yaml(path)['/**']['ros__parameters']
    loaded = PlantParameters.from_mapping(values, str(path))
    for name in values:
        if name != 'disturbance':  # an example
            assert getattr(loaded, name) == getattr(PlantParameters(), name), name
