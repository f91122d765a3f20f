"""Time of a control period in the exported C library, beside the compiled loop of the stack.

    source scripts/setup.sh && python benchmarks/native.py [--repeats N] [--seconds S] [--json FILE] [SCENARIO ...]

All parts of a scenario's first run. Library and compiled loop are measured in alternating rounds, by
processor time (`rounds`), so that their ratio holds on a busy machine. The compiled loop records all
signals, the library keeps the last ones.
"""

from __future__ import annotations

import argparse
import ctypes
import json
import statistics
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path

from rounds import alternating, as_json, machine, processor_time, ratio_of

from ev_core.lockstep.run import GraphRun
from ev_doors.export.content import Content
from ev_doors.export.library import Library
from ev_doors.export.targets import OPTIONS, TARGETS
from ev_msgs_py.contract import stamps
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario

SCENARIOS = ("shchur2019", "double_lane_change")
_DRIVE = """#include "evs_model.h"
static evs_model it;
int32_t drive(int64_t steps)
{
    int32_t status = evs_model_create(&it);
    while (steps-- > 0 && !status) status = evs_model_step(&it);
    return status;
}
"""


def exported(run: Run, steps: int, folder: Path) -> Callable[[], None]:
    """Drives the exported library from rest."""
    library, target = Library(Content(run), "model"), TARGETS["x86_64-linux"]
    objects = library.objects(target, folder)
    sources = library.write(folder, target, ["model.h", "constants.h", "model.c"])
    (folder / "drive.c").write_text(_DRIVE)
    loops = [target.compiled(source, OPTIONS) for source in (sources[-1], folder / "drive.c")]
    loaded = ctypes.CDLL(str(target.program([*objects, *loops], folder / "model.so", ["-shared"])))

    def drive() -> None:
        if status := loaded.drive(ctypes.c_int64(steps)):
            raise RuntimeError(f"{run.name}: status {status}")

    return drive


def seconds_of_loop(run: Run, steps: int) -> float:
    """Processor time of the stack's loop from rest, after everything was made."""
    graph = GraphRun(run.configurations, steps + 1)
    return processor_time(lambda: graph.drive(lambda time: None, lambda role, text: None))


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("scenarios", nargs="*", default=SCENARIOS)
    parser.add_argument("--repeats", type=int, default=31, help="rounds")
    parser.add_argument(
        "--seconds", type=float, help="simulated time, by default that of the scenario"
    )
    parser.add_argument("--json", type=Path, help="write the table to this file")
    given = parser.parse_args()
    rows = []
    print(f"{'us per control period':<30}{'library':>10}{'compiled loop':>15}  ratio")
    for scenario in given.scenarios:
        run = load_scenario(scenario, Overrides(duration=given.seconds)).runs[0]
        steps = stamps.from_seconds(run.duration) // run.period
        with tempfile.TemporaryDirectory() as folder:
            measures = {
                "library": partial(processor_time, exported(run, steps, Path(folder))),
                "loop": partial(seconds_of_loop, run, steps),
            }
            seconds = alternating(measures, given.repeats)
        library, loop = (statistics.median(row) * 1e6 / steps for row in seconds.values())
        ratio = ratio_of(seconds["library"], seconds["loop"])
        print(f"{scenario:<30}{library:>10.2f}{loop:>15.2f}  {ratio}")
        rows.append({"name": scenario, "library": library, "loop": loop, **as_json(ratio)})
    if given.json:
        given.json.write_text(json.dumps({**machine(), "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
