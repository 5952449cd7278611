# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A recording from wherever it is: a run's folder, a bag, a file of the offline twin."""

from pathlib import Path

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
    return load_npz(inside) if inside.is_file() else read_recording(path, recover)
