"""The study that compares electronic differentials, and the numbers by which it does."""

from __future__ import annotations

import argparse
import dataclasses
import json
import math
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from helpers.source_runs import driven

from ev_core.methods.register import methods_of
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_sim.surfaces import SURFACES, RoadParameters
from ev_sim.tyres.curve import peak_slip
from ev_stack.commands.run_scenario import main as run_scenario
from ev_stack.measures import handling
from ev_stack.measures.named import surfaces_of
from ev_stack.recording.recording import Recording
from ev_study.studies import compare
from ev_study.studies.run_study import arguments
from ev_study.studies.study import drive_case

pytestmark = pytest.mark.slow

ALL_DRIVEN = [("*", "vehicle.driven_wheels", list(WHEEL_NAMES))]


def asked(**changed) -> argparse.Namespace:
    options = {"scenario": "step_steer", **changed}
    return arguments(
        "compare", [word for name, value in options.items() for word in (f"--{name}", value)]
    )


@cache
def compared(four_wheels: bool) -> dict:
    values = tuple(ALL_DRIVEN) if four_wheels else ()
    cases = [
        dataclasses.replace(case, values=case.values + values, duration=2.5)
        for case in compare.cases(asked())
    ]
    return {case.name: drive_case(case, compare.measure) for case in cases}


def made(**channels) -> Recording:
    """A second at 10 m/s straight ahead, wheels rolling, with some channels changed."""
    size = 101
    zero = [
        *(f"twist.{name}" for name in ("lateral", "yaw_rate")),
        "imu.yaw_rate",
        "steering_column.state.road_wheel_angle",
    ]
    zero += [
        f"tire_forces.{kind}.{wheel}"
        for kind in ("slip_ratio", "slip_angle")
        for wheel in WHEEL_NAMES
    ]
    values = {name: np.zeros(size) for name in zero} | {"twist.longitudinal": np.full(size, 10.0)}
    values |= {
        f"tire_forces.friction_coefficient.{wheel}": np.full(size, 1.0) for wheel in WHEEL_NAMES
    }
    values |= {
        name.replace("__", "."): np.broadcast_to(value, size).copy()
        for name, value in channels.items()
    }
    return Recording(np.arange(size) * 0.01, values)


# Numbers


def test_slip_energy_is_what_the_drives_give_and_the_car_does_not_keep():
    """Drive work = kinetic energy + drag + slip on the road of Tatar & Chudzik, to 1 %.

    Samples instead of steps.
    """
    run = driven("tatar_chudzik").runs["rear_equal"]
    car = driven("tatar_chudzik").scenario.runs[2].configurations["plant"].common.vehicle
    c = run.channels
    speed = np.hypot(c["twist.longitudinal"], c["twist.lateral"])[-1]
    wheels = sum(c[f"wheel_states.velocity.{wheel}"][-1] ** 2 for wheel in WHEEL_NAMES)
    kinetic = 0.5 * (1000.0 * speed**2 + 1736.0 * c["twist.yaw_rate"][-1] ** 2 + 0.2 * wheels)
    drag = 0.5 * 1.24 * 0.3 * 2.0 * np.trapezoid(c["twist.longitudinal"] ** 3, run.time)
    left = handling.drive_work(run)[-1] - kinetic - drag
    assert left > 1e4
    assert handling.slip_energy(run, car) == pytest.approx(left, rel=0.01)


def test_peak_sideslip_leaves_out_a_car_that_stands():
    beta = np.linspace(0.0, 0.3, 101)
    turning = made(twist__lateral=10.0 * np.tan(beta))
    assert handling.peak_sideslip(turning) == pytest.approx(0.3, rel=1e-12)
    assert handling.peak_sideslip(made(twist__longitudinal=0.1, twist__lateral=0.9)) == 0.0


def test_a_car_that_slides_backwards_has_spun_and_one_in_reverse_has_not():
    """Turned by 100 deg while it moves on at 10 m/s.

    The same angle where it stands, or 80 deg, is no spin.
    """
    angle = np.radians(np.linspace(0.0, 100.0, 101))
    spun = made(twist__longitudinal=10.0 * np.cos(angle), twist__lateral=10.0 * np.sin(angle))
    assert handling.has_spun(spun)
    assert not handling.has_spun(made(twist__longitudinal=-10.0, twist__lateral=0.5))
    held = made(
        twist__longitudinal=10.0 * np.cos(0.8 * angle), twist__lateral=10.0 * np.sin(0.8 * angle)
    )
    assert not handling.has_spun(held)
    assert not handling.has_spun(Recording(np.zeros(1), {}))


