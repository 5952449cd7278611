# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Whether the recording of a run is complete.

Of every sample there is exactly one acceleration, voltage, controller state and truth per strut. A model is there for
every sample of a phase in which it is estimated and for every sample before a hand-over, and nowhere else.
"""

import json
from pathlib import Path
from typing import Any

from satvib_common.phases import Phase, PhasePlan

REPORT = 'recording.json'
# what ends with a controller that is killed; the last model waits for a voltage that will not come
_OF_THE_KILLED = frozenset({'voltage', 'controller_state', 'identified_model'})


def expected_models(plan: PhasePlan, phases: frozenset[Phase], period: int) -> int:
    """How many models a strut publishes in a whole run.

    Args:
        plan: phases by sample.
        phases: those in which the estimate is updated.
        period: samples between hand-overs.
    """
    return sum(plan.at(k) in phases or plan.is_hand_over(k + 1, period) for k in range(plan.end))


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
    samples: int,
    models: int,
    silenced: frozenset[str] = frozenset(),
) -> str:
    """What is wrong with a recording, in one line; empty when nothing is.

    Args:
        report: of the recorder, by topic.
        struts: names.
        samples: how many there must be.
        models: how many models per strut there must be.
        silenced: struts whose controllers were killed in the run: what these say may end early.
    """
    for strut in struts:
        wanted = dict.fromkeys(('acceleration', 'voltage', 'controller_state', 'truth'), samples)
        wanted['identified_model'] = models
        for name, count in wanted.items():
            topic = f'/{strut}/{name}'
            found = report.get(topic, {'count': 0})
            if strut in silenced and name in _OF_THE_KILLED:
                if not 0 < found['count'] <= count:
                    return _miscounted(found, topic, f'1 to {count}')
                continue
            if found['count'] != count:
                return _miscounted(found, topic, str(count))
            if count and name != 'identified_model' and (found['gaps'] or found['first'] != 0):
                return f'recording: {topic} has gaps'
    if report.get('/schedule', {'count': 0})['count'] != 1:
        return 'recording: the schedule is not in it'
    return ''


def _miscounted(found: dict[str, Any], topic: str, wanted: str) -> str:
    span = f' (samples {found["first"]} to {found["last"]})' if found['count'] else ''
    return f'recording: {found["count"]} messages on {topic}{span}, not {wanted}'
