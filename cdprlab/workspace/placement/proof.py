"""That no placement at all can serve a pose and wrench: bounds on what cables pull from wherever their bases stand."""

from dataclasses import replace
from itertools import product

import numpy as np

from ...arrays import Array
from ...mechanics.cables import anchor_offsets, cable_directions, cable_vectors
from ...mechanics.optimization import largest_last
from ...mechanics.statics import footings
from ...robot import Robot
from ...robot.pose import Pose, cross
from .program import Duty

_ROUNDING = 1e-6
"""Shares of a wrench closer to 1 than this are no proof."""


def why_impossible(robot: Robot, duty: Duty) -> str:
    """The first pose and wrench that no placement can serve, and what is short there; '' where none is proven.

    For every cable the force f_i = τ_i u_i lies, wherever its base stands, in a convex set: a
    cable on a base that cannot move keeps u_i; one on a base that drives along E pulls within
    {α (A_i − B_i) + E β, α ≥ 0}, |f_i| ≤ τ_max. Standing is a linear bound on the f_i too. The
    largest share λ ≤ 1 of w_e that Σ [f_i; (R b_i) × f_i] = −λ w_e allows is a linear program;
    below 1, no placement balances w_e. Over pulleys u_i turns otherwise, and nothing is proven.
    """
    if robot.pulleys.size:
        return ""
    for i, j in np.ndindex(*duty.loads.shape[:2]):
        pose, load = duty.poses[i], duty.loads[i, j]
        if largest_share(robot, pose, load, duty.tipping) < 1 - _ROUNDING:
            return f"{duty.named(i, j)}: {_lift(robot, pose, load) or _short(robot, pose, load)}"
    return ""


def _lift(robot: Robot, pose: Pose, load: Array) -> str:
    """The plainest reason, or '': what must be pulled up, and the cables that pull up at all."""
    d = robot.dimension
    lifting = np.array([rise > 0 or bool(_ways(robot, k)[:, -1].any())
                        for rise, k in zip(cable_vectors(robot, pose)[:, -1], robot.base_indices)])
    able = float(robot.tension_max[lifting].sum())
    if robot.n_dof < d or -load[d - 1] <= able:
        return ""
    return (f"it needs {-load[d - 1]:.4g} N upwards; {int(lifting.sum())} of {robot.n_cables} cables have their exit "
            f"point above their anchor point there and could pull {able:.4g} N at most")


def _short(robot: Robot, pose: Pose, load: Array) -> str:
    """What allows a share of the load only: limits with every base free, directions that are held, or standing."""
    floor = np.array([1.0, 1.0, 1.0] if robot.dimension == 3 else [0.0, 1.0, 0.0])     # what any base could do
    held = [base.name for base in robot.bases if (base.speed_max[floor > 0] == 0).any()]
    free = replace(robot, bases=tuple(replace(base, speed_max=np.maximum(base.speed_max, floor))
                                      for base in robot.bases))
    for placed, standing, reason in (
            (free, False, "wherever the bases stand, the tension limits allow"),
            (robot, False, f"while {' and '.join(held)} may not drive in every direction (speed limits of 0), the "
                           "tension limits allow"),
            (robot, True, "the tension limits would allow it, but with every base standing, wherever that is,")):
        share = largest_share(placed, pose, load, standing)
        if share < 1 - _ROUNDING:
            return f"{reason} {f'at most {100 * share:.4g} %' if share >= 0 else 'no part'} of it"
    return ""


