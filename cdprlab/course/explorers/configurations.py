"""Move S and G on the plan: which three cables hold, where they change, and the chosen sequence in the engine."""

from typing import Any

import ipywidgets
import numpy as np
from matplotlib.figure import Figure

from ...arrays import Array, checked
from ...configurations.classify import classify_configurations
from ...configurations.configuration import triplets
from ...configurations.sequence import ConfigurationSequence, plan_configurations
from ...configurations.sides import FORMS
from ...errors import InvalidInput
from ...run import Run
from ...run.switching import follow_sequence
from ...view.style import GREY, INK
from ...world import World
from ..pictures.configuration_plan import WIDE_MARGIN, draw_room, fill_sequence, fill_triplet, in_words
from ..text_table import in_brackets
from .explorer import Choice, Explorer, Slider, Values, once_a_move
from .player import MotionPlayer

_LISTED = 6
"""Sequences to choose from."""

REELING = 0.1
"""Speed at which slack is taken up and let out [m/s]."""


@checked
class ConfigurationExplorer(Explorer):
    """Sliders for S and G; triangles inside, uncertain or outside; sequences with scores; the chosen one in the engine.

    world : a point mass (3T) on three cables or more
    uncertain : whether the uncertainties, the interval form and the method can be chosen;
        without, all is exact
    Raises InvalidInput for another kind of world.

    >>> import cdprlab as cl
    >>> explorer = configuration_explorer(cl.load_world("marionet"))
    >>> print(explorer.sequences[0])
    A124 → A123: score 4, safe
    >>> explorer.close()
    """

    below = 1

    def __init__(self, world: World, uncertain: bool = True) -> None:
        self.world, self.robot = world, world.robot
        self.names = triplets(self.robot)
        self.run: Run | None = None
        self._player: MotionPlayer | None = None
        super().__init__(_controls(world, uncertain),
                         f"{world.title}: configurations from S to G",
                         size=(6.2, 3.4))
        self._add_fly_button()

    # --- the plan ---------------------------------------------------------------------------------------
    @property
    def sequences(self) -> list[ConfigurationSequence]:
        """From S to G, best first."""
        return self.planned(self.values)[0]

    @once_a_move
    def planned(self, values: Values) -> tuple[list[ConfigurationSequence], str]:
        """Sequences, and why there are none: S outside all triangles is no mistake of the reader's."""
        position, exits = _boxes(values)
        try:
            return plan_configurations(self.robot, *_ends(values),
                                       values.get("method", "stability"),
                                       position_uncertainty=position, exit_uncertainty=exits), \
                "method accuracy finds no change where both configurations are certain"
        except InvalidInput as reason:
            return [], str(reason)

    def chosen(self, values: Values) -> ConfigurationSequence | None:
        """The sequence picked, the last there is if there are fewer; None if there is none."""
        sequences, _ = self.planned(values)
        return sequences[min(values["pick"], len(sequences)) - 1] if sequences else None

    def place(self, values: Values) -> Array:
        """(3,) the point on the way that is looked at [m]."""
        start, goal = _ends(values)
        return np.asarray(start + values["share"] * (goal - start))

    @once_a_move
    def classes(self, values: Values) -> dict[Any, str]:
        """Triplet → class at that point."""
        return dict(classify_configurations(self.robot, self.place(values), *_boxes(values),
                                            form=values.get("form", "corners")))

    def fly(self) -> Run:
        """The chosen sequence in the engine, shown below the picture.

        Raises InvalidInput where there is none.
        """
        sequence = self.chosen(self.values)
        if sequence is None:
            raise InvalidInput(f"there is no sequence to fly: {self.planned(self.values)[1]}")
        speed = 0.8 * self.robot.speed_max.min()
        run = follow_sequence(self.world, sequence, slack=self.values["slack"], speed=speed,
                              reeling=min(REELING, speed))
        self._show_player(MotionPlayer(run))
        self.run = run
        return run

    # --- what an explorer says ---------------------------------------------------------------------------
    def build(self, figure: Figure) -> None:
        columns = 2 if len(self.names) <= 4 else 3
        rows = -(-len(self.names) // columns)
        grid = figure.add_gridspec(rows, columns + 1,
                                   width_ratios=[2.0] + [2.0 / columns] * columns)
        self._plan = figure.add_subplot(grid[:, 0])
        self._small = [figure.add_subplot(grid[k // columns, 1 + k % columns])
                       for k in range(len(self.names))]
        draw_room(self._plan, self.robot)
        for panel in self._small:
            draw_room(panel, self.robot, WIDE_MARGIN)
            panel.set(xlabel="", ylabel="", xticks=[], yticks=[])

    def draw(self, values: Values) -> None:
        sequence, place = self.chosen(values), self.place(values)
        if sequence is None:
            for name, end in zip("SG", _ends(values)):
                self._plan.plot(*end[:2], marker="o", color=GREY, markersize=8)
                self._plan.annotate(name, (end[0], end[1]), (0, 9), textcoords="offset points",
                                    ha="center")
        else:
            fill_sequence(self._plan, self.robot, sequence)
        self._plan.plot(*place[:2], marker="x", markersize=9, markeredgewidth=2,
                        color=INK, zorder=7)
        self._plan.set_title("no sequence" if sequence is None else str(sequence), fontsize=11)
        for panel, (chosen, verdict) in zip(self._small, self.classes(values).items()):
            fill_triplet(panel, self.robot, chosen, place, verdict, *_boxes(values))
            panel.title.set_fontsize(9)

    def numbers(self, values: Values) -> dict[str, Any]:
        sequences, reason = self.planned(values)
        listed = "\n".join(f"{k}: {sequence}"
                           for k, sequence in enumerate(sequences[:_LISTED], start=1))
        found = {"sequences": listed or f"none: {reason}"}
        sequence = self.chosen(values)
        if sequence is not None:
            found["the chosen one: position, cables, score"] = _steps(sequence)
        found[f"at {in_brackets(self.place(values), 2)} m"] = "\n".join(
            f"{chosen}: {verdict}" for chosen, verdict in self.classes(values).items())
        return found

    def idle(self, values: Values) -> dict[str, str]:
        idle = {}
        if len(self.planned(values)[0]) < 2:
            idle["pick"] = "there is nothing to choose from"
        if "form" in values and not any(_boxes(values)):
            idle["form"] = "both uncertainties are 0"
        return idle

    def describe(self, values: Values) -> str:
        chosen = self.chosen(values)
        return (f"Plan of the room with exit points, S and G; {chosen if chosen is not None else 'no sequence'}; "
                f"at {values['share']:.0%} of the way {in_words(self.classes(values))}")

    def close(self) -> None:
        """Let go of everything, the flight too."""
        self._show_player(None)
        super().close()

    # --- inside -------------------------------------------------------------------------------------------
    def _add_fly_button(self) -> None:
        self.plan_box = ipywidgets.VBox(self.stage.children)
        self.stage.children = (self.plan_box,)
        self.button = ipywidgets.Button(description="Play in the engine", icon="play",
                                        layout={"width": "auto"})
        self.button.on_click(lambda _: self._clicked())
        self.panel.children = (*self.panel.children, self.button)
        self.on_move(lambda _: self._show_player(None))  # a flight belongs to the sequence it was made of

    def _clicked(self) -> None:
        self.button.disabled, self.button.description = True, "The engine is at work …"
        try:
            self.fly()
        except Exception as error:
            self.show_mistake(error)
        finally:
            self.button.disabled, self.button.description = False, "Play in the engine"

    def _show_player(self, player: MotionPlayer | None) -> None:
        if self._player is not None:
            self._player.close()
        self._player = player
        self.plan_box.layout.display = None if player is None else "none"
        self.stage.children = (self.plan_box,) if player is None else (self.plan_box, player.widget)


configuration_explorer = ConfigurationExplorer


def _controls(world: World, uncertain: bool) -> list[Slider | Choice]:
    exits = world.robot.exit_points
    low, high = exits.min(axis=0), exits.max(axis=0)
    task = world.tasks.get("default")
    ends = [world.pose.position, world.pose.position if task is None else task.end.position]
    # Sliders stop 10 cm short of the ceiling and of the floor below it.
    low, high = np.append(low[:2], 0.1).round(2), np.append(high[:2], high[2] - 0.1).round(2)
    sliders: list[Slider | Choice] = []
    for name, end in zip("SG", ends):
        sliders += [Slider(f"{name}{axis}", f"{name} {axis}", "m", float(low[k]),
                           float(max(high[k], low[k] + 0.1)),
                           float(np.clip(end[k], low[k], high[k])), 0.01)
                    for k, axis in enumerate("xyz")]
    sliders += [Slider("share", "look at share of way", "", 0.0, 1.0, 0.0, 0.01),
                Choice("pick", "sequence", tuple(range(1, _LISTED + 1)))]
    if uncertain:
        sliders += [Slider("position_uncertainty", "position ±", "m", 0.0, 0.15, 0.05, 0.005),
                    Slider("exit_uncertainty", "exit points ±", "m", 0.0, 0.06, 0.02, 0.005),
                    Choice("form", "interval form", tuple(FORMS)),
                    Choice("method", "method", ("stability", "accuracy"))]
    return [*sliders, Slider("slack", "slack when played", "m", 0.0, 0.3, 0.1, 0.01)]


def _ends(values: Values) -> tuple[Array, Array]:
    start, goal = (np.array([values[name + axis] for axis in "xyz"]) for name in "SG")
    return start, goal


def _boxes(values: Values) -> tuple[float, float]:
    return values.get("position_uncertainty", 0.0), values.get("exit_uncertainty", 0.0)


def _steps(sequence: ConfigurationSequence) -> str:
    rows = [f"{in_brackets(place, 2)} m  {chosen}  {score:.3g}"
            for (place, chosen), score in zip(sequence.steps, sequence.location_scores)]
    changes = ", ".join(map(str, sequence.transition_scores)) or "none"
    return "\n".join([*rows, f"changes: {changes}"])
