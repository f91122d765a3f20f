"""What the machine does to a run: no time, no room, no memory to share, no descriptors, other clocks, another run."""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys

from campaign.moments import MOVING, Moment, drawn
from campaign.time_of_day import TimeOfDay
from campaign.trial import RUNNER, Skipped, Trial
from campaign.under_way import PATIENCE, ROOT, UnderWay

_OWN_MOUNTS = "EV_CAMPAIGN_OWN_MOUNTS"  # set by scripts/campaign.sh inside a name space of its own
_BUSY_AT_MOST = 30.0  # s


def busy(trial: Trial) -> None:
    """As many processes as cores that do nothing but compute."""

    def disturb(run: UnderWay) -> None:
        text = (
            f"import time; end = time.monotonic() + {_BUSY_AT_MOST}\nwhile time.monotonic() < end:"
            " pass"
        )
        hogs = [
            subprocess.Popen([sys.executable, "-c", text], env=run.environment)
            for _ in range(os.cpu_count() or 1)
        ]
        run.wait_until(lambda: False, _BUSY_AT_MOST)
        for hog in hogs:
            hog.kill()
            hog.wait()

    trial.disturb = disturb
    trial.about = f"{os.cpu_count()} cores"


def full_disk(trial: Trial) -> None:
    """The output folder on a disk of few kilobytes."""
    if _OWN_MOUNTS not in os.environ:
        raise Skipped("no name space for mounts is granted: no small disk")
    size = int(10 ** trial.chance.uniform(0.7, 3.5))
    trial.about = f"{size} kB"
    trial.out.mkdir()
    mounted = subprocess.run(
        ["mount", "-t", "tmpfs", "-o", f"size={size}k", "none", trial.out], capture_output=True
    )
    if mounted.returncode:
        raise Skipped("mount of a tmpfs is not granted: no small disk")
    trial.clean_up.callback(subprocess.run, ["umount", "--lazy", trial.out], check=False)
    trial.from_the_start = True
    trial.names = "No space left on device|no space left on device|Disk quota"


def file_size(trial: Trial) -> None:
    """No file may grow beyond some kilobytes."""
    size = int(10 ** trial.chance.uniform(0.3, 3.3))
    trial.about = f"{size} kB"
    trial.limits[resource.RLIMIT_FSIZE] = size * 1024
    trial.environment["PYTHONDONTWRITEBYTECODE"] = "1"
    trial.from_the_start = True
    trial.names = "File too large|file size"


def few_descriptors(trial: Trial) -> None:
    """So few open files that something cannot be opened."""
    most = trial.chance.randrange(20, 80)
    trial.about = str(most)
    trial.from_the_start = True
    trial.names = (
        "[Tt]oo many open files|file descriptors|cannot be started|participant|ended with status"
    )
    trial.limits[resource.RLIMIT_NOFILE] = most


def no_shared_memory(trial: Trial) -> None:
    """A /dev/shm that cannot be written, or that is full."""
    if _OWN_MOUNTS not in os.environ:
        raise Skipped("no name space for mounts is granted: /dev/shm stays")
    how = trial.chance.choice(("ro,size=4k", "size=4k"))
    trial.about = how
    trial.from_the_start = True
    trial.names = "/dev/shm is full"
    trial.before = [
        "unshare",
        "--mount",
        "sh",
        "-c",
        f'mount -t tmpfs -o {how} none /dev/shm && exec "$0" "$@"',
    ]


def other_clock(trial: Trial) -> None:
    """The monotonic clock of the whole run, or of one node, is days or years away from that of the machine."""
    seconds = trial.chance.choice((100_000, 10**7, 10**9))
    clock = [
        "unshare",
        "--time",
        "--fork",
        "--kill-child",
        "--monotonic",
        str(seconds),
        "--boottime",
        str(seconds),
    ]
    if subprocess.run([*clock, "true"], capture_output=True).returncode:
        raise Skipped("no name space for time is granted: the monotonic clock stays")
    if trial.way == "in one process" or trial.chance.random() < 0.5:
        trial.before = clock
        trial.about = f"the run is {seconds} s ahead"
        return
    role = trial.chance.choice(list(trial.run.configurations))
    own = next((ROOT / "install").glob(f"*/lib/*/{role}"))
    trial.words += ["--node", f"{role}={' '.join(clock)} {own}"]
    trial.about = f"{role} is {seconds} s ahead"


def wall_clock(trial: Trial) -> None:
    """The time of day of the whole run jumps by a second to years, ahead or back, and later to where it was.

    Not beyond 2038: Fast DDS can send nothing then, which is refused by name where a run starts.
    """
    time_of_day = TimeOfDay(trial.folder)
    trial.environment |= time_of_day.environment
    sign = trial.chance.choice((1, -1))
    seconds = sign * trial.chance.choice((1, 3600, 10**6, 10**9 if sign < 0 else 3 * 10**8))
    moment = drawn(trial.chance, trial.way, trial.duration, False)
    back = trial.chance.uniform(0.0, 1.0)
    trial.about = f"by {seconds} s, {moment}, and back after {back:.2f} s"

    def disturb(run: UnderWay) -> None:
        if moment.wait(run, RUNNER) is not None:
            time_of_day.jump(seconds)
            run.wait_until(lambda: False, back)
            time_of_day.jump(0)

    trial.disturb = disturb


def rival(trial: Trial) -> None:
    """A second run wants the folder of the first one, which goes on, and is refused in one line."""
    moment = Moment(MOVING, trial.chance.uniform(0.0, 0.2))
    trial.about = f"{moment}"

    def disturb(run: UnderWay) -> None:
        if moment.wait(run, RUNNER) is None:
            return
        words = [
            ROOT / "scripts" / "run.sh",
            "coast_down",
            "--offline",
            "--duration",
            "0.1",
            "--out",
            trial.out,
        ]
        second = subprocess.run(
            words, env=run.environment, capture_output=True, text=True, timeout=PATIENCE
        )
        refused = second.returncode == 1 and re.search(
            "expected a new or an empty folder", second.stderr
        )
        if not refused:
            run.remark = (
                f"the second run was not refused: {second.returncode}"
                f" {second.stderr.strip()[-200:]}"
            )

    trial.disturb = disturb
