"""Step 6, the other way: segments by merging along a graph [Felzenszwalb and Huttenlocher, IJCV 2004].

The paper names it as its implementation of spectral clustering, which it is not (section 5, Results).
"""

import numpy as np
from jaxtyping import Float, Int

from algorithm.compiled import compiled


def merged_segments(
    pairs: tuple[Int[np.ndarray, "pair"], Int[np.ndarray, "pair"]],
    distance: Float[np.ndarray, "pair"],
    *,
    count: int,
    k: float,
) -> Int[np.ndarray, "node"]:
    """The segment of each of `count` nodes, from 0 without gaps, merged along the pairs in order of their distance.

    Two segments become one if the distance of the pair between them is at most Int + k / size of either,
    where Int is the largest distance along which that segment was merged before: what is alike inside does
    not merge with what is not. The larger `k`, in the unit of the distance, the larger the segments.
    """
    first, second = pairs
    order = np.lexsort((second, first, distance))  # Equal distances in a fixed order.
    root = _merged(first[order].astype(np.int64), second[order].astype(np.int64), distance[order], count, k)
    return np.unique(root, return_inverse=True)[1]


@compiled
def _merged(first: np.ndarray, second: np.ndarray, distance: np.ndarray, count: int, k: float) -> np.ndarray:
    """A node of its segment for every node; the pairs in ascending order of distance."""
    parent = np.arange(count)
    size = np.ones(count)
    limit = np.full(count, k)  # Int + k / size; Int of a single node is 0.
    for pair in range(len(first)):
        a, b = first[pair], second[pair]
        while parent[a] != a:
            parent[a] = parent[parent[a]]
            a = parent[a]
        while parent[b] != b:
            parent[b] = parent[parent[b]]
            b = parent[b]
        if a != b and distance[pair] <= min(limit[a], limit[b]):
            if size[a] < size[b]:
                a, b = b, a
            parent[b] = a
            size[a] += size[b]
            limit[a] = distance[pair] + k / size[a]  # Ascending: this pair's distance is the largest so far.
    for node in range(count):
        root = node
        while parent[root] != root:
            root = parent[root]
        parent[node] = root
    return parent
