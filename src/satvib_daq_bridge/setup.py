# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from setuptools import find_packages, setup

NAME = 'satvib_daq_bridge'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={NAME: ['py.typed', 'config/*.yaml']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (f'share/{NAME}/config', sorted(map(str, Path('config').glob('*.yaml')))),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='The loop on real hardware: channels, calibration, output guard, back ends',
    license='Apache-2.0',
    extras_require={'test': ['pytest'], 'nidaqmx': ['nidaqmx[grpc]'], 'iio': ['pylibiio<1']},
    entry_points={
        'console_scripts': [
            'daq_bridge = satvib_daq_bridge.start:daq_bridge',
            'daq_emulator = satvib_daq_bridge.start:daq_emulator',
        ],
    },
)
