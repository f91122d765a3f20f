"""A time of day of its own for one run: a library that is loaded before all others answers who asks for it."""

from __future__ import annotations

import shutil
import struct
import subprocess
from pathlib import Path

from campaign.trial import Skipped

_SOURCE = Path(__file__).with_suffix(".c")


class TimeOfDay:
    """Builds the library in a folder; Skipped where there is no C compiler."""

    def __init__(self, folder: Path) -> None:
        compiler = shutil.which("cc")
        if compiler is None:
            raise Skipped("no C compiler is there for the library that moves the time of day")
        self._library, self._place = folder / "time_of_day.so", folder / "time_of_day"
        subprocess.run(
            [compiler, "-shared", "-fPIC", "-O2", "-o", self._library, _SOURCE], check=True
        )
        self.jump(0)

    @property
    def environment(self) -> dict[str, str]:
        """What a process needs to have this time of day."""
        return {"LD_PRELOAD": str(self._library), "EV_CAMPAIGN_TIME_OF_DAY": str(self._place)}

    def jump(self, seconds: int) -> None:
        """From now on the time of day is so far ahead of that of the machine."""
        with self._place.open("r+b" if self._place.exists() else "wb") as place:
            place.write(struct.pack("=q", seconds))
