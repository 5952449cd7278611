# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

NAME = 'satvib_studies'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test', 'test.*']),
    package_data={
        NAME: [
            'py.typed',
            'sweeps/*.yaml',
            'campaigns/*.yaml',
            'comparison/*.yaml',
            'isolation/*.yaml',
            'campaign/report/*.html',
        ]
    },
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
    ],
    install_requires=['setuptools'],
    zip_safe=False,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='Campaigns, comparisons, tuning and sweeps over many simulated runs',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [],
    },
)
