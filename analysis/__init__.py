"""From result files to figures and tables: one module a stem, run as `python3 -m analysis STEM`."""
