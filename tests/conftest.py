"""Settings that all tests share."""

import os
from itertools import groupby

import pytest
from hypothesis import settings

# How long an example takes says nothing about our code. Where so many examples do not suffice, the test says so.
settings.register_profile("ours", deadline=None, max_examples=20)
settings.load_profile("ours")

ALL = "--all-cases"


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the option for the whole suite."""
    parser.addoption(ALL, action="store_true", help="every case of the tests that are marked as sampled")


def pytest_configure(config: pytest.Config) -> None:
    """Declare the marks."""
    for mark in (
        f"sampled: of many cases the first, middle and last one; with {ALL} every one",
        f"weekly: a long test of what others show in part, with {ALL} alone",
    ):
        config.addinivalue_line("markers", mark)


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Leave out what is not asked for. The long form of a property test takes as long as it takes."""
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
