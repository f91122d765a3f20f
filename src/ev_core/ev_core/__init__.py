"""The core: how laws are declared, compiled, checked and stepped, in one process or as nodes."""
