# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parameter file that comes with the package is the one that people start from: it must load."""

from pathlib import Path

from satvib_common.files.yaml_file import load_yaml
from satvib_daq_bridge.parameters import BridgeParameters

FILE = Path(__file__).resolve().parents[1] / 'config/daq_bridge.yaml'


def test_the_parameter_file_loads():
    """Truth: the schema. Every key is known and has its default; only the channels are missing, which have none."""
    values = load_yaml(FILE)['/**']['ros__parameters']
    loaded = BridgeParameters.from_mapping(values | {'channels': 'my_rig.yaml'}, str(FILE))
    assert loaded == BridgeParameters(channels='my_rig.yaml')
    assert set(values) | {'channels'} == set(BridgeParameters.__dataclass_fields__)
