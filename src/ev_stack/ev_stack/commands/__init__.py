"""Commands of the command line: one module for each group."""

COMMANDS = {  # name -> module and function that takes words, and what it does
    "run": (
        "ev_stack.commands.run_scenario:main",
        "drive a scenario, a study or a review: ev-stack run SCENARIO; --help lists the options",
    ),
    "list": (
        "ev_stack.commands.run_scenario:list_all",
        "scenarios, studies and methods, one line each",
    ),
    "schema": (
        "ev_stack.commands.descriptions:print_schema",
        "JSON Schema of scenario, vehicle and parameter files, for editors",
    ),
    "urdf": (
        "ev_stack.commands.descriptions:print_urdf",
        "a car as URDF, for RViz and Foxglove: ev-stack urdf VEHICLE",
    ),
    "parameters": (
        "ev_stack.commands.descriptions:write_parameters",
        "all parameters of the nodes of a run, as files, and how they start",
    ),
    "header": (
        "ev_stack.commands.descriptions:print_header",
        "ev_laws.h, the interface of laws in C and C++",
    ),
    "compile": (
        "ev_stack.commands.compiling:main",
        "compile all methods, or those of scenarios, so that no run has to wait",
    ),
    "node": ("ev_stack.commands.live_graph:node", "nodes of a running graph: node list, info NODE"),
    "param": (
        "ev_stack.commands.shell:param",
        "parameters of running nodes: get NODE [NAME], set NODE NAME VALUE, list, describe, dump",
    ),
    "pause": ("ev_stack.commands.shell:pause", "let the time of a running graph stand still"),
    "resume": ("ev_stack.commands.shell:resume", "let it go on"),
    "step": ("ev_stack.commands.shell:step", "let one step pass, or N, and stand still"),
    "reset": ("ev_stack.commands.shell:reset", "restart at time zero"),
    "topic": (
        "ev_stack.commands.live_graph:topic",
        "topics of a running graph: topic list, echo NAME, hz NAME, info NAME",
    ),
    "inspect": (
        "ev_stack.commands.live_graph:inspect",
        "show the running graph: nodes, topics, rates",
    ),
}

REVIEWS = {  # of ev-stack run
    "report": (
        "ev_stack.commands.report:run_report",
        (
            "one page about the folders of several runs of scenarios, side by side with their"
            " differences"
        ),
    ),
}
