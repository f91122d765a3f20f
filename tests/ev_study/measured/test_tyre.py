"""identify --tyre.

The whole Magic Formula against that of the plant, and a made tyre found again from rig data.
"""

from __future__ import annotations

import json
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.io import savemat

from ev_core.vehicle.files import read_tyre
from ev_core.vehicle.tyre import MF_NAMES, mf_tyres
from ev_msgs_py.refusal import ParameterError
from ev_sim.tyres.mf_tyre import MfTyre, at_load, forces, is_plain
from ev_stack.commands.run_scenario import main
from ev_study.measured.magic_formula import Points, combined_lateral, combined_longitudinal
from ev_study.measured.rig import read_rig
from ev_study.measured.tyre_fit import FIXED, STARTS, fit_tyre

FILE = "tyres/pacejka_2006_205_60r15.tir"
NUMBERS = read_tyre("tyre", FILE)


def coefficients() -> dict[str, float]:
    """The tyre of the file as the plant takes it.

    Upright, nominal pressure, no shifts but that of the weight.
    """
    of = {name.upper(): value for name, value in zip(MF_NAMES, NUMBERS, strict=True)} | FIXED
    of["PKY1"] = -of["PKY1"]
    zero = "PDX3 PHX1 PHX2 PVX1 PVX2 PPX1 PPX2 PPX3 PPX4 PDY3 PEY3 PEY4 PKY3 PKY6 PKY7 PHY1 PHY2 PVY1 PVY2 PVY3 PVY4"
    more = "PPY1 PPY2 PPY3 PPY4 PPY5 RBX3 RHX1 RBY3 RBY4 RVY1 RVY2 RVY3 RVY4 RVY5 RVY6"
    return of | {"NOMPRES": 2e5} | dict.fromkeys((*zero.split(), *more.split()), 0.0)


def points(slip: np.ndarray, angle: np.ndarray, load: np.ndarray) -> Points:
    none = np.zeros(len(slip))
    return Points(slip, angle, none, load, none + 2e5, none, none)


def test_the_whole_formula_is_that_of_the_plant_where_the_plant_has_it():
    """Upright, without shifts.

    To the 1e-9 of the plant's polynomials for arc tangent, sine and cosine.
    """
    random = np.random.Generator(np.random.PCG64(0))
    slip, angle = random.uniform(0.005, 0.3, 40), random.uniform(0.005, 0.2, 40)
    load = random.uniform(1000.0, 7000.0, 40)
    at = points(slip, -angle, load)
    along, across = combined_longitudinal(coefficients(), at), combined_lateral(coefficients(), at)
    tyres = mf_tyres(NUMBERS, NUMBERS)
    for n in range(40):
        tyre = MfTyre(tyres, 0, is_plain(tyres))
        loaded = at_load(tyre, float(load[n]), 1.0, 1.0)
        ours = forces(tyre, loaded, float(slip[n]), float(np.tan(angle[n])), 1.0)
        assert (along[n], across[n]) == pytest.approx(ours, rel=1e-9)


def rig(noise: float = 0.0, seed: int = 0) -> dict[str, np.ndarray]:
    """Sweeps of the made tyre as the TTC writes them.

    6 loads, slip angle alone, then slip ratio at three angles.
    """
    random = np.random.Generator(np.random.PCG64(seed))
    wave, parts, time = np.sin(np.linspace(0.0, 6.28, 120)), [], 0.0
    for angle in (None, 0.0, -0.03, -0.07):
        for load in (1500.0, 2500.0, 3500.0, 4500.0, 5500.0, 6500.0):
            slip = np.zeros(120) if angle is None else 0.15 * wave
            side = 0.17 * wave if angle is None else np.full(120, angle)
            at = points(slip, side, np.full(120, load))
            fx, fy = combined_longitudinal(coefficients(), at), combined_lateral(coefficients(), at)
            noisy = [f + noise * random.standard_normal(120) for f in (fx, fy)]
            parts.append(
                (
                    time + np.arange(120) * 0.01,
                    slip,
                    -np.degrees(side),
                    -at.load,
                    noisy[0],
                    -noisy[1],
                )
            )
            time += 10.0
    columns = dict(
        zip(("ET", "SL", "SA", "FZ", "FX", "FY"), np.concatenate(parts, axis=1), strict=True)
    )
    return {**columns, "IA": np.zeros(len(columns["ET"])), "P": np.full(len(columns["ET"]), 200.0)}


