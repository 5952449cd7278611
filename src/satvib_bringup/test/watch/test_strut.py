# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the page knows of a strut."""

import json
import math

import numpy as np
import pytest
from satvib_bringup.watch.graph import WatchedGraph
from satvib_bringup.watch.samples import Column
from satvib_bringup.watch.strut import BLOCKS, WatchedStrut
from satvib_common.phases import Phase
from satvib_common.struts.applied import TEXTS, Applied

PERIOD = 0.005  # s
STATE = {
    'sequence': 0, 'phase': 4, 'law': 'narrowband', 'reason': '', 'fault': False,
    'kp': 1.0, 'ki': 2.0, 'kd': math.nan, 'ki_min': -3.0, 'ki_max': 3.0,
}  # fmt: skip


def tone(first: int, last: int, amplitude: float = 1.0, frequency: float = 10.0) -> list:
    """Samples of a tone at the upper plate, and twice that at the lower."""
    values = amplitude * np.sin(2.0 * np.pi * frequency * PERIOD * np.arange(first, last))
    return [(k, PERIOD, v, 2.0 * v) for k, v in zip(range(first, last), values, strict=True)]


def test_news_in_portions_and_the_whole_show_the_same_blocks():
    """Truth: the blocks of a page that was opened later; no tolerance."""
    strut = WatchedStrut('strut_1')
    portions = []
    for first in range(0, 3000, 40):
        strut.take_accelerations(tone(first, first + 40))
        strut.take_voltages(Column.ASKED, [(k, 0.1) for k in range(first, first + 40)])
        portions.append(strut.news()['blocks'])
    whole = strut.whole()['blocks']
    shown = {}
    for part in portions:
        for i, block in enumerate(range(part['first'], part['last'] + 1)):
            shown[block] = [row[i] for row in (*part['low'], *part['high'])]
    assert whole['last'] + 1 - whole['first'] == BLOCKS
    for i, block in enumerate(range(whole['first'], whole['last'] + 1)):
        assert shown[block] == [row[i] for row in (*whole['low'], *whole['high'])]


def test_a_late_voltage_is_shown_again():
    """Truth: sample 100 is in block 25 of 4 samples; its voltage comes when later blocks have been shown."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 400))
    before = strut.news()['blocks']
    assert before['size'] == 4
    assert before['high'][Column.ASKED][25] is None
    strut.take_voltages(Column.ASKED, [(100, 3.0)])
    again = strut.news()['blocks']
    assert again['first'] == 25
    assert again['high'][Column.ASKED][0] == 3.0


def test_the_spectrum_has_the_level_of_a_tone():
    """Truth: a tone of amplitude A has the mean square A^2/2, the integral of the density; 1 %, of Welch's window."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 2400, amplitude=3.0))
    strut.look()
    found = strut.news()['spectra']
    frequency, upper, lower = (np.array(found[n]) for n in ('frequency', 'upper', 'lower'))
    assert abs(frequency[np.argmax(upper)] - 10.0) <= frequency[1]
    power = np.sum(upper**2) * frequency[1]
    assert power == pytest.approx(3.0**2 / 2.0, rel=0.01)
    np.testing.assert_allclose(lower[upper > 1e-3] / upper[upper > 1e-3], 2.0, rtol=1e-3)


def test_lost_samples_are_no_steps_in_the_spectrum():
    """Truth: a sensor at rest with a bias of 2 m/s^2 has no spectrum, whatever is lost; 1e-12 for rounding."""
    strut = WatchedStrut('strut_1')
    rows = [(k, PERIOD, 2.0, 2.0) for k in range(2000) if k % 100 > 10]
    strut.take_accelerations(rows)
    strut.look()
    assert max(strut.news()['spectra']['upper']) < 1e-12


def test_the_spectrum_before_control_stays_that_of_standby():
    """Truth: amplitude 2 in STANDBY and 0.2 in CONTROL: 20 dB between the two; 0.1 dB of four digits."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 2400, 2.0))
    strut.take_progress(2399, Phase.STANDBY, 1.41)
    strut.look()
    strut.take_accelerations(tone(2400, 4800, 0.2))
    strut.take_progress(4799, Phase.CONTROL, 0.141)
    strut.look()
    found = strut.news()
    ratio = max(found['spectra']['upper']) / max(found['spectra']['before'][1])
    assert 20.0 * math.log10(ratio) == pytest.approx(-20.0, abs=0.1)
    assert found['attenuation'] == pytest.approx(-20.0, abs=0.1)


def test_another_run_begins_with_nothing_of_the_one_before():
    """Truth: the samples of the second run alone."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 1000, 5.0))
    strut.take_progress(999, Phase.STANDBY, 3.5)
    strut.take_state(STATE)
    first = strut.news()['run']
    strut.take_accelerations([*tone(1000, 1010, 5.0), *tone(0, 40)])
    found = strut.news()
    assert found['run'] == first + 1
    assert found['blocks']['first'] == 0
    assert max(found['blocks']['high'][Column.UPPER]) <= 1.0
    assert found['state'] == {}
    assert found['attenuation'] is None


