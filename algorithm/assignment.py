"""The cheapest one-to-one assignment between many rows and columns of which each row knows a few."""

from heapq import heappop, heappush

import numpy as np
from jaxtyping import Float, Int

from algorithm.compiled import compiled


def cheapest_assignment(
    row: Int[np.ndarray, "pair"], column: Int[np.ndarray, "pair"], cost: Float[np.ndarray, "pair"], *, alone: float
) -> Int[np.ndarray, "chosen"]:
    """Which pairs are chosen: those of least total cost, where every row may stay alone for the price of `alone`.

    No row and no column is chosen twice. Rows and columns are any numbers; costs are not negative, and no pair
    occurs twice. Shortest augmenting paths [Jonker, Volgenant, Computing 1987]: each row in turn looks for the
    cheapest way to be placed, and since it may stay alone it never looks farther than `alone`. So what it costs
    depends on how many candidates lie near one another and not on how many there are in all.
    """
    if not len(cost):
        return np.zeros(0, int)
    rows, number = np.unique(row, return_inverse=True)
    columns, goal = np.unique(column, return_inverse=True)
    order = np.lexsort((goal, number))
    start = np.searchsorted(number[order], np.arange(len(rows) + 1))
    pair = _pair_of_rows(
        start.astype(np.int64),
        goal[order].astype(np.int64),
        np.ascontiguousarray(cost[order], dtype=np.float64),
        len(columns),
        float(alone),
    )
    return np.sort(order[pair[pair >= 0]])


@compiled
def _pair_of_rows(  # noqa: C901, PLR0912, PLR0915 - one search in one loop: compiled code hands no state around
    start: np.ndarray, goal: np.ndarray, cost: np.ndarray, columns: int, alone: float
) -> np.ndarray:  # pragma: no cover
    """The pair chosen for every row, -1 where it stays alone; row i has the pairs start[i] to start[i + 1]."""
    rows = len(start) - 1
    chosen = np.full(rows, -1)
    owner = np.full(columns, -1)  # The row that a column is given to.
    row_price, column_price = np.zeros(rows), np.zeros(columns)
    distance = np.full(columns, np.inf)
    came_by = np.full(columns, -1)  # The pair by which a column was reached, and the row of that pair.
    came_from = np.full(columns, -1)
    done = np.zeros(columns, np.bool_)
    for begin in range(rows):
        touched, settled = [0], [0]
        touched.clear()
        settled.clear()
        heap = [(0.0, 0)]
        heap.clear()
        row, walked = begin, 0.0
        least, last_row, last_column = np.inf, begin, -1
        while True:
            staying = walked + alone - row_price[row]
            if staying < least:
                least, last_row, last_column = staying, row, -1
            for pair in range(start[row], start[row + 1]):
                column = goal[pair]
                if done[column]:
                    continue
                reach = walked + cost[pair] - row_price[row] - column_price[column]
                if reach < distance[column]:
                    if distance[column] == np.inf:
                        touched.append(column)
                    distance[column], came_by[column], came_from[column] = reach, pair, row
                    heappush(heap, (reach, column))
            nearest = -1
            while len(heap) > 0:
                reach, column = heappop(heap)
                if not done[column] and reach == distance[column]:
                    nearest = column
                    break
            if nearest < 0 or distance[nearest] >= least:
                break
            if owner[nearest] < 0:
                least, last_column = distance[nearest], nearest
                break
            done[nearest] = True
            settled.append(nearest)
            row, walked = owner[nearest], distance[nearest]
        row_price[begin] += least
        for column in settled:
            row_price[owner[column]] += least - distance[column]
            column_price[column] -= least - distance[column]
        column = last_column
        if column < 0 and last_row != begin:  # A row on the way gives its column up and stays alone.
            column = goal[chosen[last_row]]
            chosen[last_row] = -1
        while column >= 0:
            row, pair = came_from[column], came_by[column]
            before = chosen[row]
            chosen[row], owner[column] = pair, row
            column = goal[before] if before >= 0 and row != begin else -1
        for column in touched:
            distance[column] = np.inf
            done[column] = False
    return chosen
