"""The workspace is one that colcon, pip and bash understand."""

import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
import release
import yaml
from catkin_pkg.package import parse_package

import ev_stack
from ev_msgs_py.packages import OURS

ROOT = Path(__file__).parents[2]
PACKAGES = tuple(sorted(OURS))
SCRIPTS = sorted([*ROOT.glob("scripts/*.sh"), ROOT / ".ci" / "run"])


def test_colcon_knows_every_package_as_ament_python():
    """An invalid package.xml silently makes a plain `python` package, unknown to `ros2 run`."""
    command = [
        sys.executable,
        "-m",
        "colcon",
        "--log-base",
        "/dev/null",
        "list",
        "--base-paths",
        str(ROOT / "src"),
    ]
    listed = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    types = {
        name: build_type
        for name, _, build_type in (line.split("\t") for line in listed.splitlines())
    }
    assert types == dict.fromkeys(PACKAGES, "(ros.ament_python)")


def test_versions_agree():
    """ROS reads that of each package in package.xml, and so does setup.py.

    The changelog names the latest one first.
    """
    versions = {
        ElementTree.parse(ROOT / "src" / package / "package.xml").findtext("version")
        for package in PACKAGES
    }
    versions.update(
        re.findall(r"^version: (.+)$", (ROOT / "CITATION.cff").read_text(), re.MULTILINE)
    )
    versions.update(
        re.findall(r"^## \[(\d.*)\]", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)[:1]
    )
    assert versions == {ev_stack.__version__}
    assert not any(
        ev_stack.__version__ in (ROOT / "src" / package / "setup.py").read_text()
        for package in PACKAGES
    )


def test_entries_of_the_changelog_are_short():
    """Three lines say what a user notices; the rest is in the pages that they link."""
    entries = re.findall(r"^- .*(?:\n  .*)*", (ROOT / "CHANGELOG.md").read_text(), re.MULTILINE)
    assert len(entries) > 20
    assert [entry for entry in entries if entry.count("\n") > 2] == []


def test_a_release_moves_all_versions_and_gives_its_notes(tmp_path, capsys):
    for name in (*release.FILES, release.CHANGELOG):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(ROOT / name, tmp_path / name)
    changelog = tmp_path / release.CHANGELOG
    before = changelog.read_text().replace(
        "## [Unreleased]\n", "## [Unreleased]\n\n### Added\n\n- A law.\n", 1
    )
    changelog.write_text(before)
    for version in ("0.2", "0.0.9"):
        with pytest.raises(ValueError, match="is refused"):
            release.main(tmp_path, version)
    release.main(tmp_path, "47.11.0")
    texts = [(tmp_path / name).read_text() for name in release.FILES]
    old = ElementTree.parse(ROOT / "src" / "ev_sim" / "package.xml").findtext("version")
    assert all("47.11.0" in text and old not in text for text in texts)
    after = changelog.read_text()
    assert release.notes(after, "Unreleased") == ""
    assert release.notes(after, "47.11.0") == release.notes(before, "Unreleased")
    assert (tmp_path / "build" / "release_notes.md").read_text().startswith("### Added")
    with pytest.raises(ValueError, match="nothing is unreleased"):
        release.main(tmp_path, "47.12.0")
    assert "47.11.0; notes" in capsys.readouterr().out


@pytest.mark.parametrize("distribution", ["jazzy", "lyrical", "kilted"])
def test_pixi_brings_every_message_package_that_the_packages_name(distribution):
    settings = tomllib.loads((ROOT / "pixi.toml").read_text())
    feature = settings["feature"][distribution]
    assert feature["channels"] == [f"robostack-{distribution}"]
    assert [distribution] in settings["environments"].values()
    begin = f"ros-{distribution}-"
    names = {name.removeprefix(begin).replace("-", "_") for name in feature["dependencies"]}
    assert all(name.startswith(begin) for name in feature["dependencies"])
    needed = set()
    for package in PACKAGES:
        tree = ElementTree.parse(ROOT / "src" / package / "package.xml")
        required = [
            found.text for found in tree.iter("exec_depend") if found.get("condition") is None
        ]
        needed |= {name for name in required if not name.startswith("python3-")}
    assert needed - set(PACKAGES) <= names
    assert all((ROOT / task.split()[0]).exists() for task in settings["tasks"].values())


# The keys of rosdep/python.yaml in ros/rosdistro (8468e88c, 2026-08-22) that the packages name,
# each looked up there.
ROSDEP_KEYS = {
    *(
        "python3-can",
        "python3-cantools-pip",
        "python3-gymnasium-pip",
        "python3-jinja2",
        "python3-matplotlib",
    ),
    *(
        "python3-msgpack",
        "python3-numba",
        "python3-numpy",
        "python3-pandas",
        "python3-pytest",
        "python3-rosbags-pip",
    ),
    *("python3-scipy", "python3-tornado", "python3-tqdm", "python3-yaml"),
}


