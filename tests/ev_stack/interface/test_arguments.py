"""Arguments of public functions: another kind than is expected is one line, before anything is done."""

from __future__ import annotations

import inspect
import math
import re
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Annotated, Any, Literal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ev_stack
import ev_study
from ev_core.law import DriverCommand, WheelTorqueRequest
from ev_core.methods.register import method
from ev_core.parameters.declaration import parameter
from ev_core.parameters.record import entry, row, series
from ev_doors.learning.environment import Environment
from ev_doors.learning.vector import VectorEnvironment
from ev_msgs_py import arguments
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.batch import batch
from ev_stack.batches.observer import last
from ev_stack.interface.simulation import SteppedLaw
from ev_stack.measures.metric import Metric
from ev_stack.report.tables import short_lines

VALUES = {
    "none": st.none(),
    "text": st.text(),
    "path": st.text(alphabet="ab/", min_size=1).map(Path),
    "bytes": st.binary(),
    "bool": st.sampled_from([True, False, np.True_]),
    "whole": st.integers() | st.integers(0, 9).map(np.int64),
    "number": st.floats(allow_nan=False) | st.floats(0.0, 9.0).map(np.float64),
    "nan": st.sampled_from([math.nan, np.float64(math.nan)]),
    "complex": st.complex_numbers(),
    "texts": st.lists(st.text(), min_size=1),
    "numbers": st.lists(st.integers(), min_size=1),
    "array": st.just(np.array(5.0)),
    "texts by name": st.dictionaries(st.text(), st.text(), min_size=1),
    "numbers by name": st.dictionaries(st.text(), st.integers(), min_size=1),
    "by number": st.dictionaries(st.integers(), st.text(), min_size=1),
    "function": st.just(len),
    "object": st.builds(SimpleNamespace),
    "reductions": st.just({"end": last("imu.yaw_rate")}),
}
NAME = {"text", "path"}
TEXTS = {"texts"}
NUMBER = {"whole", "number"}
BY_NAME = {"texts by name", "numbers by name", "reductions"}
CHANGES = {
    "method": {"none", "texts by name"},
    "set": {"none", *BY_NAME},
    "seed": {"none", "whole"},
    "duration": {"none", "text", *NUMBER},
    "vehicle": {"none", *NAME},
    "params": {"none", *TEXTS},
    "cycle": {"none", *NAME},
}
ANYTHING = set(VALUES)
OF_RUNS = {"none", "reductions"}  # a reduction is a tuple to Python, and so has several values
OF_STUDIES = {"run": {"text"}, "metrics": TEXTS, "workers": {"none", "whole"}, **CHANGES}
ENVIRONMENT = {
    "scenario": NAME,
    "action": {"text"},
    "observe": TEXTS,
    "reward": {"none", "function"},
    "ends": {"function"},
    "run": {"text"},
    "record": {"bool"},
    "render_mode": {"none", "text"},
    **CHANGES,
}
# By function the kinds that each argument takes; `self` is left out.
CALLS = {
    ev_stack.run: {"scenario": NAME, "runs": TEXTS, "metrics": TEXTS, **CHANGES},
    ev_stack.batch: {
        "scenario": NAME,
        "vary": OF_RUNS,
        "run": {"text"},
        "signals": TEXTS,
        "every": {"whole"},
        "metrics": {"none", "texts", "reductions"},
        "initial_states": {"none", *BY_NAME},
        "threads": {"none", "whole"},
        **CHANGES,
    },
    batch: {
        "configurations": set(),
        "duration": NUMBER,
        "vary": OF_RUNS,
        "initial_states": {"none", *BY_NAME},
        "signals": TEXTS,
        "every": {"whole"},
        "metrics": {"none", "texts", "reductions"},
        "threads": {"none", "whole"},
        "hashes": {"bool"},
        "ending": {"none"},
    },
    ev_study.compare: {"scenario": NAME, "methods": TEXTS, **OF_STUDIES},
    ev_study.sweep: {"scenario": NAME, "vary": OF_RUNS, "seeds": {"whole"}, **OF_STUDIES},
    ev_study.StudyResult.figures: {"width": NUMBER},
    ev_study.StudyResult.plot: {"panels": TEXTS, "width": NUMBER},
    ev_stack.Simulation.__init__: {
        "scenario": NAME,
        "without": TEXTS,
        "run": {"text"},
        "record": {"bool"},
        **CHANGES,
    },
    ev_stack.Simulation.reset: {"seed": {"none", "whole"}},
    ev_stack.Simulation.step: {"inputs": {"none", "numbers by name"}},
    SteppedLaw.answer: {"time": NUMBER, "given": {"numbers by name"}},
    ev_stack.Result.figures: {"width": NUMBER},
    ev_stack.Result.data_frame: {"run": {"text"}},
    ev_stack.Result.plot: {
        "others": set(),
        "signals": TEXTS,
        "panels": TEXTS,
        "names": TEXTS,
        "width": NUMBER,
    },
    ev_stack.Result.save: {
        "directory": {"none", *NAME},
        "formats": set(),
        "width": NUMBER,
        "panels": TEXTS,
    },
    ev_stack.Result.write_report: {"folder": {"path"}, "figures": BY_NAME, "page": {"bool"}},
    Environment.__init__: ENVIRONMENT,
    Environment.reset: {"seed": {"none", "whole"}, "options": {"none", *BY_NAME}},
    VectorEnvironment.reset: {
        "seed": {"none", "whole", "numbers"},
        "options": {"none", *BY_NAME},
    },
    VectorEnvironment.__init__: {
        "num_envs": {"whole"},
        "vary": OF_RUNS,
        "autoreset_mode": {"text"},
        "threads": {"none", "whole"},
        "of_each": ANYTHING,
    },
    method: {"role": {"text"}, "name": {"text"}, "how": ANYTHING},
    entry: {"start": {*NUMBER, "bool"}, "unit": {"text"}, "about": {"text"}},
    series: {"count": {"whole"}, "start": {*NUMBER, "bool"}, "unit": {"text"}, "about": {"text"}},
    row: {"places": set()},
}
WRONG = [
    (call, name, kind)
    for call, takes in CALLS.items()
    for name, kinds in takes.items()
    for kind in sorted(ANYTHING - kinds)
]


