"""The graph, declared once: what each node reads and writes.

The offline runner orders the roles by this table, the nodes make their publishers and subscriptions
from it, and the graph in docs/topics.md is drawn from it.
"""

from dataclasses import dataclass
from enum import Enum
from itertools import chain

from ev_msgs_py.contract import optional_signals as optional
from ev_msgs_py.contract import signals

# In the order of publishing: first the inputs of the driver, with which every step begins.
_BODY = (
    signals.WheelStates,
    signals.BodyVelocity,
    signals.BodyPose,
    signals.InertialMeasurement,
    signals.MotorStates,
    signals.BatteryCondition,
)
_ELECTRICAL = (optional.MotorElectrics, optional.MotorTemperatures, optional.CellCondition)
# The test sequence of the bench, in order: first the object of control is chosen.
BENCH_SERVICES = (
    "choose_both",
    "choose_right",
    "choose_left",
    "connect",
    "load_model",
    "start",
    "siemens_rev_0",
    "disconnect",
    "emergency_stop",
)
MASTER = "plant"
RECORDER = "recorder"  # a node that plays no role
RECORDER_WRITES = signals.RecorderProgress


class RoleKind(Enum):
    """Dependence of the output of a role for the instant t_k on what it reads."""

    ANSWERS = "its output at t_k follows at once from what it reads at t_k"
    INTEGRATES = "its output at t_k follows from what it read up to t_k-1; it has an initial state"


@dataclass(frozen=True, slots=True)
class Role:
    """Signals that a node reads and writes.

    `default_method` plays the role where no parameter names another; a role that is `optional` is
    played only where a parameter chooses its method. A method reads only what it uses, and a plant
    model writes only what it can know (`writes` is what it may write). What a role `offers` is
    written only by methods that declare it. Its `services` are std_srvs/Trigger, below the name of
    its node.
    """

    name: str
    kind: RoleKind
    reads: tuple[type, ...]
    writes: tuple[type, ...]
    default_method: str
    optional: bool = False
    offers: tuple[type, ...] = ()
    services: tuple[str, ...] = ()

    @property
    def may_write(self) -> tuple[type, ...]:
        """All that a method of this role may write."""
        return (*self.writes, *self.offers)


ROLES = {
    role.name: role
    for role in (
        Role(
            "plant",
            RoleKind.INTEGRATES,
            reads=(
                signals.WheelTorqueCommand,
                signals.SteeringColumnState,
                optional.WheelSpeedCommand,
                optional.RearSteeringState,
                optional.BenchShafts,
                optional.BenchElectrical,
            ),
            writes=(
                *_BODY,
                signals.TireForces,
                *_ELECTRICAL,
                optional.BodyRoll,
                optional.LoadCommand,
            ),
            default_method="kinematic",
        ),
        Role(
            "steering_column",
            RoleKind.INTEGRATES,
            reads=(
                signals.DriverCommand,
                signals.WheelStates,
                signals.TireForces,
                signals.BodyVelocity,
            ),
            writes=(signals.SteeringColumnState,),
            default_method="powered",
        ),
        Role(
            "rear_steering",
            RoleKind.INTEGRATES,
            reads=(signals.SteeringColumnState, signals.BodyVelocity, signals.TireForces),
            writes=(optional.RearSteeringState,),
            default_method="speed_dependent",
            optional=True,
        ),
        Role(
            "test_bench",
            RoleKind.INTEGRATES,
            reads=(
                signals.WheelTorqueCommand,
                optional.SetPointFrames,
                optional.LoadCommand,
                signals.BatteryCondition,
            ),
            writes=(
                optional.BenchShafts,
                optional.BenchElectrical,
                optional.BenchTemperatures,
                optional.BenchEnergy,
                optional.FeedbackFrames,
                optional.BusStates,
                optional.BenchCoolant,
                optional.BatteryCoolant,
            ),
            default_method="circuits",
            optional=True,
            services=BENCH_SERVICES,
        ),
        Role(
            "driver",
            RoleKind.ANSWERS,
            reads=(
                signals.BodyVelocity,
                signals.SteeringColumnState,
                signals.BodyPose,
                signals.InertialMeasurement,
                signals.WheelStates,
            ),
            writes=(signals.DriverCommand,),
            default_method="speed_profile",
        ),
        Role(
            "electronic_differential",
            RoleKind.ANSWERS,
            reads=(signals.DriverCommand, signals.SteeringColumnState, *_BODY, signals.TireForces),
            writes=(signals.WheelTorqueRequest,),
            default_method="equal_torque",
        ),
        Role(
            "asr",
            RoleKind.ANSWERS,
            reads=(signals.WheelTorqueRequest, signals.SteeringColumnState, *_BODY),
            writes=(signals.WheelTorqueCommand,),
            default_method="off",
            offers=(optional.WheelSpeedCommand,),
        ),
        Role(
            "inverter_gateway",
            RoleKind.ANSWERS,
            reads=(
                signals.WheelTorqueCommand,
                optional.LoadCommand,
                optional.FeedbackFrames,
                optional.BenchShafts,
            ),
            writes=(optional.SetPointFrames,),
            default_method="can",
            optional=True,
        ),
    )
}

REQUIRED = tuple(name for name, role in ROLES.items() if not role.optional)

_INTEGRATING = [role for role in ROLES.values() if role.kind is RoleKind.INTEGRATES]
INTEGRATED = frozenset(chain.from_iterable(role.writes for role in _INTEGRATING))
_OFFERED = chain.from_iterable(role.offers for role in ROLES.values())
_WRITTEN = chain.from_iterable(role.writes for role in ROLES.values())
_ALL = (*_OFFERED, *_WRITTEN)
_ALWAYS = [ROLES[name] for name in REQUIRED]
_ALWAYS_WRITTEN = set(chain.from_iterable(role.writes for role in _ALWAYS))
_ALWAYS_READ = set(chain.from_iterable(role.reads for role in _ALWAYS))
# Signals that no role that is always played writes, or none reads. They come last in a frame: one
# without them is as short as if they did not exist.
EXTRA = frozenset(_ALL) - (_ALWAYS_WRITTEN & _ALWAYS_READ)
RECORDED = tuple(sorted(_ALL, key=lambda signal: signal in EXTRA))
