"""The bits are those of every other machine, and nothing in the source could make them differ."""

from __future__ import annotations

import ast
import hashlib
import random
import struct
import subprocess
import sys
from pathlib import Path

import pytest
from elementary.precise import LIMITS, ONE, TWO

from ev_core import elementary

SOURCES = sorted(Path(elementary.__file__).parent.glob("*.py"))

# Exact, or correctly rounded by IEEE 754, whatever the library.
EXACT = {"copysign", "fabs", "floor", "frexp", "inf", "isfinite", "isqrt", "ldexp", "nan", "sqrt"}

DIGEST = "d5772117bf6ae446"


def test_results_are_those_of_every_other_machine():
    """The digest of 22 000 results, once written down.

    The C library's own change with what the processor can do.
    """
    generator = random.Random(1)
    results = []
    for name in (*ONE, "remainder", "fmod", *TWO):
        function = getattr(elementary, name)
        low, high = LIMITS.get(name, (-30.0, 30.0))
        for _ in range(1000):
            x = generator.uniform(low, high or 30.0)
            y = generator.uniform(-30.0, 30.0)
            results.append(function(x, y) if name in (*TWO, "remainder", "fmod") else function(x))
        if name in ("sin", "cos", "tan", "atan"):
            results += [function(generator.uniform(-1.0, 1.0) * 2.0**k) for k in range(1000)]
    assert hashlib.sha256(struct.pack(f"<{len(results)}d", *results)).hexdigest()[:16] == DIGEST


@pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.stem)
def test_source_takes_only_exact_functions_from_elsewhere(source):
    tree = ast.parse(source.read_text())
    for node in ast.walk(tree):
        assert not isinstance(node, ast.Import), ast.unparse(node)
        if isinstance(node, ast.ImportFrom):
            taken = {alias.name for alias in node.names}
            ours = node.module.startswith(("ev_core.elementary.", "ev_msgs_py.compilable"))
            assert (
                ours or node.module == "__future__" or (node.module == "math" and taken <= EXACT)
            ), ast.unparse(node)


@pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.stem)
def test_source_raises_nothing_to_a_power_while_it_computes(source):
    """Python's ** is the C library's pow; of constants it is a power of two, which is exact."""
    for function in ast.walk(ast.parse(source.read_text())):
        if isinstance(function, ast.FunctionDef):
            assert not any(isinstance(node, ast.Pow) for node in ast.walk(function)), function.name


def test_import_is_cheap():
    """Small nodes import it: no compiler, no numpy."""
    code = "import sys, ev_core.elementary; print([n for n in ('numba', 'numpy', 'yaml') if n in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"
