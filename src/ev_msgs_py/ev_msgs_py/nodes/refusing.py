"""Services whose callbacks raise refuse: no request ends a node, and none is done by half."""

from __future__ import annotations

from typing import Any

from rcl_interfaces.msg import SetParametersResult
from rclpy.node import Node
from rclpy.parameter import Parameter
from rclpy.service import Service

from ev_msgs_py.parameters.shown import LINE, shown


class Refusing:
    """The callback of a service; where it raises, the answer says why, as far as its type has a place for that."""

    def __init__(self, service: Service, node: Node) -> None:
        self._callback, self._response, self._logger = service.callback, service.srv_type.Response, node.get_logger()

    def __call__(self, request: Any, response: Any) -> Any:
        """The answer of the callback, or a refusal."""
        try:
            for parameter in getattr(request, "parameters", ()):
                Parameter.from_parameter_msg(parameter)  # before any is set: rclpy finds a type that is none on its way
            return self._callback(request, response)
        except Exception as error:  # whatever it is: others wait for this node
            reason = shown(f"refused: {error}", LINE)
            self._logger.error(reason)
            return self._refusal(request, reason)

    def _refusal(self, request: Any, reason: str) -> Any:
        refused: Any = self._response()
        result = SetParametersResult(successful=False, reason=reason)
        if hasattr(refused, "message"):
            refused.success, refused.message = False, reason
        elif hasattr(request, "parameters"):
            if hasattr(refused, "results"):
                refused.results = [result for _ in request.parameters]
            else:
                refused.result = result
        return refused


def refuse_what_raises(node: Node) -> None:
    """Let all services of a node answer whatever is asked; those that do already stay as they are."""
    for service in node.services:
        if not isinstance(service.callback, Refusing):
            service.callback = Refusing(service, node)