def dependencies(**environment: str) -> set[str]:
    """Packages that rosdep would install for all of ours."""
    found = set()
    for package in PACKAGES:
        described = parse_package(ROOT / "src" / package / "package.xml")
        described.evaluate_conditions(environment)
        found |= {
            each.name
            for each in described.exec_depends + described.test_depends
            if each.evaluated_condition
        }
    return found - set(PACKAGES)


def test_rosdep_finds_what_is_needed_and_on_demand_what_is_optional():
    """A key with -pip keeps a package from being released; what is needed has none.

    No bridge is needed by anybody.
    """
    needed, everything = dependencies(), dependencies(EV_STACK_OPTIONAL="yes")
    optional = everything - needed
    assert {name for name in everything if name.startswith("python3-")} == ROSDEP_KEYS
    assert not [name for name in needed if name.endswith("-pip")]
    assert {
        "simulation_interfaces",
        "autoware_vehicle_msgs",
        "ackermann_msgs",
        "nav_msgs",
        "tf2_msgs",
    } < optional
    assert {"rclpy", "sensor_msgs", "python3-numba"} < needed


def test_the_workflow_tries_every_distribution_that_installing_names():
    """Each by the digest of its image."""
    tried = re.findall(
        r"- distribution: (\w+)\n +digest: sha256:[0-9a-f]{64}\n",
        (ROOT / ".github/workflows/ci.yml").read_text(),
    )
    table = (ROOT / "docs" / "installing.md").read_text()
    named = {
        name.lower() for name in re.findall(r"^\| (\w+) \|[^|]*\| workflow \|", table, re.MULTILINE)
    }
    assert {*tried} == named


def test_hooks_before_a_commit_are_what_the_environment_has():
    """Pinned with it, so that a hook and the suite do not disagree."""
    settings = yaml.safe_load((ROOT / ".pre-commit-config.yaml").read_text())
    hooks = [hook for repository in settings["repos"] for hook in repository["hooks"]]
    programs = {hook["entry"].split()[0].removeprefix(".venv/bin/") for hook in hooks}
    assert programs == {"ruff", "lint-imports", "mypy"}
    assert all((Path(sys.executable).parent / program).exists() for program in programs)
    assert {hook["language"] for hook in hooks} == {"system"}


@pytest.mark.parametrize(
    "form", sorted(ROOT.glob(".github/ISSUE_TEMPLATE/w*.yml")), ids=lambda form: form.stem
)
def test_a_form_for_issues_has_what_github_needs(form: Path):
    content = yaml.safe_load(form.read_text())
    assert content["name"] and content["description"]
    assert any(field.get("validations", {}).get("required") for field in content["body"])
    assert all(
        field["type"] in ("input", "textarea") and field["attributes"]["label"]
        for field in content["body"]
    )


def test_the_readme_is_short():
    assert (ROOT / "README.md").read_text().count("\n") <= 150


def test_the_pages_of_the_repository_have_what_people_read():
    """Tables that follow from code or kept numbers are built: scripts/document.sh."""
    words = sum(len(page.read_text().split()) for page in (ROOT / "docs").rglob("*.md"))
    assert words <= 120_000


def test_requirements_are_pinned():
    lines = [
        line.partition("#")[0].strip()
        for line in (ROOT / "requirements.txt").read_text().splitlines()
    ]
    loose = [
        line for line in lines if line and not re.fullmatch(r"[\w.-]+(\[\w+\])?==\d+(\.\d+)+", line)
    ]
    assert not loose


def pins(file: str) -> dict[str, str]:
    """Versions by name that a file asks for."""
    found = re.findall(r"^([\w.-]+)(?:\[\w+\])?==(\S+)", (ROOT / file).read_text(), re.MULTILINE)
    return {name.lower().replace("_", "-").replace(".", "-"): version for name, version in found}


WANTED = pins("requirements.txt")
OF_KILTED = {name: version for name, version in WANTED.items() if name != "ros-fastrtps"} | pins(
    "scripts/kilted-overrides.txt"
)


@pytest.mark.parametrize(
    ("lock", "wanted"),
    [("requirements.lock", WANTED), ("requirements-kilted.lock", OF_KILTED)],
    ids=["jazzy", "kilted"],
)
def test_the_lock_has_every_requirement_and_a_hash_for_every_package(lock, wanted):
    """A change of requirements.txt alone is found: scripts/lock.sh writes the lock."""
    locked = (ROOT / lock).read_text()
    packages = re.findall(
        r"^([\w.-]+)(?:\[[\w,]+\])?==(\S+)(.*\n {4}--hash=sha256:[0-9a-f]{64})?",
        locked,
        re.MULTILINE,
    )
    assert wanted.items() <= {name: version for name, version, _ in packages}.items()
    assert [name for name, _, first_hash in packages if not first_hash] == []
    assert "://" not in locked, "the index is named at installation"


def test_locks_differ_in_ros_alone():
    """All of what Kilted's overrides replace, and nothing else."""
    jazzy, kilted = pins("requirements.lock"), pins("requirements-kilted.lock")
    differing = {name for name, _ in jazzy.items() ^ kilted.items()}
    assert {name for name in WANTED if name.startswith("ros-")} <= differing
    assert [name for name in differing if not name.startswith("ros-")] == []


