# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The report: complete, self-contained, strict JSON, nothing overwritten."""

import base64
import inspect
import json
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from satvib_common.errors import SatvibError
from satvib_experiment.analysis.analysis import analyse
from satvib_experiment.analysis.evaluation import KINDS
from satvib_experiment.recording.bag_reader import read_recording
from satvib_experiment.recording.signals import without_bias
from satvib_experiment.report import drawing
from satvib_experiment.report.build import write_report
from satvib_experiment.report.context import Context
from satvib_experiment.report.drawing import Drawing
from satvib_experiment.report.figures.registry import FIGURES, figure_module
from satvib_experiment.report.result import write_result


@pytest.fixture(scope='module')
def made(quick_run, tmp_path_factory):
    """A report, and what was there when its result was known: the result's format, the files of figures."""
    folder, seen = tmp_path_factory.mktemp('report'), []
    report = write_report(
        quick_run,
        folder,
        analysed=lambda result: seen.append((result['format'], list(folder.rglob('*.png')))),
    )
    return report, seen


@pytest.fixture(scope='module')
def written(made):
    return made[0]


def refuse(constant):
    message = f'{constant} is not JSON'
    raise ValueError(message)


class Links(HTMLParser):
    """Collects what a page would load, and its text."""

    def __init__(self):
        super().__init__()
        self.loaded, self.text = [], []

    def handle_starttag(self, _, attributes):
        self.loaded += [v for k, v in attributes if k in {'src', 'href', 'srcset', 'data'}]

    def handle_data(self, data):
        self.text.append(data)


def parsed(page):
    links = Links()
    links.feed(page.read_text(encoding='utf-8'))
    return links, ' '.join(links.text)


def test_result_is_strict_json_with_everything_in_it(written, quick_run):
    """Truth: the evaluation in memory and the scenario that was run; NaN and infinity are no JSON."""
    text = (written.page.parent / 'result.json').read_text()
    result = json.loads(text, parse_constant=refuse)
    assert result == written.result
    assert result['format'] == 'satvib result 1'
    assert result['seed'] == 1
    assert result['samples'] == 400
    assert result['settings'] == json.loads(json.dumps(quick_run.scenario.to_mapping()))
    assert result['rig'] == json.loads(json.dumps(quick_run.rig.to_mapping()))
    assert result['lost'] == {'acceleration': 0, 'voltage': 0, 'state': 0, 'truth': 0}
    for i, strut in enumerate(result['struts']):
        for kind in KINDS:
            assert strut['attenuation'][kind] == written.evaluation.attenuation[kind][i]
        assert len(strut['model']['a']) == 2
        assert len(strut['model']['b']) == 3


def test_the_page_needs_nothing_else(written):
    """Truth: every source in the page is data inside it; no style or script from outside."""
    links, _ = parsed(written.page)
    assert links.loaded
    assert all(link.startswith('data:image/png;base64,') for link in links.loaded)
    raw = written.page.read_text(encoding='utf-8')
    assert not re.search(r'@import|url\(|<script[^>]*src|<link|https?://(?!www\.w3)', raw)


def test_every_figure_is_in_the_page_and_beside_it(written):
    """Truth: the list of figures; a PNG begins with its signature."""
    links, text = parsed(written.page)
    assert len(links.loaded) == len(FIGURES)
    for name, heading in FIGURES:
        file = written.page.parent / 'figures' / f'{name}.png'
        assert file.read_bytes().startswith(b'\x89PNG')
        assert heading in text


def test_the_page_says_what_the_figures_say(written):
    """Truth: the evaluation, shown with two digits."""
    _, text = parsed(written.page)
    for strut in written.result['struts']:
        shown = f'{strut["attenuation"]["true_rms"]:+.2f}'.replace('-', '\u2212')
        assert shown in text
    assert 'seed 1' in text
    for note in written.result['notes']:
        assert note in text


def test_nothing_is_overwritten(written, quick_run):
    """Truth: the page has the bytes it had before."""
    before = written.page.read_bytes()
    with pytest.raises(SatvibError, match=r'report\.html: exists already'):
        write_report(quick_run, written.page.parent)
    assert written.page.read_bytes() == before


def test_a_bag_of_someone_else_gets_a_report_too(quick_run, bag_writer, tmp_path):
    """No scenario, no truth, no models. Truth: measured figures alone, and the page says what is missing."""
    bag = bag_writer(quick_run, tmp_path / 'bag', custom=False, groups=('acceleration', 'voltage'))
    report = write_report(read_recording(bag), tmp_path / 'report', Drawing(0))
    for strut in report.result['struts']:
        assert strut['attenuation']['true_rms'] is None
        assert np.isfinite(strut['attenuation']['measured_rms'])
    _, text = parsed(report.page)
    assert 'no truth between the samples' in text


def test_a_folder_that_cannot_be_made_is_named(quick_run, tmp_path):
    """Truth: a file stands in the way."""
    (tmp_path / 'file').write_text('')
    with pytest.raises(SatvibError, match='cannot be made'):
        write_report(quick_run, tmp_path / 'file' / 'report')


