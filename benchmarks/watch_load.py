# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the page of `satvib watch` costs a graph in real time: with and without it in turns, within one run.

    ./satvib shell -c '.venv/bin/python benchmarks/watch_load.py'
    ... --scenario clean_3dof_narrowband --seconds 100 --browser     # with a headless Chromium that draws

Every stretch lasts 10 s. Its first 4 s, in which processes start and end, do not count. Figures: processor time of
the page's server, latency and lateness of the voltages of both kinds of stretches, and their ratio.
"""

import argparse
import os
import shutil
import signal
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import psutil

from satvib_bringup import Progress, run_experiment
from satvib_experiment import load_scenario

STRETCH, SETTLING = 10.0, 4.0  # s
BROWSERS = ('chromium-headless-shell', 'chromium')
SOCKET = """
import asyncio, sys
from tornado.websocket import websocket_connect
async def read(address):
    page = await websocket_connect(address)
    while await page.read_message() is not None:
        pass
asyncio.run(read(sys.argv[1]))
"""


class Page:
    """The server and one page."""

    def __init__(self, folder: Path, browser: bool) -> None:
        command = [sys.executable, '-m', 'satvib_bringup.cli.main', 'watch', '--port', '0']
        self.server = subprocess.Popen(command, stdout=subprocess.PIPE)
        address = self.server.stdout.readline().decode().strip()
        if browser:
            program = next(p for p in BROWSERS if shutil.which(p))
            command = [program, '--headless', '--no-sandbox', '--disable-gpu']
            command += ['--remote-debugging-port=0', f'--user-data-dir={folder}', address]
        else:
            command = [sys.executable, '-c', SOCKET, f'ws{address.removeprefix("http")}/live']
        self.client = subprocess.Popen(
            command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, start_new_session=True
        )
        self.begin: tuple[float, float, float] | None = None

    def usage(self) -> tuple[float, float]:
        """Processor time of the server and of the client so far, s."""
        client = psutil.Process(self.client.pid)
        parts = [client, *client.children(recursive=True)]
        return (
            sum(psutil.Process(self.server.pid).cpu_times()[:2]),
            sum(sum(part.cpu_times()[:2]) for part in parts),
        )

    def memory(self) -> float:
        """Of the server, MB."""
        return psutil.Process(self.server.pid).memory_info().rss / 1e6

    def close(self) -> None:
        """End both."""
        os.killpg(self.client.pid, signal.SIGKILL)  # a browser is a group of processes
        self.server.terminate()
        for process in (self.client, self.server):
            process.wait(30)


class Stretches:
    """Opens and closes the page while the run goes on.

    Attributes:
        shares: of a processor, of the server and of its client, for each stretch with the page.
    """

    def __init__(self, folder: Path, browser: bool) -> None:
        self.folder, self.browser = folder, browser
        self.page: Page | None = None
        self.shares: list[tuple[float, float]] = []
        self.memory = 0.0

    def __call__(self, progress: Progress) -> None:
        """Open or close, and measure."""
        index, within = divmod(progress.time, STRETCH)
        wanted = index % 2 == 1
        if wanted and self.page is None:
            self.page = Page(self.folder / f'browser-{index:.0f}', self.browser)
        elif not wanted and self.page is not None:
            self.end(progress.time)
        if self.page is not None and self.page.begin is None and within >= SETTLING:
            self.page.begin = (progress.time, *self.page.usage())

    def end(self, now: float) -> None:
        """Close the page."""
        if self.page is None:
            return
        if self.page.begin is not None:
            since, *before = self.page.begin
            after = self.page.usage()
            self.shares.append(
                tuple((b - a) / (now - since) for a, b in zip(before, after, strict=True))
            )
            self.memory = self.page.memory()
        self.page.close()
        self.page = None


def main() -> None:
    """Run and print."""
    parser = argparse.ArgumentParser()
    parser.add_argument('--scenario', default='clean_3dof_narrowband')
    parser.add_argument('--seconds', type=float, default=80.0)
    parser.add_argument('--browser', action='store_true')
    options = parser.parse_args()
    end = options.seconds
    scenario = load_scenario(
        options.scenario,
        [f'duration={end}', f'analysis.controlled=[{end - 5.0}, {end}]'],
    )
    period = 1.0 / scenario.load_rig().acquisition.sample_rate
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        stretches = Stretches(folder, options.browser)
        arrivals = folder / 'arrivals.npz'
        try:
            outcome = run_experiment(
                scenario, folder / 'run', realtime=True, progress=stretches, arrivals=arrivals
            )
        finally:
            stretches.end(end)
        print(outcome.message)
        rows = np.load(arrivals)['voltages']
    index, within = np.divmod(rows[:, 1] * period, STRETCH)
    counted = (within >= SETTLING) & (index >= 2)
    found = []
    for text, odd in (('without', 0), ('with the page', 1)):
        some = rows[counted & (index % 2 == odd), 2]
        late = np.mean(some > period)
        p50, p99 = np.percentile(some, [50, 99])
        found.append((late, p50, p99))
        print(
            f'{text:14}: {len(some)} voltages, {100 * late:.3f} % late, median {1e3 * p50:.3f} ms, '
            f'99th percentile {1e3 * p99:.3f} ms'
        )
    print('ratios        : ' + ', '.join(
        f'{n} {b / a:.2f}' if a else f'{n} -' for n, a, b in
        zip(('late', 'median', '99th percentile'), *found, strict=True)))  # fmt: skip
    server, client = np.mean(stretches.shares, axis=0)
    print(f'server: {100 * server:.1f} % of a processor, {stretches.memory:.0f} MB')
    print(f'its page: {100 * client:.1f} % of a processor')


if __name__ == '__main__':
    main()
