"""scripts/setup.sh on a bare machine, in a checkout with small packages.

By uv, by pip, interrupted, side by side.
"""

from __future__ import annotations

import hashlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time
import zipfile
from pathlib import Path

import pytest
import uv_as_pip
from helpers.patience import wait_until

from ev_stack.running.beforehand import compile_for
from ev_stack.scenarios.scenario import load_scenario

ROOT = Path(__file__).parents[2]

# Does what the real one is asked for, by pip, and tells what it was given.
UV = """
import os, subprocess, sys
def main():
    with open(os.environ["CALLS"], "a") as calls:
        print(*sys.argv[1:], os.environ.get("UV_FIND_LINKS"), file=calls)
    python, words = sys.argv[4], sys.argv[5:]
    sys.exit(os.environ.get("UV_FAILS") or subprocess.call([python, "-m", "pip", "install", "--no-compile", *words]))
"""
# As the real one it compiles while the rest is set up, which takes longest.
AHEAD = """
import os, time
print(os.getpid(), flush=True)
time.sleep(float(os.environ["AHEAD_TIME"]))
"""
SETUP = """
from setuptools import find_packages, setup
program = "ev-stack = ev_stack:main"
setup(name="ev_stack", version="1.0", packages=find_packages(), entry_points={"console_scripts": [program]})
"""
COLCON = """
import pathlib
folder = pathlib.Path("install/ev_stack/lib/ev_stack")
folder.mkdir(parents=True, exist_ok=True)
(folder / "ev-stack").write_text("#!/bin/sh\\necho the command\\n")
(folder / "ev-stack").chmod(0o755)
pathlib.Path("install/local_setup.bash").write_text("export PYTHONPATH=nothing\\n")
"""


def wheel(folder: Path, name: str, files: dict[str, str], version: str = "1.0") -> str:
    """Write a wheel of a package; its line in a lock."""
    info = f"{name}-{version}.dist-info"
    files = {
        **files,
        f"{info}/METADATA": f"Metadata-Version: 2.1\nName: {name}\nVersion: {version}\n",
        f"{info}/WHEEL": "Wheel-Version: 1.0\nGenerator: test\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
    }
    files[f"{info}/RECORD"] = "".join(f"{each},,\n" for each in (*files, f"{info}/RECORD"))
    path = folder / f"{name}-{version}-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as written:
        for each, text in files.items():
            written.writestr(zipfile.ZipInfo(each), text)
    return f"{name}=={version} \\\n    --hash=sha256:{hashlib.sha256(path.read_bytes()).hexdigest()}\n    # via a test\n"


