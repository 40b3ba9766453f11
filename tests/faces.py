"""Who calls cdprlab and how: every public function and method with arguments that it takes, for test_input to spoil."""

import dataclasses
from functools import cache
from typing import Any

import numpy as np
from matplotlib.figure import Figure

import cdprlab as cl
from cdprlab import course, fastkit, view

Words = dict[str, Any]

CAROCA, POINT, FLAT = (cl.load_world(name) for name in ("caroca", "point_mass", "planar_mcdpr"))
PLANAR, MARIONET = cl.load_world("planar_rigid"), cl.load_world("marionet")
FASTKIT = cl.load_world("fastkit_suspended")
BOUNDS, HERE, AXIS = [[-5, -6], [7, 2]], [0.5, 0.2, 0.1], np.array([1.0, 0, 0, 0, 0, 0])
GRID = cl.Pose([[0.0, 0.0, 1.0]])
W, W_E = cl.wrench_matrix(CAROCA.robot, CAROCA.pose), cl.gravity_wrench(CAROCA.robot, CAROCA.pose)


def fields(part: Any) -> Words:
    return {field.name: getattr(part, field.name) for field in dataclasses.fields(part)}


@cache
def made(name: str) -> Any:
    """One of the things that methods belong to."""
    return MAKERS[name]()


def until(most: float) -> Any:
    """Called as progress is: what takes longer ends with an error of ours."""
    def progress(done: float, *_: Any) -> None:
        if done > most:
            raise cl.CdprError("enough")

    return progress


def _follower() -> Any:
    return fastkit.Follower(made("vehicle"), [[0, 0, 0], [1, 0, 0]])


MAKERS = {
    "vehicle": lambda: fastkit.Vehicle.of(FASTKIT.robot, beams=11),
    "hall": lambda: fastkit.Hall.of([[2, 0, 1, 1, 0]], BOUNDS),
    "grid": lambda: fastkit.OccupancyGrid.of(made("hall"), 0.2),
    "scanner": lambda: fastkit.Scanner(beams=5),
    "random": lambda: np.random.default_rng(0),
    "pair": lambda: fastkit.KinematicPair(made("vehicle"), made("hall"), [-3, -3, 0]),
    "journey": lambda: fastkit.navigate(fastkit.KinematicPair(made("vehicle"), made("hall"), [-2, -3, 0]),
                                        made("hall"), [-2, -3, 0], [-1.5, -3, 0]),
    "mission": lambda: fastkit.Mission(FASTKIT, "pick_and_place", 0, journey=made("journey")),
    "trip": lambda: fastkit.Trip(FASTKIT, FASTKIT.task("pick_and_place"), np.array(BOUNDS, float), np.zeros(3),
                                 np.array([0.2, -0.4, 0]), (), 11),
    "sensors": lambda: fastkit.Readings(0.0, 0.0, 0.0, np.ones(8), 0.0, 0.0, {"active": np.ones(4)}, 0.0, False, 0.0),
    "machine": lambda: fastkit.Machine((fastkit.Phase("a", "b", 1.0),), ()),
    "run": lambda: cl.run(PLANAR, duration=0.02), "flat": lambda: cl.run(POINT, cables="length", duration=0.02),
    "set": lambda: cl.available_wrench_set(CAROCA.robot, CAROCA.pose),
    "rows": lambda: cl.Polytope.from_rows([[1, 0], [0, 1], [-1, 0], [0, -1]], [1, 1, 1, 1]),
    "poses": lambda: cl.PoseGrid({"x": np.arange(3.0)}, CAROCA.pose),
    "sequence": lambda: cl.plan_configurations(MARIONET.robot, [0.6, 0.8, 0.8], [0.7, 0.8, 0.8])[0],
    "state": lambda: cl.open_simulator(PLANAR).state(),
    "axes": lambda: Figure().subplots(),
    "brief": lambda: course.workshop_brief(),
    "explorer": lambda: course.gain_explorer(),
    "comparison": lambda: cl.compare_tensions(PLANAR, methods="kernel", time_step=1.0),
    "plan": lambda: fastkit.plan_path(made("grid"), made("vehicle"), [-3, -3, 0], [-2, -3, 0]),
    "path": lambda: cl.hold(CAROCA.pose, 1.0),
    "job": lambda: _job(),
}


