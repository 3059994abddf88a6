"""The fixtures of these tests. They are in program.py, beside what tests import: several folders
have a module named conftest."""

from program import experiment, hausbench, outside, plugin, program_file, raised, tetrahedron

__all__ = ["experiment", "hausbench", "outside", "plugin", "program_file", "raised", "tetrahedron"]
