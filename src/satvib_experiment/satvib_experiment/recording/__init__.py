# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What happened in a run, as arrays by sample and strut, from the twin, a bag or a file."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_experiment.recording.bag.files import find_bag
    from satvib_experiment.recording.bag_reader import read_recording
    from satvib_experiment.recording.load import load_recording
    from satvib_experiment.recording.npz_file import load_npz
    from satvib_experiment.recording.recording import Recording, differences
    from satvib_experiment.recording.run_folder import (
        free_run_folder,
        make_run_folder,
        write_scenario,
    )
    from satvib_experiment.recording.signals import fine, without_bias

__all__ = [
    'Recording',
    'differences',
    'find_bag',
    'fine',
    'free_run_folder',
    'load_npz',
    'load_recording',
    'make_run_folder',
    'read_recording',
    'without_bias',
    'write_scenario',
]
__getattr__, __dir__ = door(__name__, __file__)
