# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""What the tests of set-up share: `tools/` and this folder can be imported."""

import sys
from pathlib import Path

FOLDER = Path(__file__).resolve().parent
for place in (FOLDER, FOLDER.parent.parent / 'tools'):
    if str(place) not in sys.path:
        sys.path.insert(0, str(place))