def largest_share(robot: Robot, pose: Pose, load: Array, tipping: bool) -> float:
    """An upper bound on the share λ ≤ 1 of ``load`` that any placement can balance; −1 where not even λ = 0."""
    m, d = robot.n_cables, robot.dimension
    # What cables can pull wherever their bases stand: f = y @ forces, three entries of y a
    # cable.
    pulls, bounds = np.zeros((m, m, 3, d)), np.full((m, 3, 2), [-np.inf, np.inf])
    for i, (u, k) in enumerate(zip(cable_directions(robot, pose), robot.base_indices)):
        ways = _ways(robot, k)
        pulls[i, i] = [u, *ways]
        bounds[i, 0] = (0.0, np.inf) if ways.any() else (robot.tension_min[i], robot.tension_max[i])
    forces = pulls.reshape(m, 3 * m, d)
    moments = cross(anchor_offsets(robot, pose)[:, None], forces)
    exerted = robot.pattern.basis(pose.rotation).T @ np.concatenate([forces, moments], axis=-1).sum(axis=0).T
    # |f_i| ≤ τ_max as a polytope around the ball: what it does not hold, the ball does not.
    normals = _normals(d, load)
    rows = [np.swapaxes(forces @ normals.T, 1, 2).reshape(-1, 3 * m)]
    sides = [np.repeat(robot.tension_max, len(normals))]
    for k, base in enumerate(robot.bases) if tipping else ():
        if len(base.footprint) and not (d == 2 and base.speed_max[0]):   # the plane turns footprints up
            edges, spare = standing_rows(robot, k, cable_vectors(robot, pose)[:, -1])
            rows.append(np.einsum("eid,ivd->ev", edges, forces))
            sides.append(spare)
    A = np.pad(np.concatenate(rows), ((0, 0), (0, 1)))
    share, _ = largest_last(A, np.concatenate(sides), np.column_stack([exerted, load]),
                            np.zeros(robot.n_dof),
                            [*bounds.reshape(-1, 2), (0.0, 1.0)])
    if np.isnan(share):   # no answer is no proof
        return 1.0
    return max(share, -1.0)


def _ways(robot: Robot, k: int) -> Array:
    """(2, d) directions in which a base takes its exit points along, or 0; a turning one swings them any way."""
    ways = np.eye(2, robot.dimension)
    if k < 0:
        return 0 * ways
    base = robot.bases[k]
    if base.speed_max[0] > 0:
        return ways
    return np.asarray(base.rotation.T[:2] * (base.speed_max[1:, None] > 0))


def _normals(d: int, load: Array) -> Array:
    """(q, d) unit normals of the polytope around a ball, one of them along the force that is needed."""
    corners = np.array(list(product(np.linspace(-1, 1, 5), repeat=d)))
    normals = np.vstack([corners, np.append(-load[:d], np.zeros(d))[:d]])
    normals = normals[normals.any(axis=1)]
    return np.asarray(normals / np.linalg.norm(normals, axis=1, keepdims=True))


def standing_rows(robot: Robot, k: int, rises: Array) -> tuple[Array, Array]:
    """Rows (e, m, d) over the f_i and sides (e,) [N m] that hold while a base with a footprint stands, wherever it is.

    A base that does not turn takes its footing along. One that turns may bring exit points r_i,
    center of mass G and corners any way round: in every direction e its center of pressure p
    keeps p·e ≤ R, the farthest corner's, with p·e N = Σ (−z_i f_ie + r_ie f_iz) + G_e m g and N
    = m g + Σ f_iz, and only the lengths of r_i and G are known.
    """
    base = robot.bases[k]
    if base.speed_max[0] == 0:
        footing = next(each for each in footings(robot) if each.base == k)
        return footing.levers @ base.rotation.T, -footing.center @ (footing.weight @ base.rotation)
    angles = np.arange(16) * np.pi / 8
    around = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    reach = np.linalg.norm(base.footprint, axis=1).max()
    rows = np.zeros((len(around), robot.n_cables, 3))
    for i, carrier in enumerate(robot.base_indices):
        if carrier == k:
            x, y, z = robot.cables[i].exit_point
            rows[:, i] = -z * around
            rows[:, i, 2] = -np.hypot(x, y) * np.sign(rises[i]) - reach
    return rows, np.full(len(around), (reach + np.hypot(*base.center_of_mass[:2])) * base.mass * robot.gravity)
