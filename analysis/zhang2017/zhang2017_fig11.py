"""Figure 11 of Zhang et al. 2017: a gear moved and turned through another."""

from __future__ import annotations

import sys
from pathlib import Path

from analysis.shared import command
from analysis.zhang2017 import zhang_motion
from analysis.shared.load import Results

STEM = "zhang2017_fig11"


def make(results: Results, out: Path) -> list[Path]:
    caption = "A gear moved and turned through one of another shape and size (Fig. 11 of Zhang et al. 2017)."
    return zhang_motion.make(STEM, caption, results, out)


if __name__ == "__main__":
    sys.exit(command.main(STEM, make))
