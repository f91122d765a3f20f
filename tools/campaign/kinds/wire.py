"""What happens to the messages of a node: one of ours is started through `campaign.faulty_node`, which loses them."""

from __future__ import annotations

import shlex
import sys

from campaign.kinds.signals import named_then_interrupted
from campaign.spoiling import HOW
from campaign.trial import Trial
from campaign.under_way import UnderWay

_MODELLED = {
    "lost": ("imu", "steering_column/state", "wheel_states"),
    "delayed": ("imu", "wheel_states", "twist"),
    "reordered": ("wheel_states", "twist"),
    "scaled": ("wheel_states.velocity.front_left",),
    "frozen": ("imu", "steering_column/state"),
}


def _faulty(trial: Trial, how: str, share: float) -> str:
    role = trial.chance.choice([name for name in trial.roles() if name != "recorder"])
    words = [sys.executable, "-m", "campaign.faulty_node", how, f"{share:g}", str(trial.seed), role]
    trial.words += ["--node", f"{role}={shlex.join(words)}"]
    trial.about = f"{role}: {how} {share:g}"
    # Nodes ask again for what they miss; what only the recorder hears is missing in the recording,
    # which it says.
    trial.from_the_start = True
    trial.names = "the recording has a gap"
    return role


def _share(trial: Trial) -> float:
    return round(10 ** trial.chance.uniform(-3.0, -1.5), 5)


def loss(trial: Trial) -> None:
    """Messages that are never sent: the run takes longer."""
    _faulty(trial, "loss", _share(trial))


def delay(trial: Trial) -> None:
    """Messages that come late by up to 50 ms."""
    _faulty(trial, "delay", _share(trial))


def reorder(trial: Trial) -> None:
    """Messages after which the one before comes again."""
    _faulty(trial, "reorder", 0.3)


def duplicate(trial: Trial) -> None:
    """Messages that come twice."""
    _faulty(trial, "duplicate", 0.5)


def spoilt(trial: Trial) -> None:
    """Messages in whose place something comes that no node can read or believe."""
    _faulty(trial, trial.chance.choice(HOW), _share(trial))


def mute(trial: Trial) -> None:
    """A node that says nothing any more after some messages: it is named."""
    role = _faulty(trial, "mute", float(trial.chance.randrange(3, 40)))
    trial.names = "stopped|the recording has a gap"

    def disturb(run: UnderWay) -> None:
        if run.wait_until(run.is_moving):
            run.struck = True
            named_then_interrupted(run, rf"node {role} does not answer")

    trial.disturb = disturb


def modelled(trial: Trial) -> None:
    """Faults of docs/faults.md, in their place among the parameters: the same in all ways of running."""
    kind = trial.chance.choice(list(_MODELLED))
    where = trial.chance.choice(_MODELLED[kind])
    value = {"lost": "0.3", "delayed": "0.03", "reordered": "0.3", "scaled": "0.9"}.get(kind, "")
    begin = round(trial.chance.uniform(0.0, trial.duration), 2)
    text = " ".join(f"{kind} {where} {value} from {begin}".split())
    owner = "steering_column" if where.startswith("steering") else "plant"
    trial.words += ["--set", f"{owner}.faults=['{text}']"]
    trial.about = text
