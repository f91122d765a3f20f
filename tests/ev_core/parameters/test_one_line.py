"""Refusals are one line whatever the user has written."""

from ev_msgs_py.refusal import ParameterError


def test_line_breaks_in_a_name_do_not_break_the_line():
    error = ParameterError("a\nb\r\u2028c.yaml: no such file")
    assert str(error) == r"a\nb\r\u2028c.yaml: no such file"
    assert len(str(error).splitlines()) == 1
