"""The bag of a recorder that was killed is refused with the command that mends it."""

from __future__ import annotations

import pytest

from ev_msgs_py.refusal import ParameterError
from ev_study.measured.records.bags import standard_channels
from ev_study.replay.recorded import find_recorded


@pytest.mark.parametrize(
    ("read", "path"), [(find_recorded, "."), (find_recorded, "bag"), (standard_channels, "bag")]
)
def test_a_bag_without_metadata_is_refused_with_the_command_that_mends_it(read, path, tmp_path):
    (tmp_path / "bag").mkdir()
    (tmp_path / "bag" / "bag.mcap").write_bytes(b"\x89MCAP0\r\n")
    with pytest.raises(ParameterError, match=r"has no metadata\.yaml.*`mcap recover bag\.mcap "):
        read(tmp_path / path)
