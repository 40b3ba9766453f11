"""Which poses are judged: grids of positions, planes among them, random and evenly spread samples."""

from collections.abc import Mapping
from typing import Annotated, Any

import numpy as np
from numpy.typing import ArrayLike

from ..arrays import Array, as_array, as_number, as_seed, checked, frozen_dataclass
from ..errors import InvalidInput, quoted
from ..robot.pose import Pose

MOST_POSES = 100_000_000
"""In a grid: their verdicts and margins take about a gigabyte then."""


@frozen_dataclass
class PoseGrid:
    """Positions on a regular grid, one orientation for all; a batch of poses that exist only when asked for.

    axes : name ("x", "y", "z") → (k,) places along it, for the axes that vary [m]
    origin : Pose with the orientation, and the places along the axes that are held

    >>> grid = position_grid([-1, 0, 0.5], [1, 0, 1.5], 0.5)
    >>> grid.shape, len(grid), grid[:2].position.tolist()
    ((5, 3), 15, [[-1.0, 0.0, 0.5], [-1.0, 0.0, 1.0]])
    """

    axes: Mapping[str, Array]
    origin: Pose

    def __post_init__(self) -> None:
        if not {*self.axes} <= {*axis_names(self.origin.dimension)}:
            raise InvalidInput(f"axes are those of a position, x, y and z in space, got {quoted(list(self.axes))}")
        object.__setattr__(self, "axes", {name: as_array(places, name, ("k",), "m")
                                          for name, places in self.axes.items()})

    @property
    def shape(self) -> tuple[int, ...]:
        """Places along each axis; fields over the grid have this shape."""
        return tuple(len(places) for places in self.axes.values())

    def __len__(self) -> int:
        return int(np.prod(self.shape))

    def __getitem__(self, index: slice) -> Pose:
        """A batch of the poses, numbered with the last axis fastest."""
        chosen = np.unravel_index(np.arange(*index.indices(len(self))), self.shape)
        return self.poses_at(np.stack([places[at] for places, at in zip(self.axes.values(), chosen)], axis=1))

    def poses_at(self, places: ArrayLike) -> Pose:
        """A batch (N,) of poses from places (N, k) along the axes that vary [m]."""
        places = as_array(places, "places", ("N", len(self.axes)), "m")
        position = np.tile(self.origin.position, (len(places), 1))
        position[:, [axis_names(self.origin.dimension).index(name) for name in self.axes]] = places
        rotation = self.origin.rotation
        return Pose.of(position, np.broadcast_to(rotation, (len(position), *rotation.shape)))

    @property
    def poses(self) -> Pose:
        """All of them at once."""
        return self[:]

    def field(self, values: ArrayLike) -> Any:
        """Values of all poses, laid out over the axes."""
        if np.shape(values) != (len(self),):
            raise InvalidInput(f"values must be {len(self)}, one a pose, got {quoted(values)}")
        return np.asarray(values).reshape(self.shape)

    @property
    def step(self) -> Array:
        """Between neighbors along each axis [m]."""
        return np.array([places[1] - places[0] for places in self.axes.values()])

    @property
    def cell(self) -> float:
        """Length, area or volume that a pose stands for [m, m², m³]."""
        return float(np.prod(self.step))


def axis_names(dimension: int) -> str:
    """Of positions: "xy" in the plane, "xyz" in space."""
    return "xyz"[:dimension]


@checked
def position_grid(lower: ArrayLike, upper: ArrayLike, step: float, *,
                  rpy: ArrayLike | None = None,
                  angle: float | None = None) -> PoseGrid:
    """A grid from corner to corner at one orientation; an axis whose ends are equal is held, which makes a plane.

    lower, upper : (d,) corners [m]
    step : at most this between neighbors, so that both ends are on the grid [m]
    rpy, angle : the orientation, as `Pose` takes it [rad]
    Raises InvalidInput for crossed corners, or if no axis varies.

    >>> {name: len(places) for name, places in position_grid([-2, 0, 0], [2, 0, 3], 0.1).axes.items()}
    {'x': 41, 'z': 31}
    """
    low, high = corners(lower, upper)
    spacing = as_number(step, "step", "m", positive=True)
    counts = np.ceil((high - low) / spacing - 1e-9) + 1
    if counts.prod() > MOST_POSES:
        raise InvalidInput(f"step must leave at most {MOST_POSES:g} poses, got {spacing:g} m: {counts.prod():g} poses")
    axes = {name: np.linspace(low[k], high[k], int(counts[k]))
            for k, name in enumerate(axis_names(len(low)))
            if high[k] > low[k]}
    if not axes:
        raise InvalidInput(f"lower and upper are the same point {quoted(low)}: let at least one axis vary")
    return PoseGrid(axes, Pose(low, rpy, angle=angle))


@checked
def low_discrepancy_poses(lower: ArrayLike, upper: ArrayLike, count: int, seed: int = 0, *,
                          turn: Annotated[float, "[rad] ≥ 0"] = 0.0) -> Pose:
    """Random positions in a box, spread evenly by a scrambled Halton sequence: shares converge almost as 1 / count.

    lower, upper : (d,) corners [m]
    turn : largest |roll|, |pitch|, |yaw|, or |angle| in the plane [rad]
    Source: Owen 2017, A randomized Halton algorithm.

    >>> low_discrepancy_poses([0, 0], [1, 2], 5).batch_shape
    (5,)
    """
    from scipy.stats import qmc

    low, high = corners(lower, upper)
    d = len(low)
    shares = qmc.Halton(3 if d == 2 else 6, rng=np.random.default_rng(as_seed(seed))).random(count)
    position = low + shares[:, :d] * (high - low)
    angles = turn * (2 * shares[:, d:] - 1)
    return Pose(position, angle=angles[:, 0]) if d == 2 else Pose(position, rpy=angles)


def corners(lower: ArrayLike, upper: ArrayLike) -> tuple[Array, Array]:
    """Two checked corners of a box of positions."""
    low = as_array(lower, "lower", ("d",), "m")
    high = as_array(upper, "upper", low.shape, "m")
    if (low > high).any() or low.size not in (2, 3):
        raise InvalidInput(f"lower and upper must be corners of 2 or 3 numbers, lower first [m], got {quoted(low)} "
                           f"and {quoted(high)}")
    return low, high
