# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

NAME = 'satvib_bringup'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    package_data={
        NAME: [
            'scenarios/*.yaml',
            'studies/*.yaml',
            'campaigns/*.yaml',
            'comparison/*.yaml',
            'report/*.html',
            'report/*.css',
            'campaign/*.html',
        ]
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (f'share/{NAME}/config', ['config/fastdds.xml']),
        (f'share/{NAME}/launch', ['launch/simulation.launch.py']),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='Scenarios, live experiments, the offline twin, recording and reports',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [
            'satvib = satvib_bringup.cli:main',
            'recorder = satvib_bringup.recorder_node:main',
            'experiment = satvib_bringup.experiment_node:main',
            'schedule = satvib_bringup.schedule_node:main',
            'replay = satvib_bringup.replay_node:main',
        ],
    },
)
