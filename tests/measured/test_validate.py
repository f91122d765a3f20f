"""scripts/run.sh validate: a car against the record that it has made itself, and against that of another one."""

from __future__ import annotations

import json

import pytest
from measured.made_records import CAR, columns_of, driven, write

from ev_sim.commands.run_scenario import main


def test_the_car_that_made_the_record_is_found_right_and_a_softer_one_wrong(tmp_path, capsys):
    """Of the very car remains what a window does not know: how far wheels and loads had followed the manoeuvre.

    That is below 1 % of the signals. Another car is ten times as far off at least.
    """
    record = str(write(tmp_path, columns_of(driven())))
    of = ["validate", record, "--window", "2"]
    main([*of, "--vehicle", CAR, "--out", str(tmp_path / "right")])
    page = (tmp_path / "right" / "report.html").read_text()
    assert page.count("data:image/png") == 2
    assert "compact_ev against made.csv" in page
    out = capsys.readouterr().out
    assert "twist.yaw_rate" in out
    assert "6 windows of 2 s" in out
    found = json.loads((tmp_path / "right" / "summary.json").read_text())
    assert found["errors"]["twist.yaw_rate"]["explained"] > 0.9999
    assert found["errors"]["sideslip"]["explained"] > 0.999
    assert found["metrics"]["windows_left"]["value"] == 0.0
    main([*of, "--no-report", "--vehicle", "audi_a2", "--out", str(tmp_path / "wrong")])
    wrong = json.loads((tmp_path / "wrong" / "summary.json").read_text())
    assert wrong["errors"]["twist.yaw_rate"]["rms"] > 10.0 * found["errors"]["twist.yaw_rate"]["rms"]


def test_a_record_without_what_is_imposed_is_refused(tmp_path, capsys):
    path = write(tmp_path, columns_of(driven()))
    mapping = tmp_path / "made.yaml"
    mapping.write_text("\n".join(line for line in mapping.read_text().splitlines() if "steering_column" not in line))
    with pytest.raises(SystemExit) as ended:
        main(["validate", str(path), "--vehicle", CAR, "--out", str(tmp_path / "out")])
    assert "steering_column.state.angle" in str(ended.value)
