"""Small legged robots made by hand, and motions for them by closed-form leg kinematics."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from gaitforge.footfall.pattern import FootfallPattern
from gaitforge.motion.plan import Command, MotionPlan
from gaitforge.motion.timeline import Aim, Entry, Timeline
from gaitforge.robot.limbs import Foot, Limb, ToolMount
from gaitforge.robot.model import Nominal, RobotModel
from gaitforge.verify.trace import Trace

COXA, FEMUR, TIBIA, RADIUS = 0.06, 0.12, 0.16, 0.02  # [m]
HEIGHT = 0.12  # [m] of base_link above the ground
REACH = 0.19  # [m] of the standing foot from the hip, horizontally
HALF_WIDTH, PITCH = 0.10, 0.16  # [m] half distance of left and right hips; distance of neighbouring hips
BODY_KG, LINK_KG = 2.0, 0.15
OPTICAL = np.array([[0.0, 0.0, 1.0, 0.05], [-1.0, 0.0, 0.0, 0.0], [0.0, -1.0, 0.0, 0.0], [0.0, 0.0, 0.0, 1.0]])


@dataclass(frozen=True)
class Leg:
    """One limb's hip, in base_link."""

    name: str
    x: float
    y: float
    yaw: float


def legs(pairs: int) -> list[Leg]:
    xs = PITCH * (0.5 * (pairs - 1) - np.arange(pairs))
    return [
        Leg(f"{side}{k + 1}", float(x), sign * HALF_WIDTH, sign * np.pi / 2)
        for side, sign in (("L", 1.0), ("R", -1.0))
        for k, x in enumerate(xs)
    ]


def _inertial(mass: float, size: tuple[float, float, float], at: tuple[float, float, float]) -> str:
    x, y, z = size
    i = [mass / 12 * (y * y + z * z), mass / 12 * (x * x + z * z), mass / 12 * (x * x + y * y)]
    return (
        f'<inertial><origin xyz="{at[0]} {at[1]} {at[2]}"/><mass value="{mass}"/>'
        f'<inertia ixx="{i[0]}" iyy="{i[1]}" izz="{i[2]}" ixy="0" ixz="0" iyz="0"/></inertial>'
    )


def _bar(link: str, length: float, tip: str = "") -> str:
    size, at = (length, 0.02, 0.02), (length / 2, 0.0, 0.0)
    shape = f'<origin xyz="{at[0]} 0 0"/><geometry><box size="{length * 0.6} 0.02 0.02"/></geometry>'
    return (
        f'<link name="{link}">{_inertial(LINK_KG, size, at)}'
        f"<visual>{shape}</visual><collision>{shape}</collision>{tip}</link>"
    )


def urdf(pairs: int, body_com: tuple[float, float, float] = (0.0, 0.0, 0.0), tip: str = "") -> str:
    length = PITCH * (pairs - 1) + 0.12
    box = f'<geometry><box size="{length} 0.16 0.06"/></geometry>'
    out = [
        f'<robot name="walker{2 * pairs}"><link name="base_link">'
        f"{_inertial(BODY_KG, (length, 0.16, 0.06), body_com)}<visual>{box}</visual>"
        f"<collision>{box}</collision></link>"
    ]
    sphere = f'<origin xyz="{TIBIA} 0 0"/><geometry><sphere radius="{RADIUS}"/></geometry>'
    foot = f"<visual>{sphere}</visual><collision>{sphere}</collision>{tip}"
    for leg in legs(pairs):
        hip = f"{leg.x} {leg.y} 0", f"0 0 {leg.yaw}"
        chain = [("coxa", COXA, *hip, "0 0 1"), ("femur", FEMUR, f"{COXA} 0 0", "0 0 0", "0 1 0")]
        chain.append(("tibia", TIBIA, f"{FEMUR} 0 0", "0 0 0", "0 1 0"))
        parent = "base_link"
        for part, size, xyz, rpy, axis in chain:
            link = f"{leg.name}_{part}"
            out.append(_bar(link, size, foot if part == "tibia" else ""))
            out.append(
                f'<joint name="{link}_joint" type="revolute"><parent link="{parent}"/><child link="{link}"/>'
                f'<origin xyz="{xyz}" rpy="{rpy}"/><axis xyz="{axis}"/>'
                f'<limit lower="-2.6" upper="2.6" effort="7" velocity="3"/></joint>'
            )
            parent = link
    return "".join([*out, "</robot>"])


