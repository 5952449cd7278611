# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Quantiles of chi squared and of F: SciPy's compiled functions, without the Python around them.

`import scipy.special` takes 0.4 s and 15 MB, of which its compiled functions are a tenth; a node needs one number of
them. The bits are SciPy's.
"""

import importlib
import sys
from functools import cache
from importlib.util import find_spec
from types import ModuleType
from typing import Any

_PACKAGE = 'scipy.special'


def chi_squared_above(freedom: Any, share: float) -> Any:
    """Give what chi squared with some degrees of freedom exceeds with a probability; arrays of any shape."""
    return _compiled().chdtri(freedom, share)


def chi_squared_below(freedom: float, share: float) -> float:
    """Give what chi squared with some degrees of freedom stays below with a probability."""
    return 2.0 * float(_compiled().gammaincinv(0.5 * freedom, share))


def f_below(numerator: float, denominator: float, share: float) -> float:
    """Give what F with some degrees of freedom of numerator and denominator stays below with a probability."""
    return float(_compiled().fdtri(numerator, denominator, share))


@cache
def _compiled() -> ModuleType:
    """Import the module of the compiled functions only.

    While it is imported, a package without content stands where SciPy's own would be.
    """
    if _PACKAGE in sys.modules:
        return importlib.import_module(f'{_PACKAGE}._ufuncs')
    spec = find_spec('scipy')
    assert spec is not None
    assert spec.submodule_search_locations is not None
    root = spec.submodule_search_locations[0]
    importlib.import_module('scipy')
    before = set(sys.modules)
    package = ModuleType(_PACKAGE)
    package.__path__ = [f'{root}/special']
    sys.modules[_PACKAGE] = package
    try:
        return importlib.import_module(f'{_PACKAGE}._ufuncs')
    finally:
        # who imports `scipy.special` later gets the whole package
        for name in set(sys.modules) - before:
            if name.startswith(_PACKAGE):
                del sys.modules[name]
