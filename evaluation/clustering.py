"""How well clusters of points agree with the objects: every observed point weighs one.

Purity alone is worth nothing, for one cluster a point has purity 1: read it beside inverse purity and coverage.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int64, Integer
from scipy.optimize import linear_sum_assignment

FOUND_FROM = 0.75
"""A motion that reaches this F has found its object."""
EXTRACTED_BELOW = 0.1
"""An object whose error is below this share is extracted."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Contingency:
    """How many points each cluster shares with each class: the pairs that occur."""

    cluster: Int64[np.ndarray, "pair"]
    """Cluster ids, ascending."""
    label: Int64[np.ndarray, "pair"]
    """Class ids."""
    count: Int64[np.ndarray, "pair"]
    """Points; above 0."""

    @property
    def total(self) -> int:
        """All points."""
        return int(self.count.sum())


def contingency(cluster: Integer[np.ndarray, "point"], label: Integer[np.ndarray, "point"]) -> Contingency:
    """The counts of the points' (cluster, class) pairs."""
    clusters, cluster_number = np.unique(cluster.astype(np.int64), return_inverse=True)
    labels, label_number = np.unique(label.astype(np.int64), return_inverse=True)
    pair, count = np.unique(cluster_number * max(len(labels), 1) + label_number, return_counts=True)
    number, rest = np.divmod(pair, max(len(labels), 1))
    return Contingency(cluster=clusters[number], label=labels[rest], count=count.astype(np.int64))


def purity(table: Contingency) -> float | None:
    """The share of points that lie in their cluster's largest class: sum_k max_c n_kc / n, in (0, 1]."""
    return float(_largest(table.cluster, table.count).sum() / table.total) if table.total else None


def inverse_purity(table: Contingency) -> float | None:
    """The share of points that lie in their class's largest cluster: sum_c max_k n_kc / n, in (0, 1]."""
    return float(_largest(table.label, table.count).sum() / table.total) if table.total else None


def v_measure(table: Contingency) -> float | None:
    """The harmonic mean of homogeneity 1 - H(C|K) / H(C) and completeness 1 - H(K|C) / H(K), in [0, 1].

    Where H(C) or H(K) is 0 that part is 1. Rosenberg and Hirschberg, EMNLP 2007.
    """
    if not table.total:
        return None
    of_class = _entropy(_sums(table.label, table.count))
    of_cluster = _entropy(_sums(table.cluster, table.count))
    mutual = max(of_class + of_cluster - _entropy(table.count), 0.0)
    homogeneity = mutual / of_class if of_class > 0 else 1.0
    completeness = mutual / of_cluster if of_cluster > 0 else 1.0
    both = homogeneity + completeness
    return 2 * homogeneity * completeness / both if both > 0 else 0.0


def adjusted_rand_index(table: Contingency) -> float | None:
    """The agreement over all pairs of points, 1 for the same partition, 0 as by chance, down to -0.5.

    (s - ab/t) / ((a + b)/2 - ab/t), with s, a, b, t the pairs of points that share cluster and class, that share
    the cluster, that share the class, and all; 1 where both partitions are trivial. Hubert and Arabie 1985.
    """
    if not table.total:
        return None
    both = _pairs(table.count)
    in_cluster, in_class = (_pairs(_sums(ids, table.count)) for ids in (table.cluster, table.label))
    chance = in_cluster * in_class / max(_pairs(np.array([table.total])), 1.0)
    most = (in_cluster + in_class) / 2
    return (both - chance) / (most - chance) if most > chance else 1.0


def majority(table: Contingency) -> dict[int, int]:
    """Each cluster's largest class; of equal ones the lowest id."""
    order = np.lexsort((table.label, -table.count, table.cluster))
    clusters, first = np.unique(table.cluster[order], return_index=True)
    return dict(zip(clusters.tolist(), table.label[order][first].tolist(), strict=True))


def f_measures(table: Contingency, clusters: list[int], classes: list[int]) -> Float64[np.ndarray, "cluster label"]:
    """F = 2 n_kc / (n_k + n_c) of the given clusters with the given classes, in [0, 1].

    n_k and n_c count all points of the cluster and of the class, those outside the given ones included.
    """
    scores = np.zeros((len(clusters), len(classes)))
    row = {cluster: number for number, cluster in enumerate(clusters)}
    column = {label: number for number, label in enumerate(classes)}
    sizes = [
        dict(zip(np.unique(ids).tolist(), _sums(ids, table.count).tolist(), strict=True))
        for ids in (table.cluster, table.label)
    ]
    for cluster, label, count in zip(table.cluster.tolist(), table.label.tolist(), table.count.tolist(), strict=True):
        if cluster in row and label in column:
            scores[row[cluster], column[label]] = 2 * count / (sizes[0][cluster] + sizes[1][label])
    return scores


def assigned(table: Contingency, clusters: list[int], classes: list[int]) -> dict[int, tuple[int, float]]:
    """Class -> (cluster, F): the one-to-one assignment with the largest sum of F (Hungarian).

    A class that shares no point with the cluster left for it has no entry.
    """
    scores = f_measures(table, clusters, classes)
    pairs = zip(*linear_sum_assignment(scores, maximize=True), strict=True)
    return {classes[c]: (clusters[k], float(scores[k, c])) for k, c in pairs if scores[k, c] > 0}


def extracted(table: Contingency, classes: list[int]) -> int:
    """The number of classes with an error below 10 %, as MoSegEval counts extracted objects.

    Every cluster goes to its largest class. The error of a class is the share of points that only one of the two
    has, the class or the union of its clusters, among those that either has: points lost to other clusters and
    points caught from other classes both count. After Brox and Malik, ECCV 2010.
    """
    owner = majority(table)
    owners = np.array([owner[cluster] for cluster in table.cluster.tolist()], np.int64)
    return sum(_error(table, owners == label, table.label == label) < EXTRACTED_BELOW for label in classes)


def over_segmented(table: Contingency) -> int | None:
    """The number of mergers that would leave one cluster a class, after Brox and Malik 2010.

    Every cluster goes to its largest class, the background among them; all clusters but one of a class are too many.
    """
    owner = majority(table)
    return len(owner) - len(set(owner.values())) if owner else None


def _error(table: Contingency, caught: Bool[np.ndarray, "pair"], wanted: Bool[np.ndarray, "pair"]) -> float:
    either = int(table.count[caught | wanted].sum())
    return float(table.count[caught ^ wanted].sum() / either) if either else 1.0


def _sums(ids: Int64[np.ndarray, "pair"], count: Int64[np.ndarray, "pair"]) -> Int64[np.ndarray, "group"]:
    """The points of every id, ids ascending."""
    groups, number = np.unique(ids, return_inverse=True)
    sums = np.zeros(len(groups), np.int64)
    np.add.at(sums, number, count)
    return sums


def _largest(ids: Int64[np.ndarray, "pair"], count: Int64[np.ndarray, "pair"]) -> Int64[np.ndarray, "group"]:
    """The largest count of every id, ids ascending."""
    groups, number = np.unique(ids, return_inverse=True)
    largest = np.zeros(len(groups), np.int64)
    np.maximum.at(largest, number, count)
    return largest


def _entropy(count: Int64[np.ndarray, "group"]) -> float:
    """Shannon entropy in nats; exactly 0 for a single group."""
    if len(count) <= 1:
        return 0.0
    share = count / count.sum()
    return float(-(share * np.log(share)).sum())


def _pairs(count: Int64[np.ndarray, "group"]) -> float:
    """The number of pairs of points within the groups."""
    size = count.astype(np.float64)
    return float((size * (size - 1) / 2).sum())