def leg_angles(leg: Leg, target: np.ndarray) -> np.ndarray:
    """Yaw, femur and tibia angle [rad] that put the foot's centre at `target` (3,) in base_link."""
    d = np.array([target[0] - leg.x, target[1] - leg.y])
    yaw = np.arctan2(d[1], d[0]) - leg.yaw
    r, down = np.hypot(*d) - COXA, -target[2]
    reach = np.hypot(r, down)
    knee = np.arccos((FEMUR**2 + TIBIA**2 - reach**2) / (2 * FEMUR * TIBIA))
    lift = np.arccos((FEMUR**2 + reach**2 - TIBIA**2) / (2 * FEMUR * reach))
    return np.array([(yaw + np.pi) % (2 * np.pi) - np.pi, np.arctan2(down, r) - lift, np.pi - knee])


def standing_feet(pairs: int) -> np.ndarray:
    """(n_F, 3) centres of the feet in the world, base_link above the origin."""
    return np.array([[leg.x, leg.y + np.sign(leg.y) * REACH, RADIUS] for leg in legs(pairs)])


def posture(pairs: int) -> np.ndarray:
    feet = standing_feet(pairs) - np.array([0.0, 0.0, HEIGHT])
    return np.concatenate([leg_angles(leg, f) for leg, f in zip(legs(pairs), feet, strict=True)])


def walker(pairs: int = 3, camera: str | None = None, effort: float = 7.0, **changes: str) -> RobotModel:
    """A robot of 2·pairs legs; `camera` names the limb that carries one on its femur."""
    limbs, names = [], []
    for leg in legs(pairs):
        parts = [f"{leg.name}_{part}" for part in ("coxa", "femur", "tibia")]
        joints = tuple(f"{part}_joint" for part in parts)
        names += joints
        foot = Foot(parts[-1], (TIBIA, 0.0, 0.0), RADIUS)
        side = "left" if leg.y > 0 else "right"
        limbs.append(Limb(leg.name, side, joints, foot, tuple(parts), ("camera",) if camera == leg.name else ()))
    tools = (ToolMount("camera", "camera", camera, f"{camera}_femur", OPTICAL),) if camera else ()
    n = len(names)
    model = RobotModel(
        name=f"walker{2 * pairs}",
        urdf=changes.pop("urdf", urdf(pairs)),
        limbs=tuple(limbs),
        joint_names=tuple(names),
        lower=np.full(n, -2.6),
        upper=np.full(n, 2.6),
        velocity=np.full(n, 3.0),
        effort=np.full(n, effort),
        nominal=Nominal(posture(pairs), posture(pairs), HEIGHT),
        tools=tools,
    )
    return replace(model, **changes) if changes else model


def make_plan(
    robot: RobotModel,
    contact: np.ndarray,
    duration: float,
    kind: str,
    base: np.ndarray,
    joints: np.ndarray,
    speed: float = 0.0,
    name: str = "",
) -> MotionPlan:
    """A plan from poses (N + 1, 6) and joints (n_J, N + 1)."""
    times = np.linspace(0.0, duration, len(base))
    stand = kind != "gait"
    return MotionPlan(
        name=name or kind,
        kind=kind,  # type: ignore[arg-type]
        pattern=FootfallPattern(contact, robot.limb_names, cyclic=not stand),
        times=times,
        joint_positions=joints,
        base_poses=base,
        com=np.array([robot.center_of_mass(b, q) for b, q in zip(base, joints.T, strict=True)]),
        feet=np.array([robot.foot_positions(b, q) for b, q in zip(base, joints.T, strict=True)]),
        weights=np.zeros((len(base), 2, len(robot.limbs))),
        command=Command(speed),
        joint_velocity_ends=np.zeros((2, len(robot.joint_names))) if stand else None,
        base_velocity_ends=np.zeros((2, 6)) if stand else None,
    )


