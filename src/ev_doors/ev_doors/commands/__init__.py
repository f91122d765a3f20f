"""Commands of the ways out of the stack."""

COMMANDS = {  # name -> module and function that takes words, and what it does
    "export": (
        "ev_doors.commands.exports:export_library",
        "a car or its laws as a C library: ev-stack export SCENARIO --target TARGET --out DIR",
    ),
    "fmu": (
        "ev_doors.commands.exports:export_fmu",
        (
            "a car or its laws as an FMU (FMI 2.0 or 3.0, co-simulation): ev-stack fmu SCENARIO"
            " --out NAME.fmu"
        ),
    ),
    "dashboard": (
        "ev_doors.commands.dashboard:main",
        "a local page: live signals, the car from above, parameters, time",
    ),
    "visualization": (
        "ev_doors.commands.visualization:visualize",
        "tf, odometry and markers of tyre forces beside a run, for RViz and Foxglove",
    ),
    "bridge": (
        "ev_doors.commands.bridges:bridge",
        "nodes for simulation_interfaces, Autoware, ackermann_msgs: bridge KIND",
    ),
    "security_policies": (
        "ev_doors.commands.security:policies",
        "policies for DDS security, and the running graph against them",
    ),
}
