"""A run under way: its processes, its output, how far it is, and its end."""

from __future__ import annotations

import os
import re
import resource
import signal
import subprocess
import time
import uuid
from contextlib import suppress
from pathlib import Path

from campaign.trial import RUNNER, Trial
from ev_stack.recording.recording import BAG, PARAMETERS
from ev_stack.running.children import ends_with_us

ROOT = Path(__file__).parents[2]
# s of wall time for a run that nothing keeps from its end, on a machine with much other work
PATIENCE = 150.0
# s until a run has ended that cannot go on; a node stops in order when it is loaded
AFTER_STRIKE = 60.0
_MARK = "EV_CAMPAIGN"
_LOOK = 0.01  # s between looks at what is there
_NODE = re.compile(r"[/ ](\w+) --ros-args")


class UnderWay:
    """Starts the run of a trial; everything that it starts carries a mark in its environment."""

    def __init__(self, trial: Trial) -> None:
        self.trial = trial
        self.mark = f"{_MARK}={uuid.uuid4().hex}"
        name, _, value = self.mark.partition("=")
        environment = {**os.environ, **trial.environment, name: value}
        environment.pop("ROS_DOMAIN_ID", None)
        self.environment = environment
        self._output = trial.folder / "said.txt"
        words = [
            *trial.before,
            str(ROOT / "scripts" / "run.sh"),
            *trial.words,
            "--out",
            str(trial.out),
        ]
        self.began = self.struck_at = time.monotonic()
        self.struck = False
        self.interrupted = False  # whether we have ended it, because it stood still as it should
        self.remark = ""  # what a fault has found wrong by itself
        with self._output.open("wb") as output:
            self.process = subprocess.Popen(
                words,
                env=environment,
                stdin=subprocess.DEVNULL,
                stdout=output,
                stderr=subprocess.STDOUT,
                start_new_session=True,
                preexec_fn=self._before_exec(),
            )

    def _before_exec(self):
        dies_with_us, limits = ends_with_us(), self.trial.limits

        def before() -> None:
            if dies_with_us is not None:
                dies_with_us()
            signal.signal(signal.SIGINT, signal.SIG_DFL)  # in the background it is ignored
            for kind, most in limits.items():
                resource.setrlimit(kind, (most, most))

        return before

    def text(self) -> str:
        """What the run has printed."""
        return self._output.read_text(errors="replace").replace("\r", "\n")

    def processes(self) -> dict[int, str]:
        """What works for this run, by process id: the runner, nodes by name, and helpers."""
        found = {}
        for place in Path("/proc").glob("[0-9]*"):
            try:
                if self.mark.encode() in (place / "environ").read_bytes().split(b"\0"):
                    words = (
                        (place / "cmdline")
                        .read_bytes()
                        .replace(b"\0", b" ")
                        .decode(errors="replace")
                    )
                    if words:  # nothing: it has ended already
                        node = _NODE.search(words)
                        found[int(place.name)] = node[1] if node else RUNNER
            except OSError:
                continue
        return found

    def pid_of(self, name: str) -> int | None:
        """The process id of the runner or of a node, if it is there."""
        if name == RUNNER:
            return self.process.pid
        return next((pid for pid, other in self.processes().items() if other == name), None)

    def domain(self) -> str | None:
        """The ROS domain, as soon as the run has told it."""
        said = re.search(r"ROS_DOMAIN_ID=(\d+)", self.text())
        return said[1] if said else None

    def is_moving(self) -> bool:
        """Whether messages have been recorded; offline there are only files."""
        if self.trial.way == "offline":
            return (self.trial.out / PARAMETERS).exists()
        try:
            said = (self.trial.out / BAG / "metadata.yaml").read_text()
        except OSError:
            return False
        count = re.search(r"message_count: (\d+)", said)
        return count is not None and int(count[1]) > 0

    def wait_until(self, condition, within: float = PATIENCE) -> bool:
        """Whether the condition came true before the run ended."""
        deadline = time.monotonic() + within
        while time.monotonic() < deadline and self.process.poll() is None:
            if condition():
                return True
            time.sleep(_LOOK)
        return False

    def send(self, pid: int, kind: signal.Signals, group: bool = False) -> bool:
        """Send a signal; False if nobody is there any more."""
        try:
            (os.killpg if group else os.kill)(pid, kind)
        except ProcessLookupError:
            return False
        self.struck, self.struck_at = True, time.monotonic()
        return True

    def end(self, within: float) -> int | None:
        """Exit status, None if it does not end in time."""
        with suppress(subprocess.TimeoutExpired):
            return self.process.wait(within)
        return None

    def sweep(self) -> None:
        """End everything that is still there."""
        for pid in self.processes():
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self.process.wait()
