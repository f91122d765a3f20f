"""Every benchmark, tool and script runs with its smallest work: unrun code will break."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
BENCHMARKS = {
    "batch": ("--runs", "2", "--rounds", "1"),
    "bench": ("--repeats", "1"),
    "can_faults": ("--seeds", "1"),
    "can_latency": ("--seconds", "0.1"),
    "command_timeout": ("--trials", "1"),
    "dashboard": ("--seconds", "0.1", "--way", "real_time"),
    "elementary": ("--repeats", "1", "--only", "sin"),
    "integrators": ("--only", "coast_down"),
    "lane_change": ("--cars", "audi_a2", "--speeds", "80", "--previews", "2"),
    "lockstep": (
        *("--steps", "20", "--repeats", "1", "--only"),
        *("raw_pattern_of_processes", "raw_ring_in_one_process", "offline"),
    ),
    "native": ("--repeats", "1", "--seconds", "0.1", "shchur2019"),
    "plant": ("--repeats", "1"),
    "relays": ("--help",),  # started by lockstep
    "soak": ("--steps", "40", "--one-process-steps", "0"),
    "urban_cycle": ("--repeats", "1", "--duration", "1"),
    "vector": ("--cars", "2", "--steps", "2", "--rounds", "1"),
}
# Those that nothing else starts; lock, site and wheels take packages from elsewhere, .ci/run starts
# suite and campaign.
SCRIPTS = {"determinism": ("--trials", "1", "--seconds", "0.1", "--only", "double_lane_change")}

NO_BENCHMARKS = {"rounds", "performance"}  # test_rounds, test_performance_page
LONG = (
    "batch",
    "dashboard",
    "elementary",
    "integrators",
    "lockstep",
    "native",
    "plant",
    "soak",
    "vector",
)  # 2 to 10 s of a processor

pytestmark = pytest.mark.slow


def assert_ends_well(words: list[str | Path], folder: Path) -> None:
    done = subprocess.run(words, cwd=folder, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert done.stdout and "Traceback" not in done.stderr


@pytest.mark.parametrize(
    "name",
    [
        pytest.param(name, marks=pytest.mark.weekly) if name in LONG else name
        for name in sorted({path.stem for path in ROOT.glob("benchmarks/*.py")} - NO_BENCHMARKS)
    ],
)
def test_a_benchmark_starts(name: str, tmp_path: Path):
    assert_ends_well(
        [sys.executable, ROOT / "benchmarks" / f"{name}.py", *BENCHMARKS[name]], tmp_path
    )


@pytest.mark.parametrize("name", SCRIPTS)
def test_a_script_starts(name: str, tmp_path: Path):
    assert_ends_well([ROOT / "scripts" / f"{name}.sh", *SCRIPTS[name]], tmp_path)
