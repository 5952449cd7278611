# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A rig of either kind: mechanical (`Rig`), or made of identified models (`IirRig`)."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from satvib_common.errors import SatvibError
from satvib_common.files.yaml_file import load_yaml
from satvib_common.settings_text import change_existing

from satvib_plant_sim.rig.identified_rig import IirRig
from satvib_plant_sim.rig.rig import Rig, load_rig, read_rig

AnyRig = Rig | IirRig

_MODEL_FORMAT = 'satvib-model-1'


def load_any_rig(name_or_path: str | Path, overrides: Mapping[str, Any] | None = None) -> AnyRig:
    """Load a rig of either kind, as `load_rig` does; the models' files are read too.

    Raises:
        SatvibError: as `load_rig`; a model that is missing, unstable, or of another sample rate.
    """
    data, where = read_rig(name_or_path)
    if data.get('plant') != 'iir':
        return load_rig(name_or_path, overrides)
    models = data.get('models')
    rate = (data.get('acquisition') or {}).get('sample_rate')
    if isinstance(models, list):
        folder = Path(name_or_path).parent
        data = {**data, 'models': [_read_model(m, folder, rate, where) for m in models]}
    rig = IirRig.from_mapping({'name': Path(name_or_path).stem, **data}, where)
    if not overrides:
        return rig
    return IirRig.from_mapping(change_existing(rig.to_mapping(), overrides, where), where)


def _read_model(entry: Any, folder: Path, rate: Any, where: str) -> Any:
    """Replace the key `file` of a model by the content of that file."""
    if not isinstance(entry, Mapping) or 'file' not in entry:
        return entry
    path = folder / str(entry['file'])
    data = load_yaml(path)
    if not isinstance(data, Mapping) or data.get('format') != _MODEL_FORMAT:
        raise SatvibError(f'{where}: models: {path} is not a model file ({_MODEL_FORMAT})')
    model = dict(data.get('model') or {})
    period = model.pop('sample_period', None)
    if not isinstance(period, float) or not isinstance(rate, int | float):
        raise SatvibError(f'{where}: models: {path}: its sample period or the rig rate is missing')
    if abs(period * rate - 1.0) > 1e-6:
        raise SatvibError(
            f'{where}: models: {path} is sampled at {1.0 / period:g} Hz, the rig at {rate:g} Hz'
        )
    return {**model, **{k: v for k, v in entry.items() if k != 'file'}}


def rig_from_mapping(data: Any, where: str = '') -> AnyRig:
    """Build a rig of the kind that its key `plant` says."""
    if isinstance(data, Mapping) and data.get('plant') == 'iir':
        return IirRig.from_mapping(data, where)
    return Rig.from_mapping(data, where)


def strut_count(rig: AnyRig) -> int:
    """Give the number of struts."""
    return len(rig.models) if isinstance(rig, IirRig) else rig.struts.count


def without_noise(rig: AnyRig) -> AnyRig:
    """Give the same rig with perfect sensors: no noise, no quantization."""
    if isinstance(rig, IirRig):
        return rig.replace(noise_rms=0.0, quantum=0.0)
    return rig.replace(
        accelerometer=rig.accelerometer.replace(noise_rms=0.0),
        acquisition=rig.acquisition.replace(input_bits=0),
    )
