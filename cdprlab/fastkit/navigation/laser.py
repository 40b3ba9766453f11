"""Laser scanners in the plane: where a beam ends, by geometry alone; an engine's rays give the same."""

from dataclasses import dataclass
from typing import Annotated

import numpy as np
from numpy.typing import ArrayLike

from ...arrays import Array, as_count, checked
from ...errors import InvalidInput
from ..plane import Place, carried, cross, turn

Distances = Annotated[Array, "(beams,) [m] or inf"]


@checked
@dataclass(frozen=True)
class Scanner:
    """A scanner on a moving frame; the defaults are FASTKIT's S300 (range and angle published, the others chosen).

    x, y, heading : of the scanner in the frame [m, m, rad]
    range : [m]; angle : scanned, half to either side [rad]; beams : in one scan
    noise : standard deviation of a distance [m]; height : of its plane over the floor [m]
    Source: Pedemonte et al. 2020, section 2.1.4.
    """

    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0
    range: Annotated[float, "[m] > 0"] = 3.0
    angle: Annotated[float, "[rad] > 0"] = 1.5 * np.pi
    beams: int = 271
    noise: Annotated[float, "[m] ≥ 0"] = 0.01
    height: float = 0.2

    def __post_init__(self) -> None:
        as_count(self.beams, "beams", 1, 10_000)

    @property
    def directions(self) -> Array:
        """(beams,) of the beams in the frame [rad]."""
        return self.heading + np.linspace(-self.angle / 2, self.angle / 2, self.beams)

    def beams_from(self, pose: Place) -> tuple[Array, Array]:
        """(2,) origin and (beams, 2) directions in the world, the frame at pose (3,)."""
        angles = np.asarray(pose)[2] + self.directions
        return carried(pose, [[self.x, self.y]])[0], turn(angles)[..., 0]

    def measured(self, distances: Distances, random: np.random.Generator) -> Array:
        """(beams,) what the scanner says of true distances: with noise, inf beyond its range [m]."""
        noisy = np.clip(random.normal(distances, self.noise), 0.0, self.range)
        return np.where(distances < self.range, noisy, np.inf)

    def points(self, distances: Distances) -> Array:
        """(h, 2) in the frame, where beams ended; beams that met nothing give no point [m]."""
        if len(distances) != self.beams:
            raise InvalidInput(f"distances must be {self.beams}, one a beam, got {len(distances)}")
        origin, directions = self.beams_from(np.zeros(3))
        hit = np.isfinite(distances)
        return origin + distances[hit, None] * directions[hit]


@checked
def cast(origin: Annotated[Array, "(2,) [m]"], directions: Annotated[Array, "(b, 2)"],
         segments: Annotated[Array, "(s, 2, 2) [m]"],
         circles: Annotated[ArrayLike, "(c, 3) [m]"] = ()) -> Array:
    """(b,) distance along each beam to the nearest segment or circle, inf where there is none [m].

    origin : (2,); directions : (b, 2) unit vectors; segments : (s, 2, 2)
    circles : (c, 3) center and radius

    >>> cast(np.zeros(2), np.array([[1.0, 0.0]]), np.array([[[2.0, -1.0], [2.0, 1.0]]]), [[1.0, 0.0, 0.25]])
    array([0.75])
    """
    off, along = segments[:, 0] - origin, segments[:, 1] - segments[:, 0]
    centers, radii = np.split(np.reshape(circles, (-1, 3)), [2], axis=1)
    middles = directions @ (centers - origin).T              # (b, c)
    # What a beam is parallel to, or passes by, it reaches nowhere: infinite or NaN.
    with np.errstate(divide="ignore", invalid="ignore"):
        across = cross(directions[:, None], along)           # (b, s)
        share = cross(off, directions[:, None]) / across
        walls = np.where((share >= 0) & (share <= 1), cross(off, along) / across, np.nan)
        bodies = middles - np.sqrt(radii.T**2 - ((centers - origin)**2).sum(axis=1) + middles**2)
    reach = np.concatenate([walls, bodies], axis=1)
    return np.where(reach > 0, reach, np.inf).min(axis=1, initial=np.inf)
