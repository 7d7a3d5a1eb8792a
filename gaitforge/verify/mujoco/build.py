"""A MuJoCo model made of the robot's URDF, a floor and the scene's boxes, through MjSpec."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from gaitforge.errors import SimulationError
from gaitforge.robot.gravity import GRAVITY
from gaitforge.robot.model import RobotModel
from gaitforge.robot.rotation import quaternions
from gaitforge.task.scene import Scene, SceneObject
from gaitforge.verify.mujoco.meshes import hand_over_meshes
from gaitforge.verify.mujoco.settings import Physics
from gaitforge.verify.scene import boxes_of
from gaitforge.verify.welds import Weld

IMPEDANCE = (0.5, 0.95)
"""Of a contact at no penetration and at its full depth; MuJoCo's 0.9 to begin with makes feet that slide hop."""
ALOFT_M = 100.0
"""[m] height at which the robot touches nothing but itself"""
OBJECT = "object of the scene: "
"""Before the names of objects, so that none is a link's"""
MASS_TOLERANCE = 1e-9
"""Relative"""


@dataclass(frozen=True)
class Parts:
    """Which body of the model is what."""

    links: tuple[str, ...]
    """Link names, the base first"""
    bodies: tuple[int, ...]
    """Body of each link"""
    objects: tuple[int, ...]
    """Body of each object of the scene"""
    overlapping: tuple[tuple[str, str], ...] = ()
    """Links whose shapes overlap in the nominal posture: their contacts are ignored"""


def build_model(
    mj: Any, robot: RobotModel, scene: Scene, physics: Physics, welds: Sequence[Weld] = ()
) -> tuple[Any, Parts]:
    """The compiled model; row 0 to 6 of its qpos are the pose of base_link.  Its equalities are the welds, off.

    The friction of a pair is the larger of two coefficients, so every shape has the stated one.
    SimulationError when MuJoCo refuses the URDF, or reads another mass than Pinocchio.
    """
    try:
        spec = mj.MjSpec.from_string(robot.urdf)
        hand_over_meshes(spec)
        robot_bodies = _free_robot(mj, spec, robot, physics)
        objects = [_add_object(mj, spec, item) for item in scene.objects]
        spec.worldbody.add_geom(type=mj.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0])
        _set_physics(mj, spec, physics)
        for body in (body for body, item in zip(objects, scene.objects, strict=True) if item.movable):
            _set_contacts(body.geoms, physics, physics.torsional_friction)
        for body, item in zip(objects, scene.objects, strict=True):
            body.name = OBJECT + item.name
        for weld in welds:
            spec.add_equality(
                type=mj.mjtEq.mjEQ_WELD, objtype=mj.mjtObj.mjOBJ_BODY, name1=weld.link, name2=OBJECT + weld.object,
                active=False, solref=[physics.contact_time, 1.0],
            )  # fmt: skip
        overlapping = _overlaps(mj, spec.compile(), robot)
        for one, other in overlapping:
            spec.add_exclude(bodyname1=one, bodyname2=other)
        model = spec.compile()
    except ValueError as error:
        reason = " ".join(str(error).split())
        raise SimulationError(f"{robot.name}: MuJoCo does not take the robot: {reason}") from error
    parts = Parts(
        tuple(body.name for body in robot_bodies),
        tuple(int(body.id) for body in robot_bodies),
        tuple(int(body.id) for body in objects),
        overlapping,
    )
    _check(model, robot, parts)
    return model, parts


def _overlaps(mj: Any, model: Any, robot: RobotModel) -> tuple[tuple[str, str], ...]:
    """Links that overlap in the nominal posture; many files draw thigh and trunk so."""
    data = mj.MjData(model)
    data.qpos[2] += ALOFT_M
    data.qpos[[int(model.joint(name).qposadr[0]) for name in robot.joint_names]] = robot.nominal.posture
    mj.mj_forward(model, data)
    touching = {tuple(sorted(int(model.geom_bodyid[g]) for g in c.geom)) for c in data.contact if c.dist < 0.0}
    mine = {body for body in range(model.nbody) if model.body_rootid[body] == model.body(robot.base_link).id}
    return tuple((model.body(a).name, model.body(b).name) for a, b in sorted(touching) if {a, b} <= mine)


