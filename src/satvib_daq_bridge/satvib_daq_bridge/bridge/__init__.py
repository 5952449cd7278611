# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The bridge without ROS: samples from the guardian, voltages to it, bias, faults."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_daq_bridge.bridge.bias import SensorBias
    from satvib_daq_bridge.bridge.bridge import Bridge, Published
    from satvib_daq_bridge.bridge.readable_thread import ReadableThread
    from satvib_daq_bridge.bridge.sensors import Sensors
    from satvib_daq_bridge.bridge.session import Session
    from satvib_daq_bridge.bridge.timing import Timing

__all__ = ['Bridge', 'Published', 'ReadableThread', 'SensorBias', 'Sensors', 'Session', 'Timing']
__getattr__, __dir__ = door(__name__, __file__)