def public_functions() -> set:
    """Functions that the packages offer, and methods with arguments of the classes they offer."""
    found = set()
    names = [(ev_stack, name) for name in ev_stack.__all__]
    names += [(ev_study, name) for name in ev_study.__all__]
    for package, name in names:
        offered = getattr(package, name)
        if not inspect.isclass(offered):
            found.add(offered)
        elif not issubclass(offered, Exception):
            own = vars(offered).items()
            methods = [each for name, each in own if inspect.isfunction(each) and name[0] != "_"]
            found |= {each for each in methods if len(inspect.signature(each).parameters) > 1}
    return found


def test_every_argument_of_every_public_function_is_checked():
    """A function or an argument that is new has to be named above."""
    assert public_functions() <= set(CALLS)
    for call, takes in CALLS.items():
        assert {*inspect.signature(call).parameters} - {"self"} == {*takes}


@settings(max_examples=800)
@given(st.sampled_from(WRONG), st.data())
def test_any_value_of_another_kind_is_one_line_before_anything_is_done(wrong, data):
    """All frames of the traceback are those of the check: the function has not begun."""
    call, name, kind = wrong
    value = data.draw(VALUES[kind], label=f"{call.__qualname__} {name}")
    signature = inspect.signature(call).parameters
    # The object of a method is not looked at before its arguments are checked.
    placed = [None] if "self" in signature else []
    named = {name: value}
    if signature[name].kind is inspect.Parameter.VAR_POSITIONAL:
        placed.append(named.pop(name))
    with pytest.raises(ParameterError) as refused:
        call(*placed, **named)
    text = str(refused.value)
    assert text.startswith(name)
    assert " is refused, expected " in text
    assert text.isprintable()
    frames = traceback.extract_tb(refused.value.__traceback__)[1:]
    assert {each.filename for each in frames} == {arguments.__file__}