def test_yaw_rate_error_is_against_the_neutral_car_within_its_friction():
    """A neutral car turns with u delta/L = 10 0.024/2.405.

    On ice (mu 0.05) with mu g/u = 0.049 at most.
    """
    angle, wanted = 0.02405, 0.1
    turning = made(steering_column__state__road_wheel_angle=angle, imu__yaw_rate=wanted + 0.03)
    assert handling.yaw_rate_error(turning, Vehicle()) == pytest.approx(0.03, rel=1e-9)
    ice = {f"tire_forces__friction_coefficient__{wheel}": 0.05 for wheel in WHEEL_NAMES}
    limited = made(steering_column__state__road_wheel_angle=angle, imu__yaw_rate=0.04905, **ice)
    assert handling.yaw_rate_error(limited, Vehicle()) == pytest.approx(0.0, abs=1e-12)


def test_time_over_limit_counts_slip_beyond_the_peak_of_the_curve():
    """Burckhardt's peak is at ln(C1 C2/C3)/C2 = 0.2048 on dry asphalt.

    Along and across count together.
    """
    peak = math.log(1.029 * 17.16 / 0.523) / 17.16
    assert peak_slip("burckhardt", (1.029, 17.16, 0.523, 0.0)) == pytest.approx(peak, abs=1e-4)
    available = max(
        1.029 * (1 - math.exp(-17.16 * s * 1e-4)) - 0.523 * s * 1e-4 for s in range(10001)
    )
    friction = {f"tire_forces__friction_coefficient__{wheel}": available for wheel in WHEEL_NAMES}

    def over(along: float, across: float) -> float:
        late = np.where(np.arange(101) > 60, 1.0, 0.0)
        slips = {
            "tire_forces__slip_ratio__rear_left": along * late,
            "tire_forces__slip_angle__rear_left": across * late,
        }
        return handling.time_over_limit(
            made(**slips, **friction), Vehicle(), ("dry_asphalt", "ice")
        )

    assert over(0.9 * peak, 0.0) == over(0.0, math.asin(0.9 * peak)) == 0.0
    assert over(0.9 * peak, math.asin(0.9 * peak)) == pytest.approx(0.4, rel=1e-9)


def test_the_limit_is_that_of_a_surface_that_lies_on_the_road():
    """Wet asphalt and snow, those of a random road, are not taken for other roads."""
    assert surfaces_of(RoadParameters()) == (SURFACES["dry_asphalt"],)
    assert surfaces_of(RoadParameters(right=("ice",))) == (SURFACES["dry_asphalt"], SURFACES["ice"])
    drawn = surfaces_of(RoadParameters(pattern="random"))
    assert set(drawn) == {SURFACES["wet_asphalt_1"], SURFACES["packed_snow_1"]}


# The study


@pytest.fixture(autouse=True)
def wide_terminal(monkeypatch: pytest.MonkeyPatch) -> None:
    """One table for all columns."""
    monkeypatch.setenv("COLUMNS", "400")


def test_every_method_has_its_line():
    """The car of step_steer drives its front wheels and is steered by a robot."""
    table = compare.tables(asked(), compared(False))
    assert list(compared(False)) == list(methods_of("electronic_differential"))
    refused = {name: result.refused for name, result in compared(False).items() if result.refused}
    lines = {line.split()[0]: line for line in table.splitlines()[2:]}
    assert sorted([*lines, *refused]) == list(compared(False))
    for name in ("equal_torque", "steering_correction"):
        assert len(lines[name].split()) == 1 + len(compare.QUANTITIES)
    needed = "slip_target needs rear_left and rear_right among the driven wheels, vehicle audi_a2 drives front_left"
    assert needed in refused["slip_target"]
    needed = "steer_by_wire requires steering_column method by_wire, but steering_robot is chosen"
    assert needed in refused["steer_by_wire"]


def test_methods_that_a_layout_forbids_are_driven_on_another_one():
    assert (
        compared(False)["axle_redistribution"].refused
        and not compared(True)["axle_redistribution"].refused
    )


def test_methods_differ_and_metrics_say_so():
    """These laws differ in a bend, so they must not have the same signals.

    None stands under another one's name.
    """
    metrics = compare.metrics(asked(), compared(True))
    assert set(metrics) == {f"{q}_{name}" for q in compare.QUANTITIES for name in driven_here()}
    assert all(metric.judgement == "measured" for metric in metrics.values())
    laws = ("equal_torque", "power_steering", "steering_correction", "axle_redistribution")
    assert len({compared(True)[law].signal_hash for law in laws}) == len(laws)


def driven_here() -> list[str]:
    return [name for name, result in compared(True).items() if not result.refused]


def test_overlay_names_every_method_once():
    """More methods than a panel can name: one legend above, and colours that differ."""
    figure = compare.figures(asked(), compared(True))["overlay"].figure()
    (legend,) = figure.legends
    assert [
        text.get_text().removesuffix(" (spun)").replace(" ", "_") for text in legend.get_texts()
    ] == driven_here()
    assert len(driven_here()) > 4
    for axes in figure.axes:
        assert axes.get_legend() is None
        assert len({line.get_color() for line in axes.lines}) == len(driven_here())


