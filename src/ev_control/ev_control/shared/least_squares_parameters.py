"""Parameters of the traction control by least squares: the fit's, and how slip is regulated after a hit."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_peak import SlipPeakParameters
from ev_control.estimation.wheel_dynamics import share_at_rest
from ev_control.shared.limp_mode import LimpModeParameters
from ev_core.law import ParameterError, group, parameter


@dataclass(frozen=True, slots=True)
class LeastSquaresParameters(SlipPeakParameters):
    """When the fit counts, and how slip is regulated after a hit; the source gives none of them."""

    backstop: float = parameter(
        0.3,
        unit="1",
        low=0.05,
        high=0.9,
        about="slip that is a hit whatever the fit says: it was too late, or there is no peak, as on ice",
    )
    first_slip: float = parameter(
        0.08,
        unit="1",
        low=0.01,
        high=0.5,
        about="slip that is regulated to where the backstop was the hit, which tells nothing of the peak",
    )
    use: float = parameter(
        1.0,
        unit="1",
        low=0.5,
        high=1.0,
        about="share of the fitted peak that is used after a hit, on its stable side; 1 is the peak itself, less costs "
        "little force and saves much slip",
        source="assumption: the source takes the torque of the step before the peak was passed",
    )
    bandwidth: float = parameter(
        25.0, unit="1/s", low=0.1, high=1000.0, about="rate at which the slip approaches its target"
    )
    road_filter: float = parameter(0.02, unit="s", low=0.0, high=1.0, about="time constant of the road torque")
    hold: float = parameter(0.3, unit="s", low=0.0, high=100.0, about="time for which the target stays after a hit")
    probe: float = parameter(
        1.5,
        unit="1",
        low=0.0,
        high=100.0,
        about="rise of the target after that, over the slowest one whose slips spread enough in a window to be fitted",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the road has to carry the whole request before the limit ends",
    )
    at_rest: float = share_at_rest(0.3)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)

    def __post_init__(self) -> None:
        if max(self.least_slip, self.first_slip) > self.backstop:
            raise ParameterError(f"backstop is {self.backstop:g}, allowed is at least least_slip and first_slip")
