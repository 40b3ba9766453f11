"""Mobile bases that drive during a run."""

from typing import Any

from ..arrays import as_answer
from ..robot import Robot
from ..simulate import Simulator


class Drive:
    """Mobile bases driven during a run: their speeds, asked for at each step, and what the log keeps of them.

    speeds : (3p,) or t → (3p,); period : control step [s]
    """

    def __init__(self, speeds: Any, period: float) -> None:
        self.speeds, self.period = speeds, period
        self.poses: list[Any] = []

    def step(self, engine: Simulator) -> Robot:
        """Set the coming step's speeds; returns the robot with its bases where they will be at the step's end."""
        now = len(self.poses) * self.period
        robot, speeds = engine.robot, self.speeds
        if callable(speeds):
            speeds = as_answer(speeds(now), "base_speeds", 3 * len(robot.bases), "rad/s, m/s", now)
        driven = engine.drive(speeds).reshape(-1, 3)
        robot = engine.robot
        self.poses.append([base.pose for base in robot.bases])
        return robot.with_bases({
            base.name: (*(base.position + base.rotation[:2, :2] @ speed[1:] * self.period),
                        base.heading + speed[0] * self.period)
                        for base, speed in zip(robot.bases, driven)})