@pytest.mark.parametrize(
    ("kind", "right", "wrong", "words"),
    [
        (Mapping, {"a": 1}, ["a"], "a mapping from values to values"),
        (dict[str, int], {"a": 1}, {"a": "b"}, "a whole number"),
        (Sequence, ["a", 1], "a", "a list of values"),
        (Sequence[int | str], ["a", 1], [1.5], "a whole number or a text"),
        (Literal["pdf", "svg"], "pdf", 1, "pdf or svg"),
        (Annotated[int, "one or more"], 1, 1.5, "one or more"),
        (Callable[..., Any], len, 5, "a function"),
        (float | None, None, True, "a number"),
    ],
)
def test_words_for_what_is_expected_follow_from_the_annotation(kind, right, wrong, words):
    """A wrong part of a list or mapping is named with its place."""

    def call(given):
        return given

    call.__annotations__["given"] = kind
    call = arguments.checked(call)
    assert call(right) is right
    with pytest.raises(ParameterError, match=rf"^given.* is refused, expected {re.escape(words)}$"):
        call(given=wrong)


@pytest.mark.parametrize("call", CALLS, ids=lambda call: call.__qualname__)
def test_an_unknown_keyword_is_one_line_with_those_that_are_known(call):
    kinds = {each.kind for each in inspect.signature(call).parameters.values()}
    if inspect.Parameter.VAR_KEYWORD in kinds:
        pytest.skip("it takes any keyword, and its register refuses those that no law has")
    with pytest.raises(TypeError, match=r"^unknown keyword 'nonesuch'; known: \w+"):
        call(nonesuch=1)


@given(st.sampled_from(["about", "unit", "low", "read_only"]), st.data())
def test_a_declared_parameter_is_refused_as_a_public_function_is(name, data):
    """A law file declares it; its line is read where the file is loaded."""
    takes = {"low": {"none", *NUMBER}, "read_only": {"bool"}}.get(name, {"text"})
    wrong = data.draw(st.sampled_from(sorted(ANYTHING - takes)).flatmap(VALUES.get))
    with pytest.raises(ParameterError, match=f"^{name}.* is refused, expected "):
        parameter(1.0, **{"about": "gain", name: wrong})


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        (
            {"metrics": "yaw_rate_error"},
            "metrics: 'yaw_rate_error' is refused, expected a list of texts, such as "
            "['yaw_rate_error']",
        ),
        ({"params": "my/none.yaml"}, "such as ['my/none.yaml']"),
        ({"runs": ["first", 2]}, "runs[1]: 2 is refused, expected a text"),
        ({"runs": {"first": 2}}, "runs: {'first': 2} is refused, expected a list of texts"),
        (
            {"method": "direct_yaw_moment"},
            "method: 'direct_yaw_moment' is refused, expected {NODE: METHOD}, by names or law files",
        ),
        ({"set": ["a=1"]}, "set: ['a=1'] is refused, expected {'NODE.PARAMETER': VALUE}"),
        ({"seed": True}, "seed: True is refused, expected a whole number"),
        (
            {"duration": math.nan},
            "duration: nan is refused, expected a number of seconds or such as '5 s'",
        ),
    ],
)
def test_a_line_has_what_was_given_and_what_is_expected(changed, line):
    with pytest.raises(ParameterError, match=re.escape(line) + "$"):
        ev_stack.run("shchur2019", **changed)


def test_numbers_of_numpy_lists_of_any_kind_and_iterators_are_taken():
    """None of them is a mistake: each did what it means before there was a check."""
    found = ev_stack.run(
        Path("shchur2019"),
        runs=np.array(["shchur2019"]),
        metrics=("final_speed",),
        seed=np.int64(3),
        duration=np.float64(0.02),
        params=iter(()),
    )
    assert found.summary().seed == 3
    assert len(found.time) == 3


