"""Reports, studies and sources of installed packages.

One line for what is wrong with one of them.
"""

from __future__ import annotations

from importlib.metadata import EntryPoint

import pytest

from ev_core.methods import offered as module
from ev_core.methods.offered import offered, offered_module
from ev_msgs_py.refusal import ParameterError
from ev_stack.report.reports import report_for
from ev_stack.scenarios.scenario import load_scenario
from ev_study.studies.study import study_named

GROUP = "ev_stack.reports"


@pytest.fixture
def offer(monkeypatch):
    """Entry points as if another package had brought them."""
    real, own = module.entry_points, []

    def found(**wanted: str) -> list[EntryPoint]:
        return [*real(**wanted), *(own if wanted == {"group": GROUP} else ())]

    monkeypatch.setattr(module, "entry_points", found)

    def offer(name: str, value: str) -> None:
        own.append(EntryPoint(name, value, GROUP))
        offered.cache_clear()

    yield offer
    monkeypatch.undo()
    offered.cache_clear()


def test_two_packages_do_not_share_a_name(offer):
    """The order of folders must not decide which of them a run gets."""
    offer("coast_down", "ev_stack.manoeuvres.coast_down")  # the same one, installed twice
    assert report_for("coast_down")
    assert (
        offered_module(GROUP, "report", "coast_down").__name__ == "ev_stack.manoeuvres.coast_down"
    )
    offer("coast_down", "other_package.report")
    message = r"^ev_stack\.reports 'coast_down' is offered by ev_stack\S+ and by other_package\.report, expected one$"
    with pytest.raises(ParameterError, match=message):
        report_for("coast_down")


def test_what_does_not_load_is_one_line_and_harms_its_users_only(offer):
    offer("braking", "other_package.report")
    with pytest.raises(
        ParameterError,
        match=r"^report braking: other_package\.report is not loaded: ModuleNotFoundError: No",
    ):
        report_for("braking")
    assert report_for("hill_start")
    assert (
        offered_module(GROUP, "report", "hill_start").__name__ == "ev_stack.manoeuvres.hill_start"
    )
    assert load_scenario("coast_down").runs


def test_an_unknown_name_lists_those_that_there_are():
    with pytest.raises(ParameterError, match=r"^unknown study 'sweeps'; did you mean sweep?"):
        study_named("sweeps")
    with pytest.raises(
        ParameterError, match=r"^unknown report 'braking'; did you mean zhileykin2018_braking\?$"
    ):
        offered_module(GROUP, "report", "braking")
    assert "coast_down" in offered(GROUP)
