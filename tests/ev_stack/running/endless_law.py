"""A compiled law that never ends and asks for the end of the run once it is in its loop.

As a module it drives a run in one of the ways in which laws are driven: `python endless_law.py WAY
FOLDER`. The signal goes to the process that began the run, as from a service manager; its workers
are forked off, nodes are programs.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from types import FrameType

from ev_core.law import (
    Wheels,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    entry,
    method,
    parameter,
)

TO_STOP = "TEST_PROCESS_TO_STOP"
# Functions that wait for compiled code, that make a whole run of a batch by it, and the law itself
# in plain Python.
_WAITING = ("interruptible.py: _wait", "batch.py: _drive", "endless_law.py: passed_on")
# One call of them lasts for a second: without the law's loop it takes milliseconds.
_LOOKS, _PAUSE = 20, 0.05


@dataclass(frozen=True, slots=True)
class P:
    n: float = parameter(4.0, unit="1", low=0.0, high=1e6, about="where the loop begins")


@dataclass(slots=True)
class S:
    steps: float = entry(unit="1", about="taken so far")


@compilable
def passed_on(request: WheelTorqueRequest, x: float) -> WheelTorqueCommand:
    """Pass the request on, or never answer."""
    while x > 1.0:
        x = x + 1.0 if x < 1e6 else 2.0
    drive = request.drive
    left = drive.front_left + x
    return WheelTorqueCommand(
        Wheels(left, drive.front_right, drive.rear_left, drive.rear_right), request.brake
    )


@method("asr", "forever")
@compilable
def forever(p: P, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Never returns once the car has to drive."""
    return passed_on(request, p.n if request.drive.front_left > 20.0 else 0.0)


@method("asr", "late")
@compilable
def late(p: P, s: S, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Keeps the contract for as long as that is checked, and the time of a study is estimated."""
    s.steps = s.steps + 1.0
    is_driven = request.drive.front_left + request.drive.rear_left > 20.0
    return passed_on(request, p.n if s.steps > 400.0 and is_driven else 0.0)


def _calls() -> set[FrameType]:
    """The calls of _WAITING that are under way, in all threads."""
    found = set()
    for last in sys._current_frames().values():
        frame: FrameType | None = last
        while frame is not None:
            if f"{Path(frame.f_code.co_filename).name}: {frame.f_code.co_name}" in _WAITING:
                found.add(frame)
            frame = frame.f_back
    return found


def _watch(kind: int) -> None:
    looks, standing = 0, _calls()
    while looks < _LOOKS:
        time.sleep(_PAUSE)
        standing &= _calls()
        looks = looks + 1 if standing else 0
        standing = standing or _calls()
    os.kill(int(os.environ[TO_STOP]), kind)


def watch() -> None:
    """Watch this process, and send the signal to the one that began the run."""
    os.environ.setdefault(TO_STOP, str(os.getpid()))
    kind = int(os.environ.get("TEST_SIGNAL", signal.SIGINT))

    def begin() -> None:
        # Not a thread that Python counts: workers are forked off as in any run.
        threading._start_new_thread(_watch, (kind,))

    begin()
    os.register_at_fork(after_in_child=begin)


def _by_command(*words: str) -> None:
    from ev_stack.commands.program import main

    sys.argv = ["ev-stack", "run", *words]
    main()


def _in_python(text: str) -> None:
    import ev_stack

    law = {"asr": f"{__file__}:forever"}
    if text == "run":
        ev_stack.run("shchur2019", method=law, duration=1.0)
    elif text == "simulation":
        simulation = ev_stack.Simulation("shchur2019", method=law)
        for _ in range(100):
            simulation.step()
    else:
        ev_stack.batch("shchur2019", method=law, vary={"asr.n": [2.0, 3.0, 4.0]}, duration=1.0)


if __name__ == "__main__":
    way, folder = sys.argv[1], Path(sys.argv[2])
    first, second, out = f"{__file__}:forever", f"{__file__}:late", ("--out", str(folder / "out"))
    options = ("shchur2019", "--method", f"asr={first}", "--duration", "1", *out)
    # The time of a study is estimated by the first second of its first run.
    sweep = (
        "sweep",
        "shchur2019",
        "--workers",
        "2",
        "--vary",
        "asr.n=3,4",
        "--duration",
        "4",
        *out,
    )
    compare = (
        "compare",
        "--scenario",
        "shchur2019",
        "--methods",
        "power_steering,steer_by_wire",
        *out,
    )
    board = ("--cells", "*launch:*", "--draws", "2", *out)
    benchmark = ("benchmark", "small", "--laws", "equal_torque", *board)
    ways = {
        "offline": lambda: _by_command(*options, "--offline"),
        "in one process": lambda: _by_command(*options, "--in-process"),
        "as processes": lambda: _by_command(*options),
        "sweep, its estimate": lambda: _by_command(*sweep, "--method", f"asr={first}"),
        "sweep, its workers": lambda: _by_command(*sweep, "--method", f"asr={second}"),
        "compare": lambda: _by_command(*compare, "--method", f"asr={first}"),
        "benchmark, the contract": lambda: _by_command(*benchmark, "--add", first),
        "benchmark, its workers": lambda: _by_command(*benchmark, "--add", second),
        "tune, the contract": lambda: _by_command("tune", first, "--budget", "2", *board),
        "tune, its batches": lambda: _by_command("tune", second, "--budget", "2", *board),
    }
    os.environ[TO_STOP] = str(os.getpid())
    ways.get(way, lambda: _in_python(way))()
elif not __package__ and TO_STOP in os.environ:
    watch()
