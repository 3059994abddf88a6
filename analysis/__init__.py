"""Turns result files into figures and tables: one module per stem (the name of an experiment), run
as `python3 -m analysis STEM`."""
