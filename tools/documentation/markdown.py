"""Markdown tables, and the marked parts of a page that are generated: those kept in it, and those of the built page."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping, Sequence

# A part that the repository does not keep: a mark, and the line that stands there until the page is
# built.
_BUILT = re.compile(r"<!-- built: (?P<name>[\w ]+) -->\n[^\n]*\n")
_BLOCK = re.compile(
    r"<!-- generated: (?P<name>[\w ]+) -->\n(?P<text>.*?)<!-- end of generated -->", re.DOTALL
)


def table(columns: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """A Markdown table; cells are taken as they are, except that bars in them are escaped."""
    lines = [columns, ["---"] * len(columns), *rows]
    return "".join(
        f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines
    )


def code(text: str) -> str:
    """Words of a program, as such."""
    return f"`{text}`"


def codes(texts: Iterable[str]) -> str:
    """Several of them."""
    return ", ".join(map(code, texts))


def block_names(page: str) -> list[str]:
    """Names of the generated parts of a page, in order."""
    return [match["name"] for match in _BLOCK.finditer(page)]


def with_blocks(page: str, texts: Mapping[str, str]) -> str:
    """The page with new texts between the marks; a part that `texts` does not name stays as it is."""

    def marked(match: re.Match[str]) -> str:
        text = texts.get(match["name"])
        if text is None:
            return match[0]
        return f"<!-- generated: {match['name']} -->\n{text.strip()}\n<!-- end of generated -->"

    return _BLOCK.sub(marked, page)


def built_names(page: str) -> list[str]:
    """Names of the parts of a page that only the built page has, in order."""
    return [match["name"] for match in _BUILT.finditer(page)]


def built(page: str, texts: Mapping[str, str]) -> str:
    """The page with these texts in the place of such parts."""
    return _BUILT.sub(lambda match: f"{texts[match['name']].strip()}\n", page)
