"""Logarithmic axes that can show zeros, and their ticks."""

from __future__ import annotations

from typing import Any, Final

import matplotlib.ticker
import numpy as np
import numpy.typing as npt


class LogAxis:
    """A logarithmic vertical axis that shows exact zeros in a separate band below a break.

    Construct it with all values that will be drawn, and draw `place` of each. Values below 1e-250
    are drawn at 1e-250.
    """

    LEAST: Final = 1e-250

    def __init__(self, ax: Any, values: npt.ArrayLike, most_ticks: int = 6) -> None:
        x = np.asarray(values, dtype=np.float64).ravel()
        x = x[np.isfinite(x)]
        positive = np.maximum(x[x > 0], self.LEAST)
        low = int(np.floor(np.log10(positive.min()))) if len(positive) else -1
        high = int(np.ceil(np.log10(positive.max()))) if len(positive) else 0
        high = max(high, low + 1)
        self.has_zeros = bool((x <= 0).any())
        room = 0.075 * (high - low + 1)  # in decades: half the height of the band for zeros
        self._zero = 10.0 ** (low - 2.6 * room)
        ax.set_yscale("log")
        ax.minorticks_off()
        if self.has_zeros and not len(positive):  # only zeros, so no scale
            ax.set_facecolor("#F1F1F1")
            ax.set_yticks([self._zero], ["0"])
            ax.set_ylim(self._zero / 10, self._zero * 10)
            return
        step = max(1, -(-(high - low) // (most_ticks - 1)))
        decades = list(range(high, low - 1, -step))[::-1]
        ticks = [10.0**d for d in decades]
        labels = [f"$10^{{{d}}}$" for d in decades]
        bottom = 10.0 ** (low - 0.7 * room)
        if self.has_zeros:
            ticks, labels, bottom = [self._zero] + ticks, ["0"] + labels, 10.0 ** (low - 3.9 * room)
            edge = 10.0 ** (low - 1.3 * room)
            ax.axhspan(bottom, edge, color="#F1F1F1", linewidth=0, zorder=0)
            ax.axhline(edge, color="white", linewidth=2.5, zorder=0.5)
            for y in (
                10.0 ** (low - 1.15 * room),
                10.0 ** (low - 1.45 * room),
            ):  # the break, drawn on the axis itself
                ax.plot(
                    [-0.02, 0.02],
                    [y, y],
                    transform=ax.get_yaxis_transform(),
                    color="black",
                    linewidth=0.6,
                    clip_on=False,
                    zorder=5,
                )
        ax.set_yticks(ticks, labels)
        ax.set_ylim(bottom, 10.0 ** (high + 0.7 * room))

    def place(self, values: npt.ArrayLike) -> npt.NDArray[np.float64]:
        x = np.asarray(values, dtype=np.float64)
        return np.where(x <= 0, self._zero, np.maximum(x, self.LEAST))


def log_ticks(axis: Any) -> None:
    """Sets ticks at powers of ten, without minor ticks.

    If fewer than two powers are in view, adds ticks at 3 (or 2 and 5) times a power, and writes
    plain numbers.
    """
    low, high = np.log10(sorted(axis.get_view_interval()))
    few = np.floor(high) - np.ceil(low) < 1
    axis.set_minor_locator(matplotlib.ticker.NullLocator())
    between = (1, 2, 5) if high - low < 0.6 else (1, 3)  # more would overlap in a narrow frame
    axis.set_major_locator(matplotlib.ticker.LogLocator(subs=between if few else (1,), numticks=6))
    if few:
        axis.set_major_formatter(
            matplotlib.ticker.FuncFormatter(lambda x, _: f"{x:g}" if x < 1e4 else f"{x:,.0f}")
        )
