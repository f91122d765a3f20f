"""The index that was out of range in an error of a law, and the length of its row.

How it works: Python's error names neither. But the traceback knows the columns of the line that
raised it, so that its syntax tree shows the subscript, and the frame its names. The parts of the
subscript are evaluated again in that frame, unless this could change a value.
"""

from __future__ import annotations

import ast
import linecache
from types import FrameType
from typing import Any

from ev_msgs_py.refusal import shown

# Functions that may be called once more, for they change nothing.
_PURE = ("int", "float", "round", "abs", "min", "max", "len")


def parsed(text: str) -> ast.AST:
    """Syntax tree of a text.

    Part of a text may be no Python: then it is that of an empty module.
    """
    try:
        return ast.parse(text)
    except SyntaxError:
        return ast.Module([], [])


def index_in_words(error: IndexError) -> str:
    """The index that was out of range, and the length of its row, in words.

    Empty if they cannot be found.
    """
    # The last one of the traceback has raised it.
    trace: Any = error.__traceback__
    while trace.tb_next is not None:
        trace = trace.tb_next
    frame = trace.tb_frame
    place = [*frame.f_code.co_positions()][trace.tb_lasti // 2]
    for node in ast.walk(parsed("".join(linecache.getlines(frame.f_code.co_filename)))):
        if isinstance(node, ast.Subscript) and place == (*_span(node),):
            try:
                index, of = (_value(each, frame) for each in (node.slice, node.value))
                length = len(of)
            except Exception:  # of a user's objects, or of a part that cannot be evaluated twice
                return f"{ast.unparse(node)} is out of range"
            wanted = f"expected {-length} to {length - 1}" if length else "it is empty"
            text = f"{ast.unparse(node)} is out of range"
            return f"{text}: index {shown(index)}, length {length}, {wanted}"
    return ""


def _span(node: ast.expr) -> tuple[int, int | None, int, int | None]:
    return node.lineno, node.end_lineno, node.col_offset, node.end_col_offset


def _value(node: ast.expr, frame: FrameType) -> Any:
    """Value of a part of a line in the frame in which it raised.

    ValueError if another look may change it.
    """
    for each in ast.walk(node):
        if isinstance(each, ast.NamedExpr | ast.Await | ast.Yield | ast.YieldFrom):
            raise ValueError
        if isinstance(each, ast.Call):
            is_pure = isinstance(each.func, ast.Name) and each.func.id in _PURE
            if not is_pure:
                raise ValueError
    return eval(compile(ast.Expression(node), "<law>", "eval"), frame.f_globals, frame.f_locals)
