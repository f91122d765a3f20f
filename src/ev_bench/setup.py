"""Build and install ev_bench."""

import sys
from xml.etree import ElementTree

from setuptools import find_packages, setup

PACKAGE = ElementTree.parse("package.xml").getroot()
VERSION = PACKAGE.findtext("version")

# What `ros2 run` starts is put into lib/ev_bench by colcon; a wheel would put it on the PATH, under
# these bare names.
NODES = [
    "test_bench = ev_bench.nodes.bench:main",
    "inverter = ev_bench.nodes.inverter:main",
    "inverter_gateway = ev_bench.nodes.gateway:main",
    "can_hub = ev_bench.can_hub:main",
]
IS_COLCON = not {"install", "develop"}.isdisjoint(sys.argv)

setup(
    name="ev_bench",
    version=VERSION,
    description=PACKAGE.findtext("description"),
    maintainer=PACKAGE.findtext("maintainer"),
    maintainer_email=PACKAGE.find("maintainer").get("email"),
    license=PACKAGE.findtext("license"),
    packages=find_packages(exclude=["test"]),
    package_data={"ev_bench": ["py.typed"]},
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_bench"]),
        ("share/ev_bench", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[f"ev_stack=={VERSION}"],
    extras_require={
        "can": [f"ev_msgs_py[can]=={VERSION}", "msgpack", "python-can>=4.6.1"],
        "mf4": ["asammdf>=8.8"],
        "test": ["pytest"],
    },
    zip_safe=True,
    entry_points={
        "console_scripts": NODES if IS_COLCON else [],
        "ev_stack.buses": ["can = ev_bench.runs.can"],
        "ev_stack.metrics": ["ev_bench = ev_bench.runs.metrics"],
        "ev_stack.nodes": NODES,
        "ev_stack.methods": [
            "test_bench = ev_bench.methods.bench",
            "inverter_gateway = ev_bench.methods.gateway",
        ],
    },
)
