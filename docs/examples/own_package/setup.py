"""A package with laws of your own: put it beside own_method.py and yaw_moment.py, see docs/own_things.md."""

from setuptools import setup

setup(
    name="own_laws",
    version="0.1.0",
    py_modules=["own_method", "yaw_moment"],
    install_requires=["ev_msgs_py"],
    entry_points={"ev_stack.methods": ["asr = own_method", "electronic_differential = yaw_moment"]},
)
