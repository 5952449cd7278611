# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the recording of a run is complete.

Of every sample there is exactly one acceleration and one voltage per strut, and in lockstep one controller state. The
truth is there in blocks, and a model where `satvib_ident.model_times` says, and nowhere else.
"""

import json
from pathlib import Path
from typing import Any, NamedTuple

REPORT = 'recording.json'
# what ends with a controller that is killed; the last model waits for a voltage that will not come
_OF_THE_KILLED = frozenset({'voltage', 'controller_state', 'identified_model'})


class Expected(NamedTuple):
    """How many messages a strut publishes in a whole run.

    Attributes:
        samples: of the run; accelerations and voltages.
        models: see `satvib_ident.model_times`.
        states: controller states; in real time there may be more, up to one for each sample.
        truths: blocks of truth.
    """

    samples: int
    models: int
    states: int
    truths: int


def read_report(folder: Path) -> dict[str, Any]:
    """Give the recorder's report of a run; empty when there is none."""
    path = folder / REPORT
    if not path.is_file():
        return {}
    found: dict[str, Any] = json.loads(path.read_text(encoding='utf-8'))
    return found


def complaint(
    report: dict[str, Any],
    struts: tuple[str, ...],
    expected: Expected,
    silenced: frozenset[str] = frozenset(),
) -> str:
    """What is wrong with a recording, in one line; empty when nothing is.

    Args:
        report: of the recorder, by topic.
        struts: names.
        expected: how many messages of a strut there must be.
        silenced: struts whose controllers were killed in the run: what these say may end early.
    """
    for strut in struts:
        wanted = {
            'acceleration': expected.samples,
            'voltage': expected.samples,
            'controller_state': expected.states,
            'truth': expected.truths,
            'identified_model': expected.models,
        }
        for name, count in wanted.items():
            topic = f'/{strut}/{name}'
            found = report.get(topic, {'count': 0})
            if strut in silenced and name in _OF_THE_KILLED:
                if not 0 < found['count'] <= expected.samples:
                    return _miscounted(found, topic, f'1 to {expected.samples}')
                continue
            most = expected.samples if name == 'controller_state' else count
            if not count <= found['count'] <= most:
                return _miscounted(found, topic, str(count))
            whole = count == expected.samples and name != 'identified_model'
            if count and (
                (whole and found['gaps']) or (name != 'identified_model' and found['first'])
            ):
                return f'recording: {topic} has gaps'
    if report.get('/schedule', {'count': 0})['count'] < 1:
        return 'recording: the schedule is not in it'
    return ''


def _miscounted(found: dict[str, Any], topic: str, wanted: str) -> str:
    span = f' (samples {found["first"]} to {found["last"]})' if found['count'] else ''
    return f'recording: {found["count"]} messages on {topic}{span}, not {wanted}'