def test_the_workflow_runs_the_suite_with_the_wheels_of_both():
    """Jazzy with every Python, Kilted with one."""
    test = yaml.safe_load((ROOT / ".github/workflows/ci.yml").read_text())["jobs"]["test"]
    matrix = test["strategy"]["matrix"]
    assert test["env"] == {"EV_STACK_ROS": "${{ matrix.ros }}"}
    assert matrix["ros"] == ["jazzy"]
    assert [each["ros"] for each in matrix["include"]] == ["kilted"]


@pytest.mark.parametrize("distribution", ["foxy", "humble", "iron"])
def test_a_distribution_with_an_older_python_is_refused_before_anything_is_made(
    distribution, tmp_path
):
    command = tmp_path / "ros2"
    command.write_text("#!/bin/sh\n")
    command.chmod(0o755)
    environment = {
        **os.environ,
        "ROS_DISTRO": distribution,
        "PATH": f"{tmp_path}:{os.environ['PATH']}",
    }
    done = subprocess.run(
        [ROOT / "scripts/prepare.sh"], env=environment, capture_output=True, text=True
    )
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert distribution in done.stderr and "jazzy, kilted, lyrical or rolling" in done.stderr


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.name)
def test_script_is_valid_and_executable(script: Path):
    subprocess.run(["bash", "-n", str(script)], check=True)
    assert script.stat().st_mode & 0o111 == 0o111


@pytest.mark.parametrize("name", ["setup.sh", "test.sh"])
def test_help_needs_no_set_up(name: str):
    script = ROOT / "scripts" / name
    shown = subprocess.run([script, "--help"], check=True, capture_output=True, text=True)
    assert f"scripts/{name}" in shown.stdout


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "document.sh",
        *(
            pytest.param(f"{name}.sh", marks=pytest.mark.weekly)
            for name in ("campaign", "determinism")
        ),
    ],
)
def test_tools_start_where_the_shell_has_no_path_of_python(name: str):
    """Without a distribution nothing exports PYTHONPATH."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONPATH"}
    words = [ROOT / "scripts" / name, "--help"]
    shown = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
    assert "usage" in shown.stdout


def test_every_page_is_in_the_site():
    """scripts/site.sh builds it from mkdocs.yml; those of the top folder stand outside docs/."""
    listed = set(re.findall(r": (\w+\.md)$", (ROOT / "mkdocs.yml").read_text(), re.MULTILINE))
    outside = {"index.md", "contributing.md", "changelog.md", "reporting.md", "reference.md"}
    assert listed == {page.name for page in (ROOT / "docs").glob("*.md")} | outside


@pytest.mark.slow
def test_the_python_of_the_environment_knows_the_packages_by_itself():
    """The kernel of a notebook imports them without a sourced shell."""
    program = "import ev_stack, ev_control, ev_msgs_py; print(ev_stack.run.__name__)"
    found = subprocess.run(
        [sys.executable, "-E", "-c", program], cwd="/", check=True, capture_output=True, text=True
    )
    assert found.stdout == "run\n"


@pytest.mark.parametrize("package", PACKAGES)
def test_colcon_finds_that_tests_are_by_pytest(package):
    """It asks setup.py, by `tests_require` or an extra of this name.

    Without it `colcon test` passes without a test.
    """
    assert '"test": ["pytest"]' in (ROOT / "src" / package / "setup.py").read_text()
    assert [*(ROOT / "src" / package / "test").glob("test_*.py")]


@pytest.mark.parametrize("package", PACKAGES)
def test_a_package_names_what_it_imports_of_ros_and_the_compiler(package):
    """Imports with a key of rosdep are named.

    A missing one would show only on a machine that has not built the others.
    """
    described = parse_package(ROOT / "src" / package / "package.xml")
    named = {each.name.removeprefix("python3-") for each in described.exec_depends}
    texts = [path.read_text() for path in (ROOT / "src" / package).rglob("*.py")]
    imported = {
        name
        for text in texts
        for name in re.findall(r"^ *(?:from|import) (\w+)", text, re.MULTILINE)
    }
    looked_for = {
        "numba",
        "launch",
        "launch_ros",
        "ament_index_python",
        "rclpy",
        "std_msgs",
        "sensor_msgs",
    }
    assert imported & looked_for <= named


def test_a_package_without_its_config_is_not_built(tmp_path):
    """An archive of the folder alone is refused: its link to config leads nowhere."""
    alone = tmp_path / "ev_sim"
    shutil.copytree(
        ROOT / "src" / "ev_sim",
        alone,
        symlinks=True,
        ignore=shutil.ignore_patterns("__pycache__", "*.egg-info"),
    )
    done = subprocess.run(
        [sys.executable, "setup.py", "--name"], cwd=alone, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr.count("\n")) == (1, 1)
    assert done.stderr.startswith("src/ev_sim alone lacks ev_sim/config")
