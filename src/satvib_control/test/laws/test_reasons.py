# SPDX-FileCopyrightText: 2026 The satvib authors
# SPDX-License-Identifier: Apache-2.0
"""Texts as numbers. Truth: by hand."""

from satvib_control.laws.reasons import ForeignTexts, reason, text_of


def test_a_text_keeps_its_code():
    code = reason('a text of this test')
    assert reason('a text of this test') == code
    assert text_of(code) == 'a text of this test'
    assert reason('') == 0


def test_texts_from_elsewhere_are_so_many():
    """Each is shown as it is while there is room, then without its figures, then as one of many."""
    texts = ForeignTexts(most=3)
    first = [f'off by {k} %, Q/h 1.{k}e+02' for k in range(3)]
    assert [texts.take(text) for text in first] == first
    assert texts.take('off by 8 %, Q/h 3.1e+02') == 'off by ... %, Q/h ...'
    assert texts.take(first[1]) == first[1]
    assert texts.take('another') == 'one of many reasons; see the message identified_model'
    found = {texts.take(f'reason {k} of a stranger {"x" * k}') for k in range(1000)}
    assert len(found) == 1
