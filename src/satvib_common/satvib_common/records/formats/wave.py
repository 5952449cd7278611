# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""WAV files, by scipy.io.wavfile: channels are numbers, and whole numbers are parts of full scale, from -1 to 1.

A WAV file knows no units: full scale is what `--input-unit '10 V'` says.
"""

import functools
import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from satvib_common.arrays import Array
from satvib_common.errors import SatvibError
from satvib_common.records.formats.channels import Channel, Channels
from satvib_common.records.formats.kinds import WAVE, one_line

_CUT = re.compile('EOF|prematurely|incomplete', re.IGNORECASE)


@contextmanager
def channels(path: Path, recover: bool = False) -> Iterator[Channels]:
    """List the channels of a file.

    Args:
        path: the file.
        recover: read what is there of a file that is cut.

    Raises:
        SatvibError: the file is damaged or cut.
    """
    from scipy.io import wavfile

    with one_line(path, WAVE.what):
        with warnings.catch_warnings(record=True) as said:
            warnings.simplefilter('always')
            try:
                rate, values = wavfile.read(path)
            except ValueError:  # the file ends within a sample of all channels
                rate, values = wavfile.read(_whole_samples(path))
        cut = next((str(w.message) for w in said if _CUT.search(str(w.message))), '')
    if cut and not recover:
        raise SatvibError(
            f'{path}: {cut.rstrip(".")}: the file is cut; --recover reads what is there'
        )
    if rate <= 0:
        raise SatvibError(f'{path}: damaged: its sample rate is {rate} Hz')
    columns = values.reshape(len(values), -1)
    found = [
        Channel(
            name=f'channel {i + 1}',
            short=str(i + 1),
            size=len(columns),
            load=functools.partial(part_of_full_scale, columns[:, i]),
            period=1.0 / rate,
        )
        for i in range(columns.shape[1])
    ]
    yield Channels(found, notes=[f'{cut}; what is there is used'] if cut else [])


def _whole_samples(path: Path) -> BytesIO:
    """The bytes of a file without a last sample that not all channels have; as it is where that is not the reason."""
    content = path.read_bytes()
    form, data = content.find(b'fmt '), content.find(b'data')
    begin = data + 8
    size = int.from_bytes(content[form + 20 : form + 22], 'little') if form >= 0 else 0
    more = (len(content) - begin) % size if data >= 0 and size else 0
    return BytesIO(content[: len(content) - more])


def part_of_full_scale(values: Any) -> Array:
    """Whole numbers as parts of full scale, from -1 to 1; 24 bits come in the upper ones of 32."""
    if values.dtype.kind == 'f':
        return np.asarray(values, dtype=np.float64)
    middle = 128.0 if values.dtype.kind == 'u' else 0.0
    full = 2.0 ** (8 * values.dtype.itemsize - 1)
    return np.asarray((values.astype(np.float64) - middle) / full)
