"""scripts/run.sh under way, for tests that look at it or disturb it."""

from __future__ import annotations

import os
import re
import subprocess
from pathlib import Path

from helpers.patience import PATIENCE, wait_until
from helpers.scanned_bag import scanned

ROOT = Path(__file__).parents[2]
RUN = ROOT / "scripts" / "run.sh"
ENVIRONMENT = {name: value for name, value in os.environ.items() if name != "ROS_DOMAIN_ID"}
# At most five times as fast as real time: no machine is so busy that it ends before it is disturbed.
LONG = ("shchur2019", "--duration", "1000", "--set", "plant.real_time_factor=5")


class Running:
    """A long run under way in a process group of its own."""

    def __init__(self, folder: Path, *arguments: str) -> None:
        self.folder = folder
        before = set(os.listdir("/dev/shm"))
        self.output = folder.with_suffix(".txt").open("w+")
        words = [RUN, *LONG, "--out", str(folder), *arguments]
        self.script = subprocess.Popen(
            words,
            env=ENVIRONMENT,
            stdout=self.output,
            stderr=subprocess.STDOUT,
            start_new_session=True,
        )
        bag = folder / "bag" / "bag.mcap"

        def steps() -> bool:
            """Some hundred messages are in the bag, which exists as soon as the recorder does."""
            assert self.script.poll() is None, self.text()
            return bag.exists() and sum(1 for _ in scanned(bag)) > 500

        wait_until(steps, self.text, self.text)
        self.shared_memory = set().union(*map(_shared_memory_of, self.processes())) - before

    def processes(self) -> dict[int, str]:
        """Process ids and command lines of everything that works for this run."""
        found = {}
        for place in Path("/proc").glob("[0-9]*"):
            try:
                words = (place / "cmdline").read_bytes().decode(errors="replace").replace("\0", " ")
            except OSError:
                continue
            if str(self.folder) in words:
                found[int(place.name)] = words
        return found

    def node(self, name: str) -> int:
        """Process id of a node."""
        (found,) = [
            pid for pid, words in self.processes().items() if f"/{name} --ros-args" in words
        ]
        return found

    def end(self) -> int:
        """Exit status of the script."""
        return self.script.wait(PATIENCE)

    def text(self) -> str:
        """Output of the script so far."""
        self.output.seek(0)
        return self.output.read()

    def left_behind(self) -> tuple[dict[int, str], set[str]]:
        """Processes and shared memory of this run that are still there."""
        return self.processes(), self.shared_memory & set(os.listdir("/dev/shm"))


def _shared_memory_of(pid: int) -> set[str]:
    """Names in /dev/shm of what a process has mapped or open."""
    place = Path("/proc") / str(pid)
    mapped = re.findall(r"/dev/shm/(\S+)", (place / "maps").read_text())
    opened = (os.readlink(link) for link in (place / "fd").iterdir())
    return {
        *mapped,
        *(name.removeprefix("/dev/shm/") for name in opened if name.startswith("/dev/shm/")),
    }
