"""Any words for any command: status 2 with the usage, or one line; nothing is driven here."""

from __future__ import annotations

import contextlib
import io

from fuzz.fuzzing import assert_one_line, fuzzed
from hypothesis import example, given
from hypothesis import strategies as st

from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.offered_commands import offered_commands
from ev_stack.command_line.options import arguments, overrides, own_nodes
from ev_stack.commands import program
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.run_study import arguments as study_arguments
from ev_study.studies.run_study import study_cases
from ev_study.studies.study import study_named

_texts = st.text(st.characters(exclude_characters="\0", exclude_categories=["Cs"]), max_size=12)
_values = st.sampled_from(
    [".nan", "1e999", "[", "{a: 1}", "", "-1", "front_left", "80 km/h", "&a [*a]", "0:1:1e9", "1:2"]
)
_names = st.sampled_from(
    [
        "plant",
        "driver",
        "asr",
        "*",
        "drive",
        "method",
        "seed",
        "control_period",
        "vehicle.mass",
        "x",
    ]
)
_pairs = st.builds("{}.{}={}".format, _names, _names, _values | _texts)
_options = st.sampled_from(
    ["--set", "--method", "--params", "--vehicle", "--seed", "--duration", "--node", "--out", "--figures", "--offline",
     "--in-process", "--realtime", "--no-record", "--vary", "--seeds", "--workers", "--scheduler", "--lis", "-x"]
)  # fmt: skip
_words = st.lists(_options | _pairs | _values | _texts, max_size=6)


def refused(call) -> None:
    """Call it; it may end with status 2, or in one line."""
    output = io.StringIO()
    try:
        with contextlib.redirect_stderr(output), contextlib.redirect_stdout(output):
            call()
    except SystemExit as ended:
        if isinstance(ended.code, str):
            assert_one_line(ended.code)
        else:
            assert ended.code in (0, 2), ended.code
            assert ended.code == 0 or output.getvalue().strip()
            if ended.code:
                assert_one_line(output.getvalue().strip().rpartition("\n")[2])
                assert not set(output.getvalue()) & {"\x1b", "\r", "\x9b"}
    except ParameterError as error:
        assert_one_line(error)


@fuzzed(6, 0.5)
@given(words=_words, scenario=st.sampled_from(["shchur2019", "coast_down"]) | _texts)
@example(["--duration", "x" * 5000], "shchur2019")
@example(["--" + "x" * 5000], "shchur2019")
@example(["--\x1b[2J", "\r--set"], "shchur2019")
def test_the_words_of_a_run(words, scenario):
    def call() -> None:
        given_words = arguments([scenario, *words])
        own_nodes(given_words)
        if not given_words.list:
            load_scenario(given_words.scenario, overrides(given_words))

    refused(call)


@fuzzed(6, 0.3)
@given(words=_words)
def test_the_words_of_a_sweep(words):
    refused(
        lambda: study_cases(study_named("sweep"), study_arguments("sweep", ["coast_down", *words]))
    )


@fuzzed(12, 0.5)
@given(
    words=st.lists(_texts.filter(lambda text: text not in offered_commands().commands), max_size=3)
)
def test_unknown_commands(words):
    refused(lambda: program.perform(words))
