"""Make the packages of src known to this Python and their nodes to the shell, as colcon would.

How it works: each setup.py runs with a `setup` of ours, which only keeps its arguments. Of them the
description and entry points of a package are written for importlib.metadata, and a program for each
console script, at the place from which `ros2 run` would start it. Modules are imported from src
itself, so that an edit holds at once. All ten take a tenth of a second; colcon, which starts
setuptools thirty times, takes 20 s of CPU. Where a distribution is sourced, colcon builds, since
`ros2` finds only what is built so.
"""

from __future__ import annotations

import os
import runpy
import shutil
import sys
import sysconfig
from pathlib import Path
from types import ModuleType
from typing import Any

ROOT = Path(__file__).resolve().parents[1]
INSTALL = ROOT / "install"
INDEX = "share/ament_index/resource_index/packages"  # where ROS tools look for a package
PROGRAM = """#!{python}
import sys

from {module} import {function}

sys.exit({function}())
"""


def arguments_of(package: Path) -> dict[str, Any]:
    """Return what the setup.py of a package gives to `setup`, as when it is installed for a shell."""
    given: dict[str, Any] = {}
    stand_in: Any = ModuleType("setuptools")
    stand_in.setup = given.update
    stand_in.find_packages = lambda **_: []
    sys.modules["setuptools"] = stand_in
    sys.argv = ["setup.py", "develop"]
    os.chdir(package)  # where setup.py looks for package.xml
    runpy.run_path("setup.py")
    return given


def description_of(package: str) -> Path:
    """Return the folder of a package's own description: without it the package is not there."""
    return INSTALL / package / "python"


def write_description(given: dict[str, Any]) -> None:
    """Write the .dist-info of a package (version, needs, entry points) and its mark for ROS tools."""
    folder = description_of(given["name"]) / f"{given['name']}-{given['version']}.dist-info"
    folder.mkdir(parents=True)
    lines = ["Metadata-Version: 2.1", f"Name: {given['name']}", f"Version: {given['version']}"]
    lines += [f"Requires-Dist: {needed}" for needed in given.get("install_requires", ())]
    for extra, needs in given.get("extras_require", {}).items():
        lines.append(f"Provides-Extra: {extra}")
        lines += [f'Requires-Dist: {needed}; extra == "{extra}"' for needed in needs]
    (folder / "METADATA").write_text("\n".join(lines) + "\n")
    groups = []
    for group, points in given.get("entry_points", {}).items():
        groups += [f"[{group}]", *points, ""]
    (folder / "entry_points.txt").write_text("\n".join(groups))
    index = INSTALL / given["name"] / INDEX
    index.mkdir(parents=True)
    (index / given["name"]).touch()


def write_programs(given: dict[str, Any]) -> None:
    """Write the programs of a package: its commands and nodes."""
    folder = INSTALL / given["name"] / "lib" / given["name"]
    folder.mkdir(parents=True)
    for point in given.get("entry_points", {}).get("console_scripts", ()):
        name, _, target = (word.strip() for word in point.partition("="))
        module, _, function = target.partition(":")
        program = folder / name
        program.write_text(PROGRAM.format(python=sys.executable, module=module, function=function))
        program.chmod(0o755)


def write_paths(packages: list[Path]) -> None:
    """Write where Python finds modules and descriptions, and a shell the programs.

    Python reads a .pth file in the encoding of the locale, so the paths are written in ASCII, as a
    list that Python evaluates.
    """
    descriptions = [description_of(package.name) for package in packages]
    folders = [str(folder) for folder in (*packages, *descriptions)]
    path_file = Path(sysconfig.get_path("purelib"), "ev_stack.pth")
    path_file.write_text(f"import sys; sys.path += {folders!a}\n")
    prefixes = ":".join(str(INSTALL / package.name) for package in packages)
    # A shell that knows another checkout as well, as colcon builds it, would import that one.
    (INSTALL / "environment.bash").write_text(
        f'export AMENT_PREFIX_PATH="{prefixes}${{AMENT_PREFIX_PATH:+:$AMENT_PREFIX_PATH}}"\n'
        f'[[ -z "${{PYTHONPATH:-}}" ]] || export PYTHONPATH="{":".join(folders)}:$PYTHONPATH"\n'
    )


def main() -> None:
    """Link all packages anew; nothing of a former build stays."""
    installed = INSTALL.resolve()  # a link to a folder elsewhere stays one
    if installed.exists():
        shutil.rmtree(installed)
    installed.mkdir(parents=True)
    # Nothing else there is a package of ours: bytecode that git leaves of a package that is gone,
    # or a package of CMake, which only colcon builds.
    packages = sorted(path.parent for path in (ROOT / "src").glob("*/setup.py"))
    for package in packages:
        given = arguments_of(package)
        write_description(given)
        write_programs(given)
    write_paths(packages)


if __name__ == "__main__":
    main()
