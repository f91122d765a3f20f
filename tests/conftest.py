"""Settings that all tests share."""

import gc
import os
import resource
import signal
import sys
from collections.abc import Iterator
from itertools import count, groupby

import numpy as np
import pytest
from hypothesis import settings

from ev_core.methods import register
from ev_core.parameters.data_file import entry_points

# How long an example takes says nothing about our code. Where so many examples do not suffice, the
# test says so.
settings.register_profile("ours", deadline=None, max_examples=20)
settings.load_profile("ours")

ALL = "--all-cases"
RESULTS = "EV_STACK_RESULTS"
# gymnasium does that when it is imported
_SET_BY_OTHERS = {"PYTEST_CURRENT_TEST", "PYGAME_HIDE_SUPPORT_PROMPT"}
_INSTALLED = {point.value.partition(".")[0] for point in entry_points(group="ev_stack.methods")}
_LIMITS = (resource.RLIMIT_AS, resource.RLIMIT_DATA, resource.RLIMIT_FSIZE, resource.RLIMIT_NOFILE)

# A script that starts us in the background has interrupts ignored, here and in each process that a
# test starts and ends by one.
if signal.getsignal(signal.SIGINT) is signal.SIG_IGN:
    signal.signal(signal.SIGINT, signal.default_int_handler)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the option for the whole suite."""
    parser.addoption(
        ALL, action="store_true", help="every case of the tests that are marked as sampled"
    )


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marks."""
    for mark in (
        f"sampled: of many cases the first, middle and last one; with {ALL} every one",
        f"weekly: a long test of what others show in part, with {ALL} alone",
    ):
        config.addinivalue_line("markers", mark)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not asked for.

    The long form of a property test takes as long as it takes.
    """
    if "EV_CASES" in os.environ:
        for item in items:
            item.add_marker(pytest.mark.timeout(0))
    if config.getoption(ALL) or any("::" in word for word in config.args):
        return
    left_out = {item for item in items if item.get_closest_marker("weekly")}
    for _, cases in groupby(items, lambda item: item.nodeid.partition("[")[0]):
        several = list(cases)
        if len(several) > 3 and several[0].get_closest_marker("sampled"):
            kept = {0, len(several) // 2, len(several) - 1}
            left_out.update(each for place, each in enumerate(several) if place not in kept)
    config.hook.pytest_deselected(items=[item for item in items if item in left_out])
    items[:] = [item for item in items if item not in left_out]


@pytest.fixture(autouse=True)
def nothing_left_behind() -> Iterator[None]:
    """No test leaves to the next one of its process what no new process has.

    Which one is next, the workers decide.

    What a module of an installed package registers, when it is imported at last, is there for all.
    """
    yield from _unchanged("this test")


@pytest.fixture(autouse=True, scope="module")
def nothing_left_behind_by_a_module() -> Iterator[None]:
    """Fixtures that the tests of a module share leave nothing behind either."""
    yield from _unchanged("a fixture of this module")


_numbers = count()


@pytest.fixture(autouse=True)
def own_results(tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> None:
    """A test takes no result that another one has driven."""
    monkeypatch.setenv(
        RESULTS, str(tmp_path_factory.getbasetemp() / "results" / str(next(_numbers)))
    )


@pytest.fixture(autouse=True, scope="module")
def own_results_of_a_module(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Fixtures that the tests of a module share have a store of their own, too."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(RESULTS, str(tmp_path_factory.getbasetemp() / "results" / str(next(_numbers))))
        yield


def _unchanged(scope: str) -> Iterator[None]:
    methods, shared, alive = _methods(), _shared(), _alive()
    yield
    left = {
        which: each
        for which, each in _methods().items()
        if which in methods or each.package not in _INSTALLED
    }
    assert left == methods, f"{scope} leaves other methods behind"
    for what, value in _shared().items():
        assert value == shared[what], f"{scope} leaves other {what} behind"
    if any(is_alive and not alive[what] for what, is_alive in _alive().items()):
        gc.collect()  # programs end with the objects that have started them
    for what, is_alive in _alive().items():
        assert alive[what] or not is_alive, f"{scope} leaves {what} behind"


def _methods() -> dict[tuple[str, str], register.Method]:
    return {
        (role, name): each
        for role, methods in register._REGISTER.items()
        for name, each in methods.items()
    }


def _shared() -> dict[str, object]:
    """State that tests of one process share, by name: a test leaves it as it was."""
    return {
        "variables of the environment": {
            k: v for k, v in os.environ.items() if k not in _SET_BY_OTHERS
        },
        "working directory": os.getcwd(),
        "paths of modules": list(sys.path),
        "handlers of signals": [signal.getsignal(kind) for kind in (signal.SIGINT, signal.SIGTERM)],
        "limits of the process": [resource.getrlimit(kind) for kind in _LIMITS],
        "treatment of floating-point errors": np.geterr(),
    }


def _alive() -> dict[str, bool]:
    """Things that live on behind a test, by name.

    Threads do not count: many are of libraries, and end when they like.
    """
    return {
        "processes": _has_processes(),
        "a context of rclpy": "rclpy" in sys.modules and sys.modules["rclpy"].ok(),
    }


def _has_processes() -> bool:
    try:
        os.waitid(os.P_ALL, 0, os.WEXITED | os.WNOHANG | os.WNOWAIT)
    except ChildProcessError:
        return False
    return True
