# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from setuptools import find_packages, setup

NAME = 'satvib_bringup'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={NAME: ['py.typed']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (f'share/{NAME}/config', sorted(map(str, Path('config').glob('*.xml')))),
        (f'share/{NAME}/launch', sorted(map(str, Path('launch').glob('*.launch.py')))),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='Live experiments, their nodes, launch files and the satvib command',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [
            'satvib = satvib_bringup.cli.main:main',
            'strut = satvib_bringup.nodes.strut:main',
            'single = satvib_bringup.nodes.single:main',
            'recorder = satvib_bringup.nodes.recorder_node:main',
            'experiment = satvib_bringup.nodes.experiment_node:main',
            'schedule = satvib_bringup.nodes.schedule_node:main',
            'replay = satvib_bringup.nodes.replay_node:main',
        ],
    },
)
