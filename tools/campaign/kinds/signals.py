"""Signals to the runner or to any node, at any time."""

from __future__ import annotations

import re
import signal
import time
from functools import partial

from campaign.moments import Moment, drawn
from campaign.trial import RUNNER, Trial
from campaign.under_way import UnderWay

_NAMED_WITHIN = 45.0  # s: nodes may take 10 s to come up, and the machine is busy


def _target(trial: Trial) -> tuple[str, Moment]:
    alone = trial.way in ("in one process", "offline") or trial.chance.random() < 0.35
    target = RUNNER if alone else trial.chance.choice(trial.roles())
    return target, drawn(trial.chance, trial.way, trial.duration, target != RUNNER)


def _struck(
    run: UnderWay, kind: signal.Signals, target: str, moment: Moment, group: bool = False
) -> None:
    pid = moment.wait(run, target)
    if pid is not None:
        run.send(pid, kind, group)


def _once(trial: Trial, kind: signal.Signals, how: str) -> None:
    target, moment = _target(trial)
    trial.about = f"{kind.name} to {target}, {moment}"
    trial.names = "stopped" if target == RUNNER else rf"node {target} {how}"
    trial.must_end = True
    # Ctrl-C reaches everybody in the terminal's group; kill and timeout mean one process.
    group = target == RUNNER and kind == signal.SIGINT and trial.chance.random() < 0.5
    trial.disturb = partial(_struck, kind=kind, target=target, moment=moment, group=group)


def kill(trial: Trial) -> None:
    """SIGKILL."""
    _once(trial, signal.SIGKILL, "was killed by SIGKILL")


def terminate(trial: Trial) -> None:
    """SIGTERM."""
    _once(trial, signal.SIGTERM, "(was stopped|was killed by SIGTERM)")


def interrupt(trial: Trial) -> None:
    """SIGINT."""
    _once(trial, signal.SIGINT, "(was stopped|was killed by SIGINT)")


def stop_and_continue(trial: Trial) -> None:
    """SIGSTOP, and SIGCONT after a while: nothing may be lost."""
    target, moment = _target(trial)
    pause = 10 ** trial.chance.uniform(-1.5, 0.3)
    trial.about = f"SIGSTOP to {target}, {moment}, SIGCONT after {pause:.2f} s"

    def disturb(run: UnderWay) -> None:
        pid = moment.wait(run, target)
        if pid is not None and run.send(pid, signal.SIGSTOP):
            time.sleep(pause)
            run.send(pid, signal.SIGCONT)

    trial.disturb = disturb


def stop_for_ever(trial: Trial) -> None:
    """SIGSTOP and nothing more: the node is named, and then Ctrl-C ends the run; a stopped runner is killed."""
    target, moment = _target(trial)
    trial.about = f"SIGSTOP to {target}, {moment}"
    trial.names = "stopped"

    def disturb(run: UnderWay) -> None:
        pid = moment.wait(run, target)
        if pid is None or not run.send(pid, signal.SIGSTOP):
            return
        if target == RUNNER:
            time.sleep(0.5)
            run.send(pid, signal.SIGKILL)
            return
        named_then_interrupted(
            run, rf"(stopped by a signal: .*\b{target}\b|node {target} does not answer)"
        )

    trial.disturb = disturb


def named_then_interrupted(run: UnderWay, line: str) -> None:
    """What a user sees and does when a node stands still."""
    if run.wait_until(lambda: re.search(line, run.text()) is not None, _NAMED_WITHIN):
        run.interrupted = True
    if run.process.poll() is None:
        run.send(run.process.pid, signal.SIGINT)
