# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters that every node of the loop has."""

from dataclasses import dataclass

from satvib_common.schema import Fixed, Schema, param


def sample_rate() -> float:
    """The parameter of that name, for a node of its own schema too."""
    return param(
        100.0,
        'sample rate of the acquisition',
        unit='Hz',
        above=0.0,
        maximum=20e3,
        read_only=Fixed.GRAPH,
    )


@dataclass(frozen=True, kw_only=True)
class LoopParameters(Schema):
    """What a loop member must agree on with the others, and how its process runs."""

    sample_rate: float = sample_rate()
    lockstep: bool = param(
        False,
        'hold each sample until the schedule, and at hand-over samples the model of the sample before, are there; for '
        'simulation, where nothing may depend on timing. Samples of plant_sim and daq_bridge say it themselves, and '
        'then this value does not count',
        read_only=Fixed.GRAPH,
    )
    model_period: int = param(
        50,
        'samples between hand-overs of the identified model; 0: only at phase changes',
        unit='samples',
        minimum=0,
        read_only=Fixed.GRAPH,
    )
    cpu: int = param(-1, 'processor to run on; -1: any', minimum=-1, read_only=Fixed.START)
    priority: int = param(
        0,
        'SCHED_FIFO priority; 0: the ordinary scheduler',
        minimum=0,
        maximum=99,
        read_only=Fixed.START,
    )
