# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Counts and durations that cannot be run are refused with what they would need, by the commands themselves.

Truth: the product of the counts; nothing is computed before it is refused, which the folder shows: it stays empty.
"""

import pytest
from satvib_bringup.cli import main

TUNE = ('tune', '--rig', 'soft_3dof', '--disturbance', 'soft_3dof_centralized')


@pytest.fixture
def refused(tmp_path, monkeypatch, capsys):
    """Run the command; gives what it says, which must be one line, with exit code 2 and nothing written."""
    monkeypatch.chdir(tmp_path)

    def run(*arguments):
        monkeypatch.setattr('sys.argv', ['satvib', *arguments])
        with pytest.raises(SystemExit) as ended:
            main.main()
        said = capsys.readouterr().err
        assert ended.value.code == 2, said
        assert said.count('\n') == 1
        assert [path for path in tmp_path.iterdir() if path.suffix != '.yaml'] == []
        return said

    return run


@pytest.mark.parametrize(
    ('arguments', 'key', 'need'),
    [
        (('simulate', 'quick_3dof', '--set', 'duration=1e9'), 'duration:', 'GB of memory'),
        (('study', '--set', 'seeds=100000', '--set', 'duration=1e6'), 'seeds, duration:', 'GB of memory'),
        ((*TUNE, '--set', 'swarm.budget=1000000000000000'), 'swarm.budget', 'years'),
        ((*TUNE, '--set', 'cost.duration=1e12'), 'cost.duration', 'GB of memory'),
        (('campaign', 'payload_spread', '--set', 'trials=10000000', '--set', 'set={duration: 3000}'),
         'trials: 10000000 trials of', 'processors'),
    ],
)  # fmt: skip
def test_what_cannot_be_run_is_told_from_what_it_needs(refused, arguments, key, need):
    said = refused(*arguments)
    assert key in said
    assert need in said


def test_a_sweep_of_too_many_cells(refused, tmp_path):
    """Truth: 10^12 cells."""
    axes = '\n'.join(
        f'  a{i}: {{{", ".join(f"l{k}: {{seed: {k}}}" for k in range(100))}}}' for i in range(6)
    )
    (tmp_path / 's.yaml').write_text(f'name: s\nbase: {{rig: paper_1dof}}\naxes:\n{axes}\n')
    assert '1000000000000 cells need' in refused('table', 's.yaml')


@pytest.mark.parametrize('failures', ['[reds]', '[1]', '[[a]]', '[{kind: no}]', '[{}]', '5'])
def test_a_comparison_with_failures_that_are_none(refused, failures):
    said = refused('compare', '--set', f'cases={{x: {{title: t, failures: {failures}}}}}')
    assert 'failures' in said


@pytest.mark.parametrize('failures', ['[reds]', '[{kind: no}]', '5', '{a: b}'])
def test_a_campaign_with_failures_that_are_none(refused, tmp_path, failures):
    (tmp_path / 'c.yaml').write_text(
        f'scenario: quick_3dof\ntrials: 3\nset: {{failures: {failures}}}\n'
        'parameters: {rig.payload.mass: {kind: uniform, low: 8, high: 9}}\n'
    )
    assert 'failures' in refused('campaign', 'c.yaml', '--workers', '0')
