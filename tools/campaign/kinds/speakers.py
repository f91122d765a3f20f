"""A process that has nothing to do with the run speaks on its topics and calls its services."""

from __future__ import annotations

import re
import signal
import subprocess
import sys

from campaign.forgeries import FORGERIES
from campaign.moments import ANNOUNCED, MOVING, Moment
from campaign.sayings import SAYINGS
from campaign.stranger import ACTS
from campaign.trial import RUNNER, Trial
from campaign.under_way import UnderWay
from ev_msgs_py.contract.roles import ROLES

_STANDS_STILL = 30.0  # s behind the last word of a stranger, for runs of 2 s


def start_helper(run: UnderWay, module: str, *words: str) -> subprocess.Popen:
    """Start a process of this package in the run's ROS domain, marked as belonging to it."""
    environment = {**run.environment, "ROS_DOMAIN_ID": run.domain() or "0"}
    return subprocess.Popen(
        [sys.executable, "-m", f"campaign.{module}", *words],
        env=environment,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.DEVNULL,
        stderr=(run.trial.folder / f"{module}.txt").open("wb"),
    )


def with_helper(trial: Trial, module: str, *words: str) -> None:
    """Let a helper work from some time on until the run has ended."""
    moment = Moment(trial.chance.choice((ANNOUNCED, MOVING)), trial.chance.uniform(0.0, 0.5))

    def disturb(run: UnderWay) -> None:
        if moment.wait(run, RUNNER) is None:
            return
        helper = start_helper(run, module, *words)
        run.wait_until(lambda: helper.poll() is not None)
        helper.terminate()
        if helper.wait(20) not in (0, -signal.SIGTERM):
            run.remark = (
                f"the {module} itself has failed:"
                f" {(run.trial.folder / f'{module}.txt').read_text()}"
            )

    trial.disturb = disturb


def stranger(trial: Trial) -> None:
    """All acts of a stranger in turn: what he says (`sayings.py`), does (`doings.py`) and forges (`forgeries.py`)."""
    act, rate = ACTS[trial.turn % len(ACTS)], trial.chance.choice((10, 100, 500))
    trial.about = f"{act}, {rate} /s"
    # A stranger that asks for a pause is obeyed, and what it says in /diagnostics may be believed
    # of nobody.
    with_helper(trial, "stranger", act, str(rate), str(trial.seed))
    if act in FORGERIES:
        _may_be_noticed(trial)
    # heard before the node of its name it is taken for that
    elif act in SAYINGS and SAYINGS[act].node in ROLES:
        trial.forged = True


def _may_be_noticed(trial: Trial) -> None:
    """Who forges what a node says may stop a run, which names a node then, or make it stand still until Ctrl-C."""
    trial.forged = trial.from_the_start = True
    trial.names = r"node \w+|the recording has a gap|stopped"
    speaks = trial.disturb

    def disturb(run: UnderWay) -> None:
        speaks(run)
        silent = re.compile(r"node \w+ does not answer")
        run.wait_until(lambda: False, _STANDS_STILL)
        if run.process.poll() is None and silent.search(run.text()):
            run.interrupted = True
            run.send(run.process.pid, signal.SIGINT)

    trial.disturb = disturb
