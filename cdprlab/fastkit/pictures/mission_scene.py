"""A mission as the states of a scene one turns: there, at work, and home again, past whoever walks in the hall."""

from dataclasses import replace

import numpy as np

from ...arrays import Array, checked
from ...errors import InvalidInput
from ...simulate.state import State
from ...view.film import evenly
from ...view.scene import states_of
from ...world.model import Box
from ..mission.engine_pair import shifted_bases, shifted_pose
from ..mission.mission_record import Mission
from ..navigation.journey import Journey

_MOST = 50
"""States of each part."""

_TALL = 1.7
"""A person, drawn as a post [m]."""


@checked
def mission_scene(mission: Mission) -> dict[str, list[State]]:
    """What is done → states, for `course.play` and `view.save_scene`; the hall's walls are left out.

    mission : with a job; on its ways the pair carries the platform as it begins and ends work
    Raises InvalidInput for a mission that stopped before.
    """
    job, there = mission.job, mission.journey
    if job is None or there is None:
        raise InvalidInput(f"a mission is shown from its work on, this one never came to it: {mission.reason}")
    work = states_of(job)
    shown = {}
    for name, part in mission.parts.items():
        if isinstance(part, Journey):
            anchor, row = (work[0], -1) if part is there else (work[-1], 0)
            rows = evenly(len(part.time), _MOST)
            states = [_driven(anchor, part.poses[row], part.poses[k])._replace(time=float(part.time[k])) for k in rows]
            everybody = part.people[rows]
        else:
            states = [work[k] for k in evenly(len(work), _MOST)]
            everybody = there.people[-1:].repeat(len(states), axis=0)
        shown[name] = [_among(state, mission, here) for state, here in zip(states, everybody)]
    return shown


def _driven(state: State, here: Array, there: Array) -> State:
    """Robot and boxes as the pair carries them from one pose to another."""
    pose = shifted_pose(state.pose, here, there)
    return state._replace(robot=shifted_bases(state.robot, here, there), position=pose.position, rotation=pose.rotation,
                          boxes=tuple((shifted_pose(box, here, there), size) for box, size in state.boxes))


def _among(state: State, mission: Mission, people: Array) -> State:
    """The state in its hall, with people where they are."""
    scene = mission.world.scene
    boxes = [box for box in scene.boxes if not box.name.endswith("wall")]
    boxes += [Box(np.array([x, y, _TALL / 2]), np.array([2 * r, 2 * r, _TALL]), kind="obstacle", name="person")
              for x, y, r in people.tolist()]
    return state._replace(scene=replace(scene, boxes=tuple(boxes)))
