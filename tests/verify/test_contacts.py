"""Which contacts are planned feet on the ground, and which are not."""

import numpy as np
import pytest
from walkers import RADIUS, stand_plan, standing_feet, timeline_of, tripod_plan, walker

from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.feet import foot_contacts, foot_of_contacts, last_contact_points
from gaitforge.verify.recording import GROUND, ContactTable, Recording
from gaitforge.verify.unplanned import force_in_swing, near_stance, unplanned_contacts

ROBOT = walker(3)
LINKS = ("base_link", *(link for limb in ROBOT.limbs for link in limb.links))
L1_TIBIA, R1_TIBIA = LINKS.index("L1_tibia"), LINKS.index("R1_tibia")
FEET = np.tile(standing_feet(3), (4, 1, 1))
UNDER_L1 = FEET[0, 0] - [0.0, 0.0, RADIUS]


def table(*rows: tuple[int, int, int, np.ndarray, float]) -> ContactTable:
    """Rows of step, link, other, point, force."""
    steps, links, others, points, forces = zip(*rows, strict=True)
    friction = np.tile([0.5, 0.0, 0.0], (len(rows), 1))
    return ContactTable(
        np.array(steps), np.array(links), np.array(others), np.array(points), np.array(forces), friction
    )


def events(*rows: tuple[int, int, int, np.ndarray, float], scene: Scene | None = None) -> list[tuple[str, str]]:
    found = table(*rows)
    times, n = np.arange(4) / 240, len(ROBOT.joint_names)
    still = (np.zeros((4, n)),) * 3
    record = Recording(times, LINKS, np.zeros((4, 6)), np.zeros((4, 6)), *still, np.zeros((4, 6)), still[0], found)
    foot, other = (foot_of_contacts(ROBOT, found, FEET, LINKS, link) for link in (found.link, found.other))
    listed = unplanned_contacts(ROBOT, record, scene or Scene(), foot, other, np.zeros((4, 6)))
    return [(e.kind, e.what) for e in listed]


def test_a_point_on_the_sphere_is_the_foot_and_a_point_along_the_shin_is_not() -> None:
    above = FEET[0, 0] + [0.0, 0.05, 0.0]
    found = table((0, L1_TIBIA, GROUND, UNDER_L1, 5.0), (0, L1_TIBIA, GROUND, above, 5.0))
    assert foot_of_contacts(ROBOT, found, FEET, LINKS, found.link).tolist() == [0, -1]


def test_forces_of_several_points_on_one_foot_add_up() -> None:
    found = table((1, L1_TIBIA, GROUND, UNDER_L1, 0.7), (1, L1_TIBIA, GROUND, UNDER_L1, 0.6))
    felt = foot_contacts(found, np.array([0, 0]), 4, 6)
    assert felt.normal_force[:, 0].tolist() == pytest.approx([0.0, 1.3, 0.0, 0.0])
    assert felt.contact[:, 0].tolist() == [False, True, False, False]
    np.testing.assert_allclose(felt.friction_force[1, 0], [1.0, 0.0, 0.0])


def test_a_foot_on_the_ground_is_no_event_but_its_shin_and_the_trunk_are() -> None:
    far = np.array([0.0, 0.0, 0.0])
    assert events((0, L1_TIBIA, GROUND, UNDER_L1, 5.0)) == []
    assert events((0, L1_TIBIA, GROUND, far, 5.0)) == [("ground", "L1 shin on ground")]
    assert events((0, 0, GROUND, far, 5.0)) == [("trunk", "trunk on ground")]
    assert events((0, LINKS.index("R2_femur"), GROUND, far, 5.0)) == [("ground", "R2_femur on ground")]


def test_limb_against_limb_has_one_name_whichever_way_it_is_reported() -> None:
    one = events((0, L1_TIBIA, R1_TIBIA, UNDER_L1, 5.0))
    other = events((0, R1_TIBIA, L1_TIBIA, UNDER_L1, 5.0))
    assert one == other == [("self", "L1 foot against R1 shin")]


def test_a_touched_object_is_named() -> None:
    scene = Scene((SceneObject("pipe", "pipe", (1.0, 0.0, 0.3)),))
    found = events((2, L1_TIBIA, len(LINKS), UNDER_L1 + np.array([0.1, 0.0, 0.0]), 5.0), scene=scene)
    assert found == [("object", "L1 shin against pipe")]


def test_less_than_one_newton_is_no_contact() -> None:
    assert events((0, 0, GROUND, np.zeros(3), 0.9)) == []


def test_steps_that_follow_each_other_are_one_event_with_the_largest_force() -> None:
    far = np.zeros(3)
    found = table(*((k, 0, GROUND, far, force) for k, force in enumerate((3.0, 8.0, 2.0))))
    record = Recording(
        np.array([0.0, 0.004, 0.008, 0.5]), LINKS, *(np.zeros((4, 6)),) * 2, *(np.zeros((4, 18)),) * 3,
        np.zeros((4, 6)), np.zeros((4, 18)), found,
    )  # fmt: skip
    (event,) = unplanned_contacts(ROBOT, record, Scene(), *(np.full(3, -1),) * 2, np.zeros((4, 6)))
    assert (event.time, event.end, event.force) == (0.0, 0.008, 8.0)


def test_early_and_late_within_a_column_is_near_stance_and_longer_is_not() -> None:
    times = np.arange(14) * 0.1
    contact = np.zeros((14, 1), dtype=bool)
    contact[6] = True
    near = near_stance(contact, times, np.full(14, 0.2))[:, 0]
    assert np.flatnonzero(~near).tolist() == [3, 9, 10]  # both ends of the run count as ground


def test_a_foot_that_never_stands_may_never_touch() -> None:
    assert not near_stance(np.zeros((5, 1), dtype=bool), np.arange(5.0), np.full(5, 10.0)).any()


def test_force_in_swing_counts_only_where_the_plan_is_more_than_a_column_from_stance() -> None:
    timeline = timeline_of(ROBOT, (tripod_plan(ROBOT), 2))
    plan = timeline.sample(np.arange(960) / 240)
    force = force_in_swing(timeline, plan, np.full(plan.contact.shape, 5.0))
    swing = ~plan.contact[:, 1]
    late = force[:, 1] > 0
    assert late.any()
    assert not (late & plan.contact[:, 1]).any()
    column = 2.0 / 12 * 240
    assert swing.sum() - late.sum() == pytest.approx(4 * column, abs=6)  # two swings, a column at each end


def test_the_last_contact_point_is_kept_while_the_foot_is_in_the_air() -> None:
    feet = np.zeros((4, 1, 3))
    feet[:, 0, 0] = [0.0, 1.0, 2.0, 3.0]
    contact = np.array([[False], [True], [False], [False]])
    points = last_contact_points(feet, np.array([0.02]), contact)
    assert points[:, 0, 0].tolist() == [0.0, 1.0, 1.0, 1.0]
    assert points[1, 0, 2] == pytest.approx(-0.02)


def test_the_hand_made_robot_stands_with_its_feet_on_the_ground() -> None:
    plan = stand_plan(ROBOT)
    np.testing.assert_allclose(plan.feet[0], standing_feet(3), atol=1e-9)
