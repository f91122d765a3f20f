"""Settings that all tests share."""

import os

import pytest
from hypothesis import settings

# How long an example takes says nothing about our code. Where so many examples do not suffice, the test says so.
settings.register_profile("ours", deadline=None, max_examples=25)
settings.load_profile("ours")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """The long form of a property test takes as long as it takes."""
    if "EV_CASES" in os.environ:
        for item in items:
            item.add_marker(pytest.mark.timeout(0))
