"""Build and install ev_msgs_py."""

from setuptools import find_packages, setup

setup(
    name="ev_msgs_py",
    version="0.1.0",
    description="The interface of the nodes: signals, topics, roles, frames, wire format, CAN frames.",
    maintainer="EV Control Stack maintainers",
    maintainer_email="maintainers@ev-control-stack.org",
    license="Apache-2.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_msgs_py"]),
        ("share/ev_msgs_py", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=["numpy>=1.26.4"],
    extras_require={"can": ["cantools>=45.1"]},
    zip_safe=True,
)
