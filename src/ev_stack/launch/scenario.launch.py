"""ros2 launch ev_stack scenario.launch.py scenario:=shchur2019 options:="--set driver.seed=2" rviz:=true."""

import json
import shlex
import subprocess
from pathlib import Path

from ament_index_python.packages import get_package_prefix
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, OpaqueFunction, Shutdown
from launch.conditions import IfCondition
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node

ARGUMENTS = {
    "scenario": ("shchur2019", "name or path of a scenario"),
    "options": (
        "",
        "what `ev-stack parameters --help` knows besides: --run, --method, --set, --realtime ...",
    ),
    "out": ("", "new or empty folder for bag and signals; default results/SCENARIO/TIME"),
    "rviz": ("false", "whether RViz shows the car"),
}


def generate_launch_description():
    """The nodes of one run.

    The recorder ends when it holds the whole run, and everything with it.
    """
    declared = [DeclareLaunchArgument(name, default_value=value, description=about)
                for name, (value, about) in ARGUMENTS.items()]  # fmt: skip
    return LaunchDescription([*declared, OpaqueFunction(function=nodes_of_run)])


def nodes_of_run(context):
    """The output of `ev-stack parameters`, as actions."""
    scenario, options, out = (
        LaunchConfiguration(name).perform(context) for name in ("scenario", "options", "out")
    )  # fmt: skip
    program = Path(get_package_prefix("ev_stack"), "lib", "ev_stack", "ev-stack")
    words = [str(program), "parameters", scenario, *shlex.split(options)]
    words += ["--out", out] if out else []
    graph = json.loads(subprocess.check_output(words, text=True))
    shown = IfCondition(LaunchConfiguration("rviz"))
    nodes = [
        Node(
            **node,
            namespace=graph["namespace"],
            parameters=[graph["parameters"]],
            on_exit=Shutdown() if node["executable"] == "recorder" else None,
        )
        for node in graph["nodes"]
    ]
    view = {"package": "ev_stack", "executable": "ev-stack", "arguments": ["visualization"]}
    return [
        *nodes,
        Node(**view, namespace=graph["namespace"], condition=shown),
        Node(package="rviz2", executable="rviz2", arguments=["-d", graph["rviz"]], condition=shown),
    ]
