"""PyBullet behind the `Simulator` interface: the only module that imports it, and only when used.

A cable is a UPS leg: universal joint at the exit point, an actuated prismatic joint, a point mass at the tip, and
a point-to-point constraint from the tip to the platform's anchor point. A pull on the prismatic joint is the
tension. With a 1e-4 kg tip the leg reproduces an ideal massless cable to about 1 µm and 0.001 N.
"""

from __future__ import annotations

import contextlib
import ctypes
import math
import os
import sys
from collections.abc import Iterator
from functools import cache
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array
from ..errors import InvalidInput, MissingDependency, SimulationDiverged
from ..pose import Pose
from ..robot import Robot
from ..world import World
from .simulator import Simulator, State

DEFAULT_TIP_MASS = 1e-4
DEFAULT_SOLVER_ITERATIONS = 10


class SpatialSimulator(Simulator):
    """A spatial world in its own PyBullet client (DIRECT mode, no window).

    world : a spatial World
    cables : "tension" (UPS legs) or "force" (external forces at the platform)
    dt : time step [s]
    tip_mass : point mass at each leg's tip [kg]; the tension error is about tip_mass (g + a)
    solver_iterations : of Bullet's constraint solver
    """

    def __init__(self, world: World, cables: str = "tension", dt: float = 1e-3, *,
                 tip_mass: float = DEFAULT_TIP_MASS, solver_iterations: int = DEFAULT_SOLVER_ITERATIONS) -> None:
        self.world, self.robot, self.dt, self.cables = world, world.robot, float(dt), cables
        self.tip_mass = float(tip_mass)
        self._bullet = import_pybullet()
        with _quiet():
            self._client = self._bullet.connect(self._bullet.DIRECT)
        self._camera: Any = None
        self._substeps = 1
        self._engine(self.dt, solver_iterations)
        self._body = _BodyFrame(self.robot)
        self._platform = self._make_platform()
        self._make_scene()
        self._legs: tuple[int, ...] = ()
        self.reset()

    # --- the interface ----------------------------------------------------------------------------
    def reset(self, pose: Pose | None = None) -> State:
        start = self.world.pose if pose is None else pose
        b, client = self._bullet, self._client
        position, quaternion = self._body.from_pose(start)
        b.resetBasePositionAndOrientation(self._platform, position, quaternion, physicsClientId=client)
        b.resetBaseVelocity(self._platform, [0, 0, 0], [0, 0, 0], physicsClientId=client)
        for leg in self._legs:
            b.removeBody(leg, physicsClientId=client)  # removes its constraint too
        self._legs, self._constraints = self._make_legs(start) if self.cables == "tension" else ((), ())
        m = self.robot.n_cables
        self._whole = np.ones(m, dtype=bool)
        self._push = np.zeros(6)
        self._steps = 0
        self._measured = np.zeros(m)
        self._directions = np.zeros((m, 3))
        self._reach = 20 * max(1.0, float(np.abs(self.robot.exit_points).max()), float(np.abs(start.position).max()))
        self._read()
        return self.state()

    def step(self, tensions: Array, substeps: int = 1) -> None:
        if substeps != self._substeps:
            self._substeps = substeps
            # One engine call for all substeps: forces are held over them, and Python waits only once.
            self._bullet.setPhysicsEngineParameter(fixedTimeStep=self.dt * substeps, numSubSteps=substeps
                                                   if substeps > 1 else 0, physicsClientId=self._client)
        if self._push_on:
            self._apply_wrench(self._push)
        if self._legs:
            self._pull_legs(tensions)
        else:
            self._pull_platform(tensions)
        self._bullet.stepSimulation(physicsClientId=self._client)
        self._steps += substeps
        self._read()

    def state(self) -> State:
        return State(self._steps * self.dt, self.robot, self.position, self.rotation, self.twist,
                     self.measured_tensions())

    def cut(self, cables: ArrayLike | None = None) -> None:
        m = self.robot.n_cables
        indices = range(m) if cables is None else np.atleast_1d(np.asarray(cables, dtype=int)).tolist()
        for i in indices:
            if not 0 <= i < m:
                raise InvalidInput(f"cable index must be 0 to {m - 1}, got {i}")
            if self._whole[i] and self._constraints:
                self._bullet.removeConstraint(self._constraints[i], physicsClientId=self._client)
            self._whole[i] = False

    def push(self, wrench: ArrayLike) -> None:
        given = as_array(wrench, "external wrench", (self.robot.n_dof,), "N, N m")
        self._push = self.robot.pattern.basis(self.rotation) @ given

    def contact_force(self) -> float:
        contacts = self._bullet.getContactPoints(bodyA=self._platform, physicsClientId=self._client)
        return float(sum(contact[9] for contact in contacts))

    def render(self, width: int = 640, height: int = 480) -> Any:
        from .camera import Camera

        if self._camera is None:
            self._camera = Camera(self.world)
        tensions = np.where(self._whole, self.measured_tensions(), np.nan)
        return self._camera.picture(Pose.of(self.position, self.rotation), tensions, width, height)

    def close(self) -> None:
        if self._client >= 0:
            self._bullet.disconnect(physicsClientId=self._client)
            self._client = -1
        if self._camera is not None:
            self._camera.close()
            self._camera = None

    # --- what the closed loop reads without overhead ------------------------------------------------
    def constraint_forces(self) -> Any:
        """(m, 3) reaction of each leg's constraint during the last step, on the tip, in world axes [N]."""
        read, client = self._bullet.getConstraintState, self._client
        if not self._constraints:
            return self._measured[:, None] * -self._directions
        return [read(k, physicsClientId=client)[:3] if whole else (0.0, 0.0, 0.0)
                for k, whole in zip(self._constraints, self._whole_list)]
