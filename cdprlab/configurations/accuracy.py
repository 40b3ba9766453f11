"""How far a length error moves the load: the interval system J Δx = Δρ of a triplet, solved with guarantee.

J(M) has rows −u_i. Over boxes of the position and of the exit points its entries are exact
ranges J_c ± Δ, and |Δx| ≤ (I − |J_c⁻¹| Δ)⁻¹ |J_c⁻¹| |Δρ| holds for every matrix in between, as
long as the spectral radius of |J_c⁻¹| Δ stays below 1 (Neumann series). This form is stated
because another one would move the switching point: near x = 1.85 in the paper's room, A123 and
A234 differ by less than half a percent.
"""

from typing import Annotated

import numpy as np

from ..arrays import Array, checked
from .configuration import HalfWidth
from .region import Triangle


@checked
def position_sensitivity(exits: Triangle, position: Annotated[Array, "(…, 3) [m]"],
                         position_uncertainty: HalfWidth = 0.0, exit_uncertainty: HalfWidth = 0.0) -> Array:
    """Largest |Δx|, |Δy| or |Δz| for cable lengths that are each off by one: max_i diam(Δx_i) / diam(Δρ) [m/m].

    exits : (3, 3) exit points [m]; position : (…, 3) [m]
    position_uncertainty, exit_uncertainty : half widths of the boxes [m]
    Returns (…), inf where the boxes hold a singular J.
    Source: Ramadour and Merlet 2014, eq. (4)–(6).

    >>> at_right_angles = np.array([[-1.0, 0, 0], [0, -1, 0], [0, 0, 1]])
    >>> float(position_sensitivity(at_right_angles, np.zeros(3)))
    1.0
    """
    low, high = _direction_range(exits - position[..., None, :], position_uncertainty + exit_uncertainty)
    center, radius = (low + high) / 2, (high - low) / 2
    regular = np.abs(np.linalg.det(center)) > 1e-12
    inverse = np.abs(np.linalg.inv(np.where(regular[..., None, None], center, np.eye(3))))
    growth = inverse @ radius
    regular &= np.abs(np.linalg.eigvals(growth)).max(axis=-1) < 1
    bound = np.linalg.solve(np.eye(3) - growth * regular[..., None, None], inverse.sum(axis=-1)[..., None])
    return np.where(regular, bound[..., 0].max(axis=-1), np.inf)


def _direction_range(vectors: Array, radius: float) -> tuple[Array, Array]:
    """Range of d / |d| over the box d ± radius, row by row; exact.

    d_x / |d| grows with d_x and shrinks in size with |d_y| and |d_z|.
    """
    low, high = vectors - radius, vectors + radius
    near, far = (sizes.sum(axis=-1, keepdims=True) - sizes
                 for sizes in np.square([np.maximum(np.abs(vectors) - radius, 0.0), np.abs(vectors) + radius]))

    def end(values: Array, others: Array) -> Array:
        return values / np.sqrt(np.maximum(values**2 + others, np.finfo(float).tiny))

    return end(low, np.where(low > 0, far, near)), end(high, np.where(high < 0, far, near))