class Checkout:
    """The scripts in their own folder, two packages to install, a machine with Python alone."""

    def __init__(self, folder: Path) -> None:
        self.root, self.wheels, self.calls = (
            folder / "checkout",
            folder / "wheels",
            folder / "calls",
        )
        self.wheels.mkdir()
        shutil.copytree(ROOT / "scripts", self.root / "scripts")
        package = self.root / "src" / "ev_stack"
        (package / "ev_stack").mkdir(parents=True)
        (package / "ev_stack" / "__init__.py").write_text("def main(): print('the command')\n")
        (package / "setup.py").write_text(SETUP)
        for name in ("package.xml", "setup.cfg"):
            (package / name).touch()
        entry = "uv-1.0.dist-info/entry_points.txt"
        uv = wheel(
            self.wheels, "uv", {"uv_stub.py": UV, entry: "[console_scripts]\nuv = uv_stub:main\n"}
        )
        colcon = wheel(
            self.wheels, "colcon", {"colcon/__init__.py": "", "colcon/__main__.py": COLCON}
        )
        (self.root / "requirements.txt").write_text(
            "uv==1.0  # installs\ncolcon==1.0  # builds\nros-rclpy==1.0\n"
        )
        self.lock = self.root / "requirements.lock"
        self.lock.write_text(colcon + uv)
        rclpy = wheel(self.wheels, "ros_rclpy", {}, "9.0").replace("_", "-", 1)
        (self.root / "requirements-kilted.lock").write_text(colcon + uv + rclpy)
        bare = {"PATH": f"{Path(sys._base_executable).parent}:/usr/bin:/bin", "HOME": str(folder)}
        self.environment = bare | {
            "PIP_NO_INDEX": "1",
            "PIP_FIND_LINKS": str(self.wheels),
            "CALLS": str(self.calls),
        }

    def start(self, **environment: str) -> subprocess.Popen:
        return subprocess.Popen(
            [self.root / "scripts" / "setup.sh"],
            env=self.environment | environment,
            text=True,
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            start_new_session=True,
            # as in the foreground
            preexec_fn=lambda: signal.signal(signal.SIGINT, signal.default_int_handler),
        )

    def set_up(self, **environment: str) -> tuple[int, str]:
        """Status, and what it says on standard error; on standard output it says nothing."""
        process = self.start(**environment)
        out, output = process.communicate()
        assert out == ""
        return process.returncode, output

    def compile_for(self, seconds: float) -> dict[str, str]:
        """The environment in which what compiles ahead takes this time."""
        (self.root / "scripts" / "compile_ahead.py").write_text(AHEAD)
        return {"AHEAD_TIME": str(seconds)}

    def compiling(self) -> list[str]:
        """The numbers of the processes that have begun to compile ahead."""
        log = self.root / "log" / "compile_ahead.log"
        return log.read_text().split() if log.exists() else []

    @property
    def is_complete(self) -> bool:
        command = self.root / ".venv" / "bin" / "ev-stack"
        return (
            self.root / "install" / ".complete"
        ).exists() and b"the command" in subprocess.check_output([command])


@pytest.fixture
def checkout(tmp_path: Path) -> Checkout:
    return Checkout(tmp_path)


def steps_of(text: str) -> list[str]:
    """Steps that setup.sh names, without their times."""
    return [line.partition(" done in ")[0] for line in text.splitlines()]


INSTALLING = "installing ROS 2 and the tools of requirements.lock (once) ..."


@pytest.mark.weekly
@pytest.mark.slow
def test_the_uv_of_the_lock_installs_the_lock_with_the_options_of_pip(checkout):
    """Packages are installed with their hashes.

    The next call does nothing; another lock is installed into the same .venv.
    """
    status, output = checkout.set_up()
    assert (status, steps_of(output)) == (
        0,
        ["making .venv ...", INSTALLING, "building the workspace ..."],
    )
    calls = checkout.calls.read_text()
    assert (
        "--no-deps --require-hashes --requirement .venv/locked.txt" in calls
        and str(checkout.wheels) in calls
    )
    assert checkout.is_complete
    assert checkout.set_up() == (0, "")
    other = checkout.root.parent / "python3.99"
    other.write_text("#!/bin/sh\necho 3.99.0 of /elsewhere\n")
    other.chmod(0o755)
    assert checkout.set_up(PYTHON=str(checkout.root / ".venv" / "bin" / "python")) == (0, "")
    status, output = checkout.set_up(PYTHON=str(other))  # which was ignored without a word
    assert status == 1 and output.startswith(f"PYTHON={other} is refused: .venv has Python 3.")
    checkout.lock.write_text(
        checkout.lock.read_text() + wheel(checkout.wheels, "more", {"more.py": ""})
    )
    status, output = checkout.set_up()
    assert (status, steps_of(output)) == (0, ["updating .venv ...", "building the workspace ..."])
    assert (checkout.root / ".venv" / "bin" / "uv").exists()
    assert b" from " in subprocess.check_output(
        [checkout.root / ".venv" / "bin" / "pip", "--version"]
    )
    subprocess.run([checkout.root / ".venv" / "bin" / "python", "-c", "import more"], check=True)


