# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
from setuptools import find_packages, setup

NAME = 'satvib_control'

setup(
    name=NAME,
    version='0.1.0',
    packages=find_packages(exclude=['test']),
    data_files=[
        ('share/ament_index/resource_index/packages', [f'resource/{NAME}']),
        (f'share/{NAME}', ['package.xml']),
        (
            f'share/{NAME}/config',
            ['config/strut_controller.yaml', 'config/centralized_controller.yaml'],
        ),
    ],
    install_requires=['setuptools'],
    zip_safe=True,
    maintainer='satvib maintainers',
    maintainer_email='maintainers@satvib.invalid',
    description='Decentralized and centralized control laws for active vibration isolation',
    license='Apache-2.0',
    extras_require={'test': ['pytest']},
    entry_points={
        'console_scripts': [
            'strut_controller = satvib_control.strut_controller_node:main',
            'centralized_controller = satvib_control.centralized_controller_node:main',
        ],
    },
)
