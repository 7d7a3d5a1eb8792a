"""`RobotModel`: the robot every stage works with; a URDF plus what was recognised in it."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from gaitforge.errors import InputError, Problem
from gaitforge.robot.limbs import Limb, ToolMount
from gaitforge.robot.payload import BODY, Load, laden_urdf
from gaitforge.robot.rotation import matrices, quaternions

if TYPE_CHECKING:
    import pinocchio

Array = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Nominal:
    """Defaults of a robot, from ``robot.yaml: nominal``; arrays are in the order of `joint_names`."""

    posture: Array
    """(n_J,) standing joint positions [rad]"""
    held_posture: Array
    """(n_J,) joint positions of a limb that is held off the ground [rad]"""
    body_height: float
    """Height of base_link above the ground when standing [m]"""
    speed: float = 0.064
    """[m/s]"""
    duration: float = 2.0
    """[s] of one gait cycle"""
    columns: int = 12
    """m of a gait"""
    step_height: float = 0.03
    """[m]"""
    gait: str = "tripod"
    """Pattern of a walk with all limbs: tripod · wave · program"""
    transition_columns: int = 11
    transition_column_s: float = 0.125
    """[s] per column of a transition"""
    postures: Mapping[str, Array] = field(default_factory=dict)
    """Standing postures by name, (n_J,) [rad] each, for `plan_gait(posture=…)`."""


@dataclass(frozen=True)
class Capsule:
    """A segment with a radius that encloses one collision shape; for clearance between limbs."""

    link: str
    a: tuple[float, float, float]
    """[m] in the link frame"""
    b: tuple[float, float, float]
    radius: float
    """[m]"""


@dataclass(frozen=True)
class Box:
    """A box that encloses one collision shape of the trunk; for clearance between limbs and trunk."""

    center: tuple[float, float, float]
    """[m] in the frame of the base link"""
    rotation: tuple[tuple[float, float, float], ...]
    """(3, 3) its axes in the frame of the base link"""
    size: tuple[float, float, float]
    """[m] edge lengths"""


@dataclass(frozen=True, eq=False)
class RobotModel:
    """A legged robot: frozen, and the same for planning, verification and logging.

    Base poses are (6,) arrays x, y, z [m], roll, pitch, yaw [rad] (R = Rz Ry Rx) of `base_link` in
    the world; joint vectors are (n_J,) in the order of `joint_names` (limb by limb, tool joints
    after the joints of their limb).
    """

    name: str
    urdf: str = field(repr=False)
    limbs: tuple[Limb, ...]
    joint_names: tuple[str, ...]
    lower: Array = field(repr=False)
    """(n_J,) [rad]"""
    upper: Array = field(repr=False)
    velocity: Array = field(repr=False)
    """(n_J,) [rad/s]"""
    effort: Array = field(repr=False)
    """(n_J,) [N m]"""
    nominal: Nominal = field(repr=False)
    tools: tuple[ToolMount, ...] = ()
    capsules: tuple[Capsule, ...] = field(default=(), repr=False)
    trunk: tuple[Box, ...] = field(default=(), repr=False)
    """The collision shapes of the base link."""
    base_link: str = "base_link"
    modules: int = 0
    """Number of actuated modules."""
    warnings: tuple[str, ...] = ()
    """What was noticed about the robot's file and is no error."""
    loads: tuple[Load, ...] = ()
    """What the robot carries; their masses are in `urdf`."""
    _empty: RobotModel | None = field(default=None, repr=False)
    """The robot without its loads; None: it has none."""

    def carrying(self, *loads: Load) -> RobotModel:
        """The same robot with these loads and no others: in its URDF, so in mass, centre of mass and dynamics alike.

        Raises InputError for a frame that the robot does not have.
        """
        if loads == self.loads:
            return self
        empty = self._empty or self
        if not loads:
            return empty
        if loads not in empty._laden:
            urdf = laden_urdf(empty.urdf, [(load, *empty._carrier(load)) for load in loads])
            empty._laden[loads] = replace(empty, urdf=urdf, loads=loads, _empty=empty)
        return empty._laden[loads]

    def _carrier(self, load: Load) -> tuple[str, Array]:
        """The link that carries a load, and the load's centre of mass in the frame of that link (3,) [m]."""
        point = np.array(load.point)
        if load.frame == BODY:
            return self.base_link, point
        for tool in self.tools:
            if tool.name == load.frame:
                return tool.link, tool.T_link_tool[:3, :3] @ point + tool.T_link_tool[:3, 3]
        for limb in self.limbs:
            if limb.name == load.frame:
                return limb.foot.link, point
        known = (BODY, *self.limb_names, *(tool.name for tool in self.tools))
        raise InputError(Problem(self.name, "load.frame", repr(load.frame), "one of " + ", ".join(known)))

    @cached_property
    def _laden(self) -> dict[tuple[Load, ...], RobotModel]:
        return {}

    @cached_property
    def pin(self) -> pinocchio.Model:
        """The Pinocchio model with a free-flyer root."""
        import pinocchio

        return pinocchio.buildModelFromXML(self.urdf, pinocchio.JointModelFreeFlyer())

    @cached_property
    def pin_data(self) -> pinocchio.Data:
        """Scratch memory for Pinocchio's algorithms, which takes longer to make than to use."""
        return self.pin.createData()

    @cached_property
    def _q_index(self) -> NDArray[np.intp]:
        return np.array([self.pin.joints[self.pin.getJointId(n)].idx_q for n in self.joint_names], dtype=np.intp)

    @cached_property
    def mass(self) -> float:
        """[kg]"""
        return float(sum(i.mass for i in self.pin.inertias))

    @property
    def limb_names(self) -> tuple[str, ...]:
        """Rows of C."""
        return tuple(limb.name for limb in self.limbs)

    def limb(self, name: str) -> Limb:
        """The limb called `name`, or the limb that carries the tool called `name`; else InputError."""
        for limb in self.limbs:
            if limb.name == name:
                return limb
        for tool in self.tools:
            if tool.name == name:
                return self.limb(tool.limb)
        carried = tuple(t.name for t in self.tools)
        expected = "one of " + ", ".join(self.limb_names + carried)
        raise InputError(Problem(self.name, "limb", repr(name), expected))

    def tool(self, limb: str, kind: str = "camera") -> ToolMount | None:
        """The tool of that kind on the limb, or None."""
        return next((t for t in self.tools if t.limb == limb and t.kind == kind), None)

    def joint_indices(self, limb: Limb) -> NDArray[np.intp]:
        """Rows of P that belong to the limb's walking joints."""
        return self._rows[limb.joints] if limb.joints in self._rows else self._row_numbers(limb.joints)

    @cached_property
    def _rows(self) -> dict[tuple[str, ...], NDArray[np.intp]]:
        return {limb.joints: self._row_numbers(limb.joints) for limb in self.limbs}

    def _row_numbers(self, joints: tuple[str, ...]) -> NDArray[np.intp]:
        return np.array([self.joint_names.index(j) for j in joints], dtype=np.intp)

    def standing_on(self, walking: Collection[str]) -> Array:
        """(n_J,) nominal posture of the limbs named, held posture of the others [rad]."""
        joints = np.array(self.nominal.posture, dtype=float)
        for limb in self.limbs:
            if limb.name not in walking:
                rows = self.joint_indices(limb)
                joints[rows] = self.nominal.held_posture[rows]
        return joints

    # -- Pinocchio in the conventions above -------------------------------------------------
    def configuration(self, base_pose: ArrayLike, joints: ArrayLike) -> Array:
        """(nq,) Pinocchio's q for a base pose and joint positions; (n, nq) for n of both."""
        base, positions = np.asarray(base_pose, dtype=float), np.asarray(joints, dtype=float)
        q = np.tile(self._neutral, (*base.shape[:-1], 1)) if base.ndim > 1 else self._neutral.copy()
        q[..., :3], q[..., 3:7] = base[..., :3], quaternions(base[..., 3:6])
        q[..., self._q_index] = positions
        return q

    @cached_property
    def _neutral(self) -> Array:
        import pinocchio

        return np.array(pinocchio.neutral(self.pin), dtype=float)

    def velocity_vector(self, base_pose: ArrayLike, base_rate: ArrayLike, joint_rates: ArrayLike) -> Array:
        """(nv,) Pinocchio's v from the rates of x, y, z, roll, pitch, yaw [m/s, rad/s] and of the joints.

        (n, nv) for n of all three.
        """
        pose, rate = np.asarray(base_pose, dtype=float), np.asarray(base_rate, dtype=float)
        rotation = matrices(pose[..., 3:6])
        (cr, cp), (sr, sp) = (np.moveaxis(f(pose[..., 3:5]), -1, 0) for f in (np.cos, np.sin))
        roll, pitch, yaw = np.moveaxis(rate[..., 3:6], -1, 0)
        v = np.zeros((*pose.shape[:-1], self.pin.nv))
        v[..., :3] = np.einsum("...ji,...j->...i", rotation, rate[..., :3])
        v[..., 3] = roll - sp * yaw
        v[..., 4] = cr * pitch + sr * cp * yaw
        v[..., 5] = -sr * pitch + cr * cp * yaw
        v[..., self._q_index - 1] = np.asarray(joint_rates, dtype=float)
        return v

    def _data(self, base_pose: ArrayLike, joints: ArrayLike) -> Any:
        import pinocchio

        data = self.pin_data
        pinocchio.forwardKinematics(self.pin, data, self.configuration(base_pose, joints))
        pinocchio.updateFramePlacements(self.pin, data)
        return data

    def link_pose(self, link: str, base_pose: ArrayLike, joints: ArrayLike) -> Array:
        """(4, 4) pose of a link in the world."""
        import pinocchio

        frame = self.pin.getFrameId(link, pinocchio.FrameType.BODY)
        return np.array(self._data(base_pose, joints).oMf[frame].homogeneous)

    def foot_positions(self, base_pose: ArrayLike, joints: ArrayLike) -> Array:
        """(n_F, 3) centres of the foot spheres in the world [m]."""
        import pinocchio

        data = self._data(base_pose, joints)
        body = pinocchio.FrameType.BODY
        return np.array(
            [data.oMf[self.pin.getFrameId(x.foot.link, body)].act(np.array(x.foot.offset)) for x in self.limbs]
        )

    def center_of_mass(self, base_pose: ArrayLike, joints: ArrayLike) -> Array:
        """(3,) in the world [m]; (n, 3) for n base poses and joint positions."""
        import pinocchio

        data, q = self.pin_data, self.configuration(base_pose, joints)
        if q.ndim == 1:
            return np.array(pinocchio.centerOfMass(self.pin, data, q))
        return np.array([pinocchio.centerOfMass(self.pin, data, one) for one in q])
