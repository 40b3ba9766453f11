"""What somebody may write who checks every type: `mypy --strict` finds nothing here (test_public_types)."""

from pathlib import Path

import numpy as np

import cdprlab as cl
from cdprlab import course, fastkit, view


class Low(cl.Criterion):
    """Poses near the floor."""

    unit = "m"

    def judge(self, robot: cl.Robot, poses: cl.Pose, margin: bool = True) -> cl.Judgement:
        height = 1.0 - poses.position[..., -1]
        return cl.Judgement(height >= 0, height)


def gentle(t: float, state: cl.State, reference: cl.Reference) -> cl.Array:
    """A controller of one's own."""
    return -cl.gravity_wrench(state.robot, reference.pose)


def told(done: int, total: int) -> None:
    """How far a run is."""
    print(done, total)


def fly(world: cl.World, controller: cl.Controller, progress: cl.Progress) -> cl.Run:
    """Everything named."""
    cuts: cl.Cuts = {0.5: [1]}
    return cl.run(world, controller=controller, cut=cuts, progress=progress, method="kernel")


world = cl.load_world("caroca")
task: cl.Task = world.task("default")
winch: cl.Winch | None = world.robot.winch
grid: cl.PoseGrid | cl.Pose = cl.Pose(np.zeros((4, 3)))
pivot: cl.Pivot = "world"
verdicts: dict[cl.Configuration, str] = cl.classify_configurations(cl.load_world("point_mass").robot, [0, 0, 1])
judgement: cl.Judgement = cl.workspace(world.robot, grid, cl.WrenchFeasible() & Low())
rows: dict[str, cl.TippingRows] = cl.tipping_rows(world.robot, world.pose)
columns: cl.Array = cl.base_jacobian(world.robot, world.pose, pivot)
flown: cl.Run = fly(world, gentle, told)

# --- methods of what came back ------------------------------------------------------------------------------
robot, pose = world.robot, world.pose
lengths: cl.Array = cl.cable_lengths(robot, pose)
found: cl.TensionDistribution = cl.distribute_tensions(cl.wrench_matrix(robot, pose), cl.gravity_wrench(robot, pose),
                                                       robot.tension_min, robot.tension_max).require()
box: cl.Polytope = cl.available_wrench_set(robot, pose)
inside: cl.Flags = box.contains(np.zeros((2, robot.n_dof)))
shadow: cl.Polytope = box.project([0, 1])
path: cl.Trajectory = cl.quintic(pose, pose, 1.0)
wish: cl.Reference = path(0.5)
rest: cl.AtRest = cl.equilibrium(robot, lengths, pose)
moved: cl.Robot = robot.with_payload(1.0, [0, 0, 0])
with cl.open_simulator(world, "force") as engine:
    engine.step(robot.tension_min)
    state: cl.State = engine.state()
    picture = view.draw(state)
saved: Path = flown.save("out")
film: Path = view.save_film(flown, "out/film.gif")
compared: cl.TensionComparison = cl.compare_tensions(world, methods=["kernel"])

# --- the wings ----------------------------------------------------------------------------------------------
fast = cl.load_world("fastkit_suspended")
pair: fastkit.Vehicle = fastkit.Vehicle.of(fast.robot)
hall: fastkit.Hall = fastkit.Hall.of([[0, 0, 0.2, 4, 0]], [[-5, -3], [5, 3]])
plan: fastkit.Plan = fastkit.plan_path(fastkit.OccupancyGrid.of(hall), pair, [-2.5, 0, 0], [2.5, 0, 0])
bases: fastkit.KinematicPair = fastkit.KinematicPair(pair, hall, [-3, 0, 0])
journey: fastkit.Journey = fastkit.navigate(bases, hall, [-3, 0, 0], [-2, 0, 0])
points: cl.Array = fastkit.carried([0, 0, 0], [[1, 0]])
job: fastkit.Job = fastkit.pick_and_place(fast)
state_name: str = job.state
slider = course.Slider("mass", "mass", "kg", 1.0, 9.0, 5.0)
explorer = course.gain_explorer(kp=50.0)
