# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""How a process of the loop runs."""

import subprocess
import sys

SCRIPT = """
import os, threading
from pathlib import Path
from satvib_common.realtime import set_niceness

known, over = threading.Event(), threading.Event()
threads = {}

def work(name):
    threads[name] = threading.get_native_id()
    Path(f'/proc/self/task/{threads[name]}/comm').write_text(name)
    known.set()
    over.wait()

for name in ('dds.udp.7411', 'writer'):
    known.clear()
    threading.Thread(target=work, args=(name,), daemon=True).start()
    known.wait()
before = os.getpriority(os.PRIO_PROCESS, 0)
set_niceness(before + 1)
found = [os.getpriority(os.PRIO_PROCESS, thread) for thread in (0, *threads.values())]
print(*(priority - before for priority in found))
over.set()
"""


def test_the_threads_of_the_middleware_keep_their_priority():
    """Truth: the kernel's own figures. Writers wait for locks that these threads hold."""
    done = subprocess.run(
        [sys.executable, '-c', SCRIPT], capture_output=True, text=True, check=True
    )
    assert done.stdout == '1 0 1\n'
