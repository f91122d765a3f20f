"""An edit of a law, or of anything that it reaches, acts at once and in new processes."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

import pytest
from compiling.edited_law import CELLS, answers, edit, method_of, namespace
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import cfunc, float64

from ev_core.compiled.part import is_kept
from ev_core.compiled.part_source import part_source
from ev_core.compiling.code_store import reach_of
from ev_core.compiling.fingerprint import Reach
from ev_core.methods.law import Given
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import Wheels

BEGIN = dict.fromkeys(CELLS, 1)
edits = st.lists(
    st.tuples(st.sampled_from(sorted(CELLS)), st.integers(1, 9)), min_size=1, max_size=6
)


def reach(space: dict) -> Reach:
    """Reach of the compiled law.

    Its parameters come as arguments, so that only their order counts.
    """
    return Reach(space["law"], *space["P"].__dataclass_fields__)


def text_of(numbers: dict[str, int]) -> tuple[int, ...]:
    """Equal for equal texts: two cells only ask whether their number is even."""
    return tuple(
        n % 2 if cell in ("order of a named tuple", "class of parameters") else n
        for cell, n in numbers.items()
    )


@settings(max_examples=30)
@given(edits)
def test_the_fingerprint_follows_every_edit_and_knows_what_was_there_before(changes):
    """An edit gives that of a new process with the same text; no other text has the same."""
    numbers, space = {**BEGIN}, namespace(BEGIN)
    seen = {text_of(numbers): reach(space)}
    for cell, number in changes:
        before, is_new = reach(space), number != numbers[cell]
        edit(space, cell, number)
        numbers[cell] = number
        now, new = reach(space), reach(namespace(numbers))
        assert now.digits == new.digits
        assert now.holds and new.holds
        assert not (is_new and before.holds) or cell == "class of parameters"
        seen[text_of(numbers)] = now
    assert len({each.digits for each in seen.values()}) == len(seen)


STATES = [BEGIN]
for _half in range(2):  # of the cells at a time: each state is compiled
    STATES.append({**STATES[-1], **dict.fromkeys([*CELLS][_half::2], 4 + 2 * _half)})
NEW = "import json, sys\nfrom compiling.edited_law import namespace, answers\n"
EVERY = f"{NEW}for numbers in json.loads(sys.argv[1]):\n    print(*answers(namespace(numbers)))"


def digits_of(text: str) -> str:
    """Digits of the function `law` of a text."""
    space: dict = {"__name__": "edited"}
    exec(text, space)
    return Reach(space["law"]).digits


def test_words_compile_nothing_anew():
    """Comments, docstrings and empty lines change nothing of what a function does."""
    first = 'def law(x):\n    """The first text."""\n    return x + 1.0\n'
    other = 'def law(x):\n    """Another one."""\n\n    # why\n    return x + 1.0\n'
    assert digits_of(first) == digits_of(other)


def test_a_docstring_that_is_used_as_a_value_counts():
    """A text that stands first is more than words where an instruction loads it."""
    text = 'def law(x):\n    "{0}"\n    return x == "{0}"\n'
    assert digits_of(text.format("one")) != digits_of(text.format("two"))
    alone = 'law = lambda x: x == "{0}"\n'
    assert digits_of(alone.format("one")) != digits_of(alone.format("two"))


def in_new_process(text: str, *arguments: str, folders: Sequence[Path]) -> list[str]:
    """Run a text in a new process and return its output line by line."""
    path = os.pathsep.join((*map(str, folders), os.environ.get("PYTHONPATH", "")))
    # Without files of bytecode: Python takes an old one where two texts of one length are of the
    # same second.
    command = [sys.executable, "-B", "-c", text, *arguments]
    done = subprocess.run(
        command, capture_output=True, text=True, env={**os.environ, "PYTHONPATH": path}
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.splitlines()


@pytest.mark.slow
def test_the_compiled_law_is_the_plain_one_after_every_edit():
    """One process compiles each text; a new one finds on disk what was compiled for other texts."""
    space, before, heard = namespace(BEGIN), BEGIN, []
    for state in STATES:
        for cell, number in state.items():
            if number != before[cell]:
                edit(space, cell, number)
        before = state
        compiled, plain = answers(space)
        assert compiled == plain
        heard.append(tuple(map(float, compiled)))
    assert len(set(heard)) == len(STATES)
    repeated = in_new_process(EVERY, json.dumps(STATES[::-1]), folders=Path(__file__).parents[1:3])
    assert [eval(line.partition(") ")[0] + ")", {"Wheels": Wheels}) for line in repeated] == heard[
        ::-1
    ]


@pytest.mark.slow
def test_a_constant_of_another_module_acts_in_the_next_process(tmp_path):
    """`consts.LIMIT` from 0.25 to 0.75 acts: the compiled law does not go on with 0.25."""
    (tmp_path / "limiting.py").write_text(
        "import consts\nfrom ev_msgs_py.compilable import compilable\n\n\n"
        "@compilable\ndef limiting(x):\n    return x * consts.LIMIT\n"
    )
    imports = "from limiting import limiting\nfrom ev_core.compiled.loop import compiled"
    call = f"{imports}\nprint(compiled(limiting)(2.0))"
    for limit in (0.25, 0.75):
        (tmp_path / "consts.py").write_text(f"LIMIT = {limit}\n")
        assert in_new_process(call, folders=[tmp_path]) == [str(2.0 * limit)]


def test_one_law_with_two_classes_of_parameters_reads_each_where_it_stands():
    """The code that was made for the first one read the memory of the second by its own layout."""
    space = namespace(BEGIN)
    law, one = space["law"], space["P"]
    edit(space, "class of parameters", 2)
    methods = [method_of(law, kind) for kind in (one, space["P"])]
    sources = [
        part_source(each, Given(each.law, each.parameters(), Vehicle(), 0.01)) for each in methods
    ]
    assert reach_of(*sources[0]).digits != reach_of(*sources[1]).digits


def test_code_that_holds_addresses_of_its_process_is_not_kept():
    """Code with the address of a C callback would end the next process by SIGSEGV."""
    space = namespace(BEGIN)
    space["helped"] = cfunc(float64(float64))(lambda x: 2.0 * x)
    compiled, plain = answers(space)
    assert compiled == plain
    method = method_of(space["law"], space["P"])
    assert not is_kept(method, method.parameters(), Vehicle(), 0.01)
