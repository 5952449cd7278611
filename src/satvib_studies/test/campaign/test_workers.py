# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Campaigns on several processes: the same bytes however many there are, and whatever becomes of them."""

import os
import signal
import socket
import ssl
import subprocess
import sys
from contextlib import ExitStack, contextmanager, suppress

import psutil
import pytest
import yaml
from satvib_common.errors import SatvibError
from satvib_studies.campaign import workers
from satvib_studies.campaign.keys import write_keys
from satvib_studies.campaign.run import begin, go_on
from satvib_studies.campaign.settings import Campaign
from satvib_studies.campaign.store import Store

pytestmark = pytest.mark.filterwarnings('ignore::ResourceWarning')

CAMPAIGN = Campaign(
    name='shared', scenario='quick_3dof', trials=40, chunk=5,
    parameters={'rig.payload.mass': {'kind': 'uniform', 'low': 7.0, 'high': 11.0}},
)  # fmt: skip


@pytest.fixture(scope='module')
def wanted(tmp_path_factory):
    """The bytes of the table that this process makes alone."""
    folder = tmp_path_factory.mktemp('alone') / 'c'
    go_on(begin(CAMPAIGN, folder), workers=0)
    return (folder / 'trials.parquet').read_bytes()


@contextmanager
def process(*words, **more):
    """A Dask process of its own, with more variables; gone at the end."""
    env = os.environ | {'PYTHONPATH': os.pathsep.join(p for p in sys.path if p)} | more
    started = subprocess.Popen(
        [sys.executable, '-m', *words], env=env,
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL,
    )  # fmt: skip
    try:
        yield started
    finally:
        started.kill()
        started.wait(10)


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


def alive(group):
    """Processes of a group that have not ended; one that only waits to be collected has."""
    found = []
    for other in psutil.process_iter(['pid', 'status']):
        with suppress(ProcessLookupError):
            if os.getpgid(other.pid) == group and other.info['status'] != psutil.STATUS_ZOMBIE:
                found.append(other.pid)
    return found


@pytest.mark.parametrize('count', [pytest.param(1, marks=pytest.mark.long), 2])
def test_any_number_of_processes_gives_the_same_bytes(tmp_path, wanted, count):
    """Truth: the table made without any other process; equal bytes."""
    folder = tmp_path / 'c'
    go_on(begin(CAMPAIGN, folder), workers=count)
    assert (folder / 'trials.parquet').read_bytes() == wanted


@pytest.fixture
def keys(tmp_path):
    """A file of keys, and Dask's settings with it in this process."""
    import dask
    import distributed  # noqa: F401 - brings its settings

    path = tmp_path / 'keys.yaml'
    write_keys(path)
    with dask.config.set(dask.config.merge(dask.config.config, yaml.safe_load(path.read_text()))):
        yield path


def listening(pid):
    """Addresses on which a process waits for connections."""
    return {
        f'{c.laddr.ip}:{c.laddr.port}'
        for c in psutil.Process(pid).net_connections('inet')
        if c.status == psutil.CONN_LISTEN
    }


def test_scheduler_and_two_workers_of_which_one_is_killed(tmp_path, wanted, keys):
    """Truth: the table made without any other process; equal bytes, though a worker dies after the first part.

    The processes have keys: each listens at one address, where TLS is spoken, and has no port for web pages.
    """
    port = free_port()
    address = f'tls://127.0.0.1:{port}'
    worker = ('dask', 'worker', address, '--host', '127.0.0.1', '--nthreads', '1', '--no-nanny')
    words = ('dask', 'scheduler', '--host', address)
    with ExitStack() as stack:
        scheduler = stack.enter_context(process(*words, DASK_CONFIG=str(keys)))
        pair = [stack.enter_context(process(*worker, DASK_CONFIG=str(keys))) for _ in range(2)]
        from distributed import Client

        with Client(address, timeout=60, set_as_default=False) as client:
            client.wait_for_workers(2, timeout=60)
            spoken = {client.scheduler.address, *client.scheduler_info()['workers']}
        assert {a.partition('://')[0] for a in spoken} == {'tls'}
        served = set().union(*(listening(p.pid) for p in (scheduler, *pair)))
        assert served == {a.partition('://')[2] for a in spoken}
        assert refused_without_keys(port)
        seen = []

        def told(done, _):
            seen.append(done)
            if done > 0 and pair[0].poll() is None:
                pair[0].kill()
                pair[0].wait(10)

        folder = tmp_path / 'c'
        go_on(begin(CAMPAIGN, folder), scheduler=address, progress=told)
        assert pair[0].poll() is not None
        assert pair[1].poll() is None
    assert seen[-1] == 40
    assert (folder / 'trials.parquet').read_bytes() == wanted


