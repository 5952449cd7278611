# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""A node imports what it runs: no compiler, no SciPy package, nothing of plotting or of tests.

Truth: `sys.modules` of a process of its own that has built and activated the node.
"""

import subprocess
import sys

import pytest

FORBIDDEN = {
    'numba', 'llvmlite', 'coverage', 'pytest', 'matplotlib', 'jinja2', 'pandas', 'pyarrow', 'numpy.f2py',
    'scipy.special', 'scipy.linalg', 'scipy.optimize', 'scipy.signal', 'scipy.stats', 'scipy.sparse',
}  # fmt: skip
NODES = [
    ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode', ''),
    ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode', 'law:=velocity_feedback'),
    ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode', 'law:=model_reference'),
    ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode', 'law:=narrowband'),
    ('satvib_control.nodes.strut_controller_node', 'StrutControllerNode', 'law:=feedforward'),
    ('satvib_ident.nodes.strut_identifier_node', 'StrutIdentifierNode', ''),
    ('satvib_plant_sim.nodes.plant_sim_node', 'PlantSimNode', 'rig:=paper_3dof'),
    ('satvib_bringup.nodes.recorder_node', 'RecorderNode', ''),
]
CODE = """
import importlib, sys
import rclpy
module, name, setting, folder = sys.argv[1:]
given = ['-p', setting] if setting else []
if name == 'RecorderNode':
    given = ['-p', f'folder:={folder}/bag']
rclpy.init(args=['--ros-args', '-r', '__ns:=/strut_1', '-p', 'autostart:=false', *given])
node = getattr(importlib.import_module(module), name)()
node.trigger_configure()
node.trigger_activate()
assert node.active, node.failure
print(*sorted(sys.modules), sep='\\n')
"""


def modules_of(module, name, setting, folder):
    """Build the node twice: the first process may have to compile its kernels."""
    for attempt in ('first', 'second'):
        done = subprocess.run(
            [sys.executable, '-c', CODE, module, name, setting, str(folder / attempt)],
            capture_output=True, text=True, timeout=600, check=False,
        )  # fmt: skip
        assert done.returncode == 0, done.stderr
        found = set(done.stdout.split())
        if 'numba' not in found:
            break
    return found


@pytest.mark.usefixtures('domain')
@pytest.mark.parametrize(('module', 'name', 'setting'), NODES)
def test_a_node_imports_what_it_runs(module, name, setting, tmp_path):
    found = modules_of(module, name, setting, tmp_path)
    assert module in found
    assert not FORBIDDEN & found
