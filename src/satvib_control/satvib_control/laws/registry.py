# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The laws by name, and how to make one, or a sum of them."""

import importlib

from satvib_common.errors import SatvibError

from satvib_control.laws.base import Law
from satvib_control.laws.parameters import LawParameters
from satvib_control.laws.sum import LawSum

LAWS = {
    'off': 'satvib_control.laws.off:Off',
    'velocity_feedback': 'satvib_control.laws.velocity_feedback:VelocityFeedback',
    'model_reference': 'satvib_control.laws.model_reference.law:ModelReference',
    'narrowband': 'satvib_control.laws.narrowband.law:Narrowband',
    'feedforward': 'satvib_control.laws.feedforward.law:Feedforward',
    'state_space': 'satvib_control.laws.state_space.law:StateSpace',
    'centralized': 'satvib_control.laws.centralized.law:Centralized',
}


def law_class(name: str) -> type[Law]:
    """Find the class of a law by its name or by module:Class.

    Raises:
        SatvibError: no such law.
    """
    path = LAWS.get(name, name)
    module, colon, cls = path.partition(':')
    if not colon:
        raise SatvibError(
            f'law: {name!r} is not one of {", ".join(LAWS)}; a law of your own is module:Class'
        )
    try:
        found: type[Law] = getattr(importlib.import_module(module), cls)
    except (ImportError, AttributeError) as error:
        raise SatvibError(f'law: {name!r} cannot be loaded: {error}') from None
    if not callable(getattr(found, 'step', None)):
        raise SatvibError(f'law: {name!r} has no method step, see satvib_control.laws.base')
    return found


def law_classes(names: str) -> list[type[Law]]:
    """Find the classes of a sum of laws, such as velocity_feedback+feedforward; one law is a sum of one.

    Raises:
        SatvibError: no such law.
    """
    return [law_class(name.strip()) for name in names.split('+')]


def make_law(name: str, parameters: LawParameters, dt: float, shape: tuple[int, ...] = ()) -> Law:
    """Make a law, or a sum of them, by name; `dt` in s.

    Raises:
        SatvibError: no such law.
    """
    laws = law_classes(name)
    return laws[0](parameters, dt, shape) if len(laws) == 1 else LawSum(laws, parameters, dt, shape)
