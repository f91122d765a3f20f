"""Shchur (2019): electric power steering by the torque difference of the front drives."""
