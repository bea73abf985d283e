"""Depth images that are made when they are asked for, so that a recording need not fit into memory."""

from collections.abc import Callable, Sequence
from functools import lru_cache
from typing import overload

import numpy as np
from jaxtyping import Float32

Depth = Float32[np.ndarray, "row column"]


class AtHand(Sequence[Depth]):
    """The depth image of every frame; as many as there is `room` for stay in memory, those asked for last."""

    def __init__(self, make: Callable[[int], Depth], count: int, *, room: int = 0) -> None:
        self._count = count
        self._made = lru_cache(room)(make) if room else make

    def __len__(self) -> int:
        return self._count

    @overload
    def __getitem__(self, index: int) -> Depth: ...
    @overload
    def __getitem__(self, index: slice) -> Sequence[Depth]: ...
    def __getitem__(self, index: int | slice) -> Depth | Sequence[Depth]:
        if isinstance(index, slice):
            return [self[number] for number in range(*index.indices(self._count))]
        if not -self._count <= index < self._count:
            raise IndexError(index)
        return self._made(int(index) % self._count)
