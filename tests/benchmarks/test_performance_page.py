"""The page of performance has a table for each benchmark, and is written where it is marked."""

from __future__ import annotations

import importlib.util
import json
import re
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

ROOT = Path(__file__).parents[2]
FILE = ROOT / "benchmarks" / "performance.py"
END = "<!-- end of generated -->"
PAGE = ROOT / "docs" / "performance.md"


@pytest.fixture
def performance(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    monkeypatch.syspath_prepend(str(FILE.parent))
    spec = importlib.util.spec_from_file_location("performance_of_benchmarks", FILE)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_benchmark_of_the_page_is_there_and_has_its_table(performance: ModuleType):
    page = PAGE.read_text()
    for name in (*performance.BENCHMARKS, "memory"):
        table = page.partition(f"<!-- generated: {name} -->\n")[2].partition(END)[0]
        assert table.count("\n|") > 2, name
        assert name == "memory" or (FILE.parent / f"{name}.py").is_file()


def test_ratios_are_found_wherever_they_stand_in_a_document(performance: ModuleType):
    ratio = {"ratio": 1.5, "spread": 0.1, "goal": None}
    found = {"seconds": 2.0, "one": ratio, "rows": [{"name": "two", **ratio}, {"name": "none"}]}
    assert [name for name, _ in performance.ratios(json.loads(json.dumps(found)))] == ["one", "two"]


@pytest.mark.slow
def test_a_measured_table_replaces_the_former_one_and_no_other(tmp_path: Path):
    page = tmp_path / "page.md"
    head, mark, rest = PAGE.read_text().partition("<!-- generated: native -->\n")
    before = f"{head}{mark}{rest.replace(END, f'|former|1|1||{chr(10)}{END}', 1)}"
    page.write_text(before)
    words = ["--only", "native", "--page", str(page)]
    less = ["--words", "--repeats", "5", "--seconds", "0.1", "shchur2019"]
    subprocess.run([sys.executable, FILE, *words, *less], check=True, capture_output=True)
    after = page.read_text()
    assert "|former|" not in after
    row = re.search(r"^\|shchur2019\|(.*?)\|(.*?)\|\|$", after, re.MULTILINE)
    assert row
    assert float(row[1]) > 0.0
    assert "\n`benchmarks/native.py --repeats 5 --seconds 0.1 shchur2019`\n" in after
    assert after.partition("<!-- generated: native -->")[2].count("|shchur2019|") == 1
    # All but this table and the line about the machine stays.
    rest = [
        re.sub(rf"(?s)<!-- generated: native -->.*?{END}|Machine of [^\\n]*", "", each)
        for each in (before, after)
    ]
    assert rest[0] == rest[1]
