"""What stands in the way at the best placement a search has found."""

import numpy as np

from ...arrays import Array
from ...mechanics.statics import tipping_rows, wrench_matrix
from ...robot import Robot
from ..capacity import standing_margin
from .program import UNREACHABLE, Duty, worst_margin
from .search import overlap


def why_not_found(robot: Robot, duty: Duty, best: float, demand: float) -> str:
    """The pose and wrench that are worst served there, and the cable or the base that is short."""
    if best <= UNREACHABLE:
        return ("bases would stand in each other or masts in the platform"
                if overlap(robot, duty.poses) > 0
                else "at some pose the cables cannot exert the wrench at all, whatever their tensions")
    i, j = divmod(int(np.argmin([worst_margin(robot, one)[0] for one in duty.each()])),
                  duty.loads.shape[1])
    worst = duty.one(i, j)
    alone, tensions = worst_margin(robot, worst._replace(tipping=False))
    if best >= 0:
        short = f"margin {best:.3g} instead of {demand:g}"
    else:
        short = _tipping(robot, worst) if alone >= 0 else _pulling(robot, tensions[0, 0],
                                                                   best < alone - 1e-6)
    return (f"at the best placement, pose {i + 1} of {len(duty.poses)} (at "
            f"{np.round(worst.poses.position[0], 3).tolist()} m) under the wrench "
            f"{np.round(worst.loads[0, 0], 3).tolist()}: {short}")


def _pulling(robot: Robot, tensions: Array, tips: bool) -> str:
    cable = int(np.maximum(robot.tension_min - tensions, tensions - robot.tension_max).argmax())
    too = ", and every base must stand" if tips else ""
    return (f"cable {cable + 1} would need {tensions[cable]:.4g} N, allowed {robot.tension_min[cable]:g} to "
            f"{robot.tension_max[cable]:g} N{too}; allow larger tensions, ask for fewer poses, or let more bases drive")


def _tipping(robot: Robot, worst: Duty) -> str:
    """The base that tips most, each asked for alone; or that they tip together only."""
    pose = worst.poses[0]
    W, load = wrench_matrix(robot, pose), worst.loads[0, 0]
    stands = {name: standing_margin(robot, W, load, rows.matrix, -rows.offset)
              for name, rows in tipping_rows(robot, pose).items()}
    name = min(stands, key=lambda base: stands[base])
    what = (f"base {name!r} tips, a moment of {-stands[name]:.4g} N m too much about an edge of its footprint at least"
            if stands[name] < 0 else "one base or another tips, whichever is relieved")
    return (f"the cables could within their limits, but {what}; let bases weigh more or stand wider, ask for fewer "
            "poses, or ask of the cables alone with tipping=False")
