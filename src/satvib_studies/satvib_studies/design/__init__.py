# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Fixed controllers that are designed on the rig's own model: LQG for all struts, a damper with a notch for each."""

from typing import TYPE_CHECKING

from satvib_common.door import door

if TYPE_CHECKING:
    from satvib_studies.design.closed_loop import closed_loop_poles, for_every_strut
    from satvib_studies.design.lqg import Lqg, design_lqg
    from satvib_studies.design.model import DesignModel, Shaking, design_model
    from satvib_studies.design.notch import design_notch
    from satvib_studies.design.search import (
        Designed,
        DesignSearch,
        DesignSettings,
        draw_design,
        write_design,
    )

__all__ = [
    'DesignModel',
    'DesignSearch',
    'DesignSettings',
    'Designed',
    'Lqg',
    'Shaking',
    'closed_loop_poles',
    'design_lqg',
    'design_model',
    'design_notch',
    'draw_design',
    'for_every_strut',
    'write_design',
]
__getattr__, __dir__ = door(__name__, __file__)
