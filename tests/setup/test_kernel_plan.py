# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Which kernels are compiled before a command, and in what order.

Truth: what the nodes of the graph import when they start, and the kernels that are made then.
"""

import os
import shutil
import subprocess
import sys
import threading

import pytest
from lock_files import ROOT
from workspace.plan import SCENARIO, Need, Plan, entry_points, make_plan, need_of

MADE = """
import importlib, sys
import satvib_common.kernels.compile as compiler
made = set()
original = compiler.kernel
def kernel(*given, **named):
    decorate = original(*given, **named)
    def record(function):
        made.add(function.__module__)
        return decorate(function)
    return record
compiler.kernel = kernel
importlib.import_module(sys.argv[1])
print(*sorted(made))
"""


def order(plan):
    """All tasks, as one worker takes them."""
    taken = []
    while task := plan.take():
        taken.append(task)
        plan.done(task)
    return taken


@pytest.mark.timeout(900)
@pytest.mark.parametrize('module', entry_points(ROOT / 'src'))
def test_the_demo_has_every_kernel_that_a_node_makes_when_it_starts(module):
    if 'AMENT_PREFIX_PATH' not in os.environ:
        pytest.skip('the workspace is not built and sourced; use ./satvib test')
    done = subprocess.run(
        [sys.executable, '-c', MADE, module], capture_output=True, text=True, check=True
    )
    assert set(done.stdout.split()) <= set(order(make_plan(Need.DEMO)))


def test_the_demo_compiles_less_than_all_and_its_law_last():
    few, all_of_them = order(make_plan(Need.DEMO)), order(make_plan(Need.ALL))
    assert few[-1] == SCENARIO
    assert set(few[:-1]) < set(all_of_them)


def test_commands_that_only_tell_something_compile_nothing():
    assert [need_of(word) for word in ('', '--help', 'scenarios')] == [Need.NOTHING] * 3
    assert need_of() is need_of('judge', '--help') is Need.NOTHING
    assert need_of('demo') is Need.DEMO
    assert need_of('run') is need_of('test') is Need.ALL


def test_a_task_waits_for_those_that_it_needs_and_the_heaviest_goes_first():
    after = {'a': {'b', 'elsewhere'}, 'b': set(), 'c': set(), 'd': {'a', 'c'}}
    weight = {'a': 9.0, 'b': 1.0, 'c': 2.0, 'd': 9.0}
    assert order(Plan(after, weight)) == ['c', 'b', 'a', 'd']


def test_tasks_that_need_each_other_are_done_all_the_same():
    assert sorted(order(Plan({'a': {'b'}, 'b': {'a'}}, {'a': 1.0, 'b': 1.0}))) == ['a', 'b']


def test_two_workers_do_every_task_once_and_both_come_to_an_end():
    names = [str(number) for number in range(200)]
    after = {name: set(names[: int(name) // 2]) for name in names}
    plan = Plan(after, dict.fromkeys(names, 1.0))
    taken = []

    def work():
        while task := plan.take():
            taken.append(task)
            plan.done(task)

    workers = [threading.Thread(target=work, daemon=True) for _ in range(2)]
    for worker in workers:
        worker.start()
    for worker in workers:
        worker.join(timeout=60)
        assert not worker.is_alive()
    assert sorted(taken) == sorted(names)


def test_a_cancelled_plan_lets_the_workers_go():
    plan = Plan({'a': set(), 'b': {'a'}}, {'a': 1.0, 'b': 1.0})
    assert plan.take() == 'a'
    waiting = threading.Thread(target=plan.take, daemon=True)
    waiting.start()
    plan.cancel()
    waiting.join(timeout=60)
    assert not waiting.is_alive()


def test_set_up_is_told_all_words_of_the_command(tmp_path):
    """Truth: what the script `satvib` itself hands to a set-up that only prints it, and then fails."""
    (tmp_path / 'tools').mkdir()
    (tmp_path / 'tools/bootstrap.py').write_text('import sys; sys.exit(" ".join(sys.argv[1:]))')
    shutil.copy(ROOT / 'satvib', tmp_path)
    done = subprocess.run(
        [tmp_path / 'satvib', 'judge', '--help'], env=os.environ | {'SATVIB_PYTHON': sys.executable},
        capture_output=True, text=True, check=False, timeout=60,
    )  # fmt: skip
    assert done.stderr == 'judge --help\n'
