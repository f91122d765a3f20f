"""Energy of electric cars.

The list, the assumptions by class, sums over a cycle beside the plant, and the fit.
"""

from __future__ import annotations

import dataclasses
import re
from types import SimpleNamespace

import pytest

from ev_core.parameters.data_file import find_file
from ev_msgs_py.refusal import ParameterError
from ev_study.studies import electric_cars, energy
from ev_study.studies.electric_cars import (
    ASSUMPTIONS,
    CYCLES,
    assumption_rows,
    consumption,
    fit,
    held_out,
    read_assumptions,
    read_cars,
)
from ev_study.studies.study import drive_case

HEAD = "make,model,vehicle,configuration,drive,test_weight_lb,A_lbf,B_lbf_per_mph,C_lbf_per_mph2,udds_mpge,hwfet_mpge"
DRIVES = ("2-Wheel Drive, Front", "All Wheel Drive")


def listed(tmp_path, rows):
    file = tmp_path / "cars.csv"
    file.write_text("\n".join((HEAD, *rows)) + "\n")
    return file


def car(name, drive, weight=4000, a=30, b=0.2, c=0.018, udds=120, hwfet=100):
    return f'M,{name},{name},0,"{drive}",{weight},{a},{b},{c},{udds},{hwfet}'


def test_classes_by_model_else_by_driven_axles(tmp_path):
    file = listed(
        tmp_path, [car("Any", DRIVES[0]), car("Any", DRIVES[1]), car("Taycan 4", DRIVES[1])]
    )
    assert [each.drive for each in read_cars(file)] == [
        "one machine",
        "two machines",
        "two-speed gearbox",
    ]
    first = read_cars(file)[0]
    assert first.mass == pytest.approx(4000 * 0.45359237) and first.measured[
        "udds"
    ] == pytest.approx(174.53, abs=0.01)


@pytest.mark.parametrize(
    ("row", "message"),
    [
        (
            car("X", DRIVES[0], weight="heavy"),
            "line 2, column test_weight_lb: 'heavy' is refused, expected a",
        ),
        (car("X", DRIVES[0], udds=0), "line 2, column udds_mpge: '0' is refused"),
        (car("X", DRIVES[0], c="nan"), "line 2, column C_lbf_per_mph2: 'nan' is refused"),
        (
            car("X", "three wheels"),
            "line 2, column drive: .three wheels. is refused, expected one of 2-Wheel Drive, Front",
        ),
    ],
)
def test_a_wrong_row_is_one_line(tmp_path, row, message):
    with pytest.raises(ParameterError, match=message):
        read_cars(listed(tmp_path, [row]))


def test_a_list_without_cars_or_with_a_class_missing_is_refused(tmp_path):
    with pytest.raises(ParameterError, match="no car is in it"):
        read_cars(listed(tmp_path, []))
    file = tmp_path / "assumed.csv"
    file.write_text("quantity,class,value,unit\ngear_efficiency,all,0.9,1\n")
    with pytest.raises(ParameterError, match="lacks idle of one machine"):
        read_assumptions(file)


def test_a_car_is_new_unless_the_assumptions_were_fitted_to_its_code(tmp_path):
    """A list of other cars is all new, whatever its order.

    A fitted code of the shipped assumptions is not.
    """
    known = sorted(read_assumptions().fitted)[0]
    file = listed(tmp_path, [car("X", DRIVES[0]), car(known, DRIVES[0]), car("Y", DRIVES[1])])
    given = SimpleNamespace(cars=file, assumptions=None, fit=False, only=[], duration=None)
    driven = SimpleNamespace(measured={"consumption": 150.0})
    results = dict.fromkeys([case.name for case in energy.cases(given)], driven)
    assert [row[2] for row in energy.rows(given, results)] == ["new", "fit", "new"]
    numbers = energy.metrics(given, results)
    assert set(numbers) == {
        f"{name}{part}"
        for name in ("median_error", "ninety_percent_within")
        for part in ("", "_new")
    }
    shown = energy.tables(given, results)
    assert "cars that the assumptions were not fitted to: median error" in shown
    assert known in shown and "fitted  " not in shown


