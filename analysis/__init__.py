"""Turns result files into figures and tables: one module per stem, run as `python3 -m analysis STEM`."""
