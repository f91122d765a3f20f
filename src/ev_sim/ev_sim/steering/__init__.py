"""Steering columns: eq 3 of Shchur (2019) with and without the differential torque, and by wire."""
