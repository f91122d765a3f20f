"""The command line of a study, and the cases that it means."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from ev_msgs_py.refusal import ParameterError, quoted
from ev_sim.command_line.options import add_outputs, add_overrides, overrides
from ev_sim.command_line.refusal import Parser
from ev_sim.scenarios.parameter_file import ParameterFile
from ev_sim.scenarios.scenario import Overrides, refuse_unused_values
from ev_sim.study.case import Case, run_of
from ev_sim.study.study import Study, study_named

_EVERY_NODE, _FILE = "*", "file"


def arguments(name: str, argv: Sequence[str]) -> argparse.Namespace:
    """Parse the command line of a study; argparse ends the process with status 2 for words it does not know."""
    study = study_named(name)
    parser = Parser(prog=f"run.sh {name}", description=study.ABOUT)
    parser.add_argument("--scheduler", metavar="tcp://HOST:PORT", help="a dask scheduler instead of this machine")
    parser.add_argument("--workers", type=_positive, metavar="N", help="worker processes here; default: one per core")
    parser.add_argument("--out", type=Path, metavar="DIR", help=f"output folder; default results/{name}")
    parser.add_argument("--anew", action="store_true", help="drive again what was driven before with this --out")
    parser.add_argument("--signals", action="store_true", help="keep the signals of every run, in DIR/signals")
    add_overrides(parser)
    add_outputs(parser)
    study.add_options(parser)
    return parser.parse_args(argv)


def _positive(text: str) -> int:
    if not text.isdecimal() or int(text) < 1:
        raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, allowed is 1 or more")
    return int(text)


def study_cases(study: Study, given: argparse.Namespace) -> list[Case]:
    """The cases of a study with what the command line changes in all of them.

    ParameterError if it sets what a case sets itself, if two cases have one name, or if runs end before there is
    anything to measure.
    """
    common, cases = overrides(given), study.cases(given)
    shortest = getattr(study, "SHORTEST", 0.0)
    if common.duration is not None and 0.0 < common.duration < shortest:
        raise ParameterError(
            f"--duration {common.duration:g} is refused: what this study measures comes later, "
            f"allowed is {shortest:g} s or more"
        )
    _refuse_same_names(cases)
    told = _told(common)
    for case in cases:
        _refuse_what_it_sets(case, told)
        if common.vehicle and case.vehicle:
            raise ParameterError(f"--vehicle is refused: case {quoted(case.name)} sets it itself, {case.vehicle}")
    cases = [
        replace(
            case,
            values=(*case.values, *common.told),
            files=(*case.files, *common.files),
            duration=case.duration if common.duration is None else common.duration,
            vehicle=common.vehicle or case.vehicle,
        )
        for case in cases
    ]
    _refuse_unused(study, given, cases)
    return cases


def _refuse_unused(study: Study, given: argparse.Namespace, cases: Sequence[Case]) -> None:
    """ParameterError for what the command line sets or varies and no method of any case has."""
    varied = study.variations(given) if hasattr(study, "variations") else {}
    places = [(*name.split(".", 1), None) for name in varied if "." in name]
    told = [*overrides(given).values, *places]
    if not told:
        return
    alike = {(c.scenario, c.run, c.files, *(str(v) for v in c.values if v[1] == "method")): c for c in cases}
    runs = []
    for case in alike.values():
        with suppress(ParameterError):  # a case that cannot be driven comes back as refused
            runs.append(run_of(case))
    if runs:
        refuse_unused_values(told, runs)


def _refuse_same_names(cases: Iterable[Case]) -> None:
    seen: set[str] = set()
    for case in cases:
        if case.name in seen:
            raise ParameterError(f"case {quoted(case.name)} is there twice, allowed is once")
        seen.add(case.name)


def _told(common: Overrides) -> list[tuple[str, str]]:
    """Node and name of each parameter that goes before those of the cases; a file of parameters only names files so."""
    in_files = (name for file in common.files for name in ParameterFile(file).names())
    files = [(_EVERY_NODE, name) for name in in_files if name.endswith(_FILE)]
    return [*((node, name) for node, name, _ in common.told), *files]


def _refuse_what_it_sets(case: Case, told: Iterable[tuple[str, str]]) -> None:
    """ParameterError for what would silently take the place of what a case sets, and is called by."""
    for node, name in told:
        for its_node, its_name, _ in case.values:
            if (node == its_node or _EVERY_NODE in (node, its_node)) and _takes_the_place(name, its_name):
                raise ParameterError(
                    f"{node}.{name} is refused: case {quoted(case.name)} sets {its_node}.{its_name} itself"
                )


def _takes_the_place(name: str, its_name: str) -> bool:
    """Whether it is the same parameter, or a file of which that is read: speed_profile.file of speed_profile.time."""
    return name == its_name or (name.endswith(_FILE) and its_name.startswith(name.removesuffix(_FILE)))
