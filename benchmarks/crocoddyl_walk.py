"""One walking cycle planned by Crocoddyl: `python crocoddyl_walk.py request.json reply.json`.

Run by `benchmarks.motion_crocoddyl` with the Python of another environment; imports nothing of gaitforge.
Contacts are given, feet are points, the dynamics those of the whole body; feasibility-driven DDP begins with the first
state at every node.  Costs are quadratic, weighted much as in Crocoddyl's own quadruped examples; limits and friction
cones are costs too.
"""

from __future__ import annotations

import json
import sys
import time
from importlib import metadata
from pathlib import Path
from typing import Any

import crocoddyl
import numpy as np
import pinocchio as pin

FOOT, LANDING, COM, FRICTION, LIMITS = 1e6, 1e7, 1e6, 1e2, 1e3
SIDEWAYS = 0.01
"""Share of the centre of mass's weight that holds it on the midline: a crawl sways."""


class Walk:
    """The request as a Pinocchio model, the states it begins with, and where feet and body shall go."""

    def __init__(self, request: dict[str, Any], nodes: int) -> None:
        self.request, self.nodes = request, nodes
        self.contact = np.repeat(np.array(request["contact"], dtype=bool), nodes, axis=1).T  # (N, n_F)
        self.dt = request["duration"] / len(self.contact)
        self.model = pin.buildModelFromUrdf(request["urdf"], pin.JointModelFreeFlyer())
        self.feet = [self._foot(i, **foot) for i, foot in enumerate(request["feet"])]
        self.data = self.model.createData()
        self.q, later = (self._configuration(**request[key]) for key in ("start", "soon"))
        velocity = pin.difference(self.model, self.q, later) / request["soon_seconds"]
        self.x0 = np.concatenate([self.q, velocity])
        pin.centerOfMass(self.model, self.data, self.q)
        self.com = self.data.com[0].copy()
        self.home = self.positions(self.q)  # (n_F, 3)
        self.travel = request["speed"] * request["duration"]
        self.state = crocoddyl.StateMultibody(self.model)
        self.actuation = crocoddyl.ActuationModelFloatingBase(self.state)

    def _foot(self, number: int, link: str, offset: list[float]) -> int:
        """A frame in the centre of the foot sphere."""
        body = self.model.frames[self.model.getFrameId(link, pin.FrameType.BODY)]
        place = body.placement * pin.SE3(np.eye(3), np.array(offset))
        return int(
            self.model.addFrame(pin.Frame(f"walking_foot_{number}", body.parentJoint, place, pin.FrameType.OP_FRAME))
        )

    def _configuration(self, base: list[float], joints: dict[str, float]) -> np.ndarray:
        tangent = np.zeros(self.model.nv)
        for name, angle in joints.items():
            tangent[self.model.joints[self.model.getJointId(name)].idx_v] = angle
        q = pin.integrate(self.model, pin.neutral(self.model), tangent)
        turn = pin.rpy.rpyToMatrix(np.array(base[3:]))
        q[:7] = pin.SE3ToXYZQUAT(pin.SE3(turn, np.array(base[:3])))
        return q

    def positions(self, q: np.ndarray) -> np.ndarray:
        """(n_F, 3) [m] of the feet."""
        pin.framesForwardKinematics(self.model, self.data, q)
        return np.array([self.data.oMf[f].translation for f in self.feet])

    def targets(self) -> np.ndarray:
        """(N + 1, n_F, 3): every foot waits, swings once, by the travel of the cycle, and waits."""
        count, n_feet = self.contact.shape
        at = np.tile(self.home, (count + 1, 1, 1))
        for i in range(n_feet):
            swing = np.flatnonzero(~self.contact[:, i])
            done = np.clip((np.arange(count + 1) - swing[0]) / len(swing), 0.0, 1.0)
            at[:, i, 0] += self.travel * done
            at[:, i, 2] += self.request["step_height"] * np.sin(np.pi * done) ** 2
        return at

    def problem(self) -> crocoddyl.ShootingProblem:
        """One action a node; the end asks for the first state, carried on."""
        at = self.targets()
        running = [
            crocoddyl.IntegratedActionModelEuler(self._action(at[k], k, self.contact[k]), self.dt)
            for k in range(len(self.contact))
        ]
        last = self._action(at[-1], len(self.contact), self.contact[-1])
        return crocoddyl.ShootingProblem(self.x0, running, crocoddyl.IntegratedActionModelEuler(last, 0.0))

    def _action(self, at: np.ndarray, k: int, held: np.ndarray) -> Any:
        """Constrained forward dynamics in interval k with the costs at its beginning."""
        state, nu = self.state, self.actuation.nu
        contacts = crocoddyl.ContactModelMultiple(state, nu)
        costs = crocoddyl.CostModelSum(state, nu)
        cone = crocoddyl.FrictionCone(np.eye(3), self.request["friction"], 4, True)  # a pyramid inside the cone
        bounds = crocoddyl.ActivationBounds(cone.lb, cone.ub)
        for i, frame in enumerate(self.feet):
            if held[i]:
                contact = crocoddyl.ContactModel3D(
                    state, frame, at[i], pin.LOCAL_WORLD_ALIGNED, nu, np.array([0.0, 50.0])
                )
                contacts.addContact(f"foot {i}", contact)
                residual = crocoddyl.ResidualModelContactFrictionCone(state, frame, cone, nu)
                barrier = crocoddyl.ActivationModelQuadraticBarrier(bounds)
                costs.addCost(f"cone {i}", crocoddyl.CostModelResidual(state, barrier, residual), FRICTION)
            lands = k > 0 and held[i] and not self.contact[k - 1, i]
            if lands or not held[i]:
                place = crocoddyl.ResidualModelFrameTranslation(state, frame, at[i], nu)
                costs.addCost(f"place {i}", crocoddyl.CostModelResidual(state, place), LANDING if lands else FOOT)
            if lands:
                still = crocoddyl.ResidualModelFrameVelocity(
                    state, frame, pin.Motion.Zero(), pin.LOCAL_WORLD_ALIGNED, nu
                )
                linear = crocoddyl.ActivationModelWeightedQuad(np.array([1.0] * 3 + [0.0] * 3))
                costs.addCost(f"still {i}", crocoddyl.CostModelResidual(state, linear, still), FOOT)
        self._body_costs(costs, k)
        return crocoddyl.DifferentialActionModelContactFwdDynamics(state, self.actuation, contacts, costs, 0.0, True)

    def _body_costs(self, costs: crocoddyl.CostModelSum, k: int) -> None:
        state, nu, joints = self.state, self.actuation.nu, self.model.nv - 6
        goal = self.com + np.array([self.travel * k / len(self.contact), 0.0, 0.0])
        along = crocoddyl.ActivationModelWeightedQuad(np.array([1.0, SIDEWAYS, 1.0]))
        com = crocoddyl.ResidualModelCoMPosition(state, goal, nu)
        costs.addCost("com", crocoddyl.CostModelResidual(state, along, com), COM)
        weights = np.array([0.0] * 3 + [500.0] * 3 + [0.01] * joints + [10.0] * 6 + [1.0] * joints)
        rest = np.concatenate([self.q, np.zeros(self.model.nv)])
        posture = crocoddyl.ActivationModelWeightedQuad(weights)
        residual = crocoddyl.ResidualModelState(state, rest, nu)
        costs.addCost("posture", crocoddyl.CostModelResidual(state, posture, residual), 1e1)
        costs.addCost("torque", crocoddyl.CostModelResidual(state, crocoddyl.ResidualModelControl(state, nu)), 1e-1)
        lower = np.concatenate([state.lb[1 : state.nv + 1], state.lb[-state.nv :]])
        upper = np.concatenate([state.ub[1 : state.nv + 1], state.ub[-state.nv :]])
        barrier = crocoddyl.ActivationModelQuadraticBarrier(crocoddyl.ActivationBounds(lower, upper))
        free = crocoddyl.ResidualModelState(state, state.zero(), nu)
        costs.addCost("limits", crocoddyl.CostModelResidual(state, barrier, free), LIMITS)

    def measured(self, solver: crocoddyl.SolverFDDP) -> dict[str, float]:
        """What the plan keeps of what nobody enforced [m, rad, N m]."""
        at, xs = self.targets(), np.array(solver.xs)
        feet = np.array([self.positions(x[: self.model.nq]) for x in xs])
        landed = [float(np.linalg.norm(feet[-1, i] - at[-1, i])) for i in range(len(self.feet))]
        slips, lifts = [0.0], []
        for i in range(len(self.feet)):
            swing = np.flatnonzero(~self.contact[:, i])
            before, after = feet[: swing[0] + 1, i, :2], feet[swing[-1] + 1 :, i, :2]
            slips += [float(np.linalg.norm(np.ptp(part, axis=0))) for part in (before, after)]
            lifts.append(float(feet[:, i, 2].max() - self.home[i, 2]))
        end = self.q.copy()
        end[0] += self.travel
        return {
            "slip_m": max(slips),
            "penetration_m": float(np.maximum(0.0, (self.home[:, 2] - feet[:, :, 2])).max()),
            "landing_error_m": max(landed),
            "lift_m": min(lifts),
            "cone_excess_N": self._cone_excess(solver),
            "cyclic_gap_rad": float(np.abs(pin.difference(self.model, end, xs[-1][: self.model.nq])[6:]).max()),
            "torque_Nm": float(np.abs(np.array(solver.us)).max()),
        }

    def _cone_excess(self, solver: crocoddyl.SolverFDDP) -> float:
        """[N] by which a contact force leaves its cone, or pulls, at worst."""
        solver.problem.calc(solver.xs, solver.us)  # the last step tried may not be the one taken
        worst = 0.0
        for held, data in zip(self.contact, solver.problem.runningDatas, strict=True):
            for i in np.flatnonzero(held):
                force = data.differential.multibody.contacts.contacts[f"foot {i}"].f.linear  # along the world's axes
                worst = max(worst, float(np.hypot(force[0], force[1]) - self.request["friction"] * force[2]))
        return worst


