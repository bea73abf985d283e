"""The colours of all pictures and pages, as text and as bytes."""

import numpy as np
from jaxtyping import Int, UInt8

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#F0E442", "#000000")
"""Okabe and Ito's palette, which colour-blind people can tell apart."""
FAINT = "#BBBBBB"
"""What belongs to nothing, or stands behind."""
TRUTH = "#999999"
DEPTH = "viridis_r"
"""Colours of depth, by matplotlib's name: near is light."""


def colours_of(number: Int[np.ndarray, "number"]) -> np.ndarray:
    """The colours of motions or segments, by turns; noise, which has a negative number, is faint."""
    return np.array([*COLOURS, FAINT])[_turn(number)]


def colour_of(number: int) -> str:
    """The colour of one motion or segment."""
    return str(colours_of(np.array([number]))[0])


def rgb(colour: str) -> UInt8[np.ndarray, "3"]:
    """Red, green and blue, 0 to 255, of a colour that is written as `#RRGGBB`."""
    return np.frombuffer(bytes.fromhex(colour.removeprefix("#")), np.uint8)


def rgb_of(number: Int[np.ndarray, "number"]) -> UInt8[np.ndarray, "number 3"]:
    """Red, green and blue of the colours of motions or segments, as `colours_of` has them."""
    return np.stack([rgb(colour) for colour in (*COLOURS, FAINT)])[_turn(number)]


def _turn(number: Int[np.ndarray, "number"]) -> Int[np.ndarray, "number"]:
    return np.where(number < 0, len(COLOURS), number % len(COLOURS))
