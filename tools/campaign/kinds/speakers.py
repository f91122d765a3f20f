"""A process that has nothing to do with the run speaks on its topics and calls its services."""

from __future__ import annotations

import subprocess
import sys

from campaign.moments import ANNOUNCED, MOVING, Moment
from campaign.stranger import ACTS
from campaign.trial import RUNNER, Trial
from campaign.under_way import UnderWay


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
        helper.wait(20)

    trial.disturb = disturb


def stranger(trial: Trial) -> None:
    """Other numbers under the right stamps, stamps to come, unreadable messages, a pause, foreign diagnostics."""
    act, rate = trial.chance.choice(ACTS), trial.chance.choice((10, 100, 500))
    trial.about = f"{act}, {rate} /s"
    # A stranger that asks for a pause is obeyed, and what it says in /diagnostics may be believed of nobody.
    with_helper(trial, "stranger", act, str(rate), str(trial.seed))
