"""Limbs of two bones, and bones turned along directions."""

import numpy as np

from simulator.limb import middle_joint, turns


def directions(generator: np.random.Generator, count: int = 50) -> np.ndarray:
    vectors = generator.normal(size=(count, 3))
    return vectors / np.linalg.norm(vectors, axis=1, keepdims=True)


def test_both_bones_keep_their_lengths_and_the_joint_gives_way_as_told() -> None:
    generator = np.random.default_rng(1)
    root = generator.normal(size=(50, 3))
    line = directions(generator)
    end = root + line * generator.uniform(0.1, 0.54, size=(50, 1))
    towards = directions(generator)
    elbow = middle_joint(root, end, (0.3, 0.25), towards=towards)
    np.testing.assert_allclose(np.linalg.norm(elbow - root, axis=1), 0.3)
    np.testing.assert_allclose(np.linalg.norm(end - elbow, axis=1), 0.25)
    aside = (elbow - root) - np.sum((elbow - root) * line, axis=1, keepdims=True) * line
    assert (np.sum(aside * towards, axis=1) >= 0).all()
    np.testing.assert_allclose(np.sum(np.cross(line, towards) * aside, axis=1), 0.0, atol=1e-12)


def test_what_is_out_of_reach_has_no_elbow() -> None:
    ends = np.array([[0.6, 0.0, 0.0], [0.01, 0.0, 0.0], [0.4, 0.0, 0.0]])
    elbow = middle_joint(np.zeros((3, 3)), ends, (0.3, 0.25), towards=np.tile([0.0, 0.0, -1.0], (3, 1)))
    assert np.isnan(elbow).any(axis=1).tolist() == [True, True, False]


def test_a_turn_takes_the_one_to_the_one_and_is_a_rotation() -> None:
    generator = np.random.default_rng(2)
    first, second = directions(generator), directions(generator)
    rest = np.array([0.0, 0.0, -2.0]), np.array([0.1, 1.0, 0.0])
    rotation = turns(rest, (first, second))
    np.testing.assert_allclose(rotation @ [0.0, 0.0, -1.0], first, atol=1e-12)
    np.testing.assert_allclose(rotation @ np.swapaxes(rotation, 1, 2), np.tile(np.eye(3), (50, 1, 1)), atol=1e-12)
    np.testing.assert_allclose(np.linalg.det(rotation), 1.0)
    assert (np.sum((rotation @ rest[1]) * second, axis=1) > 0).all()
