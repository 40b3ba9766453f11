"""Turn the size of a robot's errors: what do they do to a platform at rest, wound to length or pulled by tensions?"""

from typing import Any

import numpy as np
from matplotlib.figure import Figure

from ...arrays import checked
from ...errors import InvalidInput
from ...mechanics.cables import cable_lengths
from ...mechanics.dynamics import mass_matrix
from ...mechanics.kinematics import moved
from ...mechanics.rest import AtRest, equilibrium
from ...mechanics.statics import gravity_wrench, wrench_matrix
from ...tensions import distribute_tensions
from ...view.style import BLUE, INK, LineStyle
from ...world import World
from ...world.perturbation import perturbed
from ..pictures.panels import bar_panel, draw_bars
from .explorer import Choice, Explorer, Values, once_a_move, rounded_up, sliders

STIFF = 100.0
"""[1/s²] K_p of the tension control, a run's default."""


@checked
class ModelErrorExplorer(Explorer):
    """Tensions and place at rest of a robot whose exit points are not those of its model.

    world : believed in, with ropes that stretch; the platform is held at the end of its default
        task
    Raises InvalidInput for ropes that do not.

    >>> import cdprlab as cl
    >>> explorer = model_error_explorer(cl.load_world("fastkit_suspended"))
    >>> explorer.set(size=20)
    >>> print(explorer.text.splitlines()[1])
    slack cables          2
    """

    def __init__(self, world: World) -> None:
        self.world, robot, self.pose = world, world.robot, world.task().end
        if robot.elasticity is None:
            raise InvalidInput(f"a model error explorer needs ropes that stretch; {world.name} has no axial_stiffness")
        self.wanted = distribute_tensions(wrench_matrix(robot, self.pose),
                                          gravity_wrench(robot, self.pose),
                                          robot.tension_min,
                                          robot.tension_max).require().tensions
        self._stiffness = robot.elasticity.axial_stiffness
        self._ropes = robot.elasticity.unstrained(cable_lengths(robot, self.pose), self.wanted)
        control = Choice("control", "control", ("wound to length", "tension control"))
        super().__init__([*sliders("model_errors"), control], f"{world.title}, at rest",
                         (6.2, 4.6))

    @once_a_move
    def rest(self, values: Values) -> AtRest:
        """Of the robot as built: on its ropes, or where K_p holds what its tensions do not balance."""
        real = perturbed(self.world, exit_points=1e-3 * values["size"],
                         seed=round(values["seed"])).robot
        if values["control"] == "wound to length":
            return equilibrium(real, self._ropes, self.pose, axial_stiffness=self._stiffness)
        left = wrench_matrix(real, self.pose) @ self.wanted + gravity_wrench(real, self.pose)
        given_way = np.linalg.solve(STIFF * mass_matrix(real, self.pose), left).astype(float)
        return AtRest(moved(real, self.pose, given_way), self.wanted)

    def build(self, figure: Figure) -> None:
        m = self.wanted.size
        self._bars = bar_panel(figure.subplots(), m, rounded_up(3.0 * self.wanted.max(), 1))
        self._bars.barh(range(1, m + 1), self.wanted, height=0.8, fill=False, edgecolor=INK,
                        label="wanted")
        self._bars.legend(loc="lower right")

    def draw(self, values: Values) -> None:
        tau = self.rest(values).tensions
        words = [f"{pull:.1f}" if pull else "slack" for pull in tau]
        self.words = draw_bars(self._bars, tau, [LineStyle(BLUE, "solid")] * tau.size, words)

    def numbers(self, values: Values) -> dict[str, Any]:
        pose, tau = self.rest(values)
        off = np.linalg.norm(pose.position - self.pose.position)
        return {"tensions [N]": f"{tau.min():.1f} to {tau.max():.1f}",
                "slack cables": (tau == 0).sum(),
                "platform off by [mm]": f"{1e3 * off:.2f}"}


model_error_explorer = ModelErrorExplorer
