"""`ev-stack export`.

The folder that it leaves, which links by the line in its README, and what it refuses.
"""

from __future__ import annotations

import ast
import re
import shutil
import subprocess
from pathlib import Path

import pytest

from ev_core.compiling.object_symbols import calls
from ev_core.compiling.other_processors import X86_64_LINUX
from ev_doors.export import targets
from ev_stack.commands.program import perform

LAW = ["export", "shchur2019", "--only", "driver"]
LINUX = ["--target", "x86_64-linux"]
NAMED = [*LAW, *LINUX, "--name", "main"]  # which C has already
ROOT = Path(__file__).parents[3]
PLAIN = ROOT / "docs" / "examples" / "own_law.py"


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    made = tmp_path_factory.mktemp("export") / "driver"
    perform([*NAMED, "--out", str(made)])
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
    answer = subprocess.run(
        [folder / "program"], input=b"c", capture_output=True, check=True
    ).stdout
    (folder / "program").unlink()
    assert answer[:4] == bytes(4)  # created, without complaint


@pytest.mark.skipif(
    not shutil.which("x86_64-w64-mingw32-gcc"), reason="x86_64-w64-mingw32-gcc is not installed"
)
def test_the_line_of_the_readme_links_the_program_of_another_system(tmp_path):
    perform([*LAW, "--target", "x86_64-windows", "--out", str(tmp_path)])
    (line,) = re.findall(r"^\S+-gcc .*$", (tmp_path / "README.md").read_text(), re.MULTILINE)
    subprocess.run(line, shell=True, cwd=tmp_path, check=True)
    program = (tmp_path / "program.exe").read_bytes()
    assert b"KERNEL32.dll" in program
    assert b"libwinpthread" not in program  # else it would need that file beside it


def test_the_library_calls_nothing_but_what_is_listed(folder, tmp_path):
    """The linker sees memset and what scales exponents in the archive: no heap, file or Python."""
    archive = next(folder.glob("*.a"))
    subprocess.run(["ar", "x", archive], cwd=tmp_path, check=True)
    objects = [file.read_bytes() for file in tmp_path.glob("*.o")]
    assert len(objects) == 2  # the law and the loop
    own = {
        "_GLOBAL_OFFSET_TABLE_",
        *(name for each in objects for name in calls(each) if name.startswith("evs_main")),
    }
    assert {name for each in objects for name in calls(each)} - own <= X86_64_LINUX.may_call


def test_the_same_export_gives_the_same_files(folder, tmp_path):
    perform([*NAMED, "--out", str(tmp_path)])
    before = {file.name: file.read_bytes() for file in folder.iterdir()}
    assert {file.name: file.read_bytes() for file in tmp_path.iterdir()} == before


@pytest.mark.sampled
@pytest.mark.parametrize("target", targets.TARGETS.values(), ids=lambda target: target.name)
@pytest.mark.parametrize("way", ["README.md", "CMakeLists.txt"])
def test_both_printed_ways_of_building_work_for_every_target(target, way, tmp_path):
    """Programs run where there is an emulator: they create the law without complaint."""
    if lacking := [each for each in (target.compiler, "cmake") if not shutil.which(each)]:
        pytest.skip(f"{lacking[0]} is not installed")
    perform([*LAW, "--target", target.name, "--out", str(tmp_path)])
    pattern = r"^\S*gcc .*$" if way == "README.md" else r"cmake -B .*$"
    (line,) = re.findall(pattern, (tmp_path / way).read_text(), re.MULTILINE)
    done = subprocess.run(line, shell=True, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    built = "program*" if way == "README.md" else "build/evs_*_program*"
    (program,) = (file for file in tmp_path.glob(built) if file.is_file())
    if target.system != "Windows" and shutil.which((*target.emulator, "sh")[0]):
        answer = subprocess.run(
            [*target.emulator, program], input=b"c", capture_output=True, timeout=60
        ).stdout
        assert answer[:4] == bytes(4)


_WITH_A_LIST = """
from dataclasses import dataclass

from ev_core.law import Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter


@dataclass(frozen=True, slots=True)
class ShareParameters:
    share: float = parameter(0.5, unit="1", low=0.0, high=1.0, about="of the torques")


@method("asr", "with_a_list")
@compilable
def with_a_list(p: ShareParameters, request: WheelTorqueRequest) -> WheelTorqueCommand:
    torque = [0.0, 0.0, 0.0, 0.0]
    for i in range(4):
        torque[i] = p.share * request.drive[i]
    return WheelTorqueCommand(Wheels(torque[0], torque[1], torque[2], torque[3]), request.brake)
"""


def test_a_law_that_needs_a_heap_is_refused(tmp_path):
    file = tmp_path / "law.py"
    file.write_text(_WITH_A_LIST)
    words = [
        "export",
        "shchur2019",
        "--only",
        "asr",
        "--method",
        f"asr={file}",
        *LINUX,
        "--out",
        str(tmp_path / "out"),
    ]
    assert "makes a list or an array in a step, which needs a heap" in refused(*words)
    assert not (tmp_path / "out").exists()


def test_no_compiled_function_of_ours_makes_a_list():
    """Every law and every plant can be exported.

    The text is read, for to compile all of them takes minutes.
    """
    made = []
    for file in (ROOT / "src").glob("*/*/**/*.py"):
        for function in ast.walk(ast.parse(file.read_text())):
            if isinstance(function, ast.FunctionDef) and any(
                map(_is_compilable, function.decorator_list)
            ):
                made += [
                    (file.name, n.lineno)
                    for n in ast.walk(function)
                    if isinstance(n, (ast.List, ast.ListComp))
                ]
    assert made == []


def _is_compilable(decorator: ast.expr) -> bool:
    return isinstance(decorator, ast.Name) and decorator.id == "compilable"


def test_a_method_in_plain_python_is_refused(tmp_path):
    words = [
        "export",
        "shchur2019",
        "--only",
        "asr",
        "--method",
        f"asr={PLAIN}:limit_in_python",
        *LINUX,
    ]
    assert "is not compiled" in refused(*words, "--out", str(tmp_path / "out"))
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("words", "line"),
    [
        ((*LAW, "--target", "pdp11"), "unknown target 'pdp11'"),
        (("export", "shchur2019", "--target", "thumbv7em"), "expected roles that answer"),
        ((*LAW, *LINUX, "--name", "2fast"), "name '2fast' is refused"),
        (("export", "shchur2019", *LINUX, "--only", "pilot"), "unknown role 'pilot'"),
        (
            (
                "export",
                "shchur2019",
                *LINUX,
                "--without",
                "plant,steering_column,driver,electronic_differential,asr",
            ),
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
    assert line.endswith(
        "aarch64-linux-gnu-gcc is not installed; Debian has it in gcc-aarch64-linux-gnu"
    )
    assert not (tmp_path / "out").exists()
