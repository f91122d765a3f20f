"""python tools/reading.py: how the code in src reads: density, comments, signatures, openings of docstrings."""

from __future__ import annotations

import ast
import io
import re
import tokenize
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

from house import ROOT, files, modules

MANY_ARGUMENTS = 7
WIDTH = 100
# A docstring begins with what its thing is or does.
OPENINGS = (
    *("In", "Of", "For", "By", "With", "From", "To", "At", "On", "As", "Without"),
    *("Where", "What", "Which", "Who", "Whether", "How", "Not"),
)
# Words for people: a thing prints, reports or sends, and is a "that".
PERSONAL = ("told", "said", "who", "whose", "whoever", "nobody", "somebody")
_LAYOUT = (tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER)


@dataclass(frozen=True)
class Reading:
    """Counts of some files; a line of code has at least one token that is no comment and no docstring."""

    tokens: int
    code_lines: int
    comments: int
    long_signatures: int
    odd_docstrings: int
    long_lines: int
    personal_words: int

    @property
    def density(self) -> float:
        """Tokens a line of code."""
        return self.tokens / self.code_lines

    @property
    def comment_share(self) -> float:
        """Comments over lines of code [1]."""
        return self.comments / self.code_lines


def reading_of(paths: Iterable[Path]) -> Reading:
    """Count some files of Python."""
    tokens = code_lines = comments = signatures = odd = long = personal = 0
    for path in paths:
        text = path.read_text(encoding="utf-8")
        lines = set()
        for token in tokenize.generate_tokens(io.StringIO(text).readline):
            is_docstring = token.type == tokenize.STRING and token.string.startswith(
                ('"""', 'r"""')
            )
            if token.type == tokenize.COMMENT:
                comments += 1
            elif token.type not in _LAYOUT and not is_docstring:
                tokens += 1
                lines.add(token.start[0])
        code_lines += len(lines)
        signatures += sum(_arguments(node) >= MANY_ARGUMENTS for node in ast.walk(ast.parse(text)))
        odd += len(re.findall(rf'"""(?:{"|".join(OPENINGS)})\b', text))
        long += sum(len(line) > WIDTH for line in text.splitlines())
        personal += len(re.findall(rf"\b(?:{'|'.join(PERSONAL)})\b", text, re.IGNORECASE))
    return Reading(tokens, code_lines, comments, signatures, odd, long, personal)


def _arguments(node: ast.AST) -> int:
    if not isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef):
        return 0
    return len(node.args.posonlyargs) + len(node.args.args) + len(node.args.kwonlyargs)


def main() -> None:
    """Print the counts of src."""
    found = reading_of(ROOT / each.path for each in files(modules()))
    print(f"{found.tokens} tokens of code, {found.density:.1f} a line")
    print(f"comments: {found.comment_share:.1%} of the lines of code")
    print(f"functions with {MANY_ARGUMENTS} arguments or more: {found.long_signatures}")
    print(f"docstrings that begin with a preposition or a question word: {found.odd_docstrings}")
    print(f"lines of more than {WIDTH} characters: {found.long_lines}")
    print(f"words for people ({', '.join(PERSONAL)}): {found.personal_words}")


if __name__ == "__main__":
    main()
