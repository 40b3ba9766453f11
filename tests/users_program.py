"""What somebody may write who checks every type: `mypy --strict` finds nothing here (test_public_types)."""

import numpy as np

import cdprlab as cl


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
