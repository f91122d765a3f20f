"""What figures show: bands for chatter, maps to scale, published curves, and files as wide as a paper's column."""

from __future__ import annotations

import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from ev_sim.command_line.options import arguments
from ev_sim.figures.drawing import Curve, Panel, chatter, level

TIME = np.arange(0.0, 10.0, 0.001)
SLOW = np.sin(TIME)
LATE_CHATTER = np.where(TIME < 5.0, SLOW, np.where(np.arange(len(TIME)) % 2, 3.0, -1.0))


def sheet_of(*panels: Panel):
    from ev_sim.figures.drawing import sheet

    return sheet(panels, "time [s]")


def test_a_line_is_no_chatter():
    assert chatter(TIME, SLOW, 500) is None
    assert chatter(TIME[:50], LATE_CHATTER[-50:], 500) is None  # there is a pixel for every sample


def test_chatter_becomes_a_band_with_its_mean():
    found = chatter(TIME, LATE_CHATTER, 500)
    dense = np.isfinite(found.mean)
    assert found.edges[np.flatnonzero(dense)[0]] == pytest.approx(5.0, abs=0.2)  # the width of a bin
    assert dense[np.flatnonzero(dense)[0] :].all()
    assert (found.lowest[dense] == -1.0).all() and (found.highest[dense] == 3.0).all()
    assert np.abs(found.mean[dense] - 1.0).max() < 0.05
    assert np.array_equal(found.line[TIME < 4.9], SLOW[TIME < 4.9])
    assert np.isnan(found.line[TIME > 5.3]).all()


def test_a_gap_is_neither_line_nor_band():
    values = LATE_CHATTER.copy()
    values[7000:8000] = np.nan
    found = chatter(TIME, values, 500)
    at_gap = (found.edges[:-1] > 7.0) & (found.edges[1:] < 8.0)
    assert np.isnan(found.mean[at_gap]).all()


def test_the_band_stands_in_the_figure_and_says_what_it_is():
    (axes,) = sheet_of(Panel("Torque", "torque [N m]", [Curve(TIME, LATE_CHATTER)])).axes
    assert len(axes.collections) == 1
    assert axes.texts[0].get_text() == "band: lowest to highest, line: mean"


def test_panels_of_one_scale_have_one_ordinate_and_a_spun_run_leaves_its_panel():
    left, right, angle = sheet_of(
        Panel("left", "force [N]", [Curve(TIME, SLOW)], scale="force"),
        Panel("right", "force [N]", [Curve(TIME, 5.0 * SLOW)], scale="force"),
        Panel("angle", "angle [deg]", [Curve(TIME, 180.0 * SLOW)], within=(-30.0, 30.0)),
    ).axes
    assert left.get_ylim() == right.get_ylim()
    assert -6.0 < left.get_ylim()[0] < -5.0
    assert angle.get_ylim() == pytest.approx((-33.6, 33.6))  # 6 % of the range beyond


def test_a_run_that_has_spun_does_not_set_the_limits_unless_there_is_no_other():
    held, spun = Curve(TIME, SLOW), Curve(TIME, 180.0 * SLOW, spun=True)
    alone, both, lost = sheet_of(*(Panel("angle", "angle [deg]", of) for of in ([held], [held, spun], [spun]))).axes
    assert both.get_ylim() == alone.get_ylim()
    assert lost.get_ylim()[1] > 180.0


def test_what_is_published_is_black_named_once_and_changes_no_colour():
    published = [level(1.0, 2.0, 4.0), level(-1.0, 6.0, 8.0)]
    (axes,) = sheet_of(Panel("V", "V [m/s]", [Curve(TIME, SLOW, "ours"), *published])).axes
    assert [line.get_color() for line in axes.lines] == ["#0072B2", "black", "black"]
    assert [text.get_text() for text in axes.get_legend().get_texts()] == ["ours", "published"]


@pytest.mark.parametrize(("width", "times"), [(20.0, 1), (0.5, 50)])
def test_a_map_is_to_scale_or_says_how_much_larger_it_is_across(width: float, times: int):
    """A course 20 m across over 100 m can be drawn to scale; one of 0.5 m would be a hair on 8.4 inches."""
    from ev_sim.figures.other_axes import plan_view

    figure = plan_view("Path", [Curve(10 * TIME, width * SLOW / 2, "car")])
    (axes,) = figure.axes
    assert axes.get_aspect() == times
    assert (f"{times} times as large" in axes.get_title(loc="left")) == (times > 1)
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    along, across = np.diff(axes.get_xlim())[0] / box.width, np.diff(axes.get_ylim())[0] / box.height
    assert along / across == pytest.approx(times, rel=1e-6)


@pytest.mark.slow
def test_figures_for_print_are_as_wide_as_a_column_with_letters_as_letters(tmp_path: Path):
    """3.5 in are 252 pt."""
    from ev_sim.figures.other_axes import plan_view
    from ev_sim.figures.saving import save_figures

    labels, few = ["front left", "front right", "rear left", "rear right"], TIME[::100]
    panels = [
        Panel(name, "speed [m/s]", [Curve(few, np.sin(few) + n, each) for n, each in enumerate(labels)])
        for name in "ab"
    ]
    figures = {"sheet": sheet_of(*panels), "path": plan_view("Path", [Curve(10 * few, 10 * np.sin(few), "car")])}
    paths = save_figures(figures, tmp_path, ("pdf", "svg"))
    assert [path.name for path in paths] == [f"{name}.{kind}" for name in figures for kind in ("png", "pdf", "svg")]
    assert (tmp_path / "sheet.pdf").read_bytes().startswith(b"%PDF")
    for name in figures:
        root = ElementTree.parse(tmp_path / f"{name}.svg").getroot()
        assert root.get("width") == "252pt"
        texts = {element.text for element in root.iter("{http://www.w3.org/2000/svg}text")}
        assert {"sheet": {"a", "b", "speed [m/s]", "time [s]", *labels}, "path": {"Path", "x [m]", "y [m]"}}[
            name
        ] <= texts
    figure = figures["path"]
    figure.draw_without_rendering()
    box, (axes,) = figure.axes[0].get_window_extent(), figure.axes
    assert np.diff(axes.get_xlim())[0] / box.width == pytest.approx(np.diff(axes.get_ylim())[0] / box.height, rel=1e-6)
    first = (tmp_path / "sheet.svg").read_bytes()
    again = tmp_path / "again"
    again.mkdir()
    save_figures({"sheet": sheet_of(*panels)}, again, ("svg",))
    assert (again / "sheet.svg").read_bytes() == first


def test_another_format_is_refused(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        arguments(["shchur2019", "--figures", "eps"])
    assert "'eps' is refused, allowed is pdf, svg or pdf,svg" in capsys.readouterr().err
    assert arguments(["shchur2019", "--figures", "svg,pdf"]).figures == ("svg", "pdf")


def test_there_are_more_strokes_than_laws():
    """With twelve the thirteenth law of an overlay looked like the first."""
    from ev_sim.figures.drawing import STROKES

    assert len(STROKES) == len(set(STROKES)) == 32