def _free_robot(mj: Any, spec: Any, robot: RobotModel, physics: Physics) -> list[Any]:
    """Let the root float, and give each joint a servo.  Left alone, a URDF's root is fused into the world.

    A servo's damping is far too stiff for explicit steps.  MuJoCo's implicit integrators take it into
    the step, but its contact solver does not see it: stance feet then chatter, and their slip halves
    with the step.  An implicit step of kv is the same as an explicit one of a joint with the inertia
    kv · dt on its axis, and that inertia the contact solver does see.
    """
    spec.compiler.fusestatic = False
    base = spec.body(robot.base_link)
    if base is None or base.parent.name != "world":
        raise SimulationError(f"{robot.name}: {robot.base_link} is not the root in MuJoCo")
    base.add_freejoint()
    bodies = [body for body in spec.bodies if body.name != "world"]
    for geom in (geom for body in bodies for geom in body.geoms):
        geom.mass = 0.0  # a link without <inertial> would be given the mass of its shapes
    for name, effort in zip(robot.joint_names, robot.effort.tolist(), strict=True):
        kp = effort / physics.full_effort_error
        kv = kp / physics.servo_rate
        joint = spec.joint(name)
        joint.actfrclimited, joint.armature = mj.mjtLimited.mjLIMITED_FALSE, kv * physics.timestep
        servo = spec.add_actuator(trntype=mj.mjtTrn.mjTRN_JOINT, target=name)
        servo.set_to_position(kp=kp, kv=kv)
        servo.forcelimited, servo.forcerange = mj.mjtLimited.mjLIMITED_TRUE, [-effort, effort]
    return sorted(bodies, key=lambda body: body.name != robot.base_link)


def _add_object(mj: Any, spec: Any, item: SceneObject) -> Any:
    """One body made of the object's boxes; mass 0 stands fast."""
    body = spec.worldbody.add_body(pos=item.xyz, quat=_wxyz(item.rpy))
    if item.movable:
        body.add_freejoint()
    boxes = boxes_of(item)
    for box in boxes:
        half = [0.5 * edge for edge in box.size]
        shape = {"type": mj.mjtGeom.mjGEOM_BOX, "size": half, "pos": box.xyz, "quat": _wxyz(box.rpy)}
        body.add_geom(**shape, mass=item.mass / len(boxes))
    return body


def _set_physics(mj: Any, spec: Any, physics: Physics) -> None:
    option = spec.option
    option.timestep, option.iterations, option.gravity = physics.timestep, physics.iterations, [0.0, 0.0, -GRAVITY]
    option.integrator = mj.mjtIntegrator.mjINT_EULER
    option.cone, option.impratio = mj.mjtCone.mjCONE_ELLIPTIC, physics.impedance_ratio
    option.disableflags |= mj.mjtDisableBit.mjDSBL_AUTORESET
    _set_contacts(spec.geoms, physics, torsion=0.0)


def _set_contacts(geoms: Iterable[Any], physics: Physics, torsion: float) -> None:
    """Friction and compliance; of the two shapes of a pair the larger coefficients count."""
    for geom in geoms:
        geom.condim = 4 if torsion > 0.0 else 3
        geom.friction = [physics.friction, torsion, 0.0]
        geom.solref = [physics.contact_time, 1.0]
        geom.solimp = [*IMPEDANCE, physics.contact_depth, 0.5, 2.0]


def _check(model: Any, robot: RobotModel, parts: Parts) -> None:
    """A URDF may be read differently by different readers; here is where that is noticed."""
    mass = float(np.sum(model.body_mass[list(parts.bodies)]))
    if abs(mass - robot.mass) > MASS_TOLERANCE * robot.mass:
        raise SimulationError(f"{robot.name}: {mass:.6g} kg in MuJoCo, {robot.mass:.6g} kg in the model")


def _wxyz(rpy: tuple[float, float, float]) -> list[float]:
    x, y, z, w = quaternions(np.array(rpy)).tolist()
    return [w, x, y, z]
