"""The pages as a site: those of docs/ and of the top folder, in the places where a site has them."""

from __future__ import annotations

import shutil
import sys
from pathlib import Path


def gather(root: Path, to: Path) -> None:
    """Copy the pages into a new folder that a site generator reads; FileExistsError if there is something."""
    shutil.copytree(root / "docs", to, ignore=shutil.ignore_patterns("measured", "__pycache__"))
    places = {
        "](docs/": "](",
        "](CHANGELOG.md": "](changelog.md",
        "](CONTRIBUTING.md": "](contributing.md",
        "](LICENSE": "](LICENSE.txt",
    }
    for name, there in (("README", "index"), ("CONTRIBUTING", "contributing"), ("CHANGELOG", "changelog")):
        _copy(root / f"{name}.md", to / f"{there}.md", places)
    shutil.copy(root / "LICENSE", to / "LICENSE.txt")
    for page in to.glob("*.md"):
        _copy(page, page, {"](../CHANGELOG.md": "](changelog.md", "](../README.md": "](index.md"})


def _copy(page: Path, to: Path, links: dict[str, str]) -> None:
    text = page.read_text(encoding="utf-8")
    for link, there in links.items():
        text = text.replace(link, there)
    to.write_text(text, encoding="utf-8")


if __name__ == "__main__":
    gather(Path(sys.argv[1]), Path(sys.argv[2]))
