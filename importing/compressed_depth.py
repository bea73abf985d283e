"""Depth images as ROS's `compressed_depth_image_transport` packs them into `sensor_msgs/CompressedImage`.

The format says "16UC1; compressedDepth png", older ones no more than "16UC1; compressedDepth". The data are 12 bytes,
an enumeration and two numbers a and b in single precision, then a PNG of 16 bits. Of 16UC1 these are the numbers
themselves; of 32FC1 inverse depths v = a / z + b rounded down, so that z = a / (v - b), and 0 is no return.
"""

import struct
from io import BytesIO

import numpy as np

from importing.png import png_numbers
from recording.errors import InputError

MARK = "compressedDepth"
"""Stands in the format of all of them."""
_HEAD = struct.Struct("<iff")


def unpacked(format_: str, data: np.ndarray, *, source: str) -> np.ndarray:
    """The numbers of a message: whole ones of 16UC1, metres of 32FC1, 0 for no return."""
    encoding, _, packing = (part.strip() for part in format_.partition(";"))
    if packing not in (MARK, f"{MARK} png"):
        raise InputError(
            f"{source}: expected '16UC1; {MARK} png' or '32FC1; {MARK} png', got {format_!r}: import the topic of raw "
            "images, or record with the publisher's format set to png"
        )
    if encoding not in ("16UC1", "mono16", "32FC1"):
        raise InputError(f"{source}: expected depth of 16UC1 or 32FC1, got {encoding!r}")
    content = np.asarray(data, np.uint8).tobytes()
    numbers = png_numbers(BytesIO(content[_HEAD.size :]), source=f"{source}, after 12 bytes")
    if numbers.ndim != 2 or numbers.dtype != np.uint16:
        raise InputError(f"{source}: expected a PNG of 16 bits and one channel, got {numbers.dtype}")
    if encoding != "32FC1":
        return numbers
    _, a, b = _HEAD.unpack_from(content)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        depth = np.float32(a) / (numbers.astype(np.float32) - np.float32(b))
    return np.where(numbers > 0, depth, np.float32(0))
