"""Files that are cut off or spoilt: scenario, vehicle, roads, cycle."""

from __future__ import annotations

from pathlib import Path

from campaign.damage import DAMAGES
from campaign.trial import Trial
from campaign.under_way import ROOT

_CONFIG = ROOT / "config"


def spoilt(trial: Trial) -> None:
    """A copy of one of our files with something wrong in it; what can still be read gives what it gives offline."""
    kind = trial.chance.choice(("scenario", "vehicle", "parameters", "cycle"))
    how = trial.chance.choice(list(DAMAGES))
    copy = trial.folder / "copy"
    copy.mkdir()
    trial.about = f"{kind} {how}"

    def made(path: Path) -> str:
        to = copy / path.name
        to.write_bytes(DAMAGES[how](path.read_bytes(), trial.chance))
        return str(to)

    if kind == "scenario":
        trial.words[0] = made(_CONFIG / "scenarios" / f"{trial.scenario}.yaml")
    elif kind == "vehicle":
        trial.words += ["--vehicle", made(_CONFIG / "vehicles" / f"{_vehicle(trial)}.yaml")]
    elif kind == "parameters":
        trial.words += [
            "--params",
            made(trial.chance.choice(sorted((_CONFIG / "surfaces").glob("*.yaml")))),
        ]
    else:
        path = made(trial.chance.choice(sorted((_CONFIG / "cycles").glob("*.csv"))))
        trial.words[0] = "shchur2019"
        trial.words += ["--set", f"driver.speed_profile.file={path}"]


def _vehicle(trial: Trial) -> str:
    return "dissertation_class_b" if trial.scenario == "bench_fault" else "audi_a2"
