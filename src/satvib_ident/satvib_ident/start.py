# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Where the executables of this package begin, see `satvib_common.process.start`."""

from satvib_common.process.start import starter

strut_identifier = starter('satvib_ident.nodes.strut_identifier_node')
