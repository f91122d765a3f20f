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
    install_requires=["setuptools"],
    extras_require={"test": ["pytest"]},
    zip_safe=True,
)
