"""Step 6: spectral clustering of the affinities into segments (paper, section 4, Motion segmentation)."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import sparse
from scipy.sparse.csgraph import connected_components
from scipy.sparse.linalg import eigsh
from scipy.spatial import cKDTree
from sklearn.cluster import SpectralClustering

from algorithm.trajectories import Trajectories

Labels = Int[np.ndarray, "trajectory"]
_DENSE_BELOW = 64
"""Nodes up to which all eigenvectors are computed at once; iterating for a few of so few does not pay."""

_TOLERANCE = 3e-4
"""Of the eigenvectors; at 1e-6 the segments are the same and take six times as long, at 1e-2 they are not."""


def cut_while_cheap(affinity: sparse.csr_array, *, cut_below: float, smallest: int) -> Labels:
    """Segments by recursive normalised cuts [Shi and Malik, PAMI 2000].

    Each connected component is cut in two along its second eigenvector, where the normalised cut is the
    cheapest, as long as that costs less than `cut_below` and leaves `smallest` members on both sides. So
    the number of segments comes out of the affinities; with 0 the components stay whole.
    """
    smallest = max(smallest, 1)
    label = np.zeros(affinity.shape[0], int)
    found = 0
    waiting = list(_components(affinity))
    while waiting:
        members = waiting.pop()
        halves = _cheapest_cut(affinity[members][:, members], smallest) if len(members) >= 2 * smallest else None
        if halves is not None and halves[0] < cut_below:
            for half in (members[halves[1]], members[~halves[1]]):
                waiting += [half[part] for part in _components(affinity[half][:, half])]
        else:
            label[members] = found
            found += 1
    return label


def cut_at_eigengap(affinity: sparse.csr_array, *, most: int, seed: int = 0) -> Labels:
    """Segments by spectral clustering, as many as the largest gap between the eigenvalues says.

    Per connected component: the normalised Laplacian's eigenvalues in ascending order, at most `most` of
    them; k is where the next one is farthest away; then k-way clustering with cluster_qr [Damle et al.,
    2019].
    """
    label = np.zeros(affinity.shape[0], int)
    found = 0
    for members in _components(affinity):
        part = affinity[members][:, members]
        count = _eigengap(part, most)
        if count > 1:
            method = SpectralClustering(
                count, affinity="precomputed", assign_labels="cluster_qr", eigen_solver="arpack", random_state=seed
            )
            label[members] = found + method.fit_predict(sparse.csr_matrix(part))
        else:
            label[members] = found
        found = int(label[members].max()) + 1
    return label


def without_small(label: Labels, *, smallest: float) -> Labels:
    """The labels counted from 0 anew; -1 where a segment has fewer than `smallest` members (epsilon 4)."""
    names, index, size = np.unique(label, return_inverse=True, return_counts=True)
    kept = (size >= smallest) & (names >= 0)
    return np.where(kept[index], np.cumsum(kept)[index] - 1, -1)


def followers(
    trajectories: Trajectories,
    sample: Bool[np.ndarray, "trajectory"],
    label: Int[np.ndarray, "sampled"],
    *,
    radius_m: float,
) -> Labels:
    """The labels of all trajectories, when only a sample was clustered (epsilon 5).

    A trajectory out of the sample takes the label of its nearest sampled neighbour in its middle frame;
    -1 where that frame has none within `radius_m`.
    """
    everyone = np.full(trajectories.count, -1)
    everyone[sample] = label
    row = trajectories.first_row + trajectories.length // 2
    sampled_rows = np.flatnonzero(sample[trajectories.trajectory])
    left = np.flatnonzero(~sample)
    for frame in np.unique(trajectories.frame[row[left]]):
        known = sampled_rows[trajectories.frame[sampled_rows] == frame]
        asking = left[trajectories.frame[row[left]] == frame]
        if len(known):
            tree = cKDTree(trajectories.position[known])
            distance, nearest = tree.query(trajectories.position[row[asking]], distance_upper_bound=radius_m)
            near = np.isfinite(distance)
            everyone[asking[near]] = everyone[trajectories.trajectory[known[nearest[near]]]]
    return everyone


def normalised_cut(affinity: sparse.csr_array, side: np.ndarray) -> float:
    """cut(A, B) / vol(A) + cut(A, B) / vol(B) of the two sides."""
    degree = np.asarray(affinity.sum(axis=1)).ravel()
    cut = float(affinity[side][:, ~side].sum())
    return cut / float(degree[side].sum()) + cut / float(degree[~side].sum())


def _components(affinity: sparse.csr_array) -> Iterator[Int[np.ndarray, "member"]]:
    if not affinity.shape[0]:
        return
    _, component = connected_components(affinity, directed=False)
    order = np.argsort(component, kind="stable")
    yield from np.split(order, np.flatnonzero(np.diff(component[order])) + 1)


def _cheapest_cut(affinity: sparse.csr_array, smallest: int) -> tuple[float, np.ndarray] | None:
    """The cheapest normalised cut along the second eigenvector, and which members lie on its first side."""
    degree = np.asarray(affinity.sum(axis=1)).ravel()
    order = np.argsort(_leading_vectors(affinity, 2)[1][:, 1] / np.sqrt(degree), kind="stable")
    place = np.empty(len(order), int)
    place[order] = np.arange(len(order))
    edges = affinity.tocoo()
    forward = place[edges.row] < place[edges.col]
    begin, end, weight = place[edges.row[forward]], place[edges.col[forward]], edges.data[forward]
    size = len(order)
    across = np.bincount(begin, weight, size) - np.bincount(end, weight, size)
    cut = np.cumsum(across)[:-1]  # Weight of the edges that span the place between two members.
    volume = np.cumsum(degree[order])
    cost = cut / volume[:-1] + cut / (volume[-1] - volume[:-1])
    cost = cost[smallest - 1 : size - smallest]
    if not len(cost):
        return None
    best = int(np.argmin(cost))
    return float(cost[best]), place < best + smallest


def _eigengap(affinity: sparse.csr_array, most: int) -> int:
    """The number of eigenvalues of the normalised Laplacian before the largest gap; 1 for tiny components."""
    count = min(most + 1, affinity.shape[0] - 1)
    if count < 3:
        return 1
    value = 1.0 - _leading_vectors(affinity, count)[0]
    return int(np.argmax(np.diff(value))) + 1


def _leading_vectors(
    affinity: sparse.csr_array, count: int
) -> tuple[Float[np.ndarray, "vector"], Float[np.ndarray, "member vector"]]:
    """The largest eigenvalues, descending, and the eigenvectors of D^-1/2 W D^-1/2."""
    scale = 1.0 / np.sqrt(np.asarray(affinity.sum(axis=1)).ravel())
    normalised = sparse.csr_array(affinity.multiply(scale[:, None]).multiply(scale[None, :]))
    if affinity.shape[0] <= max(_DENSE_BELOW, count + 1):
        value, vector = np.linalg.eigh(normalised.toarray())
    else:
        start = np.linspace(1.0, 2.0, affinity.shape[0])  # A fixed start makes the result repeatable.
        shifted = normalised + sparse.eye_array(affinity.shape[0])
        value, vector = eigsh(shifted, k=count, which="LA", v0=start, tol=_TOLERANCE)
        value = value - 1.0
    order = np.argsort(-value, kind="stable")[:count]
    return value[order], vector[:, order]
