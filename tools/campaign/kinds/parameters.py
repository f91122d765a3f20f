"""Values that no parameter may have, at the start and while the run goes on."""

from __future__ import annotations

from campaign.kinds.foreign import with_helper
from campaign.trial import Trial

_VALUES = (
    ".nan", ".inf", "-.inf", "1e999", "-1", "0", "1e300", "-1e300", "99999999999999999999999999", "''", "no such thing",
    "[1, 2, 3]", "[]", "[.nan]", "[[1]]", "{a: 1}", "true", "null", "2026-11-22", "0x1F", "1 parsec",
    "!!python/none ''", "&a [*a]", "'\\0'", "[", "\t", "é",
)  # fmt: skip


def _name(trial: Trial) -> tuple[str, str]:
    role = trial.chance.choice(list(trial.run.configurations))
    return role, trial.chance.choice(sorted(trial.run.configurations[role].values()))


def at_start(trial: Trial) -> None:
    """By --set; what is allowed after all gives what it gives offline."""
    role, name = _name(trial)
    value = trial.chance.choice(_VALUES)
    if trial.chance.random() < 0.1:
        name += "x"
    trial.words += ["--set", f"{role}.{name}={value}"]
    trial.about = f"{role}.{name}={value}"


def live(trial: Trial) -> None:
    """By the node's service; what is allowed after all marks the run as one that cannot be repeated."""
    role, name = _name(trial)
    trial.about = f"{role}.{name}"
    with_helper(trial, "live", role, name, str(trial.seed))
