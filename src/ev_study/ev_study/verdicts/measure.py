"""Measures of published numbers: a function with its words, or an expression over runs.

How it works: the column `measure` of a published number is either the name of a function with words
behind it (`Call`) or an expression over the signals of a run (`Expression`). Both are checked
against the needs when the list is read. Calls in braces fill numbers into the texts of tolerances
and notes (`Template`).
"""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any

from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.measures.expression import number_of, parsed
from ev_stack.measures.metric import NotMeasured, run_named
from ev_stack.measures.named import DrivenRun
from ev_study.verdicts.need import Need, ScenarioRuns, StudyNeed

# A measure gets what was driven, one argument for each need, and the words behind its name; it may
# raise NotMeasured.
Measure = Callable[..., Any]
Measures = Mapping[str, Measure]
_NUMBER = re.compile(r"[-+]?\d+(\.\d+)?(e[-+]?\d+)?")
_CALLS = re.compile(r"\{([^{}]*)\}")
_OF_RUN = re.compile(r"(\w+):\s+(.*)")


def measures_of(*modules: ModuleType) -> dict[str, Measure]:
    """The public functions of some modules by name; ValueError if two of them have one name."""
    found: dict[str, Measure] = {}
    for module in modules:
        for name, function in inspect.getmembers(module, inspect.isfunction):
            # Functions that a module imports are not measures of it.
            if function.__module__ == module.__name__ and not name.startswith("_") and found.setdefault(
                name, function
            ) is not function:  # fmt: skip
                raise ValueError(
                    f"{name} of {module.__name__} is a measure of {found[name].__module__} as well"
                )
    return found


def parameter(driven: ScenarioRuns, node: str, name: str) -> float:
    """A number among the parameters of a node, by its dotted name."""
    return float(driven.parameters[node][name])


COMMON: Measures = {"parameter": parameter}  # that every source may name


@dataclass(frozen=True, slots=True)
class Call:
    """A measure with its words: `mean yaw_rate 2` is mean(*driven, "yaw_rate", 2.0)."""

    measure: Measure
    words: tuple[str | float, ...]

    @classmethod
    def of(cls, text: str, measures: Measures, needs: Sequence[Need]) -> Call:
        """The call that a text means.

        Raises ParameterError for an unknown measure, and for words that it does not take.
        """
        name, *words = text.split() or [""]
        if name not in measures:
            raise unknown_name("measure", name, measures)
        # Words that are no numbers stay texts, such as names of runs.
        given = tuple(float(word) if _NUMBER.fullmatch(word) else word for word in words)
        signature = inspect.signature(measures[name])
        try:
            # Checked before anything is driven, with the needs in the place of what is driven.
            signature.bind(*needs, *given)
        except TypeError as error:
            raise ParameterError(
                f"measure {quoted(text)} is refused ({error}), expected {name}{signature}, "
                f"of which the first {len(needs)} are what is driven"
            ) from None
        return cls(measures[name], given)

    def __call__(self, driven: Sequence[Any]) -> Any:
        """Measure the driven runs."""
        return self.measure(*driven, *self.words)

    def renamed(self, words: Mapping[str | float, str | float]) -> Call:
        """The same with other words in place of some."""
        return replace(self, words=tuple(words.get(word, word) for word in self.words))


@dataclass(frozen=True, slots=True)
class Template:
    """A text in which calls in braces, `{measure words}`, are filled in with what was driven."""

    parts: tuple[str | Call, ...] = ()

    @classmethod
    def of(cls, text: str, measures: Measures, needs: Sequence[Need]) -> Template:
        """The template of a text; ParameterError as `Call.of`."""
        # The group in the pattern makes every second part a call.
        parts = _CALLS.split(text)
        return cls(
            tuple(Call.of(part, measures, needs) if n % 2 else part for n, part in enumerate(parts))
        )

    @property
    def is_plain(self) -> bool:
        """True if there is nothing to fill in."""
        return len(self.parts) < 2

    def filled(self, driven: Sequence[Any]) -> str:
        """The text."""
        found = (part(driven) if isinstance(part, Call) else part for part in self.parts)
        return "".join(each if isinstance(each, str) else f"{each:g}" for each in found)


EMPTY = Template()


@dataclass(frozen=True, slots=True)
class Expression:
    """An expression of docs/metrics.md over a run: `rate: at(imu.yaw_rate, 3)` is its value for the run `rate`.

    Of two needs it is the value for the first one over that for the second one. `runs` has one run
    for each need, which is empty where a need drives one run only.
    """

    runs: tuple[str, ...]
    of: Callable[[DrivenRun], float]

    @classmethod
    def parsed(cls, text: str, needs: Sequence[Need]) -> Expression:
        """The expression that a text means.

        Raises ParameterError, in one line, if it has no meaning for these needs.
        """
        named = _OF_RUN.fullmatch(text)
        run, expression = named.groups() if named else ("", text)
        runs = []
        for need in needs:
            if isinstance(need, StudyNeed):
                raise ParameterError(
                    "an expression is of the runs of a scenario, and a study keeps none"
                )
            # A need that drives one named run leaves no question.
            runs.append(need.runs[0] if not run and len(need.runs) == 1 else run)
        if not 1 <= len(runs) <= 2:
            raise ParameterError(
                f"{len(runs)} are driven, expected one scenario, or two for a ratio"
            )
        return cls(tuple(runs), number_of(parsed(expression)))

    def __call__(self, driven: Sequence[ScenarioRuns]) -> float:
        """Measure the driven runs."""
        first, *other = map(self._value, driven, self.runs)
        if not other:
            return first
        # A ratio to zero has no meaning; that is no failure of what is measured.
        if not other[0]:
            raise NotMeasured("the number that it is divided by is 0")
        return first / other[0]

    def _value(self, driven: ScenarioRuns, run: str) -> float:
        if not run and len(driven.runs) > 1:
            raise NotMeasured(
                f"no run is named, expected one of {', '.join(driven.runs)} in front of the"
                " expression"
            )
        recording = run_named(driven.runs, run or next(iter(driven.runs)))
        return self.of(DrivenRun(recording, driven.vehicle))

    def renamed(self, words: Mapping[str | float, str | float]) -> Expression:
        """The same of other runs."""
        return replace(self, runs=tuple(str(words.get(run, run)) for run in self.runs))


def measured_by(text: str, measures: Measures, needs: Sequence[Need]) -> Call | Expression:
    """Return a measure with its words, or an expression; ParameterError if the text is neither."""
    name = text.partition(" ")[0]
    if name in measures:
        return Call.of(text, measures, needs)
    try:
        return Expression.parsed(text, needs)
    except ParameterError as error:
        # A plain word in front is a misspelt measure rather than the beginning of an expression.
        if name.isidentifier():
            raise unknown_name("measure", name, measures) from None
        raise ParameterError(f"the measure {quoted(text)} is refused: {error}") from None


def compared(text: str) -> tuple[str, str, str]:
    """Split a comparison: text before its `<` or `>`, the sign, the rest; else the text alone."""
    depth = 0
    for place, letter in enumerate(text):
        depth += (letter in "([") - (letter in ")]")
        # A sign within brackets belongs to an expression, such as [time > 2].
        if depth == 0 and text[place - 1 : place + 2] in (" < ", " > "):
            return text[: place - 1], letter, text[place + 2 :]
    return text, "", ""
