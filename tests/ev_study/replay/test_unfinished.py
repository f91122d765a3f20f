"""The bag of a recorder that did not come to its end is refused with the command that mends it."""

from __future__ import annotations

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.bags import standard_channels
from ev_study.replay.recorded import find_recorded

MAGIC = b"\x89MCAP0\r\n"
FILE = "bag/bag.mcap"


@pytest.mark.parametrize("content", [MAGIC, MAGIC + bytes(100)], ids=["empty", "cut off"])
@pytest.mark.parametrize(
    ("read", "path"),
    [
        (find_recorded, "."),
        (find_recorded, "bag"),
        (find_recorded, FILE),
        (standard_channels, "bag"),
        (standard_channels, FILE),
    ],
)
def test_a_bag_without_an_end_is_refused_with_the_command_that_mends_it(
    read, path, content, tmp_path
):
    (tmp_path / "bag").mkdir()
    (tmp_path / FILE).write_bytes(content)
    with pytest.raises(ParameterError, match=r"has no index.*`mcap recover bag\.mcap "):
        read(tmp_path / path)
