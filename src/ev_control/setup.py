"""Build and install ev_control."""

import sys

from setuptools import find_packages, setup

# What `ros2 run` starts is put into lib/ev_control by colcon; a wheel would put it on the PATH, under these bare names.
NODES = [
    "electronic_differential = ev_control.nodes:main",
    "asr = ev_control.nodes:main",
    "inverter_gateway = ev_control.inverter_gateway.node:main",
]
IS_COLCON = not {"install", "develop"}.isdisjoint(sys.argv)

setup(
    name="ev_control",
    version="0.1.0",
    description="Control laws: electronic differential, power steering, torque vectoring, anti-slip regulation.",
    maintainer="EV Control Stack maintainers",
    maintainer_email="maintainers@ev-control-stack.org",
    license="Apache-2.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_control"]),
        ("share/ev_control", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=["ev_core==0.1.0", "numpy>=1.26.4"],
    zip_safe=True,
    entry_points={
        "console_scripts": NODES if IS_COLCON else [],
        "ev_stack.nodes": NODES,
        "ev_stack.methods": [
            "electronic_differential = ev_control.methods.electronic_differential",
            "asr = ev_control.methods.asr",
            "inverter_gateway = ev_control.methods.inverter_gateway",
        ],
    },
)
