"""`ev-stack export`: the folder that it leaves, which links by the line in its README, and what it refuses."""

from __future__ import annotations

import re
import shutil
import subprocess
from pathlib import Path

import pytest

from ev_core.compiling.object_symbols import calls
from ev_core.compiling.other_processors import X86_64_LINUX
from ev_sim.commands.ev_stack import perform
from ev_sim.export import targets

LAW = ["export", "shchur2019", "--only", "driver"]
LINUX = ["--target", "x86_64-linux"]
PLAIN = Path(__file__).parents[2] / "docs" / "examples" / "own_law.py"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("export") / "driver"
    perform([*LAW, *LINUX, "--out", str(made)])
    return made


def refused(*words: str) -> str:
    """The one line of a command that is refused."""
    with pytest.raises(SystemExit) as ended:
        perform([*words])
    (line,) = str(ended.value.code).splitlines()
    return line


def test_the_line_of_the_readme_links_the_program(folder):
    (line,) = re.findall(r"^gcc .*$", (folder / "README.md").read_text(), re.MULTILINE)
    subprocess.run(line, shell=True, cwd=folder, check=True)
    answer = subprocess.run([folder / "program"], input=b"c", capture_output=True, check=True).stdout
    (folder / "program").unlink()
    assert answer[:4] == bytes(4)  # created, without complaint


def test_the_library_calls_nothing_but_what_is_listed(folder, tmp_path):
    """Of the whole archive, as the linker sees it: memset and what scales exponents, no heap, no file, no Python."""
    archive = next(folder.glob("*.a"))
    subprocess.run(["ar", "x", archive], cwd=tmp_path, check=True)
    objects = [file.read_bytes() for file in tmp_path.glob("*.o")]
    assert len(objects) == 2  # the law and the loop
    own = {"_GLOBAL_OFFSET_TABLE_", *(name for each in objects for name in calls(each) if name.startswith("shchur"))}
    assert {name for each in objects for name in calls(each)} - own <= X86_64_LINUX.may_call


def test_the_same_export_is_replaced_and_a_changed_file_is_not(folder):
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    perform([*LAW, *LINUX, "--out", str(folder)])
    assert {file.name: file.read_bytes() for file in folder.iterdir()} == before
    header = folder / "shchur2019_driver.h"
    header.write_text("mine")
    assert "shchur2019_driver.h there was changed" in refused(*LAW, *LINUX, "--out", str(folder))
    assert header.read_text() == "mine"
    header.write_bytes(before[header.name])


@pytest.mark.skipif(not shutil.which("arm-none-eabi-gcc"), reason="arm-none-eabi-gcc is not installed")
def test_a_law_is_made_for_a_processor_without_system(tmp_path):
    perform([*LAW, "--target", "thumbv7em", "--out", str(tmp_path)])
    assert not [*tmp_path.glob("*_program.c")]  # nothing there runs one


def test_a_method_in_plain_python_is_refused(tmp_path):
    words = ["export", "shchur2019", "--only", "asr", "--method", f"asr={PLAIN}:limit_in_python", *LINUX]
    assert "is not compiled" in refused(*words, "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ((*LAW, "--target", "pdp11"), "unknown target 'pdp11'"),
        (("export", "shchur2019", "--target", "thumbv7em"), "allowed are roles that answer"),
        ((*LAW, *LINUX, "--name", "2fast"), "name '2fast' is refused"),
        (("export", "shchur2019", *LINUX, "--only", "pilot"), "unknown role 'pilot'"),
        (
            ("export", "shchur2019", *LINUX, "--without", "plant,steering_column,driver,electronic_differential,asr"),
            "all",
        ),
    ],
)
def test_what_cannot_be_made_is_one_line(words, line, tmp_path, monkeypatch):
    monkeypatch.setattr(targets.shutil, "which", lambda name: name)
    assert line in refused(*words, "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


def test_a_target_without_compiler_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(targets.shutil, "which", lambda name: None)
    line = refused(*LAW, "--target", "aarch64-linux", "--out", str(tmp_path / "out"))
    assert line.endswith("aarch64-linux-gnu-gcc is not installed; Debian has it in gcc-aarch64-linux-gnu")
    assert not (tmp_path / "out").exists()
