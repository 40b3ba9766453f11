"""Ropes of commanded length that can only pull: which of them are taut in a step, and how hard they then pull.

At the end of a step every rope is at most as long as its winch has let it out, L' ≤ ρ'; a rope
that is shorter carries nothing. With L' ≈ L + dt J v' and v' = v_free − dt M⁻¹ Jᵀ T this is the
linear complementarity problem

    T ≥ 0,   A T − b ≥ 0,   Tᵀ (A T − b) = 0,   A = J M⁻¹ Jᵀ + C,   b = (J v_free − (ρ' − L) /
    dt) / dt,

whose solution minimizes ½ Tᵀ A T − bᵀ T over T ≥ 0. C is what ropes yield: next to nothing. Of ropes
that stretch, stiffness k = EA / ρ and damping d, T is what Newmark's average acceleration makes
of the step,

    T = k (L − ρ) + d (J v − ρ̇) + (k dt / 4 + d / 2) J (v' − v),

the same problem with C = 1 / (dt (k dt / 4 + d / 2)): no dt makes them unstable, and they ring as
long as their damping lets them.
"""

from functools import partial

import numpy as np

from ..arrays import Array
from ..robot import Elasticity, Robot


class RopeLaw:
    """The tensions of ropes wound to given lengths, for one step at a time.

    robot : Robot; dt : [s]; elasticity : how the ropes stretch, None: not at all
    """

    def __init__(self, robot: Robot, dt: float, elasticity: Elasticity | None = None) -> None:
        from ..compiled.complementarity import rope_tensions

        body = robot.platform
        self._solve = partial(rope_tensions, body.mass, np.atleast_2d(body.inertia), body.center_of_mass, robot.gravity)
        self._ropes = dt, 0.0, 0.0
        if elasticity is not None:
            self._ropes = dt, elasticity.axial_stiffness, elasticity.damping
        self._last = np.ones(robot.n_cables)

    def __call__(self, W: Array, rotation: Array, twist: Array, lengths: Array, now: Array,
                 wound: Array,
                 push: Array) -> Array:
        """(m,) tensions [N].

        W : (3 planar or 6 spatial, m) whole wrench matrix, whatever rows the pattern controls;
            rotation, twist, lengths : at present
        now, wound : (m,) let out now and by the step's end [m]; push : external wrench at P
        """
        self._last = self._solve(rotation, twist, push, W, lengths, now, wound, *self._ropes, self._last)
        return self._last
