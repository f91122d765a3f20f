"""Where the recorded signals of a run are found: in a bag, or in signals.npz, with the parameters beside it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from ev_core.parameters.data_file import RecordingError
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import RECORDED
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError
from ev_sim.recording import files_of_run
from ev_sim.recording.recording import load
from ev_sim.replay.bag import read_bag
from ev_sim.replay.recorded import Recorded, refuse_short
from ev_sim.scenarios.parameter_file import ParameterFile
from ev_sim.scenarios.scenario import NAMESPACE

_METADATA = "metadata.yaml"


def find_recorded(path: Path, namespace: str = "") -> Recorded:
    """What a folder of a run, a bag or a file of signals holds.

    `namespace` is that of the topics, where a bag has several. ParameterError, in one line, if nothing can be read.
    """
    storage, folder = _found(path)
    parameters = folder / files_of_run.PARAMETERS
    told = ParameterFile(parameters) if parameters.exists() else None
    if storage.name.endswith(".npz"):
        return _of_signals(storage, told)
    return read_bag(storage, namespace, told)


def _found(path: Path) -> tuple[Path, Path]:
    """The bag or file of signals that a path means, and the folder of the run."""
    if path.is_dir():
        if (path / _METADATA).exists():
            return path, path.parent
        if (path / files_of_run.BAG / _METADATA).exists():
            return path / files_of_run.BAG, path
        if (path / files_of_run.SIGNALS).exists():
            return path / files_of_run.SIGNALS, path
        below = sorted(each.name for each in path.iterdir() if (each / files_of_run.BAG).is_dir() or (each / files_of_run.SIGNALS).exists())
        if below:
            raise ParameterError(f"{path} has several runs, allowed is one: {', '.join(str(path / b) for b in below)}")
    elif path.suffix in (".mcap", ".db3"):
        bag = path.parent / _METADATA
        return path, path.parent.parent if bag.exists() else path.parent
    elif path.suffix == ".npz":
        return path, path.parent
    if not path.exists():
        raise ParameterError(f"{path}: no such bag")
    raise ParameterError(f"{path} is no recorded run: neither a bag (metadata.yaml, .mcap, .db3) nor signals.npz")


def _of_signals(file: Path, told: ParameterFile | None) -> Recorded:
    try:
        recording = load(file)
    except RecordingError as error:
        raise ParameterError(str(error)) from None
    except OSError as error:
        raise ParameterError(f"{file}: {error.strerror}") from None
    steps = np.rint(recording.time * stamps.NANOSECONDS).astype(np.int64)
    refuse_short(file, len(steps))
    period = int(steps[1])
    if period <= 0 or not np.array_equal(steps, np.arange(len(steps)) * period):
        raise ParameterError(f"{file}: its instants are not those of a control period from time zero on")
    topics = [TOPICS[signal] for signal in RECORDED if set(TOPICS[signal].channels) <= set(recording.channels)]
    there = np.ones(len(steps), bool)
    return Recorded(file, namespace_of(told), period, recording, dict.fromkeys(topics, there), parameters=told)


def namespace_of(told: ParameterFile | None) -> str:
    """That of the nodes which a parameter file tells something."""
    sections: Sequence[str] = list(told.sections) if told else []
    return sections[0].rpartition("/")[0] if sections else NAMESPACE
