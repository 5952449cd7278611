# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from setuptools import find_packages, setup

NAME = 'satvib_control'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={NAME: ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (f'share/{NAME}/config', sorted(map(str, Path('config').glob('*.yaml')))),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='Decentralized and centralized control laws for active vibration isolation',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [
            'strut_controller = satvib_control.start:strut_controller',
            'supervisor = satvib_control.start:supervisor',
            'centralized_controller = satvib_control.start:centralized_controller',
        ],
    },
)
