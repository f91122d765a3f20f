"""Values of options that are no values.

Refused by argparse before anything is driven or written.
"""

from __future__ import annotations

import argparse

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_stack.command_line.numbers import real, whole
from ev_stack.command_line.options import arguments
from ev_stack.commands import run_scenario


@given(
    low=st.integers(-5, 5),
    width=st.integers(0, 10),
    text=st.one_of(st.integers(-20, 20).map(str), st.text()),
)
def test_a_whole_number_is_taken_within_its_bounds_and_refused_elsewhere(
    low: int, width: int, text: str
):
    try:
        expected = int(text)
    except ValueError:
        expected = None
    if expected is not None and low <= expected <= low + width:
        assert whole(low, low + width)(text) == expected
    else:
        with pytest.raises(
            argparse.ArgumentTypeError,
            match=f"expected a whole number from {low} to {low + width}$",
        ):
            whole(low, low + width)(text)


@pytest.mark.parametrize("text", ["nan", "inf", "-inf", "1e999", "", "fast", "-0.1", "181"])
def test_a_number_that_is_not_finite_or_out_of_bounds_is_refused(text: str):
    with pytest.raises(argparse.ArgumentTypeError, match=r"expected a number from 0 to 180$"):
        real(0.0, 180.0)(text)


@pytest.mark.parametrize("out", ["", " "])
def test_an_output_folder_that_is_none_is_refused(out: str, capsys: pytest.CaptureFixture):
    """`--out "$UNSET"` would write into the present folder."""
    with pytest.raises(SystemExit) as ended:
        arguments(["shchur2019", "--out", out])
    assert ended.value.code == 2
    assert capsys.readouterr().err.splitlines()[-1].endswith("expected a name")


@pytest.mark.parametrize(
    "words",
    [["sweep", "--seeds", "0"], ["benchmark", "--cells", "none"], ["tune", "none"]],
)
def test_commands_of_many_runs_show_how_python_came_to_an_error(words, capsys):
    """`--traceback` works as for a scenario."""
    with pytest.raises(SystemExit):
        run_scenario.main([*words, "--traceback"])
    assert "Traceback" in capsys.readouterr().err
