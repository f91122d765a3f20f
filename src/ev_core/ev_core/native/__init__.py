"""Laws in C or C++, as shared libraries behind a C interface without ROS (docs/embedding.md)."""
