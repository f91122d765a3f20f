"""Entry points that setup.py announces exist."""

from importlib.metadata import EntryPoint, distribution

import pytest

ENTRY_POINTS = distribution("ev_bench").entry_points


@pytest.mark.parametrize("entry_point", ENTRY_POINTS, ids=lambda entry_point: entry_point.name)
def test_entry_point_loads(entry_point: EntryPoint):
    entry_point.load()