def test_every_key_of_the_result_is_described(written):
    """Truth: the page that describes them."""
    page = Path(__file__).resolve().parents[4] / 'docs' / 'result.md'
    text = page.read_text(encoding='utf-8')
    strut = written.result['struts'][0]
    keys = {*written.result, *strut, *strut['model'], *strut['attenuation']}
    assert [key for key in sorted(keys) if f'`{key}`' not in text] == []


def test_a_run_whose_rig_and_law_are_elsewhere_gets_its_report(quick_run, tmp_path):
    """Recorded on another machine. Truth: the figures do not depend on the rig's file or the law's module."""
    away = replace(
        quick_run,
        scenario=quick_run.scenario.replace(
            rig='/nowhere/rig.yaml', controller={'law': 'nowhere:Law'}
        ),
    )
    report = write_report(away, tmp_path / 'report', Drawing(0))
    here, _ = analyse(quick_run)
    for i, strut in enumerate(report.result['struts']):
        assert strut['attenuation']['true_rms'] == here.attenuation['true_rms'][i]


def result_of(run, path, measured):
    """What result.json holds of a run with these measurements."""
    run = replace(run, groups=run.groups | {'acceleration': measured})
    evaluation, open_loop = analyse(run)
    return write_result(Context(run, open_loop, evaluation), path)


def test_clipped_samples_are_a_finding(quick_run, tmp_path):
    """Truth: the marks in the recording, counted by hand; a bag older than the mark counts none."""
    marks = np.zeros_like(quick_run.get('acceleration', 'upper_clipped'))
    marks[100:137, 1] = True
    measured = quick_run.groups['acceleration'] | {'upper_clipped': marks}
    result = result_of(quick_run, tmp_path / 'marked', measured)
    assert [s['clipped'] for s in result['struts']] == [
        {'upper': 0, 'lower': 0}, {'upper': 37, 'lower': 0}, {'upper': 0, 'lower': 0},
    ]  # fmt: skip
    found = [note for note in result['notes'] if 'clipped' in note]
    assert len(found) == 1
    assert 'upper sensor clipped at an end of its range: strut 2 37 of 400 samples' in found[0]
    older = {k: v for k, v in measured.items() if not k.endswith('_clipped')}
    result = result_of(quick_run, tmp_path / 'old', older)
    assert [s['clipped']['upper'] for s in result['struts']] == [0] * 3


def test_a_drawing_process_that_ends_costs_no_figure(quick_run, tmp_path, monkeypatch):
    """Truth: the figures of an undisturbed report, of which three will do, drawn by this process instead.

    Each says of what run it is.
    """
    some = [(name, heading) for name, heading in FIGURES if name in {'gains', 'model', 'voltage'}]
    monkeypatch.setattr(drawing, 'FIGURES', some)
    titles, real = [], Figure.suptitle
    monkeypatch.setattr(
        Figure, 'suptitle', lambda self, text, **how: titles.append(text) or real(self, text, **how)
    )
    evaluation, open_loop = analyse(quick_run)
    with Drawing(1) as processes:
        for process in processes._processes:
            process.kill()
            process.wait()
        drawn = processes.draw(Context(quick_run, open_loop, evaluation), tmp_path)
    assert [figure.name for figure in drawn] == [name for name, _ in some]
    assert all(figure.path.stat().st_size > 10_000 for figure in drawn)
    assert len(titles) == len(some)
    law = quick_run.scenario.controller['law'].replace('_', ' ')
    assert set(titles) == {f'quick_3dof · rig {quick_run.rig.name} · {law} · seed 1'}


@pytest.mark.parametrize('name', [name for name, _ in FIGURES])
def test_every_figure_says_of_what_run_it_is(name):
    """Truth: the source of the figure."""
    assert 'title=context.recording.title' in inspect.getsource(figure_module(name))


def test_the_figures_are_drawn_after_the_result_is_known(made):
    """Truth: the folder of the figures at the moment when the caller is told."""
    _, seen = made
    assert seen == [('satvib result 1', [])]


def test_the_samples_of_the_page_are_those_of_the_run(written, quick_run):
    """Truth: the recording, upper acceleration without its bias and voltage; half a step of 16 bits."""
    raw = written.page.read_text(encoding='utf-8')
    (text,) = re.findall(r'<script type="application/json" id="samples">(.*?)</script>', raw)
    about = json.loads(text)
    assert (about['start'], about['period'], about['count']) == (0.0, 0.01, 400)
    wanted = {
        'acceleration': without_bias(quick_run),
        'voltage': quick_run.get('voltage', 'voltage'),
    }
    assert [panel['name'] for panel in about['panels']] == list(wanted)
    for panel in about['panels']:
        for i, series in enumerate(panel['series']):
            shown = panel['scale'] * np.frombuffer(base64.b64decode(series), dtype='<i2')
            np.testing.assert_allclose(
                shown, wanted[panel['name']][:, i], atol=0.501 * panel['scale']
            )
