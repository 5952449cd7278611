# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The gate runs beside the pytest plugins of an installed ROS 2."""

import os
import subprocess
import sys

import pytest
from source_tree import ROOT

PLUGINS = ('launch_testing', 'launch_ros', 'launch_pytest')


@pytest.mark.parametrize('setting', [(), ('-o', 'addopts=')], ids=['ours', 'none'])
def test_a_plugin_that_does_not_fit_is_left_out(tmp_path, setting):
    """Truth: the counts. Each plugin here empties the collection, as that of Jazzy does under pytest 9."""
    for name in PLUGINS:
        info = tmp_path / f'{name}-1.0.dist-info'
        info.mkdir()
        (info / 'METADATA').write_text(f'Metadata-Version: 2.1\nName: {name}\nVersion: 1.0\n')
        (info / 'entry_points.txt').write_text(f'[pytest11]\n{name} = emptier_of_{name}\n')
        (tmp_path / f'emptier_of_{name}.py').write_text(
            'def pytest_collection_modifyitems(items):\n    items.clear()\n'
        )
    environment = dict(os.environ)
    environment['PYTHONPATH'] = f'{tmp_path}:{environment.get("PYTHONPATH", "")}'
    target = ROOT / 'src/satvib_common/test/test_levels.py'
    done = subprocess.run(
        [sys.executable, '-m', 'pytest', '-q', '--collect-only', *setting, str(target)],
        cwd=ROOT, env=environment, capture_output=True, text=True, timeout=120.0, check=False,
    )  # fmt: skip
    assert done.returncode == (5 if setting else 0), done.stdout + done.stderr
    assert ('test_levels.py' in done.stdout) is not bool(setting)
