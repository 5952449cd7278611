# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The Python of README and docs: it imports from doors only, and it runs."""

import ast
import re

import numpy as np
import pytest
from source_tree import PACKAGES, ROOT, modules

PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding='utf-8')
    for path in [*sorted(ROOT.glob('*.md')), *sorted((ROOT / 'docs').rglob('*.md'))]
}
BLOCKS = [
    pytest.param(page, block, id=f'{page}-{i}')
    for page, text in PAGES.items()
    for i, block in enumerate(re.findall(r'^```python\n(.*?)^```', text, re.DOTALL | re.MULTILINE))
]


def test_there_are_blocks_to_run():
    """Truth: README and architecture.md have one each at least."""
    assert {block.values[0] for block in BLOCKS} >= {'README.md', 'docs/architecture.md'}


@pytest.mark.parametrize('page', PAGES)
def test_a_page_imports_from_doors_only(page):
    """Also in blocks that are only indented. Truth: the doors' `__all__`."""
    known = modules()
    own = '|'.join(PACKAGES)
    for line in re.findall(rf'^\s*((?:from|import) (?:{own})\b.*)$', PAGES[page], re.MULTILINE):
        statement = ast.parse(line).body[0]
        names = [a.name for a in statement.names]
        if isinstance(statement, ast.Import):
            assert [n for n in names if not known[n].is_door] == [], line
        else:
            assert known[statement.module].is_door, line
            assert set(names) <= set(known[statement.module].public), line


@pytest.mark.parametrize(('page', 'block'), BLOCKS)
def test_a_block_runs(page, block):
    """As it stands, from the imports to the end; the loop of the architecture has a test of its own."""
    if page != 'docs/architecture.md':
        exec(compile(block, page, 'exec'), {'__name__': 'block'})


@pytest.mark.parametrize('delay', [0, 1, 2])
def test_the_loop_of_the_architecture_is_that_of_the_twin(delay):
    """Truth: `simulate`, bit for bit; at delay 0 the identifier needs the voltage of the very sample."""
    from satvib_experiment import load_scenario, simulate

    (block,) = [b.values[1] for b in BLOCKS if b.values[0] == 'docs/architecture.md']
    setting = f'identifier.delay={delay}'
    assert "load_scenario('quick_3dof')" in block
    block = block.replace("'quick_3dof'", f"'quick_3dof', ['{setting}']")
    found = {}
    exec(compile(block, 'docs/architecture.md', 'exec'), found)
    recording = simulate(load_scenario('quick_3dof', [setting]))
    voltage = recording.get('voltage', 'voltage')
    np.testing.assert_array_equal(np.array(found['voltages'][delay:]), voltage)
    np.testing.assert_array_equal(found['found'].a, recording.get('model', 'a')[-1])
    assert np.any(voltage != 0.0)
