"""The last line of a command that cannot do what it was asked for, whatever was asked."""

from __future__ import annotations

import pytest

from ev_stack.commands.program import perform

LONG = "x" * 5000
EVIL = "\x1b[2Jerror: all is well\r\n\x07"


@pytest.mark.parametrize(
    "words",
    [
        ["run", LONG, "--offline"],
        ["run", EVIL, "--offline"],
        ["run", "shchur2019", "--offline", "--set", f"driver.seed={LONG}"],
        ["run", "shchur2019", "--offline", "--set", f"{LONG}.seed=1"],
        ["run", "shchur2019", "--offline", "--set", f"driver.{EVIL}=1"],
        ["run", "shchur2019", "--offline", "--method", f"asr={EVIL}{LONG}"],
        ["run", "shchur2019", "--offline", "--vehicle", f"{LONG}.yaml"],
        ["run", "shchur2019", "--offline", "--vehicle", f"{EVIL}.yaml"],
        ["run", "shchur2019", "--offline", "--params", f"/{EVIL}"],
        ["run", "sweep", "shchur2019", "--vary", f"{EVIL}={LONG}"],
        ["run", "report", EVIL],
        ["run", "replay", EVIL, "--node", "asr"],
        ["urdf", EVIL],
        ["fmu", EVIL, "--out", f"{LONG}.fmu"],
    ],
)
def test_what_is_wrong_is_one_line_that_a_terminal_obeys_in_nothing(words, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SystemExit) as ended:
        perform(words)
    line = str(ended.value)
    assert line.startswith("error: ")
    assert line.isprintable()
    assert len(line) <= 1010
    assert "x" * 250 not in line or len(line) <= 1000
