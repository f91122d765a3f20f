"""Values of a node: which of several places counts, and which one a refusal names."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.scenario import Overrides, load_scenario

RUNS = ("first", "second")
# Sections of files, and the (run, role) of which each one gives a value to some.
SECTIONS = {
    "/**": lambda run, role: True,
    "/**/plant": lambda run, role: role == "plant",
    "/**/second/*": lambda run, role: run == "second",
    "/ev/first/asr": lambda run, role: (run, role) == ("first", "asr"),
}
NODES = ("*", "plant", "asr")
SEED = st.integers(0, 99)
REFUSED = -1


class Place(NamedTuple):
    """A file, the seeds by section of which it gives."""

    seeds: dict[str, int]

    def write(self, path: Path, head: str = "") -> Path:
        sections = [
            f"{name}:\n  ros__parameters: {{seed: {seed}}}\n" for name, seed in self.seeds.items()
        ]
        path.write_text(head + "".join(sections))
        return path

    def seed_of(self, run: str, role: str) -> int | None:
        """The last section that means a node counts."""
        found = [seed for name, seed in self.seeds.items() if SECTIONS[name](run, role)]
        return found[-1] if found else None


def places(seeds: st.SearchStrategy[int]) -> st.SearchStrategy[Place]:
    return st.builds(Place, st.dictionaries(st.sampled_from(list(SECTIONS)), seeds, min_size=1))


commands = st.lists(st.tuples(st.sampled_from(NODES), SEED), max_size=3)
HEAD = f"/**/scenario:\n  ros__parameters: {{duration: 1.0, runs: [{', '.join(RUNS)}]}}\n"


def written(folder: Path, files: Sequence[Place]) -> tuple[str, list[Path]]:
    """The scenario, which is the first file, and the further ones."""
    scenario, *further = files
    own = scenario.write(folder / "own.yaml", HEAD)
    return str(own), [
        each.write(folder / f"further_{number}.yaml") for number, each in enumerate(further)
    ]


@settings(max_examples=60, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(files=st.lists(places(SEED), min_size=1, max_size=3), command=commands)
def test_the_last_place_that_gives_a_value_counts(files, command, tmp_path):
    """Scenario, further files in their order, command line; within a file the later section."""
    own, further = written(tmp_path, files)
    values = [(node, "seed", seed) for node, seed in command]
    for run in load_scenario(own, Overrides(further, values)).runs:
        for role in ("plant", "asr", "driver"):
            given_seeds = [each.seed_of(run.name, role) for each in files]
            given_seeds += [seed for node, seed in command if node in ("*", role)]
            expected = [seed for seed in given_seeds if seed is not None]
            found = run.configurations[role].common.seed
            assert found == (expected[-1] if expected else 0)


@settings(max_examples=40, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(files=st.lists(places(SEED | st.just(REFUSED)), min_size=1, max_size=3))
def test_a_refusal_names_the_file_whose_value_counts(files, tmp_path):
    """A value that a later file overrules is refused by nothing."""
    own, further = written(tmp_path, files)
    paths = [own, *map(str, further)]
    expected = []
    for run in RUNS:
        for role in ("plant", "asr", "driver"):
            givers = [
                number for number, each in enumerate(files) if each.seed_of(run, role) is not None
            ]
            if givers and files[givers[-1]].seed_of(run, role) == REFUSED:
                expected.append(f"({paths[givers[-1]]})")
    try:
        load_scenario(own, Overrides(further))
    except ParameterError as error:
        assert str(error).endswith(tuple(expected))
        assert "seed: -1 is refused" in str(error)
    else:
        assert not expected


def test_a_value_of_the_command_line_has_no_origin(tmp_path):
    """The user sees it on the line that was typed."""
    own, _ = written(tmp_path, [Place({"/**": 1})])
    with pytest.raises(ParameterError, match=r"expected 0 to 2147483647$"):
        load_scenario(own, Overrides(values=[("plant", "seed", REFUSED)]))
