"""ROS parameter files.

The same values for a node as rclpy gives it, and one line for what is none.
"""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st

from ev_core.parameters.section import matches
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.parameter_file import ParameterFile, flattened, read_yaml

# What rclpy 9.1 gives to a node `driver` in these namespaces that declares its parameters from this
# file.
SECTIONS = """
/**:
  ros__parameters: {a: first, b: 1e-3, e: 1.0e3, f: 5, g: [1.0, 2.0]}
/**/driver:
  ros__parameters: {c: mid, n: {x: 1.5, y: {z: yes}}}
/ev/driver:
  ros__parameters: {a: full}
/ev/*:
  ros__parameters: {c: star, m: off}
/*/driver:
  ros__parameters: {d: token}
/**/run/driver:
  ros__parameters: {a: run}
driver:
  ros__parameters: {z: root}
/**/plant:
  ros__parameters: {q: 1}
"""
EVERYBODY = {"a": "first", "b": 0.001, "e": 1000.0, "f": 5, "g": [1.0, 2.0]}
DRIVERS = {"c": "mid", "n.x": 1.5, "n.y.z": True}


@pytest.fixture
def file(tmp_path: Path):
    def write(text: str | bytes) -> Path:
        path = tmp_path / "parameters.yaml"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return path

    return write


@pytest.mark.parametrize(
    ("node", "values"),
    [
        (
            "/ev/driver",
            {**EVERYBODY, **DRIVERS, "a": "full", "c": "star", "m": False, "d": "token"},
        ),
        ("/driver", {**EVERYBODY, **DRIVERS, "z": "root"}),
        ("/ev/run/driver", {**EVERYBODY, **DRIVERS, "a": "run"}),
        ("/ev/asr", {**EVERYBODY, "c": "star", "m": False}),
        ("/ev/run/plant", {**EVERYBODY, "q": 1}),
        ("/ev/driver2", {**EVERYBODY, "c": "star", "m": False}),
        ("/ev/backup_driver", {**EVERYBODY, "c": "star", "m": False}),
    ],
)
def test_a_node_gets_what_ros_gives_it(file, node, values):
    """Sections that match count in their order, whether by a wildcard or by name."""
    assert ParameterFile(file(SECTIONS)).values_for(node) == values


@pytest.mark.parametrize(
    ("pattern", "node", "match"),
    [
        ("/**", "/a/b/c", True),
        ("/**/c", "/c", True),
        ("/**/c", "/a/b/c", True),
        ("/**/b/c", "/a/b/c", True),
        ("/**/b/c", "/a/b/x/c", False),
        ("/*/c", "/a/c", True),
        ("/*/c", "/a/b/c", False),
        ("/*/c", "/c", False),
        ("/*", "/c", True),
        ("/a/**/c", "/a/b/b/c", True),
        ("/a/**/c", "/a/c", True),
        ("c", "/c", True),
        ("c", "/a/c", False),
        ("a/c", "/a/c", True),
        ("/a.c", "/abc", False),
        ("/a", "/a/c", False),
    ],
)
def test_wildcards_mean_one_token_or_any_namespaces(pattern, node, match):
    """rcl: `*` matches a single token, `/**` zero or more tokens."""
    assert matches(pattern, node) is match


def test_sections_for_all_nodes_can_be_left_out(file):
    """A scenario speaks about itself under its name; what is for all nodes is not for it."""
    parameters = ParameterFile(file(SECTIONS))
    assert parameters.values_for("/ev/driver", by_name=True) == {
        **DRIVERS,
        "a": "full",
        "d": "token",
    }


names = st.text("abcdefg_", min_size=1, max_size=3)
trees = st.recursive(
    st.integers(), lambda inner: st.dictionaries(names, inner, max_size=3), max_leaves=8
)


@given(st.dictionaries(names, trees, max_size=4))
def test_nested_keys_become_dotted_names(tree):
    """Every leaf is found by walking down its dotted name, and there is nothing else."""
    flat = dict(flattened(tree))
    for name, value in flat.items():
        place = tree
        for key in name.split("."):
            place = place[key]
        assert place == value
    assert len(flat) == leaves(tree)


def leaves(tree) -> int:
    return sum(leaves(inner) for inner in tree.values()) if isinstance(tree, dict) else 1


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_number_is_a_number_however_it_is_written(value):
    """Python, YAML 1.2 and ROS agree on 1e-05, 1e+16 and the like."""
    assert read_yaml(repr(value)) == value
    assert read_yaml(f"[{value:e}, {value:.17g}]") == [float(f"{value:e}"), value]
    assert read_yaml(yaml.safe_dump(value)) == value


@pytest.mark.parametrize(
    "text", ["e5", "1e", "1e5x", "1.2.3", "'1e5'", "front_left", "1e5 m", "nan", "e"]
)
def test_a_text_stays_a_text(text):
    assert read_yaml(text) == text.strip("'")


def refused(path: Path) -> str:
    with pytest.raises(ParameterError) as error:
        ParameterFile(path)
    text = str(error.value)
    assert "\n" not in text
    assert text.startswith(f"{path}: ")
    return text.removeprefix(f"{path}: ")


def test_a_missing_file_is_named(tmp_path):
    assert refused(tmp_path / "nowhere.yaml") == "No such file or directory"
    assert refused(tmp_path) == "it is a folder, expected a regular file of at most 4 MB"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a: [1, 2\nb: 3\n", "not readable as YAML in line 2"),
        ("a: 1\nb: }\n", "not readable as YAML in line 2"),
        ("a:\n\t- 1\n", "not readable as YAML in line 2"),
        ("a: 2026-99-99", "not readable as YAML"),
        (b"\xff\xfe\xfa", "not readable as YAML"),
        ("", "a ROS parameter file has sections such as '/**/driver:', this one has none"),
        ("- 1\n- 2", "a ROS parameter file has sections such as '/**/driver:', this one has none"),
        ("/**/driver: 5", "section '/**/driver' does not hold 'ros__parameters:' with parameters"),
        (
            "/**/driver: {method: x}",
            "section '/**/driver' does not hold 'ros__parameters:' with parameters",
        ),
        (
            "/**/driver: {ros__parameters: 5}",
            "section '/**/driver' does not hold 'ros__parameters:' with parameters",
        ),
        ("/**/driver: {ros__parameters: {a: 1}, more: 2}", "section '/**/driver' does not hold"),
        ("driver:\n  ros__parameters:\n", "section 'driver' does not hold"),
        ("a: &x 1\nb: *x", "not readable as YAML in line 2: an alias, expected what it stands for"),
        ("a: " + "[" * 1_000_000, "not readable as YAML"),
    ],
)
def test_what_is_no_parameter_file_is_one_line(file, text, message):
    assert refused(file(text)).startswith(message)


@pytest.mark.parametrize("text", ["1:30", "-1:30:00", "1:30.5", "!!int 1:30", "1" + ":1" * 300_000])
def test_a_number_to_the_base_of_sixty_is_a_text_as_for_ros(text: str):
    """YAML 1.1 takes it for a number, and the work goes with the square of its length.

    Hours for a file of 4 MB.
    """
    assert read_yaml(text) == text.removeprefix("!!int ")
