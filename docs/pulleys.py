"""Tables of docs/pulleys.md: what it costs to take CAROCA's pulleys for points, and what stretching cables do.

Run: python docs/pulleys.py
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from generated import write_tables

import cdprlab as cl

PAGE = Path(__file__).with_suffix(".md")
WHERE = {"all over the frame": ([-2.5, -1.2, 0.5], [2.5, 1.2, 2.7]),
         "within 0.5 m of the start": ([0.4, 0.4, 0.3], [1.4, 1.4, 1.0])}
POSES = 400


def robots():
    """CAROCA as it is believed to be, all cables from points, and as it is, with pulleys of 45 mm."""
    return cl.load_world("caroca"), cl.load_world("caroca_pulleys")


def poses_in(low, high):
    """Seeded poses, turned by up to 0.2 rad about each axis."""
    rng = np.random.default_rng(0)
    return cl.Pose(rng.uniform(low, high, (POSES, 3)), rng.uniform(-0.2, 0.2, (POSES, 3)))


# --- lengths ----------------------------------------------------------------------------------------------
def differences(poses):
    """(N, m) pulleys' lengths less the points', and what is left once they agree at the start [m]."""
    point, real = robots()
    off = cl.cable_lengths(real.robot, poses) - cl.cable_lengths(point.robot, poses)
    start = cl.cable_lengths(real.robot, real.pose) - cl.cable_lengths(point.robot, point.pose)
    return off, off - start


def lengths_table():
    """How far lengths are off, before and after calibration at the start."""
    rows = ["| poses | lengths off | off after calibration at the start | RMS of that |", "|---|---|---|---|"]
    for name, box in WHERE.items():
        off, left = differences(poses_in(*box))
        rows.append(f"| {name} | {100 * off.min():.1f} to {100 * off.max():.1f} cm | {1e3 * left.min():.1f} to "
                    f"{1e3 * left.max():.1f} mm | {1e3 * np.sqrt((left**2).mean()):.1f} mm |")
    return "\n".join(rows)


def poses_table():
    """Where the platform is believed to be, from lengths calibrated at the start, and what the tensions then miss."""
    point, real = robots()
    rows = ["| poses | position off, mean and largest | turned off | force missed | moment missed |",
            "|---|---|---|---|---|"]
    for name, box in WHERE.items():
        poses = poses_in(*box)
        poses = poses[np.arange(60)]
        _, left = differences(poses)
        believed = cl.forward_kinematics(point.robot, cl.cable_lengths(point.robot, poses) + left, poses,
                                         tolerance=np.inf)
        away = np.linalg.norm(believed.position - poses.position, axis=1)
        turned = np.swapaxes(poses.rotation, 1, 2) @ believed.rotation
        angle = np.degrees(np.arccos(np.clip((np.trace(turned, axis1=1, axis2=2) - 1) / 2, -1, 1)))
        weight = cl.gravity_wrench(point.robot, poses)
        W = cl.wrench_matrix(point.robot, poses)
        held = cl.distribute_tensions(W, weight, point.robot.tension_min, point.robot.tension_max)
        missed = ((cl.wrench_matrix(real.robot, poses) - W) @ held.tensions[..., None])[held.feasible, :, 0]
        force, moment = (np.linalg.norm(part, axis=1).max() for part in (missed[:, :3], missed[:, 3:]))
        rows.append(f"| {name} | {1e3 * away.mean():.1f} and {1e3 * away.max():.1f} mm | up to {angle.max():.2f}° | "
                    f"up to {force:.1f} N | up to {moment:.1f} N m |")
    return "\n".join(rows)


# --- runs -------------------------------------------------------------------------------------------------
def runs_table():
    """The default task flown on the robot with pulleys, one row a belief."""
    point, real = robots()
    start = cl.cable_lengths(real.robot, real.pose) - cl.cable_lengths(point.robot, point.pose)
    zeros = (replace(cable, length_offset=-off) for cable, off in zip(real.robot.cables, start))
    calibrated = replace(real, robot=replace(real.robot, cables=tuple(zeros)))   # with points, its encoders agree there
    flights = {
        "lengths, pulleys known": cl.run(real, cables="length", dt=2e-3),
        "lengths, points": cl.run(point, real=real, cables="length", dt=2e-3),
        "lengths, points, calibrated at the start": cl.run(point, real=calibrated, cables="length", dt=2e-3),
        "tensions, points (computed torque)": cl.run(point, real=real, dt=2e-3)}
    rows = ["| commanded | position error, largest | turned off, largest | tensions, once it moves |",
            "|---|---|---|---|"]
    for name, run in flights.items():
        tensions = run.measured_tensions[len(run.time) // 10:]
        off, turn = (np.linalg.norm(part, axis=1).max() for part in np.split(run.errors, 2, axis=1))
        rows.append(f"| {name} | {1e3 * off:.2f} mm | {np.degrees(turn):.2f}° | {max(tensions.min(), 0):.0f} to "
                    f"{tensions.max():.0f} N |")
    return "\n".join(rows)


# --- stretch ----------------------------------------------------------------------------------------------
def stretch_table():
    """How far CAROCA, held by stretching cables, sinks when 50 kg are put on it."""
    world = robots()[1]
    robot, pose, load = world.robot, world.pose, 50.0
    held = cl.distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), robot.tension_min,
                                  robot.tension_max)
    rows = ["| EA | sinks under 50 kg more, in full | by K⁻¹ times the weight | without the term of tensions |",
            "|---|---|---|---|"]
    for ea in (2e4, 1e5, 5e5):
        unstretched = cl.cable_lengths(robot, pose) / (1 + held.tensions / ea)
        heavier = robot.with_payload(load, [0, 0, 0])
        rest = cl.equilibrium(heavier, unstretched, pose, axial_stiffness=ea).pose
        weight = cl.gravity_wrench(heavier, pose) - cl.gravity_wrench(robot, pose)
        drops = [np.linalg.solve(cl.stiffness(robot, pose, tau, ea), weight)[2] for tau in (held.tensions, np.zeros(8))]
        rows.append(f"| {ea:.0e} N | {1e3 * (pose.position[2] - rest.position[2]):.2f} mm | {-1e3 * drops[0]:.2f} mm | "
                    f"{-1e3 * drops[1]:.2f} mm |")
    return "\n".join(rows)


def pretension_table():
    """The least stiffness of a fully constrained planar robot as all its cables pull harder."""
    world = cl.load_world("planar_rigid")
    W = cl.wrench_matrix(world.robot, world.pose)
    inner = np.linalg.svd(W)[2][-1]
    inner = inner / inner.mean()
    rows = ["| mean pretension | least stiffness, EA = 1e5 N | the part of the tensions |", "|---|---|---|"]
    for pull in (0.0, 100.0, 400.0):
        K, geometric = (cl.stiffness(world.robot, world.pose, pull * inner, ea) for ea in (1e5, 0.0))
        least, way = np.linalg.eigh((K + K.T) / 2)
        part = way[:, 0] @ geometric @ way[:, 0]
        rows.append(f"| {pull:.0f} N | {least[0] / 1e3:.2f} kN/m | {part / 1e3:.2f} kN/m |")
    return "\n".join(rows)


def slack_table(draws=60):
    """Of 70 kg on four stretching cables: how often all four carry where each length is off by so much."""
    world = cl.load_world("point_mass")
    robot = world.robot.with_payload(60.0, [0, 0, 0])
    ea, pose, rng = 2e5, world.pose, np.random.default_rng(1)
    held = cl.distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose), 0.0, 1e6)
    lengths = cl.cable_lengths(robot, pose)
    stretch = held.tensions * lengths / ea
    wound = lengths / (1 + held.tensions / ea)
    rows = ["| each length off by up to | all cables carry | stretch τ l / EA |", "|---|---|---|"]
    for error in (2e-3, 5e-3, 1e-2, 2e-2, 5e-2):
        taut = [(cl.equilibrium(robot, wound + rng.uniform(-error, error, robot.n_cables), pose,
                                axial_stiffness=ea).tensions > 0).all() for _ in range(draws)]
        rows.append(f"| {1e3 * error:g} mm | {100 * np.mean(taut):.0f} % | {1e3 * stretch.min():.1f} to "
                    f"{1e3 * stretch.max():.1f} mm |")
    return "\n".join(rows)


TABLES = {"lengths": lengths_table, "poses": poses_table, "runs": runs_table, "stretch": stretch_table,
          "pretension": pretension_table, "slack": slack_table}


def main():
    """Compute, fly, write."""
    write_tables(PAGE, {name: table() for name, table in TABLES.items()})


if __name__ == "__main__":
    main()
