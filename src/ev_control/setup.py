"""Build and install ev_control."""

from setuptools import find_packages, setup

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
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
    entry_points={
        "console_scripts": [
            "electronic_differential = ev_control.nodes.electronic_differential:main",
            "asr = ev_control.nodes.asr:main",
            "inverter_gateway = ev_control.nodes.inverter_gateway:main",
        ],
        "ev_stack.methods": [
            "electronic_differential = ev_control.methods.electronic_differential",
            "asr = ev_control.methods.asr",
            "inverter_gateway = ev_control.methods.inverter_gateway",
        ],
    },
)
