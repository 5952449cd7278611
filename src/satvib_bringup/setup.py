# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from pathlib import Path

from setuptools import find_packages, setup

NAME = 'satvib_bringup'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={NAME: ['py.typed', 'watch/page/*', 'watch/page/vendor/*']},
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (f'share/{NAME}/config', sorted(map(str, Path('config').glob('*.yaml')))),
        (f'share/{NAME}/config/layouts', sorted(map(str, Path('config/layouts').iterdir()))),
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
            'satvib = satvib_bringup.start:satvib',
            'strut = satvib_bringup.start:strut',
            'single = satvib_bringup.start:single',
            'recorder = satvib_bringup.start:recorder',
            'experiment = satvib_bringup.start:experiment',
            'schedule = satvib_bringup.start:schedule',
            'replay = satvib_bringup.start:replay',
        ],
    },
)
