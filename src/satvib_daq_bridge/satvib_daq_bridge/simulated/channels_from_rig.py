# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The channels file that fits a simulated rig: for the loopback, for the emulator, and as a start for a real one."""

from collections.abc import Mapping
from typing import Any

from satvib_common.struts.names import strut_names
from satvib_plant_sim.rig.rig import Rig

# of the coil LA17-28-000A: estimated from its family
_CONTINUOUS_FORCE = 28.0


def channels_of(
    rig: Rig,
    back_end: str = 'loopback',
    device: str = 'plant',
    options: Mapping[str, Any] | None = None,
    sensor: Mapping[str, Any] | None = None,
    coil: Mapping[str, Any] | None = None,
) -> dict[str, Any]:
    """Give the channels of a rig as plain data: inputs are the upper sensors, then the lower ones.

    Args:
        rig: whose sensors, coils and converters.
        back_end: who drives the device.
        device: name of the one device.
        options: settings of the back end.
        sensor, coil: changes to every sensor and to every coil.
    """
    a, q, c, n = rig.accelerometer, rig.acquisition, rig.coil, rig.struts.count
    accelerometer = {
        'device': device,
        'polarity': 1,
        'range': [-q.input_range, q.input_range],
        'bits': q.input_bits,
        'sensitivity': a.sensitivity,
        'zero_voltage': a.zero_voltage,
        'sensor_range': a.range,
        'zero_tolerance': max(a.zero_tolerance, 0.01) * 1.5,
        'noise_limit': max(a.noise_rms * 5.0, 0.05),
        # a simulated sensor without noise repeats itself
        'stuck_time': 0.5 if a.noise_rms > 0.0 else 0.0,
        **(sensor or {}),
    }
    winding = {
        'device': device,
        'polarity': 1,
        'range': [-q.output_range, q.output_range],
        'bits': q.output_bits,
        'gain': c.gain,
        'limit': min(c.voltage_limit, q.output_range * c.gain),
        'slew': 1000.0 * c.voltage_limit,
        'transconductance': c.transconductance if c.drive == 'current' else 0.0,
    }
    own = {
        'force_constant': rig.struts.own('force_constant', c.force_constant),
        'continuous_force': [
            min(_CONTINUOUS_FORCE, limit) for limit in rig.struts.own('force_limit', c.force_limit)
        ],
        'resistance': rig.struts.own('resistance', c.resistance),
        'inductance': rig.struts.own('inductance', c.inductance),
    }
    return {
        'back_end': back_end,
        'options': dict(options or {}),
        'struts': {
            strut_name: {
                'upper': {**accelerometer, 'index': i},
                'lower': {**accelerometer, 'index': n + i},
                'coil': {
                    **winding,
                    **{key: values[i] for key, values in own.items()},
                    **(coil or {}),
                    'index': i,
                },
            }
            for i, strut_name in enumerate(strut_names(n))
        },
    }
