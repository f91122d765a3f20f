"""The wheels in a Python without ROS: only what they say they need is there."""

from __future__ import annotations

import json
import re
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from importlib.metadata import distribution
from pathlib import Path

import pytest

import ev_stack
from ev_core.compiling.user_cache import cache_folder
from ev_msgs_py.packages import OURS

ROOT = Path(__file__).parents[3]
NOTEBOOK = ROOT / "docs" / "examples" / "shchur2019.ipynb"
OWN = ("ev_msgs_py", "ev_core", "ev_nodes", "ev_control", "ev_sim", "ev_stack")


def needed(name: str) -> set[str]:
    """The distributions that one says it needs, and what they need in turn, without extras."""
    found, waiting = set(), [name]
    while waiting:
        each = waiting.pop()
        if each not in found:
            found.add(each)
            requirements = [
                text for text in distribution(each).requires or () if "extra ==" not in text
            ]
            requirements = [
                text
                for text in requirements
                if "sys_platform" not in text and "platform_system" not in text
            ]
            requirements = [
                text
                for text in requirements
                if not re.search(r"python_version\s*<\s*.3\.1[01]\b", text)
            ]
            waiting += [re.match(r"[\w.-]+", text).group().lower() for text in requirements]
    return found


def tops(name: str) -> Iterator[Path]:
    """Yield the top folders and files that a distribution has put into site-packages."""
    of = distribution(name)
    for top in {file.parts[0] for file in of.files or () if file.parts[0] != ".."}:
        yield Path(of.locate_file(top))


def files_below(folder: Path, name: str) -> set[str]:
    """The files that belong to a wheel, under the name that the folder has there."""
    paths = (
        path for path in folder.rglob("*") if path.is_file() and "__pycache__" not in path.parts
    )
    return {f"{name}/{path.relative_to(folder)}" for path in paths}


@pytest.mark.slow
@pytest.mark.weekly
def test_wheels_and_the_notebook_need_nothing_else(tmp_path):
    wheels, bare = tmp_path / "wheels", tmp_path / "bare"
    subprocess.run([ROOT / "scripts" / "build_wheels.sh", wheels], check=True, capture_output=True)
    held = {
        wheel.name.partition("-")[0]: {*zipfile.ZipFile(wheel).namelist()}
        for wheel in wheels.iterdir()
    }
    assert {*held} == {*OURS}
    # py.typed, published.csv, what pages are made of, and all configuration
    for name, files in held.items():
        assert f"{name}/py.typed" in files
        assert files_below(ROOT / "src" / name / name, name) <= files
    assert files_below(ROOT / "config", "ev_sim/config") <= held["ev_sim"]
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", bare], check=True)
    (site,) = bare.glob("lib/python*/site-packages")
    for name in needed("ev_stack") - set(OWN):
        for top in tops(name):
            if not (site / top.name).exists():
                (site / top.name).symlink_to(top)
    python = bare / "bin" / "python"
    pip = [
        sys.executable,
        "-m",
        "pip",
        "--python",
        python,
        "install",
        "--quiet",
        "--no-index",
        "--no-deps",
        "--no-compile",
    ]
    subprocess.run([*pip, *wheels.glob("*.whl")], check=True)
    assert not {"plant", "driver", "asr", "inspect"} & {
        path.name for path in (bare / "bin").iterdir()
    }

    cells = [
        cell for cell in json.loads(NOTEBOOK.read_text())["cells"] if cell["cell_type"] == "code"
    ]
    assert not any(cell["outputs"] for cell in cells)
    # all cells, and all of them again
    text = 2 * ("\n".join("".join(cell["source"]) for cell in cells) + "\n")
    text += "\nprint(result.hash)\nassert len(result._repr_html_()) > 50_000\n"
    text += "import importlib.util\nassert importlib.util.find_spec('rclpy') is None\n"
    clean = {
        "PATH": f"{bare}/bin:/usr/bin:/bin",
        "HOME": str(tmp_path),
        "EV_STACK_CACHE": str(cache_folder()),
    }
    shown = subprocess.run(
        [python, "-c", text], capture_output=True, text=True, cwd=tmp_path, env=clean
    )
    assert shown.returncode == 0, shown.stderr
    assert shown.stdout.split() == [ev_stack.run("shchur2019").hash]
    refused = subprocess.run(
        [bare / "bin" / "ev-stack", "run", "shchur2019"], capture_output=True, text=True, env=clean
    )
    message = "error: nodes need ROS 2 (rclpy), which is not installed here: --offline --no-record needs none\n"
    assert (refused.returncode, refused.stderr, refused.stdout) == (1, message, "")
