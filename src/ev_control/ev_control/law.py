"""Everything that laws of one kind share: `from ev_control.law import split, ...`.

- traction controls: `traction_control` makes a method of the law of one wheel; its record is a
  `LimitedWheel` with more, what it is given a `WheelMotion`; `ReferenceSpeedParameters` and
  `LimpModeParameters` stand among its parameters
- those that regulate a slip: `SlipRegulatorParameters`, `RegulatedWheel`, `forget_regulation`,
  `stays_out`, `weighed`, `until_served`; by thresholds: `SlipThresholdParameters`
- those that set the speed of a drive: `SpeedSetPointParameters`, `SpeedSetPointWheel`,
  `forget_set_point`, `moved`, `serves_request`
- what is known of a wheel: `slip_of`, `observed_slip`, `slowest_wheel`, `share_at`, `road_torque`
- differentials: `differential` makes a method of a law; `split` gives the wheel torques by the
  driver's and a difference, `split_brake` the brake torques, both with `BrakeSplitParameters`;
  `allocated` keeps to what motors and battery can give, with `AllocationParameters` and the need
  `own_motors_to_allocate`
- first-order filters: `Filtered`, `filter_share`, `follow`, `forget_filtered`
"""

from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_observers import observed_slip
from ev_control.estimation.wheel_dynamics import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    forget_filtered,
    road_torque,
    share_at,
    slip_of,
    slowest_wheel,
)
from ev_control.shared.allocation import AllocationParameters, allocated, own_motors_to_allocate
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.torque_split import BrakeSplitParameters, differential, split, split_brake
from ev_control.shared.traction_control import LimitedWheel, traction_control
from ev_control.shared.wheel_regulation import (
    RegulatedWheel,
    SlipRegulatorParameters,
    SlipThresholdParameters,
    SpeedSetPointParameters,
    SpeedSetPointWheel,
    forget_regulation,
    forget_set_point,
    moved,
    serves_request,
    stays_out,
    until_served,
    weighed,
)

__all__ = [name for name in globals() if not name.startswith("_")]
