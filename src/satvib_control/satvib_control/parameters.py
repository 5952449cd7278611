# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Parameters of a strut's controller; also the ROS parameters of `strut_controller`."""

from dataclasses import dataclass

from satvib_control.core.parameters import CoreParameters
from satvib_control.laws.feedforward.parameters import FeedforwardParameters
from satvib_control.laws.model_reference.parameters import ModelReferenceParameters
from satvib_control.laws.narrowband.parameters import NarrowbandParameters
from satvib_control.laws.registry import law_classes
from satvib_control.laws.state_space.parameters import StateSpaceParameters


@dataclass(frozen=True, kw_only=True)
class ControllerParameters(
    FeedforwardParameters,
    NarrowbandParameters,
    StateSpaceParameters,
    ModelReferenceParameters,
    CoreParameters,
):
    """All settings of a controller: those of its core and of every law, each with the prefix of its law.

    A room adds its schema here, and its settings become ROS parameters. A law reads only those of its own schema.
    """

    def check(self) -> None:
        """Refuse a law that cannot be found, then check what each schema checks."""
        law_classes(self.law)
        super().check()
