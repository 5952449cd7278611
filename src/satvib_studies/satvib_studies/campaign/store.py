# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a campaign keeps on disk, so that nothing finished is ever lost.

    campaign.json        what was asked for: the campaign, the scenario, what software
    manifest.json        which parts are finished, each with its SHA-256
    parts/000012.parquet one part; written beside, then renamed
    trials.parquet       all of it, when the last part is there; then the parts go

Every file appears whole or not at all. A part counts once the manifest names it.
"""

from __future__ import annotations

import hashlib
import json
from pathlib import Path
from typing import Any

import pyarrow as pa
from satvib_common.errors import SatvibError
from satvib_common.files.whole_file import write_whole
from satvib_experiment.scenario.scenario import Scenario

from satvib_studies.campaign.report.table import from_bytes, joined, to_bytes
from satvib_studies.campaign.settings import Campaign

FORMAT = 'satvib campaign 1'


class Store:
    """The folder of one campaign.

    Args:
        folder: it exists, and holds campaign.json.

    Raises:
        SatvibError: it does not, or something in it is damaged.
    """

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        about = _load_json(folder / 'campaign.json')
        if about.get('format') != FORMAT:
            raise SatvibError(f'{folder}: not the folder of a campaign ({FORMAT})')
        where = str(folder / 'campaign.json')
        self.campaign = Campaign.from_mapping(about.get('campaign'), where)
        self.scenario = Scenario.from_mapping(about.get('scenario'), where)
        self.software: dict[str, str] = about.get('software', {})
        self.digest = self.campaign.digest(self.scenario.to_mapping())
        if about.get('digest') != self.digest:
            raise SatvibError(f'{where}: was changed since the campaign began; start a new one')
        self._parts: dict[str, str] = {}
        self.result: str | None = None
        manifest = folder / 'manifest.json'
        if manifest.exists():
            kept = _load_json(manifest)
            if kept.get('digest') != self.digest or not isinstance(kept.get('parts'), dict):
                raise SatvibError(f'{manifest}: belongs to another campaign; start a new one')
            self._parts = kept['parts']
            self.result = kept.get('result')

    @classmethod
    def create(
        cls, folder: Path, campaign: Campaign, scenario: Scenario, software: dict[str, str]
    ) -> Store:
        """Begin a campaign in an empty folder."""
        about = {
            'format': FORMAT,
            'digest': campaign.digest(scenario.to_mapping()),
            'campaign': campaign.to_mapping(),
            'scenario': scenario.to_mapping(),
            'software': software,
        }
        _write_json(folder / 'campaign.json', about)
        return cls(folder)

    @property
    def finished(self) -> set[int]:
        """Numbers of the finished parts."""
        return {int(name) for name in self._parts}

    @property
    def trials_done(self) -> int:
        """Number of the finished trials."""
        return sum(len(self.campaign.chunk_of(i)) for i in self.finished)

    def _path(self, index: int) -> Path:
        return self.folder / 'parts' / f'{index:06d}.parquet'

    def keep(self, index: int, data: bytes) -> None:
        """Keep the Parquet file of a finished part.

        Raises:
            SatvibError: it cannot be written; what was kept before is still there.
        """
        path = self._path(index)
        try:
            path.parent.mkdir(exist_ok=True)
            write_whole(path, lambda sink: sink.write(data))
            self._parts[f'{index:06d}'] = hashlib.sha256(data).hexdigest()
            self._write_manifest()
        except SatvibError:
            self._parts.pop(f'{index:06d}', None)
            raise
        except OSError as error:
            raise SatvibError(f'{path}: cannot be written: {error.strerror}') from None

    def kept(self) -> str:
        """Words that say what is there and how to go on."""
        count = f'{self.trials_done} of {self.campaign.trials} trials are kept'
        return f'{count}, go on with: ./satvib campaign --resume {self.folder}'

    def _write_manifest(self) -> None:
        about = {'digest': self.digest, 'parts': dict(sorted(self._parts.items()))}
        if self.result is not None:
            about['result'] = self.result
        _write_json(self.folder / 'manifest.json', about)

    def _read(self, path: Path, wanted: str, remedy: str) -> pa.Table:
        try:
            data = path.read_bytes()
        except OSError as error:
            raise SatvibError(f'{path}: cannot be read: {error.strerror}; {remedy}') from None
        if hashlib.sha256(data).hexdigest() != wanted:
            raise SatvibError(f'{path}: is damaged, its checksum is another; {remedy}')
        return from_bytes(data)

    def check(self) -> None:
        """Check the parts before going on with them.

        Raises:
            SatvibError: one of them is damaged; it is named, and none is touched.
        """
        if self.result is None:
            for name in self._parts:
                self._part(name)

    def _part(self, name: str) -> pa.Table:
        remedy = f'{self.kept()} --redo {int(name)} runs its trials again'
        return self._read(self._path(int(name)), self._parts[name], remedy)

    def forget(self, index: int) -> None:
        """Count a part as not finished."""
        if self._parts.pop(f'{index:06d}', None) is None:
            raise SatvibError(f'{self.folder}: part {index} is not among the finished ones')
        self._write_manifest()

    def finish(self) -> pa.Table:
        """Join all parts to trials.parquet, once, and give the table.

        Raises:
            SatvibError: a part is damaged, or the file cannot be written.
        """
        target = self.folder / 'trials.parquet'
        if self.result is not None:
            return self._read(target, self.result, 'start a new campaign')
        data = to_bytes(joined([self._part(name) for name in sorted(self._parts)]))
        try:
            write_whole(target, lambda sink: sink.write(data))
            self.result = hashlib.sha256(data).hexdigest()
            self._write_manifest()
        except SatvibError as error:
            self.result = None
            raise SatvibError(f'{error}; {self.kept()}') from None
        for name in self._parts:
            self._path(int(name)).unlink(missing_ok=True)
        (self.folder / 'parts').rmdir()
        return from_bytes(data)


def _write_json(path: Path, about: dict[str, Any]) -> None:
    write_whole(path, lambda sink: sink.write(json.dumps(about, indent=1).encode() + b'\n'))


def _load_json(path: Path) -> dict[str, Any]:
    try:
        data = json.loads(path.read_text(encoding='utf-8'))
    except FileNotFoundError:
        raise SatvibError(f'{path}: no such file; is this the folder of a campaign?') from None
    except (OSError, ValueError) as error:
        raise SatvibError(f'{path}: is damaged: {error}') from None
    if not isinstance(data, dict):
        raise SatvibError(f'{path}: is damaged: a mapping is expected')
    return data