@pytest.mark.slow
@pytest.mark.weekly
@pytest.mark.parametrize("why", ["cannot be had", "fails"])
def test_where_uv_is_of_no_use_pip_installs_and_one_line_says_so(why, checkout):
    if why == "cannot be had":
        (checkout.wheels / "uv-1.0-py3-none-any.whl").unlink()
    status, output = checkout.set_up(UV_FAILS="no network")
    assert status == 0
    installing = f"{INSTALLING} uv {why}: pip installs, which takes longer ..."
    assert steps_of(output) == ["making .venv ...", installing, "building the workspace ..."]
    assert checkout.is_complete


@pytest.mark.weekly
@pytest.mark.slow
def test_another_file_than_the_lock_names_is_refused_and_nothing_is_left_behind(checkout):
    """Both uv and pip refuse it."""
    (checkout.wheels / "colcon-1.0-py3-none-any.whl").unlink()
    wheel(checkout.wheels, "colcon", {"colcon/__init__.py": "import evil"})
    status, output = checkout.set_up()
    assert status == 1
    assert "DO NOT MATCH THE HASHES" in output
    assert not (checkout.root / ".venv").exists()


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind", [signal.SIGINT, pytest.param(signal.SIGKILL, marks=pytest.mark.weekly)]
)
def test_what_was_interrupted_is_repaired_by_the_next_call(kind, checkout):
    """Ctrl-C or a kill in the middle of building costs the building only.

    What was installed is not installed again; code and imports that compile meanwhile end with it.
    """
    process = checkout.start(**checkout.compile_for(600))
    while len(checkout.compiling()) < 2:
        assert process.poll() is None
        time.sleep(0.05)
    os.killpg(process.pid, kind)
    process.communicate()
    assert process.returncode != 0
    assert not (checkout.root / "install" / ".complete").exists()
    numbers = checkout.compiling()
    wait_until(lambda: not any(Path("/proc", number).exists() for number in numbers))
    (checkout.root / "scripts" / "compile_ahead.py").unlink()
    status, output = checkout.set_up()
    assert (status, steps_of(output)) == (0, ["building the workspace ..."])
    assert checkout.is_complete


@pytest.mark.slow
def test_a_package_that_comes_or_goes_is_known_after_the_next_call(checkout):
    """Its description and programs are those of its setup.py, and modules are those of src."""
    elsewhere = checkout.root.parent / "elsewhere"
    (elsewhere / "of_before").mkdir(parents=True)
    (checkout.root / "install").symlink_to(elsewhere)
    assert checkout.set_up()[0] == 0
    assert not (elsewhere / "of_before").exists()
    # A shell that knows another checkout, such as one of colcon, runs the one that it entered last;
    # a folder that its user names goes first.
    for other in ("of_colcon", "of_the_user"):
        (package := checkout.root.parent / other / "ev_stack").mkdir(parents=True)
        (package / "__init__.py").touch()
    shell = (
        'source scripts/setup.sh && python -c "$1" && PYTHONPATH="$2:$PYTHONPATH" python -c "$1"'
    )
    words = ["bash", "-c", shell, "", "import ev_stack; print(ev_stack.__file__)", package.parent]
    known = checkout.environment | {"PYTHONPATH": str(checkout.root.parent / "of_colcon")}
    shown = subprocess.check_output(words, cwd=checkout.root, env=known, text=True).split()
    folders = [checkout.root / "src" / "ev_stack", package.parent]
    assert shown == [str(folder / "ev_stack" / "__init__.py") for folder in folders]
    # What git leaves of a package that is gone, what a desktop leaves, a package of CMake alone.
    (checkout.root / "src" / "gone" / "gone" / "__pycache__").mkdir(parents=True)
    (checkout.root / "src" / ".DS_Store").touch()
    (cmake := checkout.root / "src" / "of_cmake").mkdir()
    (cmake / "package.xml").touch()
    (more := checkout.root / "src" / "more").mkdir()
    shutil.move(checkout.root / "src" / "ev_stack" / "package.xml", more)
    shutil.move(checkout.root / "src" / "ev_stack" / "setup.cfg", more)
    shutil.rmtree(checkout.root / "src" / "ev_stack")
    points = {"console_scripts": ["more = more.nodes:main"], "ev_stack.nodes": ["m = more:make"]}
    given = {"name": "more", "version": "2.0", "entry_points": points}
    given["extras_require"] = {"x": ["y>1"]}
    (more / "setup.py").write_text(f"from setuptools import setup\nsetup(**{given})\n")
    (more / "more").mkdir()
    (more / "more" / "nodes.py").touch()
    assert checkout.set_up()[0] == 0
    asked = (
        "from importlib.metadata import distribution, entry_points, packages_distributions\n"
        "of = distribution('more')\n"
        "print(of.version, of.requires, entry_points(group='ev_stack.nodes'))\n"
        "assert not entry_points(name='ev-stack')"
    )
    python = checkout.root / ".venv" / "bin" / "python"
    found = subprocess.check_output([python, "-c", asked], text=True)
    assert found.startswith("2.0 ['y>1; extra == \"x\"'] ")
    assert "EntryPoint(name='m', value='more:make', group='ev_stack.nodes')" in found
    program = checkout.root / "install" / "more" / "lib" / "more" / "more"
    edited = "import sys\ndef main(): return print(sys.argv[1:]) or 4\n"
    (more / "more" / "nodes.py").write_text(edited)
    done = subprocess.run([program, "word"], capture_output=True, text=True)
    assert (done.returncode, done.stdout) == (4, "['word']\n")
    assert not (checkout.root / "install" / "ev_stack").exists()
    assert not (checkout.root / "install" / "of_cmake").exists()


