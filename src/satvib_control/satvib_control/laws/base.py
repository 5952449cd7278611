# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What a control law is. `laws.registry` makes one by its name.

A law turns the samples of one strut into a wanted voltage. It has no clock, no ROS and no limits: `ControllerCore`
removes the bias, the voltage guard limits the voltage, and the next sample says which voltage was applied.

A law of your own is a class with this constructor and `step`, chosen by `law: my_package.my_module:MyLaw`:

    class Proportional(BasicLaw):
        def step(self, x: LawInput, phase: Phase) -> Array:
            return np.where(x.valid, -2.0 * x.upper, 0.0)

Everything has the leading axes `shape`. Per-sample arithmetic is elementwise or a `satvib_common.kernels.compile`.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, fields
from typing import TYPE_CHECKING, Any, Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from satvib_common.arrays import Array, Complex, Integers, Mask
from satvib_common.phases import Phase

from satvib_control.laws.parameters import LawParameters

if TYPE_CHECKING:
    from satvib_ident.models.iir_model import IirModel

P = TypeVar('P', bound=LawParameters)


@dataclass(frozen=True)
class LawInput:
    """One sample of a strut.

    Attributes:
        sequence: index of the sample.
        upper: shape, m/s^2; upper acceleration without its bias, 0 where it was not measured.
        lower: shape, m/s^2; lower acceleration without its bias, NaN where it was not measured.
        applied: shape, V; the voltage computed from the sample before, as the guard let it through.
        saturated: shape, bool; the guard changed it, or the divergence watch holds it at 0 V. Nothing is learnt.
        valid: shape, bool; the upper acceleration was measured. Nothing is learnt where it was not.
        fade: shape; share of the demand of the sample before that went to the guard: less than 1 at the start of
            CONTROL and where the divergence watch reduces it, 0 in the phases without a law.
        upper_clipped, lower_clipped: shape, bool; the sensor stands at an end of its range, so the acceleration is at
            least what is given. Nothing is learnt from it.
    """

    sequence: int
    upper: Array
    lower: Array
    applied: Array
    saturated: Mask
    valid: Mask
    fade: Array | float = 1.0
    upper_clipped: Mask | np.bool_ = np.False_
    lower_clipped: Mask | np.bool_ = np.False_


@dataclass
class LawState:
    """The figures that help to tune a law; fields as in satvib_msgs/ControllerState, each (shape).

    NaN means that the law does not have this figure. `reason` holds codes of `satvib_control.laws.reasons`.
    """

    shape: tuple[int, ...] = ()
    reference: Array = field(init=False)
    model_output: Array = field(init=False)
    error: Array = field(init=False)
    kp: Array = field(init=False)
    ki: Array = field(init=False)
    kd: Array = field(init=False)
    ki_min: Array = field(init=False)
    ki_max: Array = field(init=False)
    sensitivity: Array = field(init=False)
    weight_norm: Array = field(init=False)
    frequency: Array = field(init=False)
    adapting: Mask = field(init=False)
    reason: Integers = field(init=False)

    def __post_init__(self) -> None:
        """Begin with nothing known."""
        for name in STATE_FIELDS:
            setattr(self, name, np.full(self.shape, np.nan))
        self.reference = np.zeros(self.shape)
        self.adapting = np.zeros(self.shape, dtype=bool)
        self.reason = np.zeros(self.shape, dtype=np.int64)

    def copy(self) -> 'LawState':
        """Give a state that keeps what this one shows now; laws make new arrays and do not write into old ones."""
        other = object.__new__(LawState)
        other.__dict__.update(self.__dict__)
        return other


# figures of a law, by the names of their fields in satvib_msgs/ControllerState
STATE_FIELDS = tuple(
    f.name for f in fields(LawState) if f.name not in {'shape', 'adapting', 'reason'}
)


@runtime_checkable
class Law(Protocol):
    """The interface of every law.

    Attributes:
        needs_model: the law gives 0 V until it has an identified model.
        cancels: in a sum, the law sees the plant without the feedback of the other parts (see `laws.sum`).
        closes_loop: the voltage depends on the upper acceleration; in a sum, the law gets a share of the gain budget.
        state: what the law shows; renewed by every `step`.
    """

    needs_model: bool
    closes_loop: bool
    cancels: bool
    state: LawState

    def __init__(self, parameters: Any, dt: float, shape: tuple[int, ...] = ()) -> None:
        """Take the parameters of the whole controller, the sample period (s) and the leading axes."""

    def step(self, x: LawInput, phase: Phase) -> Array:
        """Take a sample, of any phase, and give the wanted voltage (shape, V).

        The voltage is used in ADAPT and CONTROL only; in the other phases a law keeps its filters running. A demand
        that is not finite latches a fault.
        """

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:
        """Take the identified model where `trusted` (shape) holds, and keep the old one elsewhere.

        `covariance` (*shape, n + m, n + m) is that of (a1..an, b1..bm).
        """

    def apply(self, parameters: Any) -> None:
        """Take new values of the parameters that are not read-only."""

    def reset(self, mask: Mask | bool = True) -> None:
        """Forget the past where `mask` (shape) holds: filters at rest, gains at their start."""


class BasicLaw(Generic[P]):
    """A law that needs no model and has no memory; the usual base class.

    Args:
        parameters: those of the whole controller. `BasicLaw[P]` says that the law reads those of the schema P only.
        dt: s, sample period.
        shape: leading axes.
    """

    needs_model = False
    closes_loop = True
    cancels = False
    settings: frozenset[str] = frozenset()  # names of the parameters that are this law's alone
    fixed_filter = False  # the voltage is -C y, and `response` gives C
    hears_partners = (
        False  # in a sum, the law keeps the margin of all loops together (see `laws.sum`)
    )

    def __init__(self, parameters: P, dt: float, shape: tuple[int, ...] = ()) -> None:
        self.parameters, self.dt, self.shape = parameters, dt, shape
        self.state = LawState(shape)

    def set_model(self, model: 'IirModel', trusted: Mask, covariance: Array | None = None) -> None:
        """Nothing to do without a model."""

    def apply(self, parameters: P) -> None:
        """Keep the parameters; a law reads what may change on each sample."""
        self.parameters = parameters

    def effect_of(self, names: frozenset[str], known: bool) -> str:
        """Say what people should know about settings that `apply` has just taken; empty: they act as set.

        Args:
            names: of the settings.
            known: the law has a trusted model of every strut.
        """
        waits = self.needs_model and not known and names & self.settings
        return 'acts when a trusted model is taken; until then 0 V' if waits else ''

    def reset(self, mask: Mask | bool = True) -> None:
        """Nothing to forget."""

    def response(self, omega: Array) -> Complex:
        """C at frequencies (*shape, q) in rad/sample, u = -C y, of a law that is a `fixed_filter`."""
        raise NotImplementedError

    def hear_partners(self, response: Callable[[Array], Complex]) -> None:
        """Take C of the loops beside this one together, for a law that `hears_partners`; after each `set_model`."""