def refused_without_keys(port):
    """Whether a scheduler closes the connection of somebody who has no certificate."""
    context = ssl.create_default_context()
    context.check_hostname, context.verify_mode = False, ssl.CERT_NONE
    with socket.create_connection(('127.0.0.1', port)) as plain:
        plain.settimeout(60.0)
        with context.wrap_socket(plain) as spoken:
            try:  # TLS 1.3 tells it with the first answer
                return spoken.recv(1) == b''
            except ssl.SSLError as error:
                return 'CERTIFICATE_REQUIRED' in str(error)


def test_keys_are_for_their_owner_and_not_overwritten(keys):
    assert keys.stat().st_mode & 0o777 == 0o600
    with pytest.raises(SatvibError, match=r'keys\.yaml: exists already'):
        write_keys(keys)


@pytest.mark.parametrize(
    ('address', 'open_'),
    [
        ('tcp://10.0.0.2:8786', True),
        ('10.0.0.2:8786', True),
        ('tls://10.0.0.2:8786', False),
        ('tcp://127.0.0.1:8786', False),
        ('tcp://localhost:8786', False),
    ],
)
def test_a_scheduler_without_keys_is_said(address, open_):
    assert ('neither encrypted' in workers.unprotected(address)) == open_


@pytest.mark.long
def test_control_c_ends_all_processes_and_keeps_the_parts(tmp_path):
    """Truth: the page on campaigns; exit 130, no traceback of anybody, the parts that were told are there."""
    file, folder = tmp_path / 'c.yaml', tmp_path / 'c'
    file.write_text(
        'scenario: quick_3dof\ntrials: 400\nchunk: 5\nparameters:\n'
        '  rig.payload.mass: {kind: uniform, low: 7.0, high: 11.0}\n'
    )
    env = os.environ | {'PYTHONPATH': os.pathsep.join(p for p in sys.path if p)}
    words = ['-m', 'satvib_bringup.cli.main', 'campaign', file, '--folder', folder, '-j', '2']
    with subprocess.Popen(
        [sys.executable, *map(str, words)], env=env, text=True, start_new_session=True,
        stdout=subprocess.PIPE, stderr=subprocess.PIPE,
    ) as running:  # fmt: skip
        for line in running.stdout:
            if '10 of 400' in line:
                os.killpg(running.pid, signal.SIGINT)  # as a terminal does: to all of the group
                break
        told, errors = running.communicate(timeout=60)
    assert running.returncode == 130
    assert errors == ''  # no word of the workers'
    assert f'--resume {folder}' in told
    assert Store(folder).trials_done >= 10
    assert alive(running.pid) == []


@pytest.mark.long
def test_a_scheduler_that_goes_away_is_one_line(tmp_path):
    """Truth: the page on campaigns; the parts that were told are kept, and the line says how to go on."""
    address = f'tcp://127.0.0.1:{free_port()}'
    with ExitStack() as stack:
        words = ('dask', 'scheduler', '--host', address, '--no-dashboard')
        scheduler = stack.enter_context(process(*words))
        stack.enter_context(
            process('dask', 'worker', address, '--nthreads', '1', '--no-nanny', '--no-dashboard')
        )

        def told(done, _):
            if done >= 10 and scheduler.poll() is None:
                scheduler.kill()
                scheduler.wait(10)

        store = begin(CAMPAIGN, tmp_path / 'c')
        with pytest.raises(SatvibError, match=r'is lost .*; \d+ of 40 trials are kept.*--resume'):
            go_on(store, scheduler=address, progress=told)
    assert store.trials_done >= 10


def test_an_unreachable_scheduler_is_one_line(tmp_path, monkeypatch):
    """Truth: nobody listens there; the message names the address and what to do, and the campaign can go on later."""
    monkeypatch.setattr(workers, '_CONNECT', 1)
    address = f'tcp://127.0.0.1:{free_port()}'
    store = begin(CAMPAIGN, tmp_path / 'c')
    with pytest.raises(SatvibError, match='cannot be reached') as caught:
        go_on(store, scheduler=address)
    assert address in str(caught.value)
    assert '\n' not in str(caught.value)
    assert store.trials_done == 0


@pytest.mark.parametrize('address', ['nonsense', 'udp://1.2.3.4:5', 'tcp://'])
def test_an_address_that_is_none_is_one_line(tmp_path, monkeypatch, address):
    """Truth: as above."""
    monkeypatch.setattr(workers, '_CONNECT', 1)
    with pytest.raises(SatvibError, match='cannot be reached') as caught:
        go_on(begin(CAMPAIGN, tmp_path / 'c'), scheduler=address)
    assert '\n' not in str(caught.value)


def test_a_worker_with_other_software_is_refused():
    """Truth: trials of two versions are not of one kind; the message names machine, library and versions."""
    from satvib_studies.campaign.trials import plan_trials

    plan = plan_trials(CAMPAIGN).part([0])
    with pytest.raises(SatvibError, match=r'numpy .* the campaign has 0\.1'):
        workers.run_task(plan, 0, {'numpy': '0.1'})