def test_a_name_that_a_result_lacks_is_one_line_and_a_key_error():
    found = ev_stack.run("shchur2019", duration=0.02)
    for things, name in (
        (found.signals, "yaw_rate"),
        (found.metrics, "fig4.V1"),
        (found.runs, "shchur"),
    ):
        with pytest.raises(KeyError) as lacking:
            things[name]
        assert isinstance(lacking.value, ParameterError)
        assert re.match(rf"unknown \w+ '{name}'; did you mean", str(lacking.value))
        assert things.get(name) is None


@pytest.mark.parametrize(
    ("how", "line"),
    [
        ({"formats": "pdf"}, "formats: 'pdf' is refused, expected a list of pdf or svg"),
        ({"formats": ["png"]}, "formats[0]: 'png' is refused, expected pdf or svg"),
        ({"formats": [np.array([1, 2])]}, "formats[0]: array([1, 2]) is refused, expected pdf"),
        ({"formats": ["pdf"], "width": 0.0}, "width: 0 is refused, expected 1 to 40 inches"),
        ({"formats": ["pdf"], "width": math.inf}, "width: inf is refused, expected 1 to 40"),
        ({"formats": ["pdf"], "panels": ["nonesuch"]}, "unknown panel 'nonesuch'"),
    ],
)
def test_what_save_refuses_leaves_no_folder(how, line, tmp_path):
    result = ev_stack.run("shchur2019", duration=0.02)
    with pytest.raises(ParameterError, match=f"^{re.escape(line)}"):
        result.save(tmp_path / "saved", **how)
    assert not [*tmp_path.iterdir()]


@pytest.mark.parametrize("rows", ["a", [[1.0], [1.0, 2.0]], {1.0}])
def test_initial_states_that_are_no_rows_are_one_line(rows):
    with pytest.raises(
        ParameterError, match=r"^initial_states of plant: .* is refused, expected rows"
    ):
        ev_stack.batch("shchur2019", initial_states={"plant": rows}, duration=0.02)


@pytest.mark.parametrize(
    ("how", "line"),
    [
        ({"outputs": 5}, "outputs: 5 is refused, expected a function"),
        ({"prepare": "x"}, "prepare: 'x' is refused, expected a function"),
        ({"options": 5}, "options: 5 is refused, expected a mapping"),
        ({"heavy": "yes"}, "heavy: 'yes' is refused, expected True or False"),
        ({"idle": "group"}, "idle: 'group' is refused, expected a tuple"),
        ({"requires": ["asr"]}, "requires=['asr'] is refused, expected a mapping by role"),
    ],
)
def test_what_a_law_declares_of_another_kind_is_one_line_with_the_law(how, line):
    def law(driver: DriverCommand) -> WheelTorqueRequest:
        """Never called."""

    begin = "electronic_differential method mine: "
    with pytest.raises(TypeError, match=f"^{re.escape(begin + line)}"):
        method("electronic_differential", "mine", **how)(law)
    with pytest.raises(TypeError, match=f"^{begin}5 is refused, expected a function or a class$"):
        method("electronic_differential", "mine")(5)


def test_seeds_and_actions_of_cars_that_are_no_numbers_are_one_line():
    car = Environment("shchur2019")
    car.reset()
    with pytest.raises(
        ParameterError, match=r"^action \[\[1\], \[1, 2\]\] is refused, expected \("
    ):
        car.step([[1], [1, 2]])
    with pytest.raises(ParameterError, match=r"^seed\[1\]: 'a' is refused|^seed: "):
        VectorEnvironment.reset(None, seed=[1, "a"])


def test_a_result_is_printed_with_angles_in_degrees_and_conditions_in_words():
    angle = Metric(math.radians(2.0), "rad")
    count = Metric(1.0, "1")
    stiffness = Metric(3.0, "N m/rad")
    passed = Metric(0.0, "1", formula="1: in the lanes; else 0")
    assert short_lines({"p": passed, "a": angle, "n": count, "k": stiffness}) == [
        "p = no, measured",
        "a = 0.0349066 rad (2 deg), measured",
        "n = 1, measured",
        "k = 3 N m/rad, measured",
    ]
