"""Text from outside is shown on one line of limited length, and no terminal obeys it."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.refusal import LONGEST, quoted, shown

ANYTHING = st.text(max_size=3 * LONGEST) | st.text(
    st.sampled_from("\x1b[2J\n\r\t\x07\x9b\u202e\0\ud800a "), max_size=600
)


@given(text=ANYTHING)
def test_any_text_is_one_printable_line_of_a_bounded_length(text):
    line = shown(text)
    assert len(line) <= LONGEST
    assert line.isprintable()
    line.encode()


@given(text=st.text(st.characters(categories=("L", "N", "P"), max_codepoint=255), max_size=LONGEST))
def test_what_is_short_and_printable_stays_as_it_is(text):
    assert shown(text) == text


def test_of_a_long_text_begin_and_end_are_shown():
    assert shown("begin " + "x" * 5000 + " end").startswith("begin xxx")
    assert shown("begin " + "x" * 5000 + " end").endswith(" end")


def test_a_value_that_python_cannot_write_is_named_by_its_kind():
    assert quoted(10**5000) == "some int"
    assert quoted("a\nb") == "'a\\nb'"
