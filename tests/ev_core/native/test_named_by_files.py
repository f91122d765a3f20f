"""A library is code.

It is chosen on the command line or from Python, and no file can have it loaded.
"""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

import ev_stack
from ev_msgs_py.refusal import ParameterError
from ev_stack.commands.run_scenario import main
from ev_stack.running.node_process import command
from ev_stack.scenarios.scenario import Overrides, load_scenario
from ev_study.replay.graph import replay_of
from ev_study.replay.recorded import find_recorded

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="no C compiler here")

ASR = "/**/asr:\n  ros__parameters:\n    method: {}\n"
LEAVES_A_FILE = """
#include <stdio.h>
__attribute__((constructor)) static void loaded(void) { fclose(fopen("RAN", "w")); }
"""


@pytest.fixture
def library(tmp_path) -> Path:
    """It leaves the file `ran` when it is loaded, and has no law."""
    (tmp_path / "law.c").write_text(LEAVES_A_FILE.replace("RAN", str(tmp_path / "ran")))
    made = tmp_path / "law.so"
    subprocess.run(["cc", "-shared", "-fPIC", "-o", made, tmp_path / "law.c"], check=True)
    return made


def output_of_node(*words: object) -> tuple[int, str]:
    """Exit status and last line of the asr's node."""
    node = [*command("asr"), "--ros-args", *map(str, words)]
    done = subprocess.run(node, capture_output=True, text=True)
    return done.returncode, done.stderr.strip().splitlines()[-1]


@pytest.mark.parametrize("what", ["scenario", "parameters", "beside a recording"])
def test_no_file_has_a_library_loaded(library, tmp_path, what):
    """A library named by a file is refused before its constructor runs."""
    file = tmp_path / "own.yaml"
    file.write_text(ASR.format(library).replace("**", "ev"))
    refused = rf"\.yaml: parameter method: '{library}' is refused, expected from a file a name: .*--method asr="
    with pytest.raises(ParameterError, match=refused):
        if what == "scenario":
            load_scenario(str(file))
        elif what == "parameters":
            load_scenario("double_lane_change", Overrides(files=[file]))
        else:
            folder = tmp_path / "results"
            ev_stack.run("double_lane_change", duration=0.1).save(folder)
            file.rename(folder / "parameters.yaml")
            replay_of(find_recorded(folder), "asr", "", Overrides())
    assert not (tmp_path / "ran").exists()


def test_the_command_line_and_python_have_it_loaded(library, tmp_path):
    """Their line is that it has no law."""
    for words in (("--method", f"asr={library}"), ("--set", f"asr.method={library}")):
        with pytest.raises(
            SystemExit, match=f"^error: asr: asr method {library}: it has no ev_asr"
        ):
            main(["double_lane_change", "--offline", "--out", str(tmp_path / "out"), *words])
    with pytest.raises(ParameterError, match="it has no ev_asr"):
        ev_stack.run("double_lane_change", method={"asr": str(library)})
    assert (tmp_path / "ran").exists()


@pytest.mark.slow
def test_a_node_takes_it_from_its_command_line_only(library, tmp_path):
    file = tmp_path / "own.yaml"
    file.write_text(ASR.format(library))
    for words in (("--params-file", file), ("--params-file", file, "-p", f"method:={library}.so")):
        status, output = output_of_node(*words)
        assert status == 1
        assert (
            f"method {library}.so" in output
            or "is refused, expected from a file a name: " in output
        )
    assert not (tmp_path / "ran").exists()
    for word in (f"method:={library}", f'asr:method:="{library}"'):
        status, output = output_of_node("--params-file", file, "-p", word)
        assert status == 1
        assert output.startswith(f"asr: asr method {library}: it has no ev_asr, ")
        (tmp_path / "ran").unlink()
