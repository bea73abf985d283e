"""A surface that follows a skeleton, and how tubes of rings become faces."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Integer


@dataclass(frozen=True, kw_only=True, eq=False)
class Skin:
    """A surface on a body at rest."""

    vertices: Float[np.ndarray, "vertex 3"]
    """Body axes, metres."""
    faces: Integer[np.ndarray, "face 3"]
    """Vertex numbers of each face's corners, counter-clockwise from outside."""
    weights: Float[np.ndarray, "vertex bone"]
    """How much of each bone's motion each vertex takes; every row sums to one."""


def joined(skins: list[Skin]) -> Skin:
    """The skins as one, in their order."""
    first = np.cumsum([0, *(len(skin.vertices) for skin in skins)])
    return Skin(
        vertices=np.concatenate([skin.vertices for skin in skins]),
        faces=np.concatenate([skin.faces + at for skin, at in zip(skins, first.tolist(), strict=False)]),
        weights=np.concatenate([skin.weights for skin in skins]),
    )


def tube_faces(rings: int, sections: int) -> Integer[np.ndarray, "face 3"]:
    """The faces between rings of vertices, open at both ends.

    Vertex s of ring r has the number `r * sections + s`. Seen from outside they are counter-clockwise where the
    rings go down and their vertices from x to y.
    """
    ring, section = np.divmod(np.arange((rings - 1) * sections), sections)
    here, after = ring * sections + section, ring * sections + (section + 1) % sections
    upper = np.stack([here, here + sections, after], axis=1)
    lower = np.stack([after, here + sections, after + sections], axis=1)
    return np.concatenate([upper, lower])