def _job() -> Any:
    def interrupt(done: int, total: int) -> None:
        if done > 300:
            raise KeyboardInterrupt

    try:
        fastkit.pick_and_place(FASTKIT, progress=interrupt)
    except KeyboardInterrupt as error:
        return error.run    # type: ignore[attr-defined]


def library() -> dict[str, tuple[Any, Words]]:
    """Name → what is called, and words that it takes: methods of what `import cdprlab` gives."""
    robot, pose = CAROCA.robot, CAROCA.pose
    box, rows, run = made("set"), made("rows"), made("run")
    criteria = {
        "WrenchClosure": {}, "StaticEquilibrium": {}, "TippingSafe": {},
        "WrenchFeasible": {"wrenches": np.zeros(6), "half_widths": np.ones(6), "by": None},
        "DynamicEquilibrium": {"accelerations": np.ones(6)},
        "TwistFeasible": {"twists": np.zeros(6), "moving": "none"},
        "InterferenceFree": {"clearance": 0.02, "obstacles": (), "cables": True, "platform": True},
        "StaticallyStable": {"method": "quadratic_program", "axial_stiffness": 1e5}}
    found: dict[str, tuple[Any, Words]] = {}
    for name, words in criteria.items():
        kind, where = getattr(cl, name), (FLAT.robot, cl.Pose([FLAT.pose.position]))
        if name != "TippingSafe":
            where = robot, GRID
        found[f"{name}.judge"] = kind(**words).judge, {"robot": where[0], "poses": where[1], "margin": True}
        found[name] = (lambda kind=kind, where=where, **words: kind(**words).judge(*where)), words
    for name, thing in {"image": cl.Polytope.from_image(np.eye(2), [[1, 0], [0, 1], [-1, 0], [0, -1]], np.ones(4)),
                        "rows": rows, "box": box}.items():
        n = thing.n
        found |= {f"Polytope.contains {name}": (thing.contains, {"x": np.zeros(n)}),
                  f"Polytope.support {name}": (thing.support, {"direction": np.ones(n)}),
                  f"Polytope.support_point {name}": (thing.support_point, {"direction": np.ones(n)}),
                  f"Polytope.axis_section {name}": (thing.axis_section, {"origin": np.zeros(n)}),
                  f"Polytope.scale {name}": (thing.scale, {"x": np.ones(n), "origin": np.zeros(n)}),
                  f"Polytope.project {name}": (thing.project, {"components": [0]}),
                  f"Polytope.slice {name}": (thing.slice, {"components": [0, 1], "origin": 0.0})}
    for cables in ("tension", "force", "length"):
        for world in (PLANAR, CAROCA):
            m, n = world.robot.n_cables, world.robot.n_dof
            engine = cl.open_simulator(world, cables)
            key = f"Simulator {world.name} {cables}"
            found |= {f"{key}.step": (engine.step, {"tensions": np.full(m, 50.0), "substeps": 1}),
                      f"{key}.wind": (engine.wind, {"lengths": engine.lengths, "substeps": 1}),
                      f"{key}.cut": (engine.cut, {"cables": [0]}),
                      f"{key}.push": (engine.push, {"wrench": np.zeros(n)}),
                      f"{key}.drive": (engine.drive, {"speeds": np.zeros(3)}),
                      f"{key}.reset": (engine.reset, {"pose": None})}
    mobile = cl.load_world("fastkit_planar")
    bases = cl.open_simulator(mobile)
    return found | {
        "Simulator bases.drive": (bases.drive, {"speeds": np.zeros(3 * len(mobile.robot.bases))}),
        "ComputedTorque": (cl.ComputedTorque, {"kp": 100.0, "kd": 20.0}),
        "TorqueControl": (cl.TorqueControl, {"kp": 900.0, "kd": 60.0, "standing": True, "toward": 0.0,
                                             "friction": None}),
        "VelocityControl": (cl.VelocityControl, {"gain": 20.0}),
        "Base.to_world": (FLAT.robot.bases[0].to_world, {"points": np.zeros((4, 2))}),
        "Robot.base": (FLAT.robot.base, {"name": FLAT.robot.bases[0].name}),
        "Robot.with_bases": (FLAT.robot.with_bases, {"poses": {FLAT.robot.bases[0].name: (0, 0, 0)}}),
        "Robot.with_bases{}": (lambda where: FLAT.robot.with_bases({FLAT.robot.bases[0].name: where}),
                               {"where": (0, 0, 0)}),
        "Robot.with_payload": (robot.with_payload, {"mass": 1.0, "position": [0, 0, 0]}),
        "World.task": (CAROCA.task, {"name": "default"}), "World.idle_keys": (CAROCA.idle_keys, {"cables": "tension"}),
        "World.from_dict": (cl.World.from_dict, {"document": CAROCA.to_dict(), "path": "x"}),
        "World.from_yaml": (cl.World.from_yaml, {"text": CAROCA.to_yaml(), "path": "x"}),
        "World.save": (CAROCA.save, {"path": "w.yaml"}),
        "Box": (cl.Box, {"position": np.zeros(3), "size": np.ones(3), "yaw": 0.0, "kind": "box", "name": "a"}),
        "Scene": (cl.Scene, {"frame": None, "floor_height": 0.0, "boxes": ()}),
        "Task": (cl.Task, {"kind": "hold", "start": pose, "end": pose, "duration": 1.0, "hold": 0.0}),
        "Elasticity": (cl.Elasticity, {"axial_stiffness": 1e5, "damping": 0.0}),
        "Friction": (cl.Friction, {"static": 0.1, "coulomb": 0.1, "viscous": 0.1}),
        "Winch": (cl.Winch, fields(FASTKIT.robot.winch)),
        "Run.boxes_at": (run.boxes_at, {"index": 0}), "Run.robot_at": (run.robot_at, {"index": 0}),
        "Run.save": (run.save, {"folder": "out"}),
        "Trajectory()": (made("path"), {"t": 0.5}),
        "PoseGrid": (cl.PoseGrid, fields(made("poses"))),
        "PoseGrid.field": (made("poses").field, {"values": np.zeros(3)}),
        "PoseGrid.poses_at": (made("poses").poses_at, {"places": np.zeros((2, 1))}),
        "Polytope.from_image": (cl.Polytope.from_image, {"M": np.eye(2), "A": np.eye(2), "b": np.ones(2)}),
        "Polytope.from_rows": (cl.Polytope.from_rows, {"normals": np.eye(2), "offsets": np.ones(2)}),
        "Polytope.from_box": (cl.Polytope.from_box, {"M": np.eye(2), "lower": np.zeros(2), "upper": np.ones(2)}),
        "Configuration": (cl.Configuration, {"cables": (1, 2, 3)}),
        **{f"distribute {name}": (cl.distribute_tensions, {
            "W": W, "w_e": W_E, "tension_min": 50.0, "tension_max": 1e4, "method": name})
            for name in cl.tension_methods()},
        "distribute choice": (cl.distribute_tensions, {
            "W": cl.wrench_matrix(PLANAR.robot, PLANAR.pose), "w_e": cl.gravity_wrench(PLANAR.robot, PLANAR.pose),
            "tension_min": 1.0, "tension_max": 1e3, "method": "kernel", "choice": "lowest"}),
        "view.draw": (view.draw, {"state": made("state"), "width": 64, "height": 48}),
        "view.save_film": (view.save_film, {"run": run, "path": "a.gif", "seconds": 0.1, "fps": 12, "width": 64}),
        "view.save_scene": (view.save_scene, {"run": run, "path": "a.html"}),
        "view.still": (view.still, {"run": run, "path": "a.png", "t": 0.0, "width": 64}),
        "view.plot_tensions": (view.plot_tensions, {"run": run}),
        "view.plot_tracking": (view.plot_tracking, {"run": run}),
        "view.save_figure": (view.save_figure, {"figure": Figure(), "path": "a.png"}),
    }


