# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The parameter files that come with the package are the ones that people start from: they must load.

Layouts for plotting tools are valid, and show topics and fields that the graph has.
"""

import json
import re
from pathlib import Path
from xml.etree import ElementTree

import pytest
from satvib_common.files.yaml_file import load_yaml

CONFIG = Path(__file__).resolve().parents[1] / 'config'
FILES = sorted(CONFIG.glob('*.yaml'))
MESSAGES = Path(__file__).resolve().parents[2] / 'satvib_msgs/msg'
LAYOUTS = sorted((CONFIG / 'layouts').iterdir())


def schemas():
    pytest.importorskip('rclpy', reason='the workspace is not built and sourced')
    from satvib_bringup.nodes.experiment_node import ExperimentParameters
    from satvib_bringup.nodes.replay_record import ReplayParameters
    from satvib_bringup.nodes.schedule_node import ScheduleParameters
    from satvib_bringup.recorder.topic_recorder import RecorderParameters
    from satvib_control.parameters import ControllerParameters
    from satvib_ident.parameters import IdentifierParameters

    return {
        'recorder': RecorderParameters,
        'schedule': ScheduleParameters,
        'replay': ReplayParameters,
        'experiment': ExperimentParameters,
        'strut_controller': ControllerParameters,
        'strut_identifier': IdentifierParameters,
    }


@pytest.mark.parametrize('path', FILES, ids=lambda path: path.name)
def test_a_parameter_file_loads(path):
    """Truth: the schemas. Every key is known and every value has its default, which the file documents."""
    for section, content in load_yaml(path).items():
        name = path.stem if section == '/**' else section.removeprefix('/**/')
        schema = schemas()[name]
        values = content['ros__parameters']
        more = {'file': 'record.csv'} if name == 'replay' else {}
        loaded = schema.from_mapping(values | more, str(path))
        for key in values:
            assert getattr(loaded, key) == schema.__dataclass_fields__[key].default, key


def fields_of_topics():
    """Topic of a strut to the fields of its message, from the definitions."""
    from satvib_experiment.recording.topics import STRUT_TOPICS

    found = {}
    for topic, kind in {**STRUT_TOPICS, 'progress': 'satvib_msgs/msg/StrutProgress'}.items():
        text = (MESSAGES / f'{kind.rpartition("/")[2]}.msg').read_text()
        found[topic] = set(re.findall(r'^[\w/]+(?:\[\])? (\w+)$', text, re.MULTILINE))
    return found


def shown_by(path):
    """The topics and fields that a layout shows: (topic of a strut, field)."""
    text = path.read_text(encoding='utf-8')
    if path.suffix == '.xml':  # PlotJuggler
        names = [curve.get('name') for curve in ElementTree.fromstring(text).iter('curve')]
    elif path.suffix == '.json':  # Foxglove
        json.loads(text)
        names = [
            n.replace('.', '/') for n in re.findall(r'"(?:value|path)": "(/strut[^"]+)"', text)
        ]
    else:  # rqt
        tree = json.loads(text)
        assert tree['keys'] is not None
        names = re.findall(r'/strut_\d/\w+/\w+', text)
    return {re.sub(r'\[.*', '', n.removeprefix('/')).partition('/')[2] for n in names}


@pytest.mark.parametrize('path', LAYOUTS, ids=lambda path: path.name)
def test_a_layout_shows_what_the_graph_has(path):
    """Truth: the topics of a strut and the definitions of their messages."""
    known = fields_of_topics()
    shown = shown_by(path)
    assert len(shown) >= 3
    for name in shown:
        topic, _, field = name.partition('/')
        assert field in known[topic], name
