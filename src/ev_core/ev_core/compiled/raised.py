"""What a step of a law has raised, in one line: law, file, line, what it was; of an index also value and length."""

from __future__ import annotations

import ast
import linecache
import traceback
from pathlib import Path
from types import FrameType
from typing import Any

from ev_core.compiled.mistakes import beginning, is_theirs, line_about, parsed
from ev_core.compiled.part_source import law_of
from ev_core.methods import part
from ev_core.methods.register import Method
from ev_msgs_py.refusal import shown

_STEPPING = (part.__file__, str(Path(__file__).parent))  # what steps a law in plain Python


def raised(method: Method, error: BaseException) -> str:
    """One line about what a step of a law has raised in plain Python."""
    frames = [each for each in traceback.extract_tb(error.__traceback__) if is_theirs(each.filename)]
    frames = [each for each in frames if not each.filename.startswith(_STEPPING)]
    at = (frames[-1].filename, frames[-1].lineno or 0) if frames else beginning(law_of(method).function)
    what = _index_in_words(error) if isinstance(error, IndexError) else ""
    return line_about(method, *at, what or f"{type(error).__name__}: {' '.join(str(error).split())}")


def raised_in_compiled_code_alone(method: Method) -> str:
    """One line about a step that has raised an exception compiled, and none in plain Python."""
    what = "its compiled form raises an exception where plain Python raises none"
    return line_about(method, *beginning(law_of(method).function), f"{what}; run it without @compilable to look for it")


def _index_in_words(error: IndexError) -> str:
    """Which index of what was out of range, and the length; empty if that cannot be found."""
    trace: Any = error.__traceback__
    while trace.tb_next is not None:
        trace = trace.tb_next
    frame = trace.tb_frame
    place = [*frame.f_code.co_positions()][trace.tb_lasti // 2]
    for node in ast.walk(parsed("".join(linecache.getlines(frame.f_code.co_filename)))):
        if isinstance(node, ast.Subscript) and place == (*_span(node),):
            index, of = (_value(each, frame) for each in (node.slice, node.value))
            length = len(of) if hasattr(of, "__len__") else 0
            wanted = f"expected {-length} to {length - 1}" if length else "it is empty"
            return f"{ast.unparse(node)} is out of range: index {shown(index)}, length {length}, {wanted}"
    return ""


def _span(node: ast.expr) -> tuple[int, int | None, int, int | None]:
    return node.lineno, node.end_lineno, node.col_offset, node.end_col_offset


def _value(node: ast.expr, frame: FrameType) -> Any:
    """What a part of a line was in the frame in which it raised: laws are pure, so it is that again."""
    return eval(compile(ast.Expression(node), "<law>", "eval"), frame.f_globals, frame.f_locals)
