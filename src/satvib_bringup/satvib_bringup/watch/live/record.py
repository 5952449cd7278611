# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Recording from the page: the node `recorder`, started and ended as a process of its own."""

import asyncio
from collections.abc import Iterable
from pathlib import Path

import yaml
from satvib_common.errors import SatvibError
from satvib_experiment.recording.run_folder import free_run_folder, make_run_folder

from satvib_bringup.live.supervisor import Supervisor
from satvib_bringup.live.workspace import executable, graph_environment
from satvib_bringup.recorder.check import REPORT

# not the name of the recorder of a run: a run refuses to begin beside one
NAME = 'watch_recorder'
_PATIENCE = 30.0  # s, to close the bags


class Recording:
    """Bags of what is heard, one for each graph (namespace above its struts).

    Args:
        base: folder under which runs are kept.
    """

    def __init__(self, base: Path) -> None:
        self._base = base
        self._supervisor: Supervisor | None = None
        self._names: list[str] = []
        self.folder: Path | None = None

    def start(self, struts: Iterable[str]) -> Path:
        """Begin to record struts (names with their namespaces); gives the folder.

        Raises:
            SatvibError: it is on already, there is no strut, or the folder cannot be made.
        """
        above: dict[str, list[str]] = {}
        for strut in struts:
            parent, _, own = strut.rpartition('/')
            above.setdefault(parent, []).append(own)
        if self._supervisor is not None:
            raise SatvibError(f'recording is on already, into {self.folder}')
        if not above:
            raise SatvibError('there is nothing to record yet: no strut is heard')
        folder = free_run_folder('watch', base=self._base).resolve()
        make_run_folder(folder)
        supervisor = Supervisor(folder / 'logs', graph_environment())
        for parent, names in above.items():
            place = folder / parent.replace('/', '.') if parent else folder
            place.mkdir(exist_ok=True)
            self._begin(supervisor, place, parent, names)
        self._supervisor, self.folder = supervisor, folder
        return folder

    def _begin(self, supervisor: Supervisor, place: Path, parent: str, struts: list[str]) -> None:
        parameters = {
            'folder': str(place / 'bag'),
            'struts': struts,
            'report': str(place / REPORT),
        }
        settings = place / 'recorder.yaml'
        settings.write_text(yaml.safe_dump({'/**': {'ros__parameters': parameters}}))
        command = [str(executable('satvib_bringup', 'recorder')), '--ros-args']
        command += ['-r', f'__ns:=/{parent}', '-r', f'__node:={NAME}']
        command += ['--params-file', str(settings)]
        name = f'{parent}/{NAME}'.lstrip('/')
        supervisor.start(name, command)
        self._names.append(name)

    def ended(self) -> list[str]:
        """What has ended by itself since the last call; then nothing is recorded any more."""
        if self._supervisor is None:
            return []
        return [str(ending) for ending in self._supervisor.ended()]

    async def stop(self) -> Path:
        """End it and wait until the bags are closed; gives their folder.

        Raises:
            SatvibError: it is not on, or a recorder failed.
        """
        supervisor, folder = self._supervisor, self.folder
        if supervisor is None or folder is None:
            raise SatvibError('recording is not on')
        self._supervisor, self.folder = None, None
        endings = await asyncio.to_thread(supervisor.stop, self._names, _PATIENCE)
        self._names.clear()
        supervisor.__exit__()
        if failed := [str(ending) for ending in endings if ending.code]:
            raise SatvibError('; '.join(failed))
        return folder
