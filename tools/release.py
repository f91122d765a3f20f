"""scripts/release.sh VERSION: the version in all files that have it, and the notes of CHANGELOG.md under its name."""

from __future__ import annotations

import datetime
import re
import sys
from pathlib import Path

CHANGELOG, CITATION = "CHANGELOG.md", "CITATION.cff"
_ROOT = Path(__file__).parents[1]
_PACKAGES = sorted(path.relative_to(_ROOT).as_posix() for path in _ROOT.glob("src/*/package.xml"))
FILES = (*_PACKAGES, CITATION)
_UNRELEASED = "## [Unreleased]\n"
_VERSION = re.compile(r"\d+\.\d+\.\d+")


def order(version: str) -> tuple[int, ...]:
    """The numbers of a version; ValueError in one line if it is none."""
    if not _VERSION.fullmatch(version):
        raise ValueError(f"version {version!r} is refused, expected three numbers, such as 0.2.0")
    return tuple(map(int, version.split(".")))


def released(changelog: str, version: str, day: str) -> str:
    """The changelog with all that is unreleased under a version; ValueError if nothing is."""
    if not notes(changelog, "Unreleased"):
        raise ValueError(f"{CHANGELOG}: nothing is unreleased")
    return changelog.replace(_UNRELEASED, f"{_UNRELEASED}\n## [{version}] - {day}\n", 1)


def notes(changelog: str, version: str) -> str:
    """What the changelog says of a version, without its heading."""
    found = re.search(
        rf"^## \[{re.escape(version)}\].*\n((?:(?!## \[).*\n?)*)", changelog, re.MULTILINE
    )
    return found[1].strip() if found else ""


def main(root: Path, version: str) -> None:
    """Write all files, and the notes to build/release_notes.md; nothing is written if something is refused."""
    day = datetime.datetime.now(datetime.UTC).date().isoformat()
    texts = {name: (root / name).read_text(encoding="utf-8") for name in (*FILES, CHANGELOG)}
    (before,) = re.findall(r"^version: (.+)$", texts[CITATION], re.MULTILINE)
    if order(version) <= order(before):
        raise ValueError(f"version {version} is refused, expected one after {before}")
    changelog = released(texts.pop(CHANGELOG), version, day)
    for name, text in texts.items():
        (root / name).write_text(text.replace(before, version), encoding="utf-8")
    (root / CHANGELOG).write_text(changelog, encoding="utf-8")
    file = root / "build" / "release_notes.md"
    file.parent.mkdir(exist_ok=True)
    file.write_text(notes(changelog, version) + "\n", encoding="utf-8")
    print(f"{before} -> {version}; notes: {file}")


if __name__ == "__main__":
    try:
        main(Path(sys.argv[1]), sys.argv[2])
    except ValueError as error:
        sys.exit(f"error: {error}")
