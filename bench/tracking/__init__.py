"""Has anything become slower? `hausbench track`, and the history of timings. CONTRIBUTING.md says what to do when it is red.

cases.py      what is tracked: the cases of experiments/tracking.toml, and kernels
blocks.py     one fresh process that measures one of them
builds.py     the program of an older commit, built beside this one
counted.py    tiers 1 and 2: work counters and instructions against baseline.toml
gate.py       tier 3, its arithmetic: what blocks of base and candidate say; pure functions
timed.py      tier 3, its measuring: pairs of blocks
places.py     where both sides of a pair lie: under paths of one length
together.py   both blocks of a pair at the same time, on one core
track.py      the three tiers, the verdict and the exit code
trials.py     whether the gate is to be believed: its verdicts on builds of which the answer is known
history.py    results/history.csv: past commits, measured in turn; steps.py finds steps in it, picture.py draws it
bisection.py  the commit that changed the counters or the instructions of a case
versions.py   preparing and solving now and at an older commit, for the table of the kernels
progress.py   how far a long measurement is
"""
