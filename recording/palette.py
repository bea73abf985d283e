"""The colours of all pictures and pages."""

import numpy as np
from jaxtyping import Int

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""
FAINT = "#BBBBBB"
"""What belongs to nothing, or stands behind."""
TRUTH = "#999999"
DEPTH = "viridis_r"
"""Colours of depth, by matplotlib's name: near is light."""


def colours_of(number: Int[np.ndarray, "number"]) -> np.ndarray:
    """The colours of motions or segments, by turns; noise, which has a negative number, is faint."""
    palette = np.array([*COLOURS, FAINT])
    return palette[np.where(number < 0, len(COLOURS), number % len(COLOURS))]


def colour_of(number: int) -> str:
    """The colour of one motion or segment."""
    return str(colours_of(np.array([number]))[0])
