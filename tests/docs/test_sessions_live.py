# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Blocks ```console of README and docs: every command is run as typed, and its output is compared.

In such a block a line `$ command` is typed; what follows is its output. A line `...` stands for any lines, and `~12.3`
for a number that is another one on another machine. A command that ends with ` &` runs in a terminal of its own. The
blocks of one page are one session, in an empty folder. That of README is always on, the others are long.
"""

import math
import os
import re
import subprocess

import pytest
from source_tree import ROOT

PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding='utf-8')
    for path in [*sorted(ROOT.glob('*.md')), *sorted((ROOT / 'docs').rglob('*.md'))]
}


def session_of(text):
    """Give (command, expected lines) of a page."""
    found = []
    for block in re.findall(r'^```console\n(.*?)^```', text, re.DOTALL | re.MULTILINE):
        for line in block.splitlines():
            if line.startswith('$ '):
                found.append((line[2:], []))
            elif line.startswith('> '):
                found[-1] = (f'{found[-1][0]}\n{line[2:]}', [])
            else:
                found[-1][1].append(line)
    return found


SESSIONS = [
    pytest.param(
        page,
        session_of(text),
        id=page,
        marks=[pytest.mark.timeout(600)] + ([] if page == 'README.md' else [pytest.mark.long]),
    )
    for page, text in PAGES.items()
    if '```console' in text
]


def pattern(lines):
    """The expected lines as a regular expression; blanks at the ends of lines do not count.

    Neither does the length of the lines of a table, which follows the figures in it.
    """
    parts = []
    for line in lines:
        if line.strip() == '...':
            parts.append(r'(?:.*\n)*?')
            continue
        texts = re.split(r'~[-+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?', line.strip())
        quoted = [re.sub(r'(?:\\ )+', r'\\s+', re.escape(text)) for text in texts]
        quoted = [re.sub('([━─])+', r'\1+', text) for text in quoted]
        text = r'(?:[-+]?[\d.]+(?:e[-+]?\d+)?|nan)'.join(quoted)
        parts.append(rf'\s*{text}\s*\n')
    return ''.join(parts)


def test_the_patterns():
    """Truth: texts written here."""
    assert re.fullmatch(pattern(['a ~1.5 b', '...', 'end']), 'a 22.75 b\nx\ny\nend\n')
    assert re.fullmatch(pattern(['a ~-3 b']), 'a   7  b\n')
    assert re.fullmatch(pattern(['┏━━━━┓', '┃ ~10.0 ┃']), '┏━━━┓\n┃ 9.5 ┃\n')
    assert not re.fullmatch(pattern(['a 1.5 b']), 'a 22.75 b\n')
    assert not re.fullmatch(pattern(['a', 'end']), 'a\nx\nend\n')


@pytest.mark.usefixtures('domain')
@pytest.mark.parametrize(('page', 'session'), SESSIONS)
def test_a_session_says_what_the_page_says(page, session, tmp_path):
    """Truth: the page."""
    folder = tmp_path / 'session'
    folder.mkdir()
    for name in ('src', 'docs', 'satvib'):
        if name != 'satvib':
            (folder / name).symlink_to(ROOT / name)
    # the workspace is there already, so what the script does before the command is left out
    (folder / 'satvib').write_text('#!/bin/sh\nexec python -m satvib_bringup.start "$@"\n')
    (folder / 'satvib').chmod(0o755)
    script = ['cd "$1"']
    for i, (command, _) in enumerate(session):
        script.append(f'printf "@@@{i}\\n"')
        script.append(
            f'{command[:-1]} >"terminal-{i}" 2>&1 &'
            if command.endswith(' &')
            else f'{command}\ncode=$?; [ $code = 0 ] || echo "exit code $code"'
        )
    script += ['printf "@@@end\\n"', 'kill $(jobs -p) 2>/dev/null', 'wait']
    environment = {k: v for k, v in os.environ.items() if k != 'SATVIB_ROOT'} | {'COLUMNS': '110'}
    done = subprocess.run(
        ['bash', '--noprofile', '--norc', '-c', '\n'.join(script), 'bash', str(folder)],
        stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=500.0, check=False, env=environment,
        stdin=subprocess.DEVNULL,
    )  # fmt: skip
    said = re.split(r'@@@(?:\d+|end)\n', done.stdout)[1:]
    assert len(said) == len(session) + 1, done.stdout
    for (command, expected), output in zip(session, said, strict=False):
        wanted = pattern([line for line in expected if line.strip()])
        plain = ''.join(f'{line}\n' for line in output.splitlines() if line.strip())
        assert re.fullmatch(wanted, plain), f'{page}: {command}\n{output}'
        # what the page leaves out must not hide that a command was refused
        assert 'exit code' in ''.join(expected) or not re.search(
            r'^exit code \d+$', output, re.MULTILINE
        ), f'{page}: {command}\n{output}'


def test_the_code_of_the_page_about_tests(start):
    """Truth: a controller that runs answers the sample, once, with a finite voltage."""
    (block,) = re.findall(
        r'^```python\n(.*?)^```', PAGES['docs/testing.md'], re.DOTALL | re.MULTILINE
    )
    found = {}
    exec(compile(block, 'docs/testing.md', 'exec'), found)
    start(
        'satvib_control', 'strut_controller', '/strut_1', law='velocity_feedback', control_at_start=True,
        lockstep=False,
    )  # fmt: skip
    assert math.isfinite(found['voltage_of_a_sample']())