@pytest.mark.weekly
@pytest.mark.slow
def test_one_variable_takes_the_wheels_of_kilted(checkout):
    """A new .venv is made: what only the wheels of another ROS 2 have would stay.

    Another name is refused.
    """
    python = checkout.root / ".venv" / "bin" / "python"
    asked = [python, "-c", "from importlib.metadata import version; print(version('ros-rclpy'))"]
    assert checkout.set_up()[0] == 0
    (of_jazzy := checkout.root / ".venv" / "of_jazzy").touch()
    assert checkout.set_up(EV_STACK_ROS="jazzy") == (0, "")
    status, output = checkout.set_up(EV_STACK_ROS="kilted")
    installing = INSTALLING.replace("requirements.lock", "requirements-kilted.lock")
    assert (status, steps_of(output)) == (
        0,
        ["making .venv ...", installing, "building the workspace ..."],
    )
    assert subprocess.check_output(asked) == b"9.0\n" and not of_jazzy.exists()
    status, output = checkout.set_up(EV_STACK_ROS="lyrical")
    assert (status, output.count("\n")) == (1, 1)
    assert output.startswith("EV_STACK_ROS=lyrical is refused, expected jazzy or kilted")
    assert subprocess.check_output(asked) == b"9.0\n"


@pytest.mark.slow
@pytest.mark.weekly
def test_two_calls_at_once_set_up_once(checkout, tmp_path):
    """The second call waits, also under a Python without ensurepip, and finds all done."""
    (tmp_path / "ensurepip.py").write_text("raise ImportError\n")
    first = checkout.start(PYTHONPATH=str(tmp_path), **checkout.compile_for(2))
    while not checkout.compiling():
        assert first.poll() is None
        time.sleep(0.05)
    assert checkout.set_up() == (0, "waiting for another set-up to finish ...\n")
    assert first.communicate() and first.returncode == 0
    assert checkout.is_complete


