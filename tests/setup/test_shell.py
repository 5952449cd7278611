# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""`./satvib shell` in a workspace that is set up. Truth: what the command in it prints."""

import subprocess

import pytest
from lock_files import ROOT

pytestmark = pytest.mark.skipif(
    not (ROOT / '.cache/environment.sh').exists(), reason='the workspace is not set up'
)


def shell(*arguments, **options):
    return subprocess.run(
        [ROOT / 'satvib', 'shell', *arguments], capture_output=True, text=True, check=True,
        timeout=600, **options,
    )  # fmt: skip


def test_a_command_and_a_script_print_what_they_print_and_no_more(tmp_path):
    """On both streams, for they are often read by a program."""
    script = tmp_path / 'script.sh'
    script.write_text('echo out; echo err >&2')
    for done in (shell('-c', 'echo out; echo err >&2'), shell(script)):
        assert (done.stdout, done.stderr) == ('out\n', 'err\n')


def test_who_has_a_shell_to_write_in_is_told_how_to_leave_it():
    assert 'workspace sourced; leave with exit' in shell(stdin=subprocess.DEVNULL).stderr
