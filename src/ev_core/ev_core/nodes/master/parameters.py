"""How time runs, as the parameters of the master of time say."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.methods.common_parameters import CommonParameters
from ev_core.parameters.declaration import setting
from ev_msgs_py.refusal import ParameterError

LONGEST = 1e7  # simulated time of a run [s]; a stamp holds 2e9
RECORDER_LAG = 200  # steps that the recorder may be behind; less than topics.QUEUE_DEPTH


@dataclass(frozen=True, slots=True)
class MasterParameters:
    """How time runs."""

    real_time_factor: float = setting(
        0.0, unit="1", low=0.0, high=1000.0, about="simulated over wall time in lockstep, at most; 0: no limit"
    )
    duration: float = setting(
        0.0, unit="s", low=0.0, high=LONGEST, about="the node ends at this time; 0: never", read_only=True
    )
    command_timeout: float = setting(
        0.1, unit="s", low=0.001, high=60.0, about="realtime: age of a torque command at which no torque is left of it"
    )
    command_ramp: float = setting(
        0.02, unit="s", low=0.0, high=60.0, about="realtime: time before that over which its torque falls to zero"
    )
    command_loss_brake_torque: float = setting(
        0.0, unit="N m", low=0.0, high=10000.0, about="realtime: at each wheel in place of what is lost; 0: it coasts"
    )
    answer_timeout: float = setting(
        2.0, unit="s", low=0.1, high=3600.0, about="wall time without an answer after which the silent nodes are named"
    )
    await_recorder: bool = setting(
        False, about=f"stay within {RECORDER_LAG} steps of the recorder, so that it misses nothing", read_only=True
    )

    def refuse_beside(self, common: CommonParameters) -> None:
        """ParameterError if they do not fit to those that every node has."""
        if common.mode == "realtime" and self.command_timeout <= 2.0 * common.control_period:
            allowed = f"more than two control periods, {2.0 * common.control_period:g} s"
            name = "command_timeout"
            raise ParameterError(f"parameter {name}: {self.command_timeout:g} is refused, allowed is {allowed}", name)
