"""The numbers of a PNG, by Pillow: OpenCV's reader prints what it finds wrong, and errors are one line here."""

import warnings
from io import BytesIO
from pathlib import Path

import numpy as np
from PIL import Image, UnidentifiedImageError

from recording.errors import DAMAGED, InputError

LARGEST_PIXELS = 2**26
"""No depth camera has more; a file that promises more is damaged, or means harm."""


def png_numbers(file: Path | BytesIO, *, source: str) -> np.ndarray:
    """The numbers (row, column), or with the channels of each pixel; those of a palette are places in it."""
    huge = InputError(f"{source}: expected a depth image, got one of more than {LARGEST_PIXELS} pixels")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", Image.DecompressionBombWarning)  # Our own bound is lower.
            image = Image.open(file, formats=("PNG",))
        with image:
            if image.width * image.height > LARGEST_PIXELS:
                raise huge
            return np.asarray(image.convert("L") if image.mode == "1" else image)
    except Image.DecompressionBombError:
        raise huge from None
    except DAMAGED as error:
        if isinstance(error, InputError):
            raise
        unknown = isinstance(error, UnidentifiedImageError)  # Its words are the file's name.
        reason = "it has no head of one" if unknown else " ".join(str(error).split())[:200] or type(error).__name__
        raise InputError(f"{source}: expected a PNG, but it cannot be read: {reason}") from None