def of_fastkit() -> dict[str, tuple[Any, Words]]:
    vehicle, hall, grid, scanner = made("vehicle"), made("hall"), made("grid"), made("scanner")
    pair, journey, mission, trip = made("pair"), made("journey"), made("mission"), made("trip")
    random, sensors, job, axes = made("random"), made("sensors"), made("job"), made("axes")
    where = fastkit.Localization(hall, HERE)
    seen = np.array([[1.0, 0.2], [1.0, 0.4]])
    world = {"world": FASTKIT, "bounds": BOUNDS}
    return {
        "carried": (fastkit.carried, {"poses": HERE, "points": seen}),
        "difference": (fastkit.difference, {"target": HERE, "pose": HERE}),
        "cast": (fastkit.cast, {"origin": np.zeros(2), "directions": np.array([[1.0, 0]]), "segments": hall.segments,
                                "circles": ()}),
        "draw_hall": (fastkit.draw_hall, {"axes": axes, "hall": hall, "vehicle": vehicle}),
        "draw_way": (fastkit.draw_way, {"axes": axes, "journey": journey, "until": 1.0}),
        "frame_at": (fastkit.frame_at, {"job": job, "t": 0.1, "width": 64, "scene": None}),
        "in_hall": (fastkit.in_hall, {**world, "pallets": [[3, -3, 0.8, 1.2, 0.3]]}),
        "inflated_width": (fastkit.inflated_width, {"grid": grid, "vehicle": vehicle, "margin": 0.1}),
        "least_edge_loads": (fastkit.least_edge_loads, {"wheels": np.ones((5, 2, 4))}),
        "mission_states": (fastkit.mission_states, {"trip": trip, "work": None}),
        "navigate": (fastkit.navigate, {
            "pair": pair, "hall": hall, "start": [-3, -3, 0], "goal": [-2.9, -3, 0], "berth": None, "leaving": None,
            "uncertainty": (0.1, 0.1, 0.05), "period": 0.1, "progress": until(0.2)}),
        "pair_pose": (fastkit.pair_pose, {"world": FASTKIT}),
        "pick_and_place": (fastkit.pick_and_place, {
            "world": FASTKIT, "task": "pick_and_place", "control": "torque", "speed": 0.5, "dt": 2e-3,
            "control_period": 4e-3, "faults": (lambda _: "enough",), "fold": False, "progress": until(300)}),
        "plan_path": (fastkit.plan_path, {"grid": grid, "vehicle": vehicle, "start": [-3, -3, 0],
                                          "goal": [-2, -3, 0], "margin": 0.1}),
        "plot_job": (fastkit.plot_job, {"job": job}), "plot_journey": (fastkit.plot_journey, {"journey": journey}),
        "run_mission": (fastkit.run_mission, {
            **world, "start": [5, -3.5, 1.8], "task": "pick_and_place", "station": (0.2, -0.4, 0), "walkers": (),
            "seed": 0, "beams": 11, "work": None, "progress": None}),
        "save_job_film": (fastkit.save_job_film, {"job": job, "path": "j.gif", "seconds": 0.2, "fps": 8, "width": 64}),
        "walk_through": (lambda **words: list(fastkit.walk_through(**words)), {"mission": mission, "states": ()}),
        "Follower": (fastkit.Follower, {"vehicle": vehicle, "poses": [HERE, HERE]}),
        "Follower.arrived": (_follower().arrived, {"pose": HERE}),
        "Follower.command": (_follower().command, {"pose": HERE, "unexpected": seen, "period": 0.1}),
        "Hall": (fastkit.Hall, fields(hall)),
        "Hall.of": (fastkit.Hall.of, {"rectangles": [[2, 0, 1, 1, 0]], "bounds": BOUNDS, "seen": True}),
        "Hall.of_world": (fastkit.Hall.of_world, world),
        "Hall.distance": (hall.distance, {"points": seen}),
        "Hall.with_rectangles": (hall.with_rectangles, {"rectangles": [[2, 0, 1, 1, 0]]}),
        "KinematicPair": (fastkit.KinematicPair, {"vehicle": vehicle, "hall": hall, "pose": HERE, "walkers": (),
                                                  "odometry": None, "seed": 0}),
        "KinematicPair.drive": (pair.drive, {"twist": np.zeros(3), "period": 0.1}),
        "KinematicPair.move": (pair.move, {"twist": np.zeros(3), "period": 0.1}),
        "KinematicPair.rays": (pair.rays, {"scanner": scanner}),
        "EnginePair": (lambda **words: fastkit.EnginePair(**words).__exit__(), {
            "world": trip.coupled, "vehicle": vehicle, "hall": hall, "pose": HERE, "walkers": (), "seed": 0}),
        "Localization": (fastkit.Localization, {"hall": hall, "pose": HERE, "uncertainty": (0.1, 0.1, 0.1),
                                                "odometry": None, "eyes": [[0, 0]]}),
        "Localization.drive": (where.drive, {"step": HERE}), "Localization.look": (where.look, {"points": seen}),
        "Localization.unexpected": (where.unexpected, {"points": seen}),
        "Machine": (fastkit.Machine, {"phases": (fastkit.Phase("a", "b", 1.0),), "faults": (), "patience": 3.0}),
        "Machine.step": (made("machine").step, {"sensors": sensors}),
        "Mission": (fastkit.Mission, {"world": FASTKIT, "task": "pick_and_place", "seed": 0}),
        "Mission.when": (mission.when, {"begins": "a"}),
        "OccupancyGrid.of": (fastkit.OccupancyGrid.of, {"hall": hall, "cell": 0.2, "points": seen, "reach": 0.1}),
        "OccupancyGrid.clearance_at": (grid.clearance_at, {"points": seen}),
        "OccupancyGrid.room": (grid.room, {"vehicle": vehicle, "poses": HERE}),
        "OccupancyGrid.room_on": (grid.room_on, {"vehicle": vehicle, "xs": np.zeros(3), "ys": np.zeros(3),
                                                 "headings": np.zeros(2)}),
        "Odometry": (fastkit.Odometry, {"scale": 0.03, "per_turn": 0.03, "per_meter": 0.01}),
        "Odometry.covariance": (fastkit.Odometry().covariance, {"step": HERE}),
        "Odometry.measured": (fastkit.Odometry().measured, {"step": HERE, "random": random}),
        "Phase": (fastkit.Phase, {"name": "a", "what": "b", "duration": 1.0, "to": None, "stroke": None, "drives": {},
                                  "begin": print, "guard": print}),
        "Plan": (fastkit.Plan, {"poses": np.zeros((2, 3)), "reason": ""}),
        "Plan.none": (fastkit.Plan.none, {"reason": "a"}),
        "Scanner": (fastkit.Scanner, fields(scanner)),
        "Scanner.beams_from": (scanner.beams_from, {"pose": HERE}),
        "Scanner.measured": (scanner.measured, {"distances": np.ones(5), "random": random}),
        "Scanner.points": (scanner.points, {"distances": np.ones(5)}),
        "Trip": (fastkit.Trip, fields(trip)), "Trip.arrived": (trip.arrived, {"mission": mission}),
        "Trip.drive_home": (trip.drive_home, {"mission": mission}),
        "Trip.work_there": (trip.work_there, {"mission": mission, "work": None}),
        "Vehicle.of": (fastkit.Vehicle.of, {"robot": FASTKIT.robot, "spacing": 2.0, "beams": 11}),
        **{f"Vehicle.{name}": (getattr(vehicle, name), {"pose": HERE})
           for name in ("base_outlines", "bases", "outline")},
        "Vehicle.base_speeds": (vehicle.base_speeds, {"twist": HERE}),
        "Vehicle.distances": (vehicle.distances, {"pose": HERE, "points": seen}),
        "Vehicle.pose_of": (vehicle.pose_of, {"active": HERE}),
        "Vehicle.quickest": (vehicle.quickest, {"step": HERE}),
        "Vehicle.way": (vehicle.way, {"a": HERE, "b": HERE}),
        "Vehicle.within_limits": (vehicle.within_limits, {"twist": HERE}),
        "Walker": (fastkit.Walker, {"way": [[0, 0], [1, 0]], "speed": 0.6, "radius": 0.25, "care": 0.4,
                                    "patience": 4.0, "hall": None}),
        "Walker.walk": (fastkit.Walker([[0, 0], [1, 0]]).walk, {"period": 0.1, "pose": HERE, "size": [1, 1]}),
        "Job.boxes_at": (job.boxes_at, {"index": 0}), "Job.state_at": (job.state_at, {"index": 0}),
        "Job.robot_at": (job.robot_at, {"index": 0}), "Job.save": (job.save, {"folder": "out"}),
    }


