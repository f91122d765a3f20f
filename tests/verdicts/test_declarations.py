"""Every published id is judged, once, and nothing else is."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ev_sim.verdicts.all_verdicts import declarations, undeclared
from ev_sim.verdicts.declaration import by_id, no_verdict
from ev_sim.verdicts.sources import published, sources

# How many numbers, curves and claims each source published; a line more or less in its list is a mistake.
PUBLISHED = {"shchur2019": 30, "ge_ni2005": 34, "tatar_chudzik": 27, "dissertation": 204, "zhileykin2018": 21}


@pytest.mark.parametrize("source", sources())
def test_list_of_published_things_is_complete(source: str):
    assert len(published(source)) == PUBLISHED[source]


@pytest.mark.parametrize("source", sources())
def test_every_published_id_is_judged(source: str):
    assert undeclared(source) == []


@pytest.mark.parametrize("source", sources())
def test_what_is_judged_has_checks_and_what_is_lost_has_a_reason(source: str):
    for id, declaration in declarations(source).items():
        assert declaration.checks or declaration.unjudged, id
        names = [check.name for check in declaration.checks]
        assert len(names) == len(set(names)), id


def test_an_id_that_nobody_published_is_refused():
    with pytest.raises(ValueError, match=r"shchur\.fig9 is not in the list of what shchur2019 published"):
        by_id("shchur2019", [no_verdict("shchur.fig9", "x")])


def test_an_id_is_judged_once():
    with pytest.raises(ValueError, match=r"shchur\.fig2 is declared twice"):
        by_id("shchur2019", [no_verdict("shchur.fig2", "x"), no_verdict("shchur.fig2", "y")])


def test_who_asks_for_one_source_loads_no_other():
    """Each brings libraries of its own, which cost a second of every run of a scenario."""
    text = (
        "import sys; from ev_sim.verdicts.all_verdicts import declarations; assert declarations('shchur2019'); "
        "print(*sorted({name.split('.')[1] for name in sys.modules if name.startswith('ev_papers.')}))"
    )
    done = subprocess.run([sys.executable, "-c", text], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["shchur2019"]
