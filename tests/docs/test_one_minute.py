"""One line names the equation, file and test of a law: each is found within a minute."""

from __future__ import annotations

from pathlib import Path

import pytest

from ev_core.methods.register import all_methods

ROOT = Path(__file__).parents[2]
PAGES = "\n".join(page.read_text() for page in (ROOT / "docs").glob("*.md"))
LAWS = [
    (role, method)
    for role, methods in all_methods().items()
    for method in methods.values()
    if method.documented.__module__.startswith("ev_control.")
]


@pytest.mark.parametrize(("role", "method"), LAWS, ids=lambda each: getattr(each, "name", each))
def test_a_law_has_a_file_a_test_and_a_place_in_the_documentation(role, method):
    module = method.documented.__module__
    assert module.startswith(f"ev_control.{role}.")
    file, test = f"/{module.rpartition('.')[2]}.py`", f"tests/ev_control/laws/test_{method.name}.py"
    assert (ROOT / test).exists()
    named = [line for line in PAGES.splitlines() if test in line and method.name in line]
    assert any(file in line for line in named), (
        f"no line names {test} and the file of the law, {module}"
    )


def test_every_test_of_a_law_is_that_of_a_law_or_of_many():
    """A file that is left over would test nothing that a reader finds."""
    of_many = {
        "test_asr_launches",
        "test_asr_properties",
        "test_differential_properties",
        "test_lost_sensors",
    }
    of_many |= {
        "test_asr_rolling_starts",
        "test_own_indices",
        "test_slippery_hills",
        "test_speed_mode",
    }
    names = {path.stem for path in (ROOT / "tests" / "ev_control" / "laws").glob("test_*.py")}
    assert names - of_many == {f"test_{method.name}" for _, method in LAWS}
