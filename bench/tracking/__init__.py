"""Detects slowdowns: `hausbench track`, and the history of timings. CONTRIBUTING.md says what to do
when it is red.

cases.py      what is tracked: the cases of experiments/tracking.toml, and kernels
blocks.py     a block: one fresh process that measures a case or all kernels
builds.py     builds the program of an older commit beside this one
counted.py    tiers 1 and 2: work counters and instructions against baseline.toml
gate.py       tier 3, arithmetic: the verdict on blocks of base and candidate; pure functions
timed.py      tier 3, measurement: pairs of blocks
places.py     puts both sides of a pair under paths of the same length
together.py   runs both blocks of a pair at the same time on one core
track.py      the three tiers, the verdict and the exit code
history.py    results/history.csv: past commits, measured in turn; the report draws it
bisection.py  finds the commit that changed the counters or the instructions of a case
progress.py   shows the progress of a long measurement
"""
