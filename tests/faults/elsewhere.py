# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The faults that have tests of their own, for the table in docs/faults.md: what must happen, and which test it is."""

from typing import NamedTuple


class Elsewhere(NamedTuple):
    """A fault that has a test of its own: in words what must happen, and the test."""

    name: str
    must: str
    test: str


OTHERS = (
    Elsewhere(
        'SIGKILL of plant, controller, identifier or recorder in a run',
        'the run ends within 3 s, by name, and the bag is read',
        'tests/faults/test_run_live.py::test_killing_a_node_ends_the_run',
    ),
    Elsewhere(
        'the same in real time, in each phase',
        'the same',
        'tests/faults/test_run_live.py::test_killing_a_node_in_any_phase_ends_the_run',
    ),
    Elsewhere(
        'SIGSTOP of the runner until the plant has ended',
        'the run is complete',
        'tests/faults/test_run_live.py::test_a_runner_that_is_stopped_for_a_while_harms_nothing',
    ),
    Elsewhere(
        'SIGKILL of the runner',
        'every node ends, and the bag is read',
        'tests/faults/test_run_live.py::test_killing_the_runner_leaves_no_process',
    ),
    Elsewhere(
        'a voltage that is no number, in lockstep',
        'the run ends by name',
        'tests/faults/test_run_live.py::test_not_a_number_on_the_voltage_topic',
    ),
    Elsewhere(
        'a second run in the same domain',
        'refused by name',
        'tests/faults/test_run_live.py::test_two_graphs_do_not_share_a_domain',
    ),
    Elsewhere(
        'two controllers of a strut, in lockstep too',
        '0 V, latched, both are named',
        'tests/test_live_rivals.py::test_two_controllers_of_one_strut_are_0_v',
    ),
    Elsewhere(
        'two plants, in lockstep too',
        'one ends, or 0 V, latched; both are named',
        'tests/test_live_rivals.py::test_two_plants_end_or_are_0_v',
    ),
    Elsewhere(
        'two identifiers of a strut',
        '0 V, latched, both are named',
        'tests/test_live_rivals.py::test_two_identifiers_of_one_strut_are_0_v',
    ),
    Elsewhere(
        'two schedules before a run',
        'the second one is refused by name',
        'tests/test_live_rivals.py::test_the_second_of_two_schedules_is_refused',
    ),
    Elsewhere(
        'the upper sensor is not at rest, or at 10^4 m/s^2, in CALIBRATE',
        '0 V that `~/reset` does not release',
        'src/satvib_control/test/core/test_controller.py::test_a_reset_cannot_give_a_bias_and_another_calibration_can',
    ),
    Elsewhere(
        'SIGSTOP of the controller with `after_silence: latch`',
        '0 V until `~/reset`',
        'tests/faults/test_restart_live.py::test_after_latch_only_reset_helps',
    ),
    Elsewhere(
        'restart of the controller in CALIBRATE, IDENTIFY, CONTROL',
        'after 1.5 s the voltage of a controller that was never away',
        'tests/faults/test_restart_live.py::test_a_controller_that_is_started_again_goes_on',
    ),
    Elsewhere(
        'restart of the identifier in IDENTIFY and CONTROL',
        'no voltage is withheld, and the bias stays',
        'tests/faults/test_restart_live.py::test_an_identifier_that_is_started_again_harms_nothing',
    ),
    Elsewhere(
        'restart of the plant',
        'the run begins again with sample 0',
        'tests/faults/test_restart_live.py::test_a_plant_that_is_started_again_begins_the_run_again',
    ),
    Elsewhere(
        'the disk is full before a run',
        'one line, exit code 2',
        'tests/faults/test_full_disk_live.py::test_a_full_disk_is_one_line',
    ),
    Elsewhere(
        'the disk fills while a bag is written',
        'the bag ends whole',
        'tests/faults/test_full_disk_live.py::test_a_recording_ends_whole_before_the_disk_is_full',
    ),
    Elsewhere(
        'the disk is full when the bag is closed',
        'that is said, and the messages are read when there is room',
        'tests/faults/test_full_disk_live.py::test_a_disk_that_is_full_when_the_bag_is_closed_loses_little',
    ),
    Elsewhere(
        'the disk is full when the report is written',
        'one line',
        'tests/faults/test_full_disk_live.py::test_a_disk_that_is_full_when_the_report_is_written_is_one_line',
    ),
    Elsewhere(
        'the disk fills in a run',
        'the run ends by name, and the bag is read',
        'tests/faults/test_full_disk_live.py::test_a_disk_that_fills_during_a_run_ends_it_and_loses_little',
    ),
    Elsewhere(
        'SIGKILL of bridge, guardian, controller or all, on hardware',
        '0 V at the terminals',
        'tests/daq/test_daq_live.py::test_kill_9',
    ),
    Elsewhere(
        'SIGSTOP of bridge or guardian, on hardware',
        '0 V at the terminals, FAULT',
        'tests/daq/test_daq_live.py::test_a_process_that_hangs_is_0_v_too',
    ),
    Elsewhere(
        'the device is unplugged',
        'FAULT; it goes on after `~/reset`',
        'tests/daq/test_daq_live.py::test_an_unplugged_device_and_its_return',
    ),
    Elsewhere(
        'a second publisher of voltages, on hardware',
        'FAULT, by name',
        'tests/daq/test_daq_live.py::test_a_second_publisher_is_refused',
    ),
)  # fmt: skip
