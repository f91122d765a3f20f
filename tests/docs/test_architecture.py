"""Imports go one way, as .importlinter declares.

The page names what is there; rooms and files keep their size.
"""

from __future__ import annotations

import re
import subprocess
import sys
from collections import defaultdict
from graphlib import TopologicalSorter
from pathlib import Path

import grimp
import house
import pytest

from documentation.architecture import DECLARATION, arrows, layers

ROOT = Path(__file__).parents[2]


def lint_imports(config: Path) -> subprocess.CompletedProcess[str]:
    """Run `lint-imports` from the top of the repository."""
    program = (
        "import sys; from importlinter.cli import lint_imports_command; lint_imports_command()"
    )
    words = [sys.executable, "-c", program, "--no-cache", "--no-logo", "--config", str(config)]
    return subprocess.run(words, cwd=ROOT, capture_output=True, text=True)


def test_imports_go_one_way():
    found = lint_imports(DECLARATION)
    assert found.returncode == 0, found.stdout + found.stderr


def test_an_import_against_the_layers_is_found(tmp_path: Path):
    """Imports that go downwards go upwards once two packages change places."""
    turned = tmp_path / "turned"
    declared = DECLARATION.read_text()
    turned.write_text(
        declared.replace("    ev_core\n    ev_msgs_py\n\n", "    ev_msgs_py\n    ev_core\n\n", 1)
    )
    assert turned.read_text() != declared
    found = lint_imports(turned)
    assert found.returncode == 1
    assert "ev_core is not allowed to import ev_msgs_py" in found.stdout


def test_no_package_of_the_page_imports_upward_or_sideways():
    height = {name: -depth for depth, layer in enumerate(layers()) for name in layer}
    assert all(height[importer] > height[imported] for importer, imported in arrows())


PAGE = (ROOT / "docs" / "architecture.md").read_text()
HAND_WRITTEN = PAGE.partition("## Packages")[0]


def test_every_path_and_name_of_the_page_is_there():
    """Every path exists, and every name stands in the file given with it."""
    paths = re.findall(r"`((?:src|tests|tools)/[\w./]+)`", HAND_WRITTEN)
    assert len(paths) > 30
    assert [path for path in paths if not (ROOT / path).exists()] == []
    named = re.findall(r"`(\w+)` in `([\w./]+\.py)`", HAND_WRITTEN)
    assert len(named) > 8
    for name, path in named:
        assert re.search(rf"^(?:def |class )?{name}\b", (ROOT / path).read_text(), re.MULTILINE), (
            name,
            path,
        )


def test_the_step_is_ten_sentences_and_a_drawing_of_ten_boxes():
    step = HAND_WRITTEN.partition("## How one step flows")[2].partition("\n## ")[0]
    boxes = re.findall(r'\["(\d+) ', step)
    sentences = re.findall(r"^(\d+)\. ", step, re.MULTILINE)
    assert boxes == sentences == [str(n) for n in range(1, 11)]


def test_no_circle_leads_through_a_room_and_the_folder_that_holds_it():
    """Annotations count as well.

    The contract of .importlinter looks only at rooms that stand side by side.
    """
    graph = grimp.build_graph(*(name for layer in layers() for name in layer), cache_dir=None)
    room = {
        name: name if graph.find_children(name) else name.rpartition(".")[0]
        for name in graph.modules
    }
    imports = defaultdict(set)
    for name in graph.modules:
        imports[room[name]] |= {
            room[each] for each in graph.find_modules_directly_imported_by(name)
        } - {room[name]}
    assert len(imports) > 50
    TopologicalSorter(imports).prepare()  # CycleError names the rooms of a circle


def test_rooms_and_files_keep_their_size():
    found = house.modules()
    assert len(found) > 300
    assert house.crowded(found) == {}
    assert house.long(found) == {}
    assert house.median(found) >= house.MEDIAN


def test_what_is_too_large_is_named(tmp_path: Path):
    room = tmp_path / "src" / "large" / "large"
    room.mkdir(parents=True)
    (room / "__init__.py").touch()
    for number in range(house.ROOM + 1):
        (room / f"module_{number}.py").write_text("import os\n" + "x = 1\n" * (house.FILE - number))
    found = house.modules(tmp_path)
    assert house.crowded(found) == {"src/large/large": house.ROOM + 1}
    assert house.long(found) == {"src/large/large/module_0.py": house.FILE + 1}
    assert house.import_share(found) == pytest.approx(16 / sum(each.lines for each in found))


def test_the_counts_are_printed():
    done = subprocess.run(
        [sys.executable, "tools/house.py"], cwd=ROOT, capture_output=True, text=True, check=True
    )
    assert "modules, median" in done.stdout and done.stdout.count("none") == 2
