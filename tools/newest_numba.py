"""What of the inside of numba the newest one that installs still bears, in one table (docs/compiled_laws.md).

    python tools/newest_numba.py                     the newest numba that installs, in an environment of its own
    python tools/newest_numba.py --numba numba==0.67.0     another one; also with --pre
    python tools/newest_numba.py --smoke             the installed one, all in the plain way; without a network

Each row is a graph that is compiled and driven in a new process with an empty cache, and once more
from that cache. Exit status 1 if a row fails or gives other bits than the plain way, or if a touch
is no longer possible.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import sysconfig
import tempfile
import time
import venv
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

from ev_core.compiled.loop import compiled
from ev_core.compiling.inside_numba import TOUCHES, VARIABLE
from ev_core.compiling.user_cache import VARIABLE as CACHE
from ev_core.law import compilable, entry, memory_type, working_memory
from ev_msgs_py.refusal import ParameterError

SCENARIO, DURATION = "shchur2019", 0.5  # the smallest graph with plant, driver and law [s]
LIMIT = 2.0


@dataclass(slots=True)
class Memory:
    """Working memory of a step."""

    total: float = entry(unit="1", about="what was added")


LAYOUT = memory_type(Memory)


@compilable
def limited(x: float) -> float:
    """What an edit of LIMIT changes."""
    return LIMIT * x


@compilable
def added(x: float) -> float:
    """The same by way of working memory."""
    memory = working_memory(LAYOUT)[0]
    memory.total += limited(x)
    return memory.total


def work() -> None:
    """Print the signal hash of the graph, what a function with working memory gives, and the same after an edit."""
    global LIMIT
    import numba

    import ev_stack

    found = {"numba": numba.__version__, "hash": ev_stack.run(SCENARIO, duration=DURATION).hash}
    found["memory"] = compiled(added)(1.5)
    LIMIT = 4.0
    try:
        found["edited"] = compiled(added)(1.5)
    except ParameterError:
        found["edited"] = None  # a new process is asked for
    print(json.dumps(found))


@dataclass(frozen=True)
class Row:
    """What one way of compiling gave; an empty `found` if it failed, with the last line of why."""

    way: str
    found: dict[str, object]
    seconds: float
    again: float
    said: str

    @property
    def bits(self) -> tuple[object, object]:
        """What must be the same in all rows."""
        return self.found.get("hash"), self.found.get("memory")


def row(python: str, way: str, off: list[str], cache: Path | None, *, again: bool = True) -> Row:
    """Work in processes of their own without the touches that are `off`."""
    with tempfile.TemporaryDirectory() as empty:
        environment = {**os.environ, VARIABLE: ",".join(off), CACHE: str(cache or empty)}
        times, words = [], [python, __file__, "--work"]
        for _ in range(1 + again):
            begin = time.monotonic()
            done = subprocess.run(words, env=environment, capture_output=True, text=True)
            times.append(time.monotonic() - begin)
        lines = [
            line
            for line in done.stderr.splitlines()
            if line.strip() and not line.startswith("compiling ")
        ]
        found = json.loads(done.stdout.splitlines()[-1]) if done.returncode == 0 else {}
    said = [line for line in lines if line.startswith("numba is another one")] if found else lines
    return Row(way, found, times[0], times[-1], said[-1][:200] if said else "")


def rows(python: str, smoke: bool) -> Iterator[Row]:
    """The plain way, each touch alone, and all of them."""
    yield row(python, "plain", ["all"], None, again=False)
    if not smoke:
        for touch in TOUCHES:
            yield row(python, touch, [other for other in TOUCHES if other != touch], None)
    yield row(python, "all touches", [], None if not smoke else _cache(), again=not smoke)


def _cache() -> Path:
    from ev_core.compiling.user_cache import cache_folder

    return cache_folder()


def verdict(each: Row, plain: Row) -> str:
    """In words what a row shows."""
    if not each.found:
        return f"fails: {each.said}"
    if each.bits != plain.bits:
        return "other bits than the plain way"
    if each.found["edited"] not in (6.0, None):
        return "an edit is not followed"
    return each.said or "same bits"


def made(folder: Path, numba: str, pre: bool) -> str:
    """The Python of a new environment with another numba; all the rest is that of this one."""
    venv.create(folder, with_pip=True)
    python = str(folder / "bin" / "python")
    pip = [
        python,
        "-m",
        "pip",
        "install",
        "--quiet",
        "--only-binary",
        ":all:",
        *(["--pre"] if pre else []),
        numba,
    ]
    subprocess.run(pip, check=True, env={**os.environ, "PYTHONPATH": ""})
    (site,) = folder.glob("lib/python*/site-packages")
    (site / "rest.pth").write_text(
        f"import site; site.addsitedir({sysconfig.get_path('purelib')!r})\n"
    )
    return python


def main() -> int:
    """Print the table; 1 if anything broke."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--numba", default="numba", help="what pip shall install")
    parser.add_argument("--pre", action="store_true", help="also what is not released yet")
    parser.add_argument(
        "--smoke", action="store_true", help="the installed numba, in the plain way and as it is"
    )
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    words = parser.parse_args()
    if words.work:
        work()
        return 0
    with tempfile.TemporaryDirectory() as folder:
        python = sys.executable if words.smoke else made(Path(folder), words.numba, words.pre)
        print(
            "| way | first run | again | signal hash | what comes of it |\n| --- | --- | --- | ---"
            " | --- |"
        )
        plain, broke, version = None, False, ""
        for each in rows(python, words.smoke):
            plain = plain or each
            shown, version = str(each.bits[0] or "")[:12], str(each.found.get("numba", version))
            said = verdict(each, plain)
            broke = broke or said != "same bits"
            print(
                f"| {each.way} | {each.seconds:.0f} s | {each.again:.0f} s | {shown} | {said} |",
                flush=True,
            )
        print(f"\nnumba {version}: {'something has to be mended' if broke else 'nothing breaks'}")
    return int(broke)


if __name__ == "__main__":
    sys.exit(main())