def test_a_plant_without_tyres_has_no_slip():
    (case,) = compare.cases(asked(scenario="shchur2019", methods="equal_torque"))
    result = drive_case(dataclasses.replace(case, duration=1.0), compare.measure)
    metrics = compare.metrics(asked(), {case.name: result})
    assert metrics["slip_energy_equal_torque"].verdict == "not measured: the plant has no tyres"
    assert metrics["drive_energy_equal_torque"].value > 0.0
    assert compare.tables(asked(), {case.name: result}).splitlines()[2].split()[3:5] == ["-", "-"]


def test_a_law_with_which_the_car_spins_is_marked_and_does_not_flatten_the_axes():
    """Five times the angle at 0.3 g at 80 km/h turns the car round; half of it does not."""
    (case,) = compare.cases(
        asked(scenario="sine_with_dwell", run="times_5_0", methods="equal_torque")
    )
    spun = drive_case(case, compare.measure)
    (case,) = compare.cases(
        asked(scenario="sine_with_dwell", run="times_2_5", methods="limited_slip")
    )
    results = {"equal_torque": spun, "limited_slip": drive_case(case, compare.measure)}
    lines = compare.tables(asked(), results).splitlines()[2:]
    assert [line.startswith("equal_torque (spun)") for line in lines] == [True, False]
    assert [row[0] for row in compare.table(asked(), results).rows] == [
        "equal_torque",
        "limited_slip",
    ]
    sideslip = compare.figures(asked(), results)["overlay"].figure().axes[1]
    assert max(map(abs, sideslip.get_ylim())) < 60.0


@pytest.mark.parametrize(
    ("changed", "line"),
    [
        ({"scenario": "step_stear"}, "unknown scenario 'step_stear'"),
        ({"run": "middle"}, "unknown run of step_steer 'middle'; known: left, right"),
        (
            {"methods": "equal_torque,sliptarget"},
            "unknown electronic_differential method 'sliptarget'",
        ),
    ],
)
def test_what_is_unknown_is_named(changed, line):
    with pytest.raises(ParameterError) as error:
        compare.cases(asked(**changed))
    assert line in str(error.value)


def test_command_line(tmp_path, capsys):
    words = [
        "--scenario",
        "step_steer",
        "--run",
        "right",
        "--methods",
        "equal_torque,slip_target",
        "--duration",
        "0.5",
    ]
    run_scenario(["compare", *words, "--workers", "1", "--out", str(tmp_path)])
    summary = json.loads((tmp_path / "summary.json").read_text())
    assert summary["cases"]["equal_torque"]["run"] == "right"
    assert "rear_left" in summary["cases"]["slip_target"]["refused"]
    assert summary["metrics"]["drive_energy_equal_torque"]["value"] > 0.0
    assert {path.name for path in tmp_path.glob("*.png")} == {"overlay.png", "paths.png"}
    assert "not driven: slip_target: " in capsys.readouterr().out


OWN_LAW = Path(__file__).parents[3] / "docs" / "examples" / "yaw_moment.py"


def test_a_law_file_stands_beside_methods(tmp_path, capsys):
    """Under the name of the file, as on a board.

    The same file once more under a name of its own.
    """
    words = [
        "compare",
        "--scenario",
        "step_steer",
        "--duration",
        "0.1",
        "--workers",
        "1",
        "--out",
        str(tmp_path),
    ]
    run_scenario([*words, "--methods", f"equal_torque,{OWN_LAW}"])
    assert list(json.loads((tmp_path / "summary.json").read_text())["cases"]) == [
        "equal_torque",
        "yaw_moment",
    ]
    copy = tmp_path / "yaw_moment.py"
    copy.write_bytes(OWN_LAW.read_bytes())
    with pytest.raises(ParameterError, match=r"are both called yaw_moment, expected two names$"):
        compare.cases(asked(methods=f"{OWN_LAW},{copy}"))
    with pytest.raises(ParameterError, match=r"none\.py"):
        compare.cases(asked(methods="none.py"))


def test_a_law_file_is_swept(tmp_path, capsys):
    """Its path is varied beside a method; a second call takes the kept rows."""
    words = [
        "sweep",
        "step_steer",
        "--vary",
        f"electronic_differential.method=equal_torque,{OWN_LAW}",
    ]
    words += ["--duration", "0.1", "--workers", "1"]
    run_scenario([*words, "--out", str(tmp_path / "first")])
    run_scenario([*words, "--out", str(tmp_path / "second")])
    assert "2 of them driven before" in capsys.readouterr().out