def planned(request: dict[str, Any], nodes: int) -> dict[str, Any]:
    """Medians are the reader's: every repeat's seconds of processor and by the clock."""
    walk = Walk(request, nodes)
    builds, clocks, processor = [], [], []
    for repeat in range(request["repeats"] + 1):
        begin = time.process_time()
        problem = walk.problem()
        problem.nthreads = 1
        solver = crocoddyl.SolverFDDP(problem)
        xs = [walk.x0] * (problem.T + 1)
        built, wall = time.process_time(), time.perf_counter()
        solved = solver.solve(xs, problem.quasiStatic(xs[:-1]), request["most_iterations"], False, 1e-9)
        if repeat:  # the first one nobody times
            builds.append(built - begin)
            processor.append(time.process_time() - built)
            clocks.append(time.perf_counter() - wall)
    numbers = {"iterations": int(solver.iter), "solved": bool(solved), "cost": float(solver.cost)}
    times = {"build_s": builds, "processor_s": processor, "wall_s": clocks}
    return {"nodes": problem.T, "dt": walk.dt, **numbers, **times, **walk.measured(solver)}


def main(request: Path, reply: Path) -> None:
    """Plan at every grid of the request."""
    asked = json.loads(request.read_text(encoding="utf-8"))
    plans = [planned(asked, nodes) for nodes in asked["nodes_per_column"]]
    versions = {name: metadata.version(name) for name in ("crocoddyl", "pin", "numpy")}
    reply.write_text(json.dumps({"versions": versions, "plans": plans}, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2]))