def stand_plan(
    robot: RobotModel,
    duration: float = 1.0,
    advance: float = 0.0,
    swing: tuple[str, ...] = (),
    joints: np.ndarray | None = None,
    height: float = HEIGHT,
) -> MotionPlan:
    """All joints still; the plan says the base goes ahead by `advance` [m] and the limbs in `swing` are in swing."""
    samples = 9
    base = np.zeros((samples, 6))
    base[:, 0], base[:, 2] = np.linspace(0.0, advance, samples), height
    contact = np.ones((len(robot.limbs), 8), dtype=bool)
    for limb in swing:
        contact[robot.limb_names.index(limb)] = False
    still = robot.nominal.posture if joints is None else joints
    joints = np.tile(still[:, None], (1, samples))
    return make_plan(robot, contact, duration, "stand", base, joints)


def tripod_plan(robot: RobotModel, speed: float = 0.06, duration: float = 2.0, lift: float = 0.03) -> MotionPlan:
    """Alternating tripod of a six-legged walker, 12 columns, 8 samples a column."""
    pairs, columns, r = len(robot.limbs) // 2, 12, 8
    phase = np.array([(k % pairs) % 2 ^ (k >= pairs) for k in range(2 * pairs)]) * columns // 2
    contact = np.array([(np.arange(columns) + p) % columns < columns // 2 for p in phase])
    n = columns * r
    base = np.zeros((n + 1, 6))
    base[:, 0], base[:, 2] = speed * duration * np.arange(n + 1) / n, HEIGHT
    joints = np.zeros((len(robot.joint_names), n + 1))
    stride = speed * duration / 2  # [m] of the base during one stance
    for k, leg in enumerate(legs(pairs)):
        for i in range(n + 1):
            s = ((i / n) + phase[k] / columns) % 1.0
            foot = standing_feet(pairs)[k] - np.array([0.0, 0.0, HEIGHT])
            u = 2 * s if s < 0.5 else 2 * s - 1
            ease = u - np.sin(2 * np.pi * u) / (2 * np.pi)
            foot[0] += stride * (0.5 - u) if s < 0.5 else stride * (ease - 0.5)
            foot[2] += 0.0 if s < 0.5 else lift * np.sin(np.pi * u) ** 2
            joints[3 * k : 3 * k + 3, i] = leg_angles(leg, foot)
    joints[:, -1] = joints[:, 0]
    return make_plan(robot, contact, duration, "gait", base, joints, speed)


def timeline_of(robot: RobotModel, *plans: tuple[MotionPlan, int], aims: tuple[Aim, ...] = ()) -> Timeline:
    """Plans straight ahead, one after the other."""
    entries, start, x = [], 0.0, 0.0
    for plan, cycles in plans:
        entries.append(Entry(plan, cycles, start, np.array([x - plan.base_poses[0, 0], 0.0, 0.0])))
        start += cycles * plan.duration
        x += cycles * float(plan.base_poses[-1, 0] - plan.base_poses[0, 0])
    return Timeline(robot, tuple(entries), aims)


def perfect_trace(robot: RobotModel, timeline: Timeline, **changes: object) -> Trace:
    """A trace that did exactly what was planned, 240 rows a second; `changes` replace its fields."""
    times = np.arange(int(timeline.duration * 240 + 1e-6) + 1) / 240
    plan = replace(timeline.sample(np.minimum(times, timeline.duration - 1e-9)), times=times)
    feet = np.array(
        [robot.foot_positions(b, q) for b, q in zip(plan.base_poses, plan.joint_positions, strict=True)]
    )  # (n, n_F, 3)
    n, n_f = plan.contact.shape
    fields: dict[str, object] = {
        "times": times,
        "plan": plan,
        "base_poses": plan.base_poses.copy(),
        "joint_positions": plan.joint_positions,
        "joint_velocities": plan.joint_velocities,
        "joint_torques": np.zeros_like(plan.joint_positions),
        "normal_force": np.where(plan.contact, 10.0, 0.0),
        "friction_force": np.zeros((n, n_f, 3)),
        "contact_points": feet - np.array([0.0, 0.0, RADIUS]),
        "slip_speed": np.zeros((n, n_f)),
        "feet": feet,
        "com": plan.base_poses[:, :3].copy(),
        "margin": np.full(n, 0.05),
    }
    return Trace(**(fields | changes))  # type: ignore[arg-type]