@pytest.mark.slow
@pytest.mark.weekly
@pytest.mark.parametrize("distribution", ["jazzy", "kilted", "lyrical", "rolling"])
def test_beside_a_distribution_only_what_it_lacks_is_installed(distribution, checkout, tmp_path):
    """ROS is left out, and numpy stays that of the distribution.

    It is pip that installs, for uv does not see the packages of the distribution. colcon builds, for
    `ros2` finds only what is built so; what was linked before goes.
    """
    assert checkout.set_up()[0] == 0
    assert (linked := checkout.root / "install" / "ev_stack" / "python").exists()
    by_uv = checkout.calls.read_text()
    (tmp_path / "ros2").write_text("#!/bin/sh\n")
    (tmp_path / "ros2").chmod(0o755)
    (tmp_path / "numpy.py").write_text("__version__ = '1.26.4'\n")
    path = f"{tmp_path}:{checkout.environment['PATH']}"
    status, output = checkout.set_up(ROS_DISTRO=distribution, PATH=path, PYTHONPATH=str(tmp_path))
    assert (status, steps_of(output)) == (
        0,
        [
            f"making .venv beside ROS 2 {distribution} ...",
            f"installing what {distribution} lacks (once) ...",
            "building the workspace ...",
        ],
    )
    venv = checkout.root / ".venv"
    assert (venv / "missing.txt").read_text() == "colcon\n"
    assert (venv / "constraints.txt").read_text() == "numpy==1.26.4\n"
    assert checkout.calls.read_text() == by_uv
    assert "include-system-site-packages = true" in (venv / "pyvenv.cfg").read_text()
    assert checkout.is_complete and not linked.exists()
    assert "nothing" in (checkout.root / "install" / "environment.bash").read_text()


def middleware_of(checkout: Checkout, before: str = "", **environment: str) -> dict[str, str]:
    """Settings of the middleware that a shell with setup.sh sourced gives its nodes."""
    named = (
        "FASTDDS_DEFAULT_PROFILES_FILE",
        "FASTRTPS_DEFAULT_PROFILES_FILE",
        "ROS_AUTOMATIC_DISCOVERY_RANGE",
    )
    shell = f"{before}\nsource scripts/setup.sh && env"
    output = subprocess.check_output(
        ["bash", "-c", shell], cwd=checkout.root, env=checkout.environment | environment, text=True
    )
    found = dict(line.split("=", 1) for line in output.splitlines() if line.startswith(named))
    return {name: value.removeprefix(f"{checkout.root}/config/") for name, value in found.items()}


@pytest.mark.weekly
@pytest.mark.slow
def test_the_installed_middleware_decides_which_profile_keeps_nodes_on_this_machine(
    checkout, tmp_path
):
    """Each Fast DDS gets its own, wheel or distribution; the user goes first."""
    assert checkout.set_up()[0] == 0
    newer = {
        "FASTDDS_DEFAULT_PROFILES_FILE": "fastdds.xml",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
    }
    older = {
        "FASTRTPS_DEFAULT_PROFILES_FILE": "fastdds2.xml",
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "SYSTEM_DEFAULT",
    }
    assert middleware_of(checkout) == newer
    (packages,) = (checkout.root / ".venv" / "lib").glob("python*/site-packages")
    wheel_of_fast_dds_2 = packages / "ros_fastrtps-2.14.5.dist-info"
    arrives = f"source scripts/setup.sh && mkdir {wheel_of_fast_dds_2}"
    assert middleware_of(checkout, before=arrives) == older
    assert middleware_of(checkout) == older
    assert (
        middleware_of(checkout, before=f"source scripts/setup.sh && rmdir {wheel_of_fast_dds_2}")
        == newer
    )
    (tmp_path / "jazzy" / "share" / "fastrtps").mkdir(parents=True)
    assert middleware_of(checkout, AMENT_PREFIX_PATH=f"/nowhere:{tmp_path}/jazzy") == older
    assert middleware_of(checkout, RMW_IMPLEMENTATION="rmw_cyclonedds_cpp") == {
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"
    }
    for own in (
        {"FASTRTPS_DEFAULT_PROFILES_FILE": "/own.xml"},
        {"ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"},
    ):
        assert middleware_of(checkout, **own) == own


