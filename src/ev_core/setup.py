"""Build and install ev_core."""

from setuptools import find_packages, setup

setup(
    name="ev_core",
    version="0.1.0",
    description="The core: how laws are declared, compiled, checked and stepped, in one process or as nodes.",
    maintainer="EV Control Stack maintainers",
    maintainer_email="maintainers@ev-control-stack.org",
    license="Apache-2.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_core"]),
        ("share/ev_core", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[
        "ev_msgs_py==0.1.0",
        "numba==0.68.*",  # and with it llvmlite, whose version decides the last bit of a result
        "numpy>=1.26.4",
    ],
    extras_require={"can": ["ev_msgs_py[can]==0.1.0", "msgpack", "python-can>=4.6.1"], "mf4": ["asammdf>=8.8"]},
    zip_safe=True,
)
