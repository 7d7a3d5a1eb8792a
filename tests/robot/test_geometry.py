"""Transforms, inertias and capsules against what can be worked out by hand."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from gaitforge.robot.capsules import capsule
from gaitforge.robot.geometry import (
    Inertia,
    Shape,
    inertia_defect,
    inertia_of_shapes,
    inverse,
    merged,
    pose,
    rotation,
    turn,
)

angle = st.floats(-3.1, 3.1)
length = st.floats(0.01, 1.0)


@given(angle, angle, angle)
def test_roll_pitch_yaw_mean_what_scipy_means_by_them(roll: float, pitch: float, yaw: float) -> None:
    expected = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
    assert rotation((roll, pitch, yaw)) == pytest.approx(expected, abs=1e-12)


@given(angle, st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1))
def test_a_turn_about_an_axis_is_scipys_rotation_vector(about: float, axis: tuple[float, float, float]) -> None:
    unit = np.array(axis) / np.linalg.norm(axis)
    assert turn(unit, about)[:3, :3] == pytest.approx(Rotation.from_rotvec(about * unit).as_matrix(), abs=1e-12)


def test_the_inverse_undoes_a_pose() -> None:
    T = pose((1.0, -2.0, 3.0), (0.3, -0.4, 2.0))
    assert inverse(T) @ T == pytest.approx(np.eye(4), abs=1e-14)


@given(length, length, length, st.floats(0.1, 0.9), angle)
def test_a_box_sawn_in_two_and_merged_again_is_the_same_box(
    x: float, y: float, z: float, cut: float, yaw: float
) -> None:
    whole = inertia_of_shapes([Shape("box", (x, y, z))], 2.0).moved(pose((0.1, 0.2, 0.3), (0.0, 0.5, yaw)))
    left = Shape("box", (x * cut, y, z), pose((-x * (1.0 - cut) / 2.0, 0.0, 0.0)))
    right = Shape("box", (x * (1.0 - cut), y, z), pose((x * cut / 2.0, 0.0, 0.0)))
    T = pose((0.1, 0.2, 0.3), (0.0, 0.5, yaw))
    halves = [inertia_of_shapes([left], 2.0 * cut).moved(T), inertia_of_shapes([right], 2.0 * (1.0 - cut)).moved(T)]
    joined = merged(halves)
    assert joined.mass == pytest.approx(2.0)
    assert joined.com == pytest.approx(whole.com, abs=1e-12)
    assert joined.matrix == pytest.approx(whole.matrix, abs=1e-12)


def test_solids_have_the_inertia_that_pinocchio_gives_them() -> None:
    import pinocchio as pin

    box = inertia_of_shapes([Shape("box", (0.1, 0.2, 0.3))], 1.5).matrix
    assert box == pytest.approx(pin.Inertia.FromBox(1.5, 0.1, 0.2, 0.3).inertia)
    cylinder = inertia_of_shapes([Shape("cylinder", (0.1, 0.3))], 1.5).matrix
    assert cylinder == pytest.approx(pin.Inertia.FromCylinder(1.5, 0.1, 0.3).inertia)
    sphere = inertia_of_shapes([Shape("sphere", (0.1,))], 1.5).matrix
    assert sphere == pytest.approx(pin.Inertia.FromSphere(1.5, 0.1).inertia)


@pytest.mark.parametrize(
    ("matrix", "words"),
    [
        (np.diag([1.0, 1.0, 2.5]), "triangle"),
        (np.diag([1.0, -1.0, 1.0]), "not positive definite"),
        (np.zeros((3, 3)), "not positive definite"),
        (np.array([[1.0, 0.5, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]), "not symmetric"),
    ],
)
def test_an_inertia_that_no_body_has_is_called_so(matrix: np.ndarray, words: str) -> None:
    assert words in (inertia_defect(matrix) or "")


@settings(max_examples=50)
@given(length, length, length, angle)
def test_no_solid_is_called_unphysical_however_it_is_turned(x: float, y: float, z: float, roll: float) -> None:
    solid = inertia_of_shapes([Shape("box", (x, y, z))], 1.0).moved(pose((1.0, 0.0, 0.0), (roll, roll / 2.0, 0.3)))
    assert inertia_defect(solid.matrix) is None


def test_parts_without_mass_do_not_move_the_centre_of_mass() -> None:
    body = Inertia(2.0, np.array([0.1, 0.0, 0.0]), np.eye(3))
    assert merged([body, Inertia(0.0, np.array([9.0, 9.0, 9.0]))]).com == pytest.approx([0.1, 0.0, 0.0])


@pytest.mark.parametrize("kind", ["box", "cylinder", "sphere"])
def test_a_capsule_encloses_its_shape(kind: str) -> None:
    random = np.random.default_rng(1)
    for _ in range(20):
        size = tuple(random.uniform(0.02, 0.3, {"box": 3, "cylinder": 2, "sphere": 1}[kind]))
        T = pose(random.uniform(-1, 1, 3), random.uniform(-3, 3, 3))
        points = surface(kind, size, random) @ T[:3, :3].T + T[:3, 3]
        c = capsule("link", Shape(kind, size, T))  # type: ignore[arg-type]
        a, b = np.array(c.a), np.array(c.b)
        along = np.clip((points - a) @ (b - a) / max(float((b - a) @ (b - a)), 1e-12), 0.0, 1.0)
        assert np.linalg.norm(points - a - along[:, None] * (b - a), axis=1).max() <= c.radius + 1e-9


def surface(kind: str, size: tuple[float, ...], random: np.random.Generator) -> np.ndarray:
    """(500, 3) points of a shape, its corners or rims among them."""
    if kind == "box":
        return random.choice([-0.5, 0.5], (500, 3)) * size
    directions = random.normal(size=(500, 3))
    if kind == "sphere":
        return size[0] * directions / np.linalg.norm(directions, axis=1)[:, None]
    ring = size[0] * directions[:, :2] / np.linalg.norm(directions[:, :2], axis=1)[:, None]
    return np.column_stack([ring, random.choice([-0.5, 0.5], 500) * size[1]])