def test_a_message_for_the_page_is_json_without_nan():
    """Truth: the JSON standard, which has no NaN."""
    graph = WatchedGraph()
    strut = graph.strut('rig_a/strut_1')
    strut.take_accelerations([(0, PERIOD, math.nan, math.inf), *tone(1, 400)])
    strut.take_state(STATE)
    strut.take_model({
        'sequence': 3, 'sample_period': PERIOD, 'a': [0.1], 'b': [math.nan],
        'standard_deviation': [math.nan, 1.0], 'converged': False, 'reason': 'early',
    })  # fmt: skip
    graph.look()
    for message in (graph.news(), graph.whole()):
        assert json.loads(json.dumps(message, allow_nan=False)) == message


def test_what_the_coil_got_and_why_is_shown():
    """Truth: the text of the state in `satvib_common.struts.applied`."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 400))
    strut.take_voltages(Column.ASKED, [(k, 2.0) for k in range(400)])
    strut.take_voltages(Column.APPLIED, [(k, 0.0) for k in range(400)])
    strut.applied = int(Applied.SILENT)
    found = strut.news()
    assert found['applied'] == TEXTS[Applied.SILENT]
    assert found['blocks']['high'][Column.ASKED][50] == 2.0
    assert found['blocks']['high'][Column.APPLIED][50] == 0.0


def test_messages_that_are_out_of_order_do_not_end_the_page():
    """Truth: samples that are sound are shown; what no enum and no period knows is not."""
    strut = WatchedStrut('strut_1')
    for row in (
        (2**63, PERIOD, 1.0, 1.0),
        (3, 0.0, 1.0, 1.0),
        (4, math.nan, 1.0, 1.0),
        (5, 1e-12, 1.0, 1.0),
    ):
        strut.take_accelerations([row])
    assert strut.news()['period'] == 0.0
    strut.take_progress(1, 99, math.nan)
    strut.take_state(STATE | {'phase': 200})
    strut.take_model(
        {'sequence': 2**63, 'sample_period': 0.0, 'a': [], 'b': [], 'standard_deviation': [1.0]}
    )
    strut.applied = 77
    strut.take_accelerations(tone(0, 400))
    found = strut.news()
    json.dumps(found, allow_nan=False)
    assert found['phase'] == ''
    assert found['applied'] == ''
    assert found['blocks']['last'] > 50


def test_half_an_hour_leaves_no_more_behind_than_ten_minutes():
    """Truth: the size of a page's first message after ten minutes; 1 % for the digits of the numbers."""
    graph = WatchedGraph()
    sizes = []
    for minute in range(30):
        for second in range(0, 60, 5):
            first = (minute * 60 + second) * 200
            strut = graph.strut('strut_1')
            strut.take_accelerations(tone(first, first + 1000, 1.5))
            strut.take_voltages(Column.ASKED, [(k, 1.5) for k in range(first, first + 1000)])
            for k in range(first, first + 1000, 25):
                strut.take_state(STATE | {'sequence': k})
            graph.take_status('/strut_1/strut_controller', 0, 'all is well', {})
            graph.say('stop: 0 V')
            graph.news()
        sizes.append(len(json.dumps(graph.whole())))
    assert sizes[-1] <= sizes[9] * 1.01


def test_instants_late_in_a_long_run_stay_apart():
    """Truth: samples 200 000 000 and 200 000 025, eleven days after the first; 0.1 ms."""
    strut = WatchedStrut('strut_1')
    strut.take_accelerations(tone(0, 10))
    for k in (200_000_000, 200_000_025):
        strut.take_state(STATE | {'sequence': k})
    first, second = (row[0] for row in strut.whole()['gains'])
    assert second - first == pytest.approx(25 * PERIOD, abs=1e-4)


def test_a_node_that_says_nothing_is_gone(monkeypatch):
    """Truth: the clock of the test."""
    now = [100.0]
    monkeypatch.setattr('time.monotonic', lambda: now[0])
    graph = WatchedGraph()
    graph.take_status('/plant_sim', 2, '0 V latched at strut_1', {})
    graph.look()
    assert graph.news()['nodes'][0]['level'] == 2
    now[0] = 106.0
    graph.look()
    assert graph.news()['nodes'][0]['text'].startswith('gone')
