"""Figures: bands for chatter, maps to scale, published curves, files as wide as a column."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import numpy as np
import pytest

from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.options import arguments, printing
from ev_stack.figures.other_axes import band, colour_map, mean_of_seeds, plan_view
from ev_stack.figures.panels import Curve, Panel, level
from ev_stack.figures.saving import FORMATS, Print, save_figures
from ev_stack.figures.sheets import COLUMN, TALLEST, WIDE, Sheet, drawn, printed
from ev_stack.figures.strokes import strokes_of
from ev_stack.figures.thinning import chatter

TIME = np.arange(0.0, 10.0, 0.001)
SLOW = np.sin(TIME)
LATE_CHATTER = np.where(TIME < 5.0, SLOW, np.where(np.arange(len(TIME)) % 2, 3.0, -1.0))


def sheet_of(*panels: Panel):
    return Sheet(panels).figure()


def test_a_line_is_no_chatter():
    assert chatter(TIME, SLOW, 500) is None
    assert chatter(TIME[:50], LATE_CHATTER[-50:], 500) is None  # there is a pixel for every sample


def test_chatter_becomes_a_band_with_its_mean():
    found = chatter(TIME, LATE_CHATTER, 500)
    dense = np.isfinite(found.mean)
    # the width of a bin
    assert found.edges[np.flatnonzero(dense)[0]] == pytest.approx(5.0, abs=0.2)
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
    figure = sheet_of(Panel("Torque", "torque [N m]", [Curve(TIME, LATE_CHATTER)]))
    (axes,), (legend,) = figure.axes, figure.legends
    assert len(axes.collections) == 1
    assert [text.get_text() for text in legend.get_texts()] == [
        "band: lowest to highest, line: mean"
    ]


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
    alone, both, lost = sheet_of(
        *(Panel("angle", "angle [deg]", of) for of in ([held], [held, spun], [spun]))
    ).axes
    assert both.get_ylim() == alone.get_ylim()
    assert lost.get_ylim()[1] > 180.0


def test_what_is_published_is_black_named_once_and_changes_no_colour():
    published = [level(1.0, 2.0, 4.0), level(-1.0, 6.0, 8.0)]
    figure = sheet_of(Panel("V", "V [m/s]", [Curve(TIME, SLOW, "ours"), *published]))
    (axes,), (legend,) = figure.axes, figure.legends
    assert [line.get_color() for line in axes.lines] == ["#0072B2", "black", "black"]
    assert [text.get_text() for text in legend.get_texts()] == ["ours", "published"]


@pytest.mark.parametrize(("width", "times"), [(20.0, 1), (0.5, 50)])
def test_a_map_is_to_scale_or_says_how_much_larger_it_is_across(width: float, times: int):
    """A course 20 m across over 100 m can be drawn to scale.

    One of 0.5 m would be a hair on 8.4 inches.
    """
    figure = plan_view("Path", [Curve(10 * TIME, width * SLOW / 2, "car")]).figure()
    (axes,) = figure.axes
    assert axes.get_aspect() == times
    assert (f"{times} times as large" in axes.get_title(loc="left")) == (times > 1)
    figure.draw_without_rendering()
    box = axes.get_window_extent()
    along, across = (
        np.diff(axes.get_xlim())[0] / box.width,
        np.diff(axes.get_ylim())[0] / box.height,
    )
    assert along / across == pytest.approx(times, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("width", [COLUMN, pytest.param(WIDE, marks=pytest.mark.weekly)])
def test_figures_for_print_are_as_wide_as_wanted_with_letters_as_letters(
    tmp_path: Path, width: float
):
    """72 pt are an inch; the same figures are the same files."""
    labels, few = ["front left", "front right", "rear left", "rear right"], TIME[::100]
    panels = [
        Panel(
            name,
            "speed [m/s]",
            [Curve(few, np.sin(few) + n, each) for n, each in enumerate(labels)],
        )
        for name in "ab"
    ]
    sheets = {
        "sheet": Sheet(panels),
        "path": plan_view("Path", [Curve(10 * few, 10 * np.sin(few), "car")]),
    }
    paths = save_figures(printed(sheets, width), tmp_path, FORMATS)
    assert [path.name for path in paths] == [
        f"{name}.{kind}" for name in sheets for kind in FORMATS
    ]
    for name in sheets:
        box = re.search(
            rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", (tmp_path / f"{name}.pdf").read_bytes()
        )
        assert float(box[1]) == pytest.approx(72 * width) and float(box[2]) <= 72 * TALLEST
        root = ElementTree.parse(tmp_path / f"{name}.svg").getroot()
        assert float(root.get("width").removesuffix("pt")) == pytest.approx(72 * width)
        texts = {element.text for element in root.iter("{http://www.w3.org/2000/svg}text")}
        assert {
            "sheet": {"a", "b", "speed [m/s]", "time [s]", *labels},
            "path": {"Path", "x [m]", "y [m]"},
        }[name] <= texts
    first = (tmp_path / "sheet.svg").read_bytes()
    again = tmp_path / "again"
    again.mkdir()
    save_figures(printed(sheets, width), again, FORMATS)
    assert (again / "sheet.svg").read_bytes() == first


def test_another_format_is_refused(capsys: pytest.CaptureFixture[str]):
    with pytest.raises(SystemExit):
        arguments(["shchur2019", "--figures", "eps"])
    assert "'eps' is refused, expected pdf, svg or pdf,svg" in capsys.readouterr().err
    assert arguments(["shchur2019", "--figures", "svg,pdf"]).figures == ("svg", "pdf")


def test_a_law_has_one_colour_in_every_panel_figure_and_study():
    """Fewer laws, another order and another study change no colour."""
    from ev_core.methods.register import methods_of

    laws = list(methods_of("electronic_differential"))
    few = [
        Curve(TIME, SLOW + n, name)
        for n, name in enumerate(("rear drive", "power steering", "equal torque"))
    ]
    figure = sheet_of(
        Panel("all", "y [1]", few),
        Panel("one", "y [1]", few[2:]),
        Panel("two", "y [1]", few[:0:-1]),
    )
    colours = [{line.get_label(): line.get_color() for line in axes.lines} for axes in figure.axes]
    assert colours[1].items() <= colours[0].items() and colours[2].items() <= colours[0].items()
    every = strokes_of(laws)
    assert (
        colours[0]["equal torque"]
        == every["equal torque"].colour
        == strokes_of(["equal_torque"])["equal torque"][0]
    )
    assert len({stroke.colour for stroke in every.values()}) == len(laws)


def test_any_number_of_names_has_strokes_and_the_first_ones_differ():
    """Seven runs, as in most reports, differ in colour.

    All strokes there are differ before one comes again.
    """
    assert len({stroke.colour for stroke in strokes_of(map(str, range(7))).values()}) == 7
    many = [stroke for name, stroke in strokes_of(map(str, range(70))).items() if name]
    assert len(many) == 70 and len(set(many)) == len(set(many[:64])) == 64


@pytest.mark.parametrize("count", [2, 4])
def test_identical_curves_take_turns_so_that_all_are_seen(count: int):
    """Drawn over each other only the last one would be seen.

    Its colour covered every other pixel.
    """
    curves = [Curve(TIME, SLOW, f"law {n}") for n in range(count)]
    figure = sheet_of(Panel("alike", "y [1]", curves))
    figure.legends[0].remove()
    figure.draw_without_rendering()
    figure.canvas.draw()
    seen = {
        tuple(pixel)
        for pixel in np.asarray(figure.canvas.buffer_rgba())[..., :3].reshape(-1, 3).tolist()
    }
    expected = {
        tuple(int(stroke.colour[k : k + 2], 16) for k in (1, 3, 5))
        for name, stroke in strokes_of(curve.label for curve in curves).items()
        if name
    }
    assert len(expected) == count and expected <= seen


def test_a_figure_that_would_show_nothing_is_not_drawn():
    empty = Sheet([Panel("Path", "y [m]")])
    assert drawn({"empty": empty}) == {}
    (axes,) = (
        Sheet([*empty.panels, Panel("Yaw rate", "yaw rate [deg/s]", note="not measured: no car")])
        .figure()
        .axes
    )
    assert axes.texts[0].get_text() == "not measured: no car"


def test_panels_for_print_are_chosen_by_name_or_refused_in_one_line():
    sheets = {
        "motion": Sheet(
            [Panel(title, "y [1]", [Curve(TIME[:9], SLOW[:9])]) for title in ("Yaw rate", "Speed")]
        ),
        "path": plan_view("Path of the car", [Curve(TIME[:9], SLOW[:9])]),
    }

    def titles(*patterns: str) -> dict[str, list[str]]:
        found = printed(sheets, panels=patterns)
        return {
            name: [axes.get_title(loc="left") for axes in figure.axes]
            for name, figure in found.items()
        }

    assert titles("yaw_rate") == {"motion": ["Yaw rate"]}
    assert list(titles("path", "motion.s*")) == ["motion", "path"]
    assert titles("motion") == {"motion": ["Yaw rate", "Speed"]}
    with pytest.raises(ParameterError, match=r"yaw_rat.*motion\.yaw_rate") as error:
        titles("yaw_rat")
    assert "\n" not in str(error.value)


def test_details_of_print_without_print_are_refused_before_anything_is_driven():
    for words in (["--panels", "fig4"], ["--width", "7.2"]):
        with pytest.raises(
            ParameterError,
            match=f"^{words[0]} is about figures for print: add --figures pdf or svg$",
        ):
            printing(arguments(["shchur2019", *words]))
    assert printing(arguments(["shchur2019", "--figures", "pdf"])) == Print(("pdf",), COLUMN, ())


def test_ticks_of_a_map_tell_its_places_apart():
    """1001 and 1002 differ; with three digits both would be 1e+03."""
    places = np.array([1001.0, 1002.0]), np.array([1.0, 2.0])
    figure = drawn(
        {"map": Sheet([colour_map("m", ("x", places[0]), ("y", places[1]), "1", np.eye(2))])}
    )["map"]
    axes = figure.axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["1001", "1002"]
    assert [label.get_text() for label in axes.get_yticklabels()] == ["1", "2"]


def test_a_band_rises_with_x_and_leaves_out_a_seed_without_a_number():
    values = np.array([[3.0, 5.0], [1.0, np.nan], [np.nan, np.nan]])
    figure = drawn({"band": Sheet([band("b", ("x", np.array([2.0, 1.0, 3.0])), "y", values)])})[
        "band"
    ]
    (line,) = figure.axes[0].lines
    assert line.get_xdata().tolist() == [1.0, 2.0, 3.0]
    assert line.get_ydata().tolist()[:2] == [1.0, 4.0] and np.isnan(line.get_ydata()[2])
    assert mean_of_seeds(np.array([[1.0, 1.0], [np.nan, 2.0]])).tolist() == [1.0, 2.0]
