"""The types of what `__init__.py` imports when it is asked for."""

from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.batch import BatchResult
from ev_stack.interface.driving import batch, run
from ev_stack.interface.simulation import Simulation
from ev_stack.report.result import Result

__version__: str
__all__ = ["BatchResult", "ParameterError", "Result", "SignalError", "Simulation", "batch", "run"]
