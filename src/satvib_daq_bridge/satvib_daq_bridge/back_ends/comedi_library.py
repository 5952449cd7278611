# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""libcomedi by ctypes: the functions for single readings and writings, and its errors in words.

The names and types are those of comedilib 0.11, <comedilib.h>.
"""

import ctypes
import ctypes.util
import os
from typing import Any

from satvib_daq_bridge.back_ends.base import BackEndError, missing_library

AI, AO = 1, 2  # kinds of subdevices
UNIT_VOLT = 0
_OOR_NUMBER = 1  # a reading at an end of the range is a number, not NaN: the bridge has its own watch on rails
REFERENCES = {'ground': 0, 'common': 1, 'diff': 2, 'other': 3}


class Range(ctypes.Structure):
    """comedi_range."""

    _fields_ = (('min', ctypes.c_double), ('max', ctypes.c_double), ('unit', ctypes.c_uint))


_HANDLE, _UINT, _INT = ctypes.c_void_p, ctypes.c_uint, ctypes.c_int
_RANGE = ctypes.POINTER(Range)
_FUNCTIONS: dict[str, tuple[Any, tuple[Any, ...]]] = {
    'comedi_open': (_HANDLE, (ctypes.c_char_p,)),
    'comedi_close': (_INT, (_HANDLE,)),
    'comedi_errno': (_INT, ()),
    'comedi_strerror': (ctypes.c_char_p, (_INT,)),
    'comedi_set_global_oor_behavior': (_INT, (_INT,)),
    'comedi_get_board_name': (ctypes.c_char_p, (_HANDLE,)),
    'comedi_find_subdevice_by_type': (_INT, (_HANDLE, _INT, _UINT)),
    'comedi_get_n_channels': (_INT, (_HANDLE, _UINT)),
    'comedi_get_maxdata': (_UINT, (_HANDLE, _UINT, _UINT)),
    'comedi_find_range': (
        _INT,
        (_HANDLE, _UINT, _UINT, _UINT, ctypes.c_double, ctypes.c_double),
    ),
    'comedi_get_range': (_RANGE, (_HANDLE, _UINT, _UINT, _UINT)),
    'comedi_to_phys': (ctypes.c_double, (_UINT, _RANGE, _UINT)),
    'comedi_from_phys': (_UINT, (ctypes.c_double, _RANGE, _UINT)),
    'comedi_data_read': (_INT, (_HANDLE, _UINT, _UINT, _UINT, _UINT, ctypes.POINTER(_UINT))),
    'comedi_data_write': (_INT, (_HANDLE, _UINT, _UINT, _UINT, _UINT, _UINT)),
    'comedi_lock': (_INT, (_HANDLE, _UINT)),
    'comedi_unlock': (_INT, (_HANDLE, _UINT)),
}


class Comedi:
    """The library.

    Args:
        path: of the shared library; empty: where the system has it.

    Raises:
        SatvibError: it is not there.
    """

    def __init__(self, path: str = '') -> None:
        found = path or ctypes.util.find_library('comedi')
        if not found:
            raise missing_library('comedi', 'libcomedi', 'apt install libcomedi0')
        try:
            self._library = ctypes.CDLL(found)
        except OSError:
            raise missing_library('comedi', found, 'apt install libcomedi0') from None
        for name, (result, arguments) in _FUNCTIONS.items():
            function = getattr(self._library, name)
            function.restype, function.argtypes = result, arguments
        self._library.comedi_set_global_oor_behavior(_OOR_NUMBER)

    def call(self, name: str, *arguments: Any) -> Any:
        """Call a function and give its result as it is."""
        return getattr(self._library, name)(*arguments)

    def checked(self, where: str, name: str, *arguments: Any) -> Any:
        """Call a function; a result that means an error (-1, or none) is one.

        Raises:
            BackEndError: the error text of the library, with `where` it happened.
        """
        result = self.call(name, *arguments)
        if result is None or (isinstance(result, int) and result == -1):
            raise BackEndError(f'{where}: {name}: {self.error()}')
        return result

    def error(self) -> str:
        """Give the text of the library's last error."""
        number = self.call('comedi_errno')
        text = self.call('comedi_strerror', number)
        said = text.decode(errors='replace') if text else os.strerror(number)
        return said or f'error {number}'
