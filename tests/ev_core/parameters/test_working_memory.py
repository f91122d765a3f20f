"""Working memory of a law.

An entry has the same meaning in plain Python and compiled, or no such name.
"""

from __future__ import annotations

from dataclasses import make_dataclass

import numpy as np
import pytest

from ev_core.law import entry, memory_type, part, working_memory


@pytest.mark.parametrize("name", ["size", "real", "imag", "mean", "dtype", "T"])
def test_a_name_of_numpys_own_is_refused(name):
    """Plain Python would find numpy's attribute of a record instead, also in a record within."""
    inner = make_dataclass("Inner", [(name, float, entry(unit="1"))], slots=True)
    with pytest.raises(
        TypeError, match=rf"^Inner\.{name}: the name is one of numpy's own, expected another one"
    ):
        memory_type(inner)
    outer = make_dataclass("Outer", [("inner", inner, part(inner))], slots=True)
    with pytest.raises(TypeError, match=rf"^Outer\.inner\.{name}: the name is one of numpy's own"):
        memory_type(outer)


def test_other_names_are_set_and_read():
    memory = working_memory(
        memory_type(make_dataclass("Fine", [("speed", float, entry(unit="m/s"))], slots=True))
    )
    memory[0].speed = 3.0
    assert memory[0].speed == 3.0 and memory.dtype.base.type is np.record