def write(path: Path, columns: dict[str, np.ndarray]) -> Path:
    rows = np.stack(list(columns.values()), axis=1)
    path.write_text("\n".join((",".join(columns), *(",".join(map(str, row)) for row in rows))))
    return path


def test_a_made_tyre_is_found_again_and_its_file_is_read(tmp_path, capsys):
    """Noise of 30 N on forces of up to 7 kN is 0.4 %.

    Unseen sweeps within 1 %, and the plant reads the file.

    The friction of the road is the named factor times that of the belt.
    """
    path = write(tmp_path / "rig.csv", rig(30.0))
    main(
        ["identify", "--tyre", str(path), "--friction-scale", "0.8", "--out", str(tmp_path / "out")]
    )
    assert "combined lateral" in capsys.readouterr().out
    found = json.loads((tmp_path / "out" / "summary.json").read_text())
    assert found["sweeps"] == 24
    assert max(found["unseen"].values()) < 0.01
    read = dict(zip(MF_NAMES, read_tyre("tyre", str(tmp_path / "out" / "tyre.tir")), strict=True))
    truth = dict(zip(MF_NAMES, NUMBERS, strict=True))
    nominal = truth["pdy1"] + truth["pdy2"] * (read["fnomin"] - truth["fnomin"]) / truth["fnomin"]
    assert read["pdy1"] == pytest.approx(0.8 * nominal, rel=0.02)


def test_a_matlab_file_is_the_same_as_its_table(tmp_path):
    columns = rig()
    savemat(tmp_path / "rig.mat", columns)
    one, other = read_rig([write(tmp_path / "rig.csv", columns)]), read_rig([tmp_path / "rig.mat"])
    assert one.count == other.count == 24
    assert one.is_lateral.sum() == other.is_lateral.sum() == 6 * 120
    assert (one.points.lateral_force == other.points.lateral_force).all()


def test_what_is_no_rig_data_is_refused(tmp_path):
    (tmp_path / "rig.csv").write_text("ET,SA\n0,1\n1,2\n")
    with pytest.raises(SystemExit) as ended:
        main(["identify", "--tyre", str(tmp_path / "rig.csv"), "--out", str(tmp_path / "out")])
    assert "lacks SL, IA, FZ" in str(ended.value)


def test_coefficients_that_no_sweep_decides_are_named_as_assumed(tmp_path, capsys):
    """Side force alone.

    What belongs to slip ratios stands in a section of its own, and the plant reads the file.
    """
    columns = rig()
    lateral = columns["SL"] == 0.0
    path = write(tmp_path / "rig.csv", {name: values[:720] for name, values in columns.items()})
    assert lateral[:720].all()
    main(["identify", "--tyre", str(path), "--out", str(tmp_path / "out")])
    assert "not identified, no sweep is there for them, assumed: PCX1" in capsys.readouterr().out
    assumed = (
        (tmp_path / "out" / "tyre.tir").read_text().partition("[COEFFICIENTS_THAT_ARE_ASSUMED]")[2]
    )
    assert all(f"{name} " in assumed for name in ("PDX1", "PKX1", "RBX1", "RBY1"))
    assert "PKY1" not in assumed
    assert len(read_tyre("tyre", str(tmp_path / "out" / "tyre.tir"))) == len(MF_NAMES)


def test_a_log_without_pauses_is_split_where_the_rig_changes_its_load(tmp_path):
    """Six loads of one sweep of the slip angle each, 1.2 s long."""
    columns = {name: values[:720] for name, values in rig().items()}
    columns["ET"] = np.arange(720) * 0.01
    assert read_rig([write(tmp_path / "rig.csv", columns)]).count == 6


@pytest.mark.parametrize(
    ("column", "factor", "line"),
    [
        ("FZ", 1e-3, r"FZ is -.* N in the median, expected -60000 to -50 N: the unit of FZ"),
        ("FZ", -1.0, r"FZ is .* N in the median, expected below 0"),
        ("P", 1 / 6.895, r"P is 29.* kPa in the median, expected 40"),
        ("FY", -1.0, "FY has the sign of SA, expected the opposite"),
        ("FX", -1.0, "FX has the sign of the opposite of SL"),
    ],
)
def test_rig_data_of_other_signs_and_units_are_refused(tmp_path, column, factor, line):
    columns = rig()
    columns[column] = factor * columns[column]
    with pytest.raises(ParameterError, match=line):
        read_rig([write(tmp_path / "rig.csv", columns)])


