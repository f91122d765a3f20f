"""Files that are cut off or spoilt: scenario, vehicle, roads, cycle."""

from __future__ import annotations

import random
from pathlib import Path

from campaign.trial import Trial
from campaign.under_way import ROOT

_CONFIG = ROOT / "config"
_WORDS = (
    b".nan",
    b".inf",
    b"-1e400",
    b"99999999999",
    b"''",
    b"[]",
    b"{}",
    b"null",
    b"\x00",
    b"\xff\xfe",
    b"\t",
    b"- ",
    b": ",
)


def spoilt(trial: Trial) -> None:
    """A copy of one of our files with something wrong in it; what can still be read gives what it gives offline."""
    kind = trial.chance.choice(("scenario", "vehicle", "parameters", "cycle"))
    how = trial.chance.choice(list(_HOW))
    copy = trial.folder / "copy"
    copy.mkdir()
    trial.about = f"{kind} {how}"

    def made(path: Path) -> str:
        to = copy / path.name
        to.write_bytes(_HOW[how](path.read_bytes(), trial.chance))
        return str(to)

    if kind == "scenario":
        trial.words[0] = made(_CONFIG / "scenarios" / f"{trial.scenario}.yaml")
    elif kind == "vehicle":
        trial.words += ["--vehicle", made(_CONFIG / "vehicles" / f"{_vehicle(trial)}.yaml")]
    elif kind == "parameters":
        trial.words += ["--params", made(trial.chance.choice(sorted((_CONFIG / "surfaces").glob("*.yaml"))))]
    else:
        path = made(trial.chance.choice(sorted((_CONFIG / "cycles").glob("*.csv"))))
        trial.words[0] = "shchur2019"
        trial.words += ["--set", f"driver.speed_profile.file={path}"]
        trial.words += ["--set", "driver.speed_profile.time=[]", "--set", "driver.speed_profile.speed=[]"]


def _vehicle(trial: Trial) -> str:
    return "dissertation_class_b" if trial.scenario == "bench_fault" else "audi_a2"


def _cut(content: bytes, chance: random.Random) -> bytes:
    return content[: chance.randrange(len(content))]


def _garbage(content: bytes, chance: random.Random) -> bytes:
    return chance.randbytes(chance.randrange(1, 3000))


def _flipped(content: bytes, chance: random.Random) -> bytes:
    changed = bytearray(content)
    for _ in range(chance.randrange(1, 6)):
        changed[chance.randrange(len(changed))] = chance.randrange(256)
    return bytes(changed)


def _lines_moved(content: bytes, chance: random.Random) -> bytes:
    lines = content.splitlines(keepends=True)
    line = lines.pop(chance.randrange(len(lines)))
    if chance.random() < 0.6:
        lines.insert(chance.randrange(len(lines) + 1), line)
    return b"".join(lines)


def _word_inserted(content: bytes, chance: random.Random) -> bytes:
    place = chance.randrange(len(content))
    return content[:place] + chance.choice(_WORDS) + content[place:]


def _number_replaced(content: bytes, chance: random.Random) -> bytes:
    digits = [place for place, byte in enumerate(content) if byte in b"0123456789"]
    place = chance.choice(digits)
    return content[:place] + chance.choice(_WORDS) + content[place + 1 :]


def _nested(content: bytes, chance: random.Random) -> bytes:
    return b"a: " + b"[" * chance.choice((50, 2000, 100_000))


def _aliases(content: bytes, chance: random.Random) -> bytes:
    lines = [
        b"a0: &a0 [1, 2]",
        *(b"a%d: &a%d [%s]" % (i, i, b", ".join([b"*a%d" % (i - 1)] * 9)) for i in range(1, 12)),
    ]
    return b"\n".join(lines)


_HOW = {
    "cut off": _cut,
    "random bytes": _garbage,
    "bytes changed": _flipped,
    "line moved": _lines_moved,
    "word inserted": _word_inserted,
    "number replaced": _number_replaced,
    "deeply nested": _nested,
    "aliases of aliases": _aliases,
    "empty": lambda content, chance: b"",
}
