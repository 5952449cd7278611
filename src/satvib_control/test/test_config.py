# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parameter files that come with the package are the ones that people start from: they must load."""

from pathlib import Path

import pytest
from satvib_common.files.yaml_file import load_yaml
from satvib_control.laws.centralized.parameters import CentralizedParameters
from satvib_control.parameters import ControllerParameters
from satvib_control.supervision.parameters import SupervisorParameters

SCHEMAS = {
    'strut_controller': ControllerParameters,
    'centralized_controller': CentralizedParameters,
    'supervisor': SupervisorParameters,
}
FILES = sorted((Path(__file__).resolve().parents[1] / 'config').glob('*.yaml'))


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.name)
def test_a_parameter_file_loads(path):
    """Truth: the schema. Every key is known and every value has its default, which the file documents."""
    values = load_yaml(path)['/**']['ros__parameters']
    schema = SCHEMAS[path.stem]
    loaded = schema.from_mapping(values, str(path))
    for name in values:
        assert getattr(loaded, name) == getattr(schema(), name), name
