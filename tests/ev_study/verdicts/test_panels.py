"""The figures of the sources.

Every panel is declared, has its own file, and shows ids that were published.
"""

from __future__ import annotations

from dataclasses import replace

import pytest
from helpers.judging import driven

from ev_papers.dissertation.figures.panels import CYCLES, ON_BENCH
from ev_study.verdicts.need import Need
from ev_study.verdicts.panels_page import draw_panels, file_name, panels, write_page
from ev_study.verdicts.sources import published, sources

# Panels that each source has, those that cannot be drawn included.
PANELS = {
    "shchur2019": 12,
    "ge_ni2005": 14,
    "tatar_chudzik": 14,
    "dissertation": 116,
    "zhileykin2018": 7,
    "outside_checks": 0,
}


@pytest.mark.parametrize("source", sources())
def test_every_panel_has_its_own_file_and_shows_what_was_published(source: str):
    found = panels(source)
    assert len({file_name(source, panel) for panel in found}) == len(found)
    for panel in found:
        assert set(panel.ids) <= set(published(source)), panel.title
        assert bool(panel.draw) != bool(panel.why_not), panel.title


@pytest.mark.parametrize(("source", "count"), PANELS.items())
def test_no_panel_is_missing(source: str, count: int):
    assert len(panels(source)) == count


@pytest.mark.parametrize(
    ("source", "count", "lost"),
    [
        ("shchur2019", 10, "a scheme of the turn"),
        pytest.param("ge_ni2005", 12, "a scheme of the law", marks=pytest.mark.weekly),
        pytest.param("tatar_chudzik", 12, "a scheme of the forces", marks=pytest.mark.weekly),
    ],
)
def test_page_shows_what_was_drawn_and_why_something_was_not(
    tmp_path, source: str, count: int, lost: str
):
    shown = panels(source)
    needs: list[Need] = [need for panel in shown for need in panel.needs]
    drawn = draw_panels(source, shown, {need: driven(need) for need in needs}, tmp_path)
    page = write_page({source: shown}, tmp_path).read_text()
    assert len(drawn) == count
    assert all(path.stat().st_size > 5_000 and path.name in page for path in drawn)
    assert f"not drawn: {lost}" in page


@pytest.mark.slow
@pytest.mark.parametrize(
    ("cycle", "count"),
    [pytest.param(CYCLES[1], 5 + 2, marks=pytest.mark.weekly), (ON_BENCH[1], 7)],
    ids=["simulation", "bench"],
)
def test_figures_of_one_method_of_the_dissertation(tmp_path, cycle, count):
    """A minute of its cycle.

    5 figures in simulation with the fitted slip curve and the road, 7 on the bench.
    """
    short = driven(replace(cycle, duration=60.0))
    shown = [panel for panel in panels("dissertation") if panel.needs == (cycle,)]
    drawn = draw_panels("dissertation", shown, {cycle: short}, tmp_path)
    assert len(drawn) == count
    assert all(path.stat().st_size > 5_000 for path in drawn)
