# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Models as YAML files: what `satvib identify --save` writes, and a rig or a controller loads."""

from pathlib import Path
from typing import Any

import yaml
from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml

from satvib_ident.models.iir_model import IirModel

_FORMAT = 'satvib-model-1'


def save_model(path: Path, model: IirModel, about: dict[str, Any] | None = None) -> None:
    """Write a model; never over an existing file.

    Args:
        path: the file.
        model: the model, single or a batch.
        about: plain data on where it comes from, kept under `about` for people.

    Raises:
        SatvibError: the file exists, or cannot be written.
    """
    data = {'format': _FORMAT, 'model': model.to_mapping(), 'about': about or {}}
    try:
        with path.open('x', encoding='utf-8') as file:
            yaml.safe_dump(data, file, sort_keys=False)
    except FileExistsError:
        raise SatvibError(f'{path}: exists already, not overwritten') from None
    except OSError as error:
        raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None


def load_model(path: Path) -> IirModel:
    """Read a model that `save_model` wrote.

    Raises:
        SatvibError: the file is missing, or is no such model.
    """
    data = load_yaml(path)
    if not isinstance(data, dict) or data.get('format') != _FORMAT or 'model' not in data:
        raise SatvibError(f'{path}: is not a model file (format: {_FORMAT} and model are expected)')
    return IirModel.from_mapping(data['model'], str(path))
