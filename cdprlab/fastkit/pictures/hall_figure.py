"""A journey from above: the map, what inflation leaves free, plans, the way driven, what the scanners see."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon

from ...arrays import LARGEST, Array, checked
from ...view.plots import Figure, mark_level
from ...view.style import BLUE, GREEN, GREY, INK, ORANGE, SKY, VERMILION, house_style
from ..navigation.hall import Hall
from ..navigation.journey import ARRIVED, Journey
from ..navigation.occupancy import OccupancyGrid
from ..navigation.vehicle import Vehicle
from ..plane import carried

_SHADE = "#E4E7EB"


@checked
def plot_journey(journey: Journey) -> Figure:
    """The map with plan and way, beside it what the scanners see at the end and how wrong the belief was.

    journey : of `navigate`
    """
    with house_style():
        figure = Figure(figsize=(11.0, 5.4), layout="constrained")
        plan, scan, errors = figure.subplot_mosaic("ps\npe", width_ratios=(1.5, 1), height_ratios=(1.3, 1)).values()
        draw_hall(plan, journey.hall, journey.vehicle)
        draw_way(plan, journey)
        # Under all: inside, it would hide the map.
        figure.legend(*plan.get_legend_handles_labels(), loc="outside lower center", ncols=5,
                      fontsize=9)
        # The last scan where the pair believes it was taken, over the map.
        pair, pose = journey.vehicle, journey.estimates[-1]
        draw_hall(scan, journey.hall)
        draw_pair(scan, pair, pose)
        scan.plot(*carried(pose, pair.eyes).T, "o", color=BLUE, markersize=6, zorder=6, label="scanners")
        scan.plot(*carried(pose, journey.scans[-1]).T, ".", color=VERMILION, markersize=3, zorder=5,
                  label="scanned points")
        reach = pair.scanners[0].range + pair.length / 2
        x, y, _ = pose
        scan.set(xlim=(x - reach, x + reach), ylim=(y - 0.75 * reach, y + 0.75 * reach),
                 title="last scan, as believed")
        scan.legend(loc="lower right", fontsize=8)
        errors.plot(journey.time, 1e3 * np.linalg.norm(journey.errors[:, :2], axis=1), color=BLUE, label="error")
        errors.plot(journey.time, 2e3 * np.linalg.norm(journey.deviations[:, :2], axis=1), "--", color=GREY,
                    label="two deviations")
        mark_level(errors, 50, "allowed at the shelf", 0.995, "right")
        errors.set(xlabel="time [s]", ylabel="position [mm]", title="localization", ylim=(0, None))
        errors.legend(loc="center right", fontsize=8)
        end = "reaches its goal" if journey.state == ARRIVED else f"stops: {journey.reason}"
        figure.alt_text = (f"A hall from above with {len(journey.hall.outlines)} things in it; the coupled bases {end} "
                           f"after {journey.time[-1]:.0f} s, never nearer than {journey.clearance.min():.2f} m "
                           "to anything. Beside it the last scan on the map, and the localization error over time.")
    return figure


@checked
def draw_hall(axes: Axes, hall: Hall, vehicle: Vehicle | None = None) -> None:
    """What stands there, and, with a vehicle, how far inflation reaches: the pair's middle line stays out of it."""
    x, y = hall.bounds.T
    if vehicle is not None:
        axes.contourf(OccupancyGrid.of(hall).clearance.T, levels=(-1, vehicle.width / 2), colors=[_SHADE],
                      origin="lower", extent=(*x, *y), zorder=0)
        axes.plot([], [], "s", color=_SHADE, markersize=9,
                  label="inflated by half the pair's width")
    for outline, seen in zip(hall.outlines, hall.seen):
        axes.add_patch(Polygon(outline, facecolor=GREY if seen else "none", edgecolor=INK, linewidth=0.8,
                               hatch=None if seen else "////", zorder=2))
    around = np.array([-0.15, 0.15])
    axes.set(xlim=x + around, ylim=y + around, aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axes.grid(False)


@checked
def draw_way(axes: Axes, journey: Journey, until: float = LARGEST) -> None:
    """Plans dashed, the way driven solid, the pair every ten seconds or so, people's ways dotted.

    until : what happened later is not drawn [s]
    """
    n = np.searchsorted(journey.time, until, side="right") or 1
    poses, plans = journey.poses[:n], [plan for time, plan in journey.plans if plan.found and time <= until]
    # Over the way driven, which is the same but for corners.
    for plan in plans:
        axes.plot(*plan.poses[:, :2].T, "--", color=ORANGE, linewidth=1.6, zorder=6,
                  label="planned way" if plan is plans[0] else None)
    axes.plot(*poses[:, :2].T, color=BLUE, linewidth=2.0, zorder=5,
              label="way driven (middle)")
    period = journey.time[1] if len(journey.time) > 1 else 1.0
    for pose in poses[::max(1, round(10 / period))]:
        draw_pair(axes, journey.vehicle, pose, 0.35)
    draw_pair(axes, journey.vehicle, poses[-1])
    axes.plot(*journey.goal[:2], "x", color=VERMILION, markersize=9, markeredgewidth=2,
              zorder=6, label="goal")
    for person in np.moveaxis(journey.people[:n], 0, 1):
        axes.plot(*person[:, :2].T, ":", color=GREEN, linewidth=1.5, zorder=3, label="person")
        axes.add_patch(Circle(person[-1, :2], person[-1, 2], facecolor=GREEN,
                              edgecolor=INK, zorder=4))


def draw_pair(axes: Axes, vehicle: Vehicle, pose: Array, alpha: float = 1.0) -> None:
    """Both bases; the active one, which drives, is filled."""
    for corners, color in zip(vehicle.base_outlines(pose), (SKY, "white")):
        axes.add_patch(Polygon(corners, facecolor=color, edgecolor=INK, linewidth=1.0,
                               alpha=alpha, zorder=3))
