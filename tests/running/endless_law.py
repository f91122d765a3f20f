"""A law that never ends, compiled, and that asks for the end of the run once it is seen to stand there.

As a module it drives a run in one of the ways in which laws are driven: `python endless_law.py WAY FOLDER`.
"""

from __future__ import annotations

import os
import signal
import sys
import threading
import time
from dataclasses import dataclass
from pathlib import Path

from ev_core.law import NO_WHEELS, Wheels, WheelTorqueCommand, WheelTorqueRequest, compilable, method, parameter

TO_STOP = "TEST_PROCESS_TO_STOP"
_WAITING = ("_wait", "_driven")  # functions in which the main thread waits for compiled code
_LOOKS, _PAUSE = 20, 0.05  # one after the other with the same sight, and between two of them [s]


@dataclass(frozen=True, slots=True)
class P:
    n: float = parameter(4.0, unit="1", low=0.0, high=1e6, about="where the loop begins")


@method("asr", "forever", P)
@compilable
def forever(p, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Never returns once the car has to drive."""
    x = p.n if request.drive.front_left > 20.0 else 0.0
    while x > 1.0:
        x = x + 1.0 if x < 1e6 else 2.0
    return WheelTorqueCommand(Wheels(x, 0.0, 0.0, 0.0), NO_WHEELS)


def _stand_waiting() -> bool:
    frame = sys._current_frames().get(threading.main_thread().ident or 0)
    while frame is not None:
        if frame.f_code.co_name in _WAITING:
            return True
        frame = frame.f_back
    return False


def _watch(kind: int) -> None:
    seen = 0
    while seen < _LOOKS:
        seen = seen + 1 if _stand_waiting() else 0
        time.sleep(_PAUSE)
    os.kill(int(os.environ[TO_STOP]), kind)


def watch() -> None:
    """Watch this process, and send the signal to the one that began the run."""
    os.environ.setdefault(TO_STOP, str(os.getpid()))
    # Not a thread that Python counts: workers are forked off as in any run.
    threading._start_new_thread(_watch, (int(os.environ.get("TEST_SIGNAL", signal.SIGINT)),))


def _by_command(*words: str) -> None:
    from ev_sim.commands.ev_stack import main

    sys.argv = ["ev-stack", "run", *words]
    main()


def _in_python(text: str) -> None:
    import ev_sim

    law = {"asr": __file__}
    if text == "run":
        ev_sim.run("shchur2019", method=law, duration=1.0)
    elif text == "simulation":
        simulation = ev_sim.Simulation("shchur2019", method=law)
        for _ in range(100):
            simulation.step()
    else:
        ev_sim.batch("shchur2019", method=law, vary={"asr.n": [2.0, 3.0, 4.0]}, duration=1.0)


if __name__ == "__main__":
    way, folder = sys.argv[1], Path(sys.argv[2])
    options = ("shchur2019", "--method", f"asr={__file__}", "--duration", "1", "--out", str(folder / "out"))
    ways = {
        "offline": lambda: _by_command(*options, "--offline"),
        "in one process": lambda: _by_command(*options, "--in-process"),
        "as processes": lambda: _by_command(*options),
    }
    os.environ[TO_STOP] = str(os.getpid())
    ways.get(way, lambda: _in_python(way))()
elif not __package__ and TO_STOP in os.environ:
    watch()