def of_course() -> dict[str, tuple[Any, Words]]:
    axes, sequence, run, brief = made("axes"), made("sequence"), made("run"), made("brief")
    explorer, exits = made("explorer"), np.array([[0, 0, 3], [4, 0, 3], [0, 3, 3.0]])
    m, line = MARIONET.robot.n_cables, np.array([[1.0], [1.0]])
    planar = course.point_load(2)
    return {
        "plot_comparison": (course.plot_comparison, {
            "x": [0, 1, 2], "pairs": {"z": ([0, 1, 4], [0, 1, 3])}, "xlabel": "a", "ylabel": "b", "title": "c",
            "names": ("engine", "formula")}),
        "draw_capability": (course.draw_capability, {"axes": axes, "bars": {"a": [1, 2]}, "names": ("v_x", "v_y"),
                                                     "group": [0, 1]}),
        "draw_equilibrium": (course.draw_equilibrium, {"robot": planar, "position": [0.0, 1.0], "push": (0.0, 0.0),
                                                       "tensions": None}),
        "draw_polygon": (course.draw_polygon, {"axes": axes, "vertices": [[0, 0], [1, 0], [0, 1]], "style": 0,
                                               "label": "a"}),
        "error_decay": (course.error_decay, {"kp": 100.0, "kd": 20.0, "times": [0, 0.1]}),
        "follow_sequence": (course.follow_sequence, {
            "world": MARIONET, "sequence": sequence, "slack": 0.05, "speed": 0.2, "reeling": 0.05,
            "real": None}),
        "hanging_position": (course.hanging_position, {"robot": MARIONET.robot, "lengths": np.full(m, 2.0)}),
        "plot_flight": (course.plot_flight, {"run": made("flat"), "planned": np.ones((20, m), bool),
                                             "taut": np.ones((20, m), bool)}),
        "plot_sequences": (course.plot_sequences, {"robot": MARIONET.robot, "sequences": [sequence], "titles": ()}),
        "plot_tension_runs": (course.plot_tension_runs, {"runs": [run]}),
        "plot_tension_set": (course.plot_tension_set, {"W": W, "w_e": W_E, "tension_min": 50.0, "tension_max": 1e4}),
        "plot_tensions": (course.plot_tensions, {"run": run}),
        "plot_triplets": (course.plot_triplets, {"robot": POINT.robot, "position": [0.5, 0.1, 1.0], "classes":
                                                 cl.classify_configurations(POINT.robot, [0.5, 0.1, 1.0])}),
        "plot_design": (course.plot_design, {"brief": brief, "world": CAROCA, "title": "a"}),
        "position_sensitivity": (course.position_sensitivity, {
            "exits": exits, "position": np.ones(3), "position_uncertainty": 0.0, "exit_uncertainty": 0.0}),
        "region": (course.region, {"exits": exits, "exit_uncertainty": 0.0, "position_uncertainty": 0.0}),
        "side_range": (course.side_range, {"start": np.zeros(2), "end": np.ones(2), "position": np.array([0.2, 0.1]),
                                           "exit_uncertainty": 0.02, "position_uncertainty": 0.05,
                                           "form": "corners"}),
        "slack_length": (course.slack_length, {"robot": POINT.robot, "position": [0.5, 0.1, 1.0],
                                               "configuration": (1, 2, 3), "length_error": 0.01}),
        "submatrix_twist_set": (course.submatrix_twist_set, {"J": line, "B": [[1], [-1]], "speed_max": [2, 2],
                                                             "base_speed_max": [0.8]}),
        "twist_set": (course.twist_set, {"J": line, "B": [[1], [-1]], "speed_max": [2, 2], "base_speed_max": [0.8]}),
        "taut_cables": (course.taut_cables, {"run": made("flat")}),
        "try_errors": (course.try_errors, {
            "world": MARIONET, "sequence": sequence, "trials": 1, "slack": 0.05, "speed": 0.2, "reeling": 0.05,
            "length_error": 0.001, "exit_error": 0.002, "seed": 0}),
        "winding_plan": (course.winding_plan, {"robot": MARIONET.robot, "sequence": sequence, "slack": 0.2,
                                               "speed": 0.2, "reeling": 0.05}),
        "without_cable": (course.without_cable, {"robot": CAROCA.robot, "index": 0}),
        "workshop_brief": (course.workshop_brief, {"most_cables": 8}),
        "Brief.judge": (brief.judge, {"design": CAROCA, "poses": GRID}),
        "Brief.poses": (brief.poses, {"seed": None, "count": 3}),
        "Brief.margins": (brief.margins, {"robot": CAROCA.robot, "poses": GRID}),
        "point_load": (course.point_load, {"n_cables": 2}), "six_cables": (course.six_cables, {"count": 6}),
        "position_grid": (course.position_grid, {"lower": [-1, 0, 0.5], "upper": [1, 0, 1.5], "step": 0.5,
                                                 "rpy": None, "angle": None}),
        "refine": (course.refine, {"robot": PLANAR.robot, "grid": course.position_grid([-1, 1], [1, 2], 0.5),
                                   "criterion": cl.WrenchClosure(), "levels": 1, "n_jobs": None}),
        "axis_names": (course.axis_names, {"motion_pattern": "3R3T", "quantity": "twist"}),
        "cable_style": (course.cable_style, {"index": 0}), "seed": (course.seed, {"n": 1}),
        "fallback": (course.fallback, {"exercise": "00_cut"}),
        "Choice": (course.Choice, {"name": "a", "label": "b", "options": ("x", "y"), "start": "x"}),
        "Choice.check": (course.Choice("a", "b", ("x", "y"), "x").check, {"value": "x"}),
        "Slider": (course.Slider, {"name": "a", "label": "b", "unit": "kg", "low": 1.0, "high": 2.0, "start": 1.5,
                                   "step": None}),
        "Slider.check": (course.Slider("a", "b", "kg", 1.0, 9.0, 5.0).check, {"value": 2.0}),
        "Slider.nearest": (course.Slider("a", "b", "kg", 1.0, 9.0, 5.0).nearest, {"value": 2.0}),
        "AllOrientations": (lambda **words: course.AllOrientations(**words).judge(CAROCA.robot, GRID),
                            {"criterion": cl.WrenchClosure(), "orientations": [[0, 0, 0]]}),
        "play": (course.play, {"motion": made("flat")}),
        "run_player": (course.run_player, {"motion": run}),
        "robot_designer": (course.robot_designer, {"world": "caroca", "brief": None}),
        "explorer.set": (explorer.set, {"kp": 50.0}),
        # What is called is called no more: its own mistake would be the next call's.
        "explorer.on_move": (lambda callback: explorer.on_move(callback)(), {"callback": print}),
        "pose_explorer": (course.pose_explorer, {"world_or_robot": CAROCA, "start": None}),
        "tension_explorer": (course.tension_explorer, {"world_or_robot": PLANAR, "start": None}),
        "equilibrium_explorer": (course.equilibrium_explorer, {"n_cables": 2, "internal": True}),
        "base_explorer": (course.base_explorer, {"world": FLAT, "bases": None}),
        "configuration_explorer": (course.configuration_explorer, {"world": POINT, "uncertain": True}),
        "forward_kinematics_explorer": (course.forward_kinematics_explorer, {"cables": 4, "cable": 2, "error": 0.0}),
        "gain_explorer": (course.gain_explorer, {"kp": 100.0, "kd": 100.0, "dt": 1.0, "span": 3.0}),
        "hanging_explorer": (course.hanging_explorer, {"world": CAROCA}),
        "planning_explorer": (course.planning_explorer, {"vehicle": made("vehicle")}),
        "twist_set_explorer": (course.twist_set_explorer, {"world": FLAT, "components": (0, 1)}),
        "two_circles_explorer": (course.two_circles_explorer, {"formula": None}),
        "workspace_explorer": (course.workspace_explorer, {"world": PLANAR}),
        "wrench_set_explorer": (course.wrench_set_explorer, {"world": PLANAR}),
    }
