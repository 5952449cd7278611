# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A measured record, identified live by the real strut_identifier."""

from pathlib import Path

import numpy as np
import pytest

RECORD = Path(__file__).resolve().parents[1] / '../shared/data/robot_arm/robot_arm.csv'


def batch_least_squares(u, y, n):
    """ARX with n poles and n + 1 coefficients by the SVD, rows n..N-1."""
    rows = [np.concatenate((-y[k - n : k][::-1], u[k - n : k + 1][::-1])) for k in range(n, len(y))]
    return np.linalg.lstsq(np.array(rows), y[n:], rcond=None)[0]


@pytest.mark.skipif(not RECORD.exists(), reason=f'{RECORD} is not here')
def test_robot_arm_live_equals_batch_least_squares(start, probe):
    """Truth: numpy.linalg.lstsq over the same rows; 1e-9 relative (the promise of the page), for orders 2, 4, 6."""
    from satvib_msgs.msg import IirParameters

    u, y = np.loadtxt(RECORD, delimiter=',', skiprows=1, unpack=True)
    found = {}
    for n in (2, 4, 6):
        strut = f'strut_{n}'
        topic = f'/arm_{n}/{strut}/identified_model'
        found[n] = probe.collect(IirParameters, topic)
        start(
            'satvib_ident', 'strut_identifier', f'/arm_{n}/{strut}', lockstep=True, delay=0,
            poles=n, coefficients=n + 1, bias='none',
        )  # fmt: skip
        # the record is longer than what a writer keeps for readers that come late
        probe.wait(lambda topic=topic: probe.readers[topic].get_publisher_count() == 1)
        start(
            'satvib_bringup', 'replay', f'/arm_{n}', file=str(RECORD), input='torque',
            output='acceleration', strut=strut,
        )  # fmt: skip
    for n, models in found.items():
        probe.wait(lambda models=models: models and models[-1].sequence == len(y) - 1)
        assert [m.sequence for m in models] == list(range(len(y)))
        live = np.concatenate((models[-1].a, models[-1].b))
        expected = batch_least_squares(u, y, n)
        assert np.linalg.norm(live - expected) < 1e-9 * np.linalg.norm(expected)


def test_replay_of_a_bag_without_the_strut(start, tmp_path):
    """Truth: a missing file is named, in one line, exit code 2."""
    process = start('satvib_bringup', 'replay', file=str(tmp_path / 'no-bag'))
    assert process.wait() == 2
    assert 'no-bag' in process.said.strip().splitlines()[-1]
