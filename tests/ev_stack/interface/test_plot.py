"""`Result.plot`: results draw themselves with the figures of their report."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.colors import to_hex
from matplotlib.figure import Figure

import ev_stack
from ev_msgs_py.refusal import ParameterError
from ev_stack.figures.overlays import as_one
from ev_stack.figures.panels import Curve, Panel
from ev_stack.figures.sheets import Sheet
from ev_stack.figures.strokes import strokes_of

GAMMA = "electronic_differential.gamma"


@pytest.fixture(scope="module")
def results() -> list[ev_stack.Result]:
    return [ev_stack.run("shchur2019", set={GAMMA: gain}, duration=0.4) for gain in (5.0, 2.0)]


def titles(figure: Figure) -> list[str]:
    return [axes.get_title(loc="left") for axes in figure.axes]


def own_lines(axes) -> dict[str, str]:
    """Colours of the curves by their labels, without those of the source."""
    lines = {line.get_label(): to_hex(line.get_color()) for line in axes.lines}
    return {label: colour for label, colour in lines.items() if colour != "#000000"}


def test_a_result_draws_the_figures_of_its_report(results):
    """The same panels with the same numbers in them, and a picture that a notebook shows."""
    figure = results[0].plot()
    (of_report,) = results[0].figures().values()
    assert isinstance(figure, Figure)
    assert titles(figure) == titles(of_report) != []
    for drawn, reported in zip(figure.axes, of_report.axes, strict=True):
        for line, same in zip(drawn.lines, reported.lines, strict=True):
            assert np.array_equal(line.get_xydata(), same.get_xydata(), equal_nan=True)
            assert line.get_color() == same.get_color()
    assert figure._repr_png_().startswith(b"\x89PNG")


def test_several_results_have_one_colour_each_in_every_panel(results):
    """A curve of its own has the result's name; parts, as of two wheels, differ in dashes."""
    figure = results[0].plot(results[1])
    assert titles(figure) == titles(results[0].plot())
    colours = {
        name: stroke.colour.lower()
        for name, stroke in strokes_of(["gamma 5.0", "gamma 2.0"]).items()
    }
    parts = set()
    for axes in figure.axes:
        lines = own_lines(axes)
        assert {label.partition(": ")[0] for label in lines} == {"gamma 5.0", "gamma 2.0"}
        for label, colour in lines.items():
            name, _, part = label.partition(": ")
            assert colour == colours[name]
            parts.add(part)
    assert parts == {"", "left", "right"}


def test_the_legend_names_laws_or_what_it_is_given(results):
    """A law has the colour that it has in every figure."""
    split = ev_stack.run(
        "shchur2019", method={"electronic_differential": "equal_torque"}, duration=0.4
    )
    lines = own_lines(results[0].plot(split, panels=["motion.yaw_rate"]).axes[0])
    laws = strokes_of(["power_steering", "equal_torque"])
    assert lines == {name: laws[name].colour.lower() for name in ("power steering", "equal torque")}
    named = results[0].plot(split, names=["mine", "theirs"], panels=["speed"])
    assert [*own_lines(named.axes[0])] == ["mine", "theirs"]
    # Equal results differ in nothing: they have numbers.
    same = results[0].plot(results[0], signals=["imu.yaw_rate"])
    assert [*own_lines(same.axes[0])] == ["1", "2"]


def test_panels_and_signals_are_chosen(results):
    """Quantities of the motion are there in every scenario; angles are in degrees."""
    one = results[0]
    assert titles(one.plot(panels=["speed", "yaw_rate"])) == ["Speed", "Yaw rate"]
    figure = one.plot(signals=["steering_column.state.angle", "wheel_states.effort.front_left"])
    assert titles(figure) == ["steering_column.state.angle", "wheel_states.effort.front_left"]
    assert [axes.get_ylabel() for axes in figure.axes] == ["[deg]", "[N m]"]
    drawn = figure.axes[0].lines[0].get_ydata()
    assert np.nanmax(drawn) == np.degrees(one.signals["steering_column.state.angle"].max())
    assert titles(one.plot(panels=["speed"], signals=["imu.yaw_rate"])) == ["Speed", "imu.yaw_rate"]


def test_the_runs_of_a_scenario_lie_over_each_other():
    both = ev_stack.run("shchur2019_steps", runs=("object", "hold_manual"), duration=0.02)
    assert [*own_lines(both.plot(signals=["imu.yaw_rate"]).axes[0])] == ["object", "hold manual"]
    twice = both.plot(both, signals=["imu.yaw_rate"], names=["a", "b"]).axes[0]
    assert [*own_lines(twice)] == ["a: object", "a: hold manual", "b: object", "b: hold manual"]


@pytest.mark.parametrize(
    ("how", "line"),
    [
        ({"panels": ["yaw"]}, r"^unknown panel 'yaw'; did you mean motion\.yaw_rate"),
        ({"signals": ["yaw_rate"]}, "^unknown channel 'yaw_rate'; did you mean imu.yaw_rate"),
        ({"names": ["a", "b"]}, r"^names: \['a', 'b'\] is refused, expected 1 different names"),
        ({"width": 0.5}, "^width: 0.5 is refused, expected 1 to 40 inches"),
    ],
)
def test_what_cannot_be_drawn_is_one_line(results, how, line):
    with pytest.raises(ParameterError, match=line):
        results[0].plot(**how)


def test_a_panel_over_another_quantity_keeps_its_abscissa():
    """As the gain over the speed in a report beside curves over time."""
    time = np.array([0.0, 1.0])
    over_speed = Sheet([Panel("Gain", "gain [1]", [Curve(time, time)])], xlabel="speed [m/s]")
    over_time = Sheet([Panel("Speed", "speed [m/s]", [Curve(time, time)])])
    figure = as_one({"gain": over_speed, "motion": over_time}).figure()
    assert [axes.get_xlabel() for axes in figure.axes] == ["speed [m/s]", "time [s]"]