@pytest.mark.weekly
@pytest.mark.slow
@pytest.mark.parametrize("drive", DRIVES)
def test_the_plant_agrees_with_the_sums_over_the_cycle(tmp_path, drive):
    """Within 2 % on the HWFET: the sums follow the cycle exactly, a driver does not."""
    given = SimpleNamespace(
        cars=listed(tmp_path, [car("X", drive)]),
        assumptions=None,
        fit=False,
        only=[],
        duration=None,
    )
    ours = drive_case(energy.cases(given)[1], energy.measure).measured
    assumed = read_assumptions()
    wanted = consumption(read_cars(given.cars)[0], "hwfet", assumed) * assumed.charger_efficiency
    assert ours["consumption"] == pytest.approx(wanted, rel=0.02)
    assert ours["speed_error"] < 0.5


@pytest.mark.slow
def test_a_fit_finds_assumptions_that_made_the_numbers(tmp_path):
    """Consumption made with other assumptions than those expected is met within 1 %.

    Held-out cars are every third.
    """
    rows = [
        car(
            f"X{n}", DRIVES[n % 2], weight=3000 + 500 * (n % 5), a=25 + 3 * (n % 4), b=0.1 * (n % 3)
        )
        for n in range(12)
    ]
    cars = read_cars(listed(tmp_path, rows))
    true = dataclasses.replace(read_assumptions(), charger_efficiency=0.9, auxiliary_power=400.0)
    made = [
        dataclasses.replace(
            each, measured={cycle: consumption(each, cycle, true) for cycle in CYCLES}
        )
        for each in cars
    ]
    kept = held_out(made)
    assert len(kept) == 4
    found = fit([each for each in made if each.vehicle not in kept])
    assert found.fitted == {each.vehicle for each in made} - kept
    for each in made:
        for cycle in CYCLES:
            assert consumption(each, cycle, found) == pytest.approx(each.measured[cycle], rel=0.01)


def test_a_fit_that_ends_at_its_bounds_can_be_read_again(tmp_path, monkeypatch):
    """Idle force and copper losses are zero there, to the bit, not a rounding below."""

    def at_low_ends(residuals, start, bounds, loss):
        return SimpleNamespace(x=bounds[0])

    monkeypatch.setattr(electric_cars, "least_squares", at_low_ends)
    found = fit(read_cars(listed(tmp_path, [car("X", DRIVES[0])])))
    assert set(found.idle.values()) == {0.0}
    assert found.copper == 0.0
    file = tmp_path / "fitted.csv"
    lines = [",".join(row) for row in assumption_rows(found)]
    file.write_text("\n".join(["quantity,class,value,unit", *lines]) + "\n")
    assert read_assumptions(file).idle == found.idle


@pytest.mark.parametrize(
    ("row", "line"),
    [
        (
            "charger_efficiency,all,0,1",
            "charger_efficiency of all is 0, expected above 0 and at most 1",
        ),
        (
            "charger_efficiency,all,88,1",
            "charger_efficiency of all is 88, expected above 0 and at most 1",
        ),
        (
            "gear_efficiency,all,nan,1",
            "gear_efficiency of all is nan, expected above 0 and at most 1",
        ),
        ("copper,all,inf,W/N^2", "copper of all is inf, expected 0 to 10000"),
        ("idle,one machine,-3,N", "idle of one machine is -3, expected 0 to 10000"),
        ("recovery,one machine,1.0,m/s^2", "recovery of one machine is there twice, expected once"),
    ],
)
def test_an_assumption_that_cannot_be_is_refused_with_its_line(tmp_path, row, line):
    """Comments count as lines; what is there twice is no choice of the later one."""
    shipped = find_file(ASSUMPTIONS).read_text().splitlines()
    quantity, drive, *_ = row.split(",")
    kept = [
        each for each in shipped if "twice" in line or not each.startswith(f"{quantity},{drive},")
    ]
    file = tmp_path / "assumed.csv"
    file.write_text("\n".join(["# by hand", *kept, row]) + "\n")
    with pytest.raises(
        ParameterError, match=rf"assumed\.csv, line {len(kept) + 2}: {re.escape(line)}"
    ):
        read_assumptions(file)


def test_a_wrong_row_behind_comments_has_the_line_of_the_file(tmp_path):
    file = listed(tmp_path, [car("X", DRIVES[0]), "# a comment", "", car("Y", DRIVES[0], udds=0)])
    with pytest.raises(ParameterError, match="line 5, column udds_mpge"):
        read_cars(file)
