# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""The colours of the struts, for figures and for the page: Okabe and Ito's palette, for colour-blind readers too."""

STRUTS = ('#0072B2', '#D55E00', '#009E73', '#CC79A7', '#E69F00', '#56B4E9')
