"""The planar plant: body in the plane, four wheels on real tyres, drives, driveline and battery."""
