"""The static margin against shapely's polygons."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from shapely import MultiPoint, Point

from gaitforge.verify.support import NO_SUPPORT, bridged, static_margin


def shapely_margin(com: np.ndarray, points: np.ndarray, contact: np.ndarray) -> float:
    if not contact.any():
        return NO_SUPPORT
    hull, here = MultiPoint(points[contact]).convex_hull, Point(com)
    distance = (hull.exterior if hull.geom_type == "Polygon" else hull).distance(here)
    return distance if hull.geom_type == "Polygon" and hull.contains(here) else -distance


@given(st.integers(0, 2**32 - 1), st.integers(1, 12))
@settings(max_examples=200, deadline=None)
def test_the_margin_is_the_signed_distance_from_the_hull_of_the_contacts(seed: int, feet: int) -> None:
    random = np.random.default_rng(seed)
    com, points = random.uniform(-1, 1, (8, 2)), random.uniform(-1, 1, (8, feet, 2))
    contact = random.random((8, feet)) < 0.6
    expected = [shapely_margin(*row) for row in zip(com, points, contact, strict=True)]
    np.testing.assert_allclose(static_margin(com, points, contact), expected, atol=1e-9)


def test_feet_in_a_row_are_no_polygon_even_when_the_mass_is_above_the_line() -> None:
    points = np.array([[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]])
    assert static_margin(np.array([[0.5, 0.0]]), points, np.ones((1, 3), dtype=bool)) == pytest.approx(0.0)
    assert static_margin(np.array([[0.5, 0.2]]), points, np.ones((1, 3), dtype=bool)) == pytest.approx(-0.2)


def test_a_square_with_a_foot_inside_has_the_margin_of_the_square() -> None:
    points = np.array([[[1.0, 1.0], [-1.0, 1.0], [0.1, 0.0], [-1.0, -1.0], [1.0, -1.0]]])
    assert static_margin(np.array([[0.3, 0.0]]), points, np.ones((1, 5), dtype=bool)) == pytest.approx(0.7)


def test_short_interruptions_of_a_contact_are_bridged_and_long_ones_are_not() -> None:
    contact = np.array([[1, 0, 0, 1, 0, 0, 0, 1]], dtype=bool).T
    assert bridged(contact, 2)[:, 0].tolist() == [True, True, True, True, False, False, False, True]