def test_a_row_of_other_units_is_refused_and_one_of_its_own_is_read(tmp_path):
    path = write(tmp_path / "rig.csv", rig())
    header, _, rows = path.read_text().partition("\n")
    own = {
        "ET": "s",
        "SL": "-",
        "SA": "deg",
        "FZ": "N",
        "FX": "N",
        "FY": "N",
        "IA": "deg",
        "P": "kPa",
    }
    for column, other in (("", ""), ("SA", "rad"), ("FY", "lb"), ("P", "psi")):
        units = {**own, **({column: other} if column else {})}
        path.write_text(
            "\n".join((header, ",".join(units[name] for name in header.split(",")), rows))
        )
        if not column:
            assert read_rig([path]).count == 24
            continue
        with pytest.raises(
            ParameterError, match=rf"rig\.csv: {column} is in '{other}', expected {own[column]}"
        ):
            read_rig([path])


def test_samples_without_a_number_or_load_are_counted(tmp_path):
    """Three cells of text and two lifted tyres among 2880 samples of 24 sweeps."""
    columns = rig()
    columns["FZ"][[100, 500]] = 0.0
    path = write(tmp_path / "rig.csv", columns)
    lines = path.read_text().splitlines()
    for n in (10, 20, 30):
        lines[n] = lines[n].rpartition(",")[0] + ",ERR"
    path.write_text("\n".join(lines))
    sweeps = read_rig([path])
    assert sweeps.passed_over == 5
    assert len(sweeps.points.load) == 2880 - 5


def assumed_by(folder: Path) -> dict[str, float]:
    """The coefficients in the section of those that are assumed."""
    text = (folder / "tyre.tir").read_text().partition("[COEFFICIENTS_THAT_ARE_ASSUMED]")[2]
    lines = (line.split("=") for line in text.splitlines() if "=" in line)
    return {name.strip(): float(value) for name, value in lines}


@settings(max_examples=8, deadline=None)
@given(number=st.integers(0, 5), seed=st.integers(0, 9))
def test_one_load_decides_nothing_over_load_inclination_and_pressure(number, seed):
    """These coefficients stay at their starts to a tenth of their range, at any load and noise.

    Without a prior the noise decided them: friction that rose by 0.7 from one nominal load to twice
    that, and was written as identified. What one load shows is found.
    """
    columns = rig(30.0, seed)
    chosen = slice(120 * number, 120 * (number + 1))
    with TemporaryDirectory() as folder:
        path = write(Path(folder) / "rig.csv", {n: each[chosen] for n, each in columns.items()})
        fit = fit_tyre(read_rig([path]))
    over_load = ("PDY2", "PEY2", "PHY2", "PVY2")
    over_others = ("PDY3", "PKY3", "PVY3", "PKY6", "PPY1", "PPY2", "PPY3")
    assert {*over_load, *over_others} <= {*fit.undecided}
    for name in (*over_load, *over_others):
        start, low, high = STARTS[name]
        assert abs(fit.coefficients[name] - start) < 0.1 * (high - low)
    assert "PDY1" not in fit.undecided
    at = points(np.zeros(1), np.full(1, 0.1), -columns["FZ"][chosen][:1])
    force = combined_lateral(fit.coefficients, at)
    assert force == pytest.approx(combined_lateral(coefficients(), at), rel=0.02)


def test_sweeps_of_small_angles_decide_no_friction(tmp_path, capsys):
    """Up to 1 deg a tyre has a third of its friction: its slope is found, its bend is assumed.

    By the noise alone the friction would come out at half of the true one.
    """
    columns = rig(30.0)
    small = {name: each[:720] for name, each in columns.items()}
    angles = np.radians(-small["SA"] / 10.0)
    loads = -small["FZ"]
    small["SA"] = -np.degrees(angles)
    noise = 10.0 * np.random.Generator(np.random.PCG64(0)).standard_normal(720)
    small["FY"] = -combined_lateral(coefficients(), points(np.zeros(720), angles, loads)) + noise
    out = tmp_path / "out"
    main(["identify", "--tyre", str(write(tmp_path / "rig.csv", small)), "--out", str(out)])
    line = "not decided by these sweeps, near what is assumed: PCY1, PDY1, PDY2"
    assert line in capsys.readouterr().out
    assumed = assumed_by(out)
    assert {name: assumed[name] for name in ("PCY1", "PDY1", "PEY1")} == {
        name: STARTS[name][0] for name in ("PCY1", "PDY1", "PEY1")
    }
    assert "PKY1" not in assumed
    assert json.loads((out / "summary.json").read_text())["assumed"].count("PDY1") == 1
