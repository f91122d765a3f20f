"""python tools/house.py: how large the house is, and how fine its grain; .importlinter declares who imports whom."""

from __future__ import annotations

import ast
import statistics
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[1]
ROOM = 15  # most modules of a room
FILE = 500  # most lines of a file, which is one idea
MEDIAN = 100  # least lines of the middle file


@dataclass(frozen=True)
class Module:
    """A file of src, from the top of the repository; `imports` are the lines of the import statements at its top."""

    path: Path
    package: str
    lines: int
    imports: int

    @property
    def is_room(self) -> bool:
        """Whether it stands for its folder."""
        return self.path.name == "__init__.py"


def modules(root: Path = ROOT) -> list[Module]:
    """Everything that the packages of a repository install."""
    packages = sorted(path.parent for path in root.glob("src/*/*/__init__.py"))
    found = ((path, package.name) for package in packages for path in sorted(package.rglob("*.py")))
    return [
        _module(root, path, package) for path, package in found if "__pycache__" not in path.parts
    ]


def _module(root: Path, path: Path, package: str) -> Module:
    text = path.read_text(encoding="utf-8")
    statements = [
        each for each in ast.parse(text).body if isinstance(each, ast.Import | ast.ImportFrom)
    ]
    imports = sum((each.end_lineno or each.lineno) - each.lineno + 1 for each in statements)
    return Module(path.relative_to(root), package, len(text.splitlines()), imports)


def files(found: list[Module]) -> list[Module]:
    """Those that are more than the line of a room."""
    return [each for each in found if not each.is_room]


def lines_of(found: list[Module]) -> Counter[str]:
    """Lines of each package."""
    counted: Counter[str] = Counter()
    for each in found:
        counted[each.package] += each.lines
    return counted


def median(found: list[Module]) -> float:
    """Lines of the middle file."""
    return statistics.median(each.lines for each in files(found))


def import_share(found: list[Module]) -> float:
    """Share of the lines that only say what is imported [1]."""
    return sum(each.imports for each in found) / sum(each.lines for each in found)


def crowded(found: list[Module]) -> dict[str, int]:
    """Rooms with more than ROOM modules, and how many they have."""
    counted = Counter(each.path.parent for each in files(found))
    return {str(room): count for room, count in counted.items() if count > ROOM}


def long(found: list[Module]) -> dict[str, int]:
    """Files of more than FILE lines, and how many they have."""
    return {str(each.path): each.lines for each in found if each.lines > FILE}


def main() -> None:
    """Print all of it."""
    found = modules()
    lines = lines_of(found)
    print(f"{lines.total()} lines in {len(files(found))} modules, median {median(found):g}")
    print(f"import statements: {import_share(found):.1%} of the lines")
    print(f"packages: {', '.join(f'{name} {count}' for name, count in lines.most_common())}")
    print(f"rooms of more than {ROOM} modules: {crowded(found) or 'none'}")
    print(f"files of more than {FILE} lines: {long(found) or 'none'}")


if __name__ == "__main__":
    main()
