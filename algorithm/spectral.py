"""Step 6: segments by spectral clustering of the affinities (paper, section 4, Motion segmentation)."""

import logging
import warnings
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Literal

import numpy as np
from jaxtyping import Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import eigsh
from sklearn.cluster import SpectralClustering

_DENSE_BELOW = 64
"""Nodes up to which all eigenvalues are computed at once; iterating for a few of so few does not pay."""
_NODES_PER_PIECE = 5
"""LOBPCG, which AMG preconditions, does not work for more eigenvectors than this allows (scikit-learn)."""
_TOLERANCE = 1e-4
"""Of the eigenvalues; between them lie hundredths."""

Spectrum = Float[np.ndarray, "_eigenvalue"]
Labels = Int[np.ndarray, "_node"]
_log = logging.getLogger(__name__)


def spectral_segments(affinity: sparse.csr_array, *, smallest: float, most: int, count: int = 0) -> Labels:
    """The segment of every node; -1 in connected components of fewer than `smallest` nodes.

    `count` segments, or without a count as many as the largest gap between the sorted eigenvalues of the
    normalised Laplacian says, `most` at the most. The connected components come first: they are what the
    eigenvalues of 0 stand for, and each is a segment at the least. Each is then cut into as many segments
    as it has eigenvalues among the lowest of all, with cluster_qr [Damle, Minden, Ying, 2019].
    """
    label = np.full(affinity.shape[0], -1)
    members = [nodes for nodes in connected(affinity) if len(nodes) >= smallest]
    parts = [affinity[nodes][:, nodes] for nodes in members]
    cuts = max((count or most) - len(parts), 0)
    spectra = [lowest_eigenvalues(part, count=cuts + 2) for part in parts]
    found = 0
    for nodes, part, pieces in zip(members, parts, _pieces(spectra, cuts, by_gap=not count), strict=True):
        label[nodes] = found + _cut(part, pieces)
        found = int(label[nodes].max()) + 1
    return label


def connected(affinity: sparse.csr_array) -> Iterator[Int[np.ndarray, "_member"]]:
    """The nodes of each connected component."""
    if not affinity.shape[0]:
        return
    _, component = connected_components(affinity, directed=False)
    order = np.argsort(component, kind="stable")
    yield from np.split(order, np.flatnonzero(np.diff(component[order])) + 1)


def lowest_eigenvalues(affinity: sparse.csr_array, *, count: int) -> Spectrum:
    """The lowest eigenvalues of the normalised Laplacian of a connected graph, ascending, the first 0.

    `count` of them, but always one less than there are nodes, so that not every node is cut off; a single
    node has a 0.
    """
    size = affinity.shape[0]
    count = min(count, size - 1)
    if count < 2:
        return np.zeros(1)
    scale = 1.0 / np.sqrt(np.asarray(affinity.sum(axis=1)).ravel())
    normalised = sparse.csr_array(affinity.multiply(scale[:, None]).multiply(scale[None, :]))
    if size <= max(_DENSE_BELOW, count + 1):
        value = np.linalg.eigvalsh(normalised.toarray())
    else:
        start = np.linspace(1.0, 2.0, size)  # A fixed start makes the result repeatable.
        shifted = normalised + sparse.eye_array(size)
        value = eigsh(shifted, k=count, which="LA", v0=start, tol=_TOLERANCE, return_eigenvectors=False) - 1.0
    lowest = np.maximum(1.0 - np.sort(value)[::-1][:count], 0.0)
    lowest[0] = 0.0
    return lowest


def _pieces(spectra: Sequence[Spectrum], cuts: int, *, by_gap: bool) -> list[int]:
    """Into how many segments each part goes: its eigenvalues among the `cuts` lowest of all but the first ones.

    `by_gap` takes only as many cuts, up to that number, as lie before the largest gap.
    """
    rest = np.concatenate([np.zeros(0), *(spectrum[1:] for spectrum in spectra)])
    owner = np.repeat(np.arange(len(spectra)), [len(spectrum) - 1 for spectrum in spectra])
    order = np.argsort(rest, kind="stable")
    if by_gap and len(rest):
        cuts = int(np.argmax(np.diff(rest[order][: cuts + 1], prepend=0.0)))
    return (1 + np.bincount(owner[order[:cuts]], minlength=len(spectra))).tolist()


def _cut(affinity: sparse.csr_array, pieces: int) -> Labels:
    """The pieces of a connected graph, from 0 without gaps: by AMG, and where that does not work by ARPACK."""
    if pieces == 1:
        return np.zeros(affinity.shape[0], int)
    if affinity.shape[0] >= _NODES_PER_PIECE * pieces:
        try:
            with warnings.catch_warnings(), _legacy_randomness(0):
                warnings.simplefilter("error", UserWarning)  # So LOBPCG says that it did not converge.
                return _clustered(affinity, pieces, "amg")
        except (UserWarning, ValueError, np.linalg.LinAlgError) as reason:
            _log.info("AMG did not converge on %d nodes, ARPACK takes its place: %s", affinity.shape[0], reason)
    return _clustered(affinity, pieces, "arpack")


def _clustered(affinity: sparse.csr_array, pieces: int, solver: Literal["amg", "arpack"]) -> Labels:
    method = SpectralClustering(
        pieces, affinity="precomputed", assign_labels="cluster_qr", eigen_solver=solver, random_state=0
    )
    return np.unique(method.fit_predict(sparse.csr_matrix(affinity)), return_inverse=True)[1]


@contextmanager
def _legacy_randomness(seed: int) -> Iterator[None]:
    """NumPy's global random state set meanwhile, for pyamg draws from it, and put back afterwards."""
    before = np.random.get_state()  # noqa: NPY002 - pyamg knows no generator.
    np.random.seed(seed)  # noqa: NPY002 - the same: it draws from this state alone.
    try:
        yield
    finally:
        np.random.set_state(before)  # noqa: NPY002 - the caller's numbers go on as if nothing was drawn.
