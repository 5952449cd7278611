# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A recording from wherever it is: a run's folder, a bag, a file of the offline twin."""

from pathlib import Path

from satvib_common.errors import SatvibError

from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.npz_file import load_npz
from satvib_experiment.recording.recording import Recording


def load_recording(path: Path, recover: bool = False) -> Recording:
    """Read a recording.

    Args:
        path: recording.npz, a bag's folder, an .mcap file, or the folder of a run with one of them inside.
        recover: read what can be read of a damaged bag.

    Raises:
        SatvibError: nothing of the kind is there, or it is damaged.
    """
    if path.suffix == '.npz':
        return load_npz(path)
    inside = path / 'recording.npz'
    if inside.is_file():
        return load_npz(inside)
    refuse_results(path)
    return read_recording(path, recover)


def refuse_results(path: Path) -> None:
    """Refuse a folder that holds results of a command and no recording, and say where the recording is.

    Raises:
        SatvibError: with what there is to do.
    """
    if any(path.glob('*.mcap')) or any(path.glob('*.db3')) or (path / 'metadata.yaml').exists():
        return
    made = [name for name in ('base.yaml', 'coils.yaml') if (path / name).is_file()]
    if (path / 'frf.json').is_file():
        way = 'give what it was made from'
        if made:
            way = f'./satvib simulate {path / made[0]} records its experiment, ./satvib frf {path / made[0]} repeats it'
        raise SatvibError(f'{path}: holds frequency responses (frf.json), no recording; {way}')
    if (path / 'result.json').is_file():
        raise SatvibError(
            f'{path}: holds a report, no recording; give the bag or run that it is of ("source" in result.json)'
        )
