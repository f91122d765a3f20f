"""Build and install ev_msgs_py."""

from setuptools import find_packages, setup

setup(
    name="ev_msgs_py",
    version="0.1.0",
    description="The contract between the nodes: signals, topics, vehicle, parameters, the stepped node.",
    maintainer="EV Control Stack maintainers",
    maintainer_email="maintainers@ev-control-stack.org",
    license="Apache-2.0",
    packages=find_packages(exclude=["test"]),
    data_files=[
        ("share/ament_index/resource_index/packages", ["resource/ev_msgs_py"]),
        ("share/ev_msgs_py", ["package.xml"]),
    ],
    python_requires=">=3.11",
    install_requires=[
        "numba==0.68.*",  # and with it llvmlite, whose version decides the last bit of a result
        "numpy>=1.26.4",
    ],
    extras_require={"can": ["cantools>=45.1", "msgpack", "python-can>=4.6.1"], "mf4": ["asammdf>=8.8"]},
    zip_safe=True,
)
