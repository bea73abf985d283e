"""Flow there and back: both ways at the same time, where there are threads for it."""

import time
from threading import Lock

import cv2
import numpy as np
import pytest
from worlds import small_camera

from algorithm.scene_flow import Footage, flows_between
from algorithm.settings import Settings


@pytest.mark.parametrize("threads", [1, 2])
def test_workers_with_one_thread_get_no_second_one(threads: int) -> None:
    before = cv2.getNumThreads()
    cv2.setNumThreads(threads)
    depth, lock = np.full((10, 12), 2.0, np.float32), Lock()
    running: list[int] = []
    most: list[int] = []

    def flow(a: int, b: int) -> np.ndarray:
        with lock:
            running.append(a)
            most.append(len(running))
        time.sleep(0.2)
        with lock:
            running.remove(a)
        return np.zeros((10, 12, 2), np.float32)

    footage = Footage(moving=[depth, depth], sensed=[depth, depth], camera=small_camera(12, 10), fps=30.0)
    try:
        flows_between(footage, Settings(), flow)(0, 1)
    finally:
        cv2.setNumThreads(before)
    assert max(most) == threads
