"""All pages, whole: those of docs/ and of the top folder where a site has them, and a reference from docstrings."""

from __future__ import annotations

import ast
import re
import shutil
from collections.abc import Iterator, Mapping
from pathlib import Path

from documentation.pages import whole_page

BUILT = "build/pages"
TOP = {
    "README": "index",
    "CONTRIBUTING": "contributing",
    "CHANGELOG": "changelog",
    "SECURITY": "reporting",
}
PLACES = {
    **{f"]({name}.md": f"]({there}.md" for name, there in TOP.items()},
    **{f"](../{name}.md": f"]({there}.md" for name, there in TOP.items()},
    "](docs/": "](",
    "](LICENSE": "](LICENSE.txt",
}
# a file of the repository that no page shows
OUTSIDE = re.compile(r"\[([^\]\n]+)\]\((?:\.\./|measured/)[^)\n]+\)")
CODE = re.compile(r"(^```.*?^```$|`[^`\n]+`)", re.MULTILINE | re.DOTALL)
NAMED = re.compile(r"\[[\w/]*?\w+\.md\]\((\w+\.md)(#[\w-]*)?\)|(?<![\w/])docs/(\w+\.md)\b")

# What a user imports, by heading; of the doors for authors of laws all that they import.
REFERENCE = {
    "Runs from Python": ("ev_stack",),
    "What a run gives": (
        "ev_stack.recording.recording.Recording",
        "ev_stack.measures.metric.Metric",
    ),
    "Metrics of a batch": ("ev_stack.batches.observer.Reduction",),
    "Gymnasium": ("ev_doors.learning.environment", "ev_doors.learning.limits.Limit"),
    "Laws": ("ev_core.law",),
    "What laws share": ("ev_control.law",),
    "Contract check": ("ev_core.check.method",),
    "Signals": ("ev_msgs_py.contract.signals", "ev_msgs_py.contract.optional_signals"),
}
DOORS = {"ev_core.law": "ev_core", "ev_control.law": "ev_control"}


def gather(root: Path, to: Path) -> None:
    """Copy the pages into a new folder that a site generator reads; FileExistsError if there is something."""
    shutil.copytree(root / "docs", to, ignore=shutil.ignore_patterns("measured", "__pycache__"))
    for name, there in TOP.items():
        shutil.copy(root / f"{name}.md", to / f"{there}.md")
    shutil.copy(root / "LICENSE", to / "LICENSE.txt")
    pages = {
        page.name: whole_page(f"docs/{page.name}", page.read_text(encoding="utf-8"))
        for page in to.glob("*.md")
    }
    titles = {name: text.partition("\n")[0].removeprefix("# ") for name, text in pages.items()}
    for name, text in pages.items():
        for link, there in PLACES.items():
            text = text.replace(link, there)
        text = OUTSIDE.sub(r"`\1`", text)
        (to / name).write_text(titled(text, titles), encoding="utf-8")
    (to / "reference.md").write_text("".join(reference(root)), encoding="utf-8")


def titled(text: str, titles: Mapping[str, str]) -> str:
    """A page whose links to pages by the names of their files have the titles of these pages as their text."""

    def link(found: re.Match[str]) -> str:
        page, anchor = found[1] or found[3], found[2] or ""
        return f"[{titles[page]}]({page}{anchor})" if page in titles else found[0]

    pieces = CODE.split(text)  # every second one is code
    return "".join(piece if i % 2 else NAMED.sub(link, piece) for i, piece in enumerate(pieces))


def reference(root: Path) -> Iterator[str]:
    """The page that mkdocstrings fills."""
    yield (
        "# Reference from docstrings\n\nWhat programs and laws import, with types, units and"
        " errors.\n"
    )
    for heading, names in REFERENCE.items():
        yield f"\n## {heading}\n"
        for name in names:
            yield f"\n::: {name}\n"
            yield from (f"\n::: {each}\n" for each in imported(root, name))


def imported(root: Path, door: str) -> Iterator[str]:
    """The full names of functions and classes that a door for authors of laws imports; none of other modules."""
    if door in DOORS:
        file = root / "src" / DOORS[door] / f"{door.replace('.', '/')}.py"
        for node in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(node, ast.ImportFrom):
                yield from (
                    f"{node.module}.{each.name}"
                    for each in node.names
                    if not (each.name == "*" or each.name.isupper())
                )