# scripts/compile_ahead.py where only packages are installed with lines in the lock that a pattern
# matches.
WITH_FIRST_PACKAGES = """
import re, runpy, sys
from importlib.metadata import packages_distributions
first, owners = sys.argv.pop(1), packages_distributions()
class Later:
    def find_spec(name, path=None, target=None):
        there = [each for each in owners.get(name, ()) if not each.startswith(("ev_", "ev-"))]
        if there and not any(re.match(first, each.lower().replace("_", "-") + "==") for each in there):
            raise ModuleNotFoundError(f"No module named {name!r} yet", name=name)
sys.meta_path.insert(0, Later)
sys.argv[0] = "scripts/compile_ahead.py"
runpy.run_path(sys.argv[0], run_name="__main__")
"""


@pytest.mark.parametrize(
    "words", [["shchur2019", "--set", "driver.wrong=1"], ["shchur2019"]], ids=["none", "run"]
)
def test_what_is_compiled_ahead_is_what_runs_look_for(words):
    """Sources and the first packages give the same names of files, compiled once."""
    compile_for(load_scenario("shchur2019").runs, in_nodes=True)
    path = os.pathsep.join(str(each) for each in (ROOT / "src").iterdir())
    first = re.search(
        r"locked '/(\^.+==)/' >\.venv/first\.txt", (ROOT / "scripts" / "prepare.sh").read_text()
    )[1]
    command = [sys.executable, "-c", WITH_FIRST_PACKAGES, first, "code", *words]
    done = subprocess.run(
        command,
        cwd=ROOT,
        env=os.environ | {"PYTHONPATH": path},
        capture_output=True,
        text=True,
        check=True,
    )
    assert done.stdout + done.stderr == ""


def test_uv_has_the_options_of_pip(monkeypatch):
    """A variable of pip goes before its files, and one of uv before both, by its older name too."""
    for name in (*os.environ,):
        if name.startswith(("UV_", "SSL_")) or name.upper().endswith("_PROXY"):
            monkeypatch.delenv(name)
    lines = (
        ":env:.find-links='/a /b'",
        "download.index-url='https://not.this'",
        "global.cert='/of/ours.pem'",
        "global.find-links='/c'",
        "global.index-url='https://one'",
        "global.progress-bar='off'",
        "install.extra-index-url='\\nhttps://two\\nhttps://three'",
    )
    found = {
        "UV_INDEX_STRATEGY": "unsafe-best-match",
        "UV_DEFAULT_INDEX": "https://one",
        "UV_INDEX": "https://two https://three",
        "UV_FIND_LINKS": "/a,/b",
        "SSL_CERT_FILE": "/of/ours.pem",
    }
    assert uv_as_pip.variables("\n".join(lines)) == found
    monkeypatch.setenv("UV_INDEX_URL", "https://mine")
    monkeypatch.setenv("UV_FIND_LINKS", "/mine")
    del found["UV_DEFAULT_INDEX"], found["UV_FIND_LINKS"]
    assert uv_as_pip.variables("\n".join(lines)) == found


def test_a_checkout_with_umlauts_in_its_path_is_set_up_twice(tmp_path: Path):
    """Its Python starts in the C locale, too: the file with the paths of the packages is ASCII."""
    folder = tmp_path / "größe"
    folder.mkdir()
    checkout = Checkout(folder)
    assert checkout.set_up()[0] == 0
    (checkout.root / "install" / ".complete").unlink()
    status, output = checkout.set_up()
    assert status == 0, output
    words = [
        checkout.root / ".venv" / "bin" / "python",
        "-c",
        "import sys; print(*map(ascii, sys.path), sep='\\n')",
    ]
    environment = checkout.environment | {"LC_ALL": "C"}
    paths = subprocess.run(words, env=environment, check=True, capture_output=True, text=True)
    assert ascii(str(checkout.root / "src" / "ev_stack")) in paths.stdout
