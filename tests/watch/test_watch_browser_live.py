# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The page in a real Chromium without a window; skipped where there is none."""

import psutil
import pytest
from graphs import RATE, begin
from satvib_common.phases import Phase

ALL = ((Phase.CALIBRATE, 0), (Phase.STANDBY, 50), (Phase.CONTROL, 150))


def press(page, words: str, where: str = 'document') -> None:
    """Press the button with these words, as a mouse does."""
    place = page.evaluate(
        f"""(() => {{ const b = [...{where}.querySelectorAll('button')].find((x) => x.textContent === '{words}');
        b.scrollIntoView({{ block: 'center', behavior: 'instant' }}); const r = b.getBoundingClientRect();
        return [r.x + r.width / 2, r.y + r.height / 2]; }})()"""
    )
    at = {'x': place[0], 'y': place[1], 'button': 'left', 'clickCount': 1}
    page.ask('Input.dispatchMouseEvent', type='mousePressed', **at)
    page.ask('Input.dispatchMouseEvent', type='mouseReleased', **at)


def struts_in_control(page) -> None:
    page.wait("document.querySelectorAll('.strut').length === 3")
    page.wait("[...document.querySelectorAll('.strut')].every((s) => Number(s.dataset.voltage))")


def test_stop_pressed_in_the_page_is_zero_volts_on_the_topic(
    start, schedule, probe, watch, browser
):
    """Truth: the messages on /strut_i/voltage that another node hears."""
    from satvib_msgs.msg import VcaVoltage

    begin(start)
    heard = [probe.collect(VcaVoltage, f'/strut_{i}/voltage', whole=False) for i in (1, 2, 3)]
    schedule(phases=ALL)
    page = browser.open(watch.address)
    struts_in_control(page)
    press(page, 'Stop', "document.querySelector('[data-strut=strut_2]')")
    probe.wait(lambda: heard[1] and heard[1][-1].fault and heard[1][-1].voltage == 0.0)
    assert not heard[0][-1].fault
    press(page, 'Stop all')
    probe.wait(lambda: all(v[-1].fault and v[-1].voltage == 0.0 for v in heard))
    page.wait(
        "[...document.querySelectorAll('.words')].every((w) => w.textContent.includes('FAULT'))"
    )
    page.wait("[...document.querySelectorAll('.strut')].every((s) => s.dataset.voltage === '0')")
    press(page, 'Reset all')
    probe.wait(lambda: all(v[-1].voltage != 0.0 for v in heard))
    page.wait(
        "[...document.querySelectorAll('.words')].every((w) => !w.textContent.includes('FAULT'))"
    )


def test_the_page_draws_and_a_field_sets_a_parameter(start, schedule, probe, watch, browser):
    """Truth: coloured pixels of the six canvases, and the node's own answer for the parameter."""
    from rcl_interfaces.srv import GetParameters

    begin(start)
    schedule(phases=ALL)
    page, other = browser.open(watch.address), browser.open(watch.address)
    for each in (page, other):
        struts_in_control(each)
        each.wait(
            """(() => { const drawn = [...document.querySelectorAll('.strut canvas')].map((c) => {
            const d = c.getContext('2d').getImageData(0, 0, c.width, c.height).data;
            let n = 0;
            for (let i = 0; i < d.length; i += 4) {
              n += Math.max(d[i], d[i + 1], d[i + 2]) - Math.min(d[i], d[i + 1], d[i + 2]) > 35;
            }
            return n; });
            return drawn.length === 6 && Math.min(...drawn) > 100; })()"""
        )
    node = '/strut_1/strut_controller'
    page.wait(f"[...document.getElementById('node').options].some((o) => o.value === '{node}')")
    page.evaluate(
        f"(() => {{ const n = document.getElementById('node'); n.value = '{node}'; n.onchange(); }})()"
    )
    field = "document.querySelector('[data-parameter=voltage_limit] input')"
    page.wait(f'Boolean({field})')
    page.evaluate(
        f"(() => {{ const f = {field}; f.value = '12.5'; f.dispatchEvent(new Event('change')); }})()"
    )
    other.wait("document.getElementById('lines').textContent.includes('voltage_limit')")
    assert 'voltage_limit = 12.5' in other.evaluate("document.getElementById('lines').textContent")
    request = GetParameters.Request(names=['voltage_limit'])
    answer = probe.call(GetParameters, f'{node}/get_parameters', request)
    assert answer.values[0].double_value == 12.5


def test_the_page_comes_back_when_its_server_was_away(watch, browser):
    """It says that what it shows is old. Truth: the process has ended."""
    page = browser.open(watch.address)
    page.wait("document.getElementById('lost').hidden")
    page.wait("document.getElementById('scenario').textContent === 'no graph is heard yet'")
    watch.end()
    page.wait("!document.getElementById('lost').hidden")


def grown(start, schedule, watch, browser, settle: float, last: float) -> tuple[float, float]:
    """Memory of server and page at the end, over that after `settle` s of the run."""
    begin(start)
    schedule(phases=ALL)
    page = browser.open(watch.address)
    process = psutil.Process(watch.popen.pid)
    seconds = "parseFloat(document.getElementById('clock').textContent)"
    page.wait(f'{seconds} > {settle}', settle + 60.0)
    page.heap()
    before = process.memory_info().rss, page.heap()
    page.wait(f'{seconds} > {last}', 2.0 * last + 60.0)
    after = process.memory_info().rss, page.heap()
    assert page.evaluate("document.querySelectorAll('.strut.silent').length") == 0
    print(f'server {before[0] / 1e6:.1f} MB -> {after[0] / 1e6:.1f} MB')
    print(f'page {before[1] / 1e6:.2f} MB -> {after[1] / 1e6:.2f} MB')
    return after[0] / before[0], after[1] / before[1]


@pytest.mark.long
def test_memory_does_not_grow_in_half_a_minute(start, schedule, watch, browser):
    """Truth: the operating system, and the browser's own count after a collection; a tenth for what is settling.

    What is kept of samples is full after 12 s; of gains, after 60 s, which is a few kilobytes.
    """
    server, page = grown(start, schedule, watch, browser, settle=15.0, last=40.0)
    assert server < 1.05
    assert page < 1.2


@pytest.mark.long
@pytest.mark.timeout(2400)
def test_memory_does_not_grow_in_half_an_hour(start, schedule, watch, browser):
    """Truth: the same, from the third minute on."""
    server, page = grown(start, schedule, watch, browser, settle=180.0, last=1800.0)
    assert server < 1.05
    assert page < 1.1


def test_the_rate_of_the_scenarios_here():
    """Truth: the rig."""
    from satvib_plant_sim.rig.any_rig import load_any_rig

    assert load_any_rig('paper_3dof').acquisition.sample_rate == RATE
