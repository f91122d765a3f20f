"""Helpers beside a run, such as a process that has no part in it, and publishes on its topics."""

from __future__ import annotations

import signal
import subprocess
import sys

from campaign.moments import ANNOUNCED, MOVING, Moment
from campaign.stranger import ACTS, Publishing
from campaign.trial import RUNNER, Trial
from campaign.under_way import UnderWay
from ev_msgs_py.contract.roles import RECORDER, ROLES


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
    """All acts of a foreign process in turn (`stranger.py`)."""
    name, rate = list(ACTS)[trial.turn % len(ACTS)], trial.chance.choice((10, 100, 500))
    trial.about = f"{name}, {rate} /s"
    with_helper(trial, "stranger", name, str(rate), str(trial.seed))
    act = ACTS[name]
    # Discovered before the node of its name it is admitted in its place, and the run says so.
    trial.has_twin = isinstance(act, Publishing) and act.node in (*ROLES, RECORDER)
