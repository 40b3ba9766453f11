"""The blocks of a world file, each declared once: its keys with type, shape, unit and default, and the part it makes.

Reading, writing, the JSON Schema and the designer's fields follow from here.
"""

from collections.abc import Iterator
from dataclasses import replace
from functools import cache
from itertools import chain
from typing import Annotated, Any, ClassVar, Literal, Self

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    NonNegativeFloat as NotNegative,
    PositiveFloat as Positive,
    PrivateAttr,
    ValidationInfo,
    model_validator,
)

from ..errors import InvalidInput, Location, quoted, under
from ..robot import (
    MOTION_PATTERNS,
    STANDARD_GRAVITY,
    Base,
    Cable,
    Elasticity,
    Platform,
    Pulley,
    Robot,
    Winch,
    box_inertia,
    check_order,
    turned_to,
)
from ..robot.pose import Pose
from .document import plain
from .model import NAME, Box, PickAndPlace, Scene, Task

Words = dict[str, Any]
"""Key or attribute → value."""


def _sized(values: list[float], info: ValidationInfo) -> list[float]:
    d = info.context
    if d and d != len(values):
        raise InvalidInput(f"must be {d} numbers in {'the plane' if d == 2 else 'space'}, got {len(values)}")
    return values


def _ordered(limits: list[float]) -> list[float]:
    check_order(*limits)
    return limits


_TWO, _THREE = Field(min_length=2, max_length=2), Field(min_length=3, max_length=3)
_TWO_OR_THREE = Field(min_length=2, max_length=3)
Vector = Annotated[list[float], _TWO_OR_THREE, AfterValidator(_sized)]
Edges = Annotated[list[Positive], _TWO_OR_THREE, AfterValidator(_sized)]
Planar = Annotated[list[float], _TWO]
Triple = Annotated[list[float], _THREE]
SpatialEdges = Annotated[list[Positive], _THREE]
Limits = Annotated[list[NotNegative], _TWO, AfterValidator(_ordered)]


class Block(BaseModel):
    """Keys and the part they make; the texts below keys are the schema's descriptions, with units in brackets.

    Unknown keys are refused, and a string is no number. A block that is read in a world whose
    dimension is known (pydantic's context) tries to make its part: what the part refuses is the
    file's mistake, named by its place.
    """

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False,
                              use_attribute_docstrings=True)
    makes: ClassVar[Any] = dict
    """What is called with the block's words. A dict: they are words of the block around it."""
    called: ClassVar[dict[str, tuple[str, ...]]] = {}
    """Key → the part's attributes, where they have other names."""
    zeros: ClassVar[tuple[str, ...]] = ()
    """Vectors that are zero where they are left out."""
    _made: Any = PrivateAttr(None)

    def part(self, d: int) -> Any:
        """What the block describes, in d dimensions; made once."""
        if self._made is None:
            self._made = self.makes(**self.words(d))
        return self._made

    def words(self, d: int) -> Words:
        """What the block says, as arguments of its part; what it leaves out is left to the part's own default."""
        words: Words = {key: [0.0] * d for key in self.zeros}
        for key, field in type(self).model_fields.items():
            value = getattr(self, key)
            if value is None or field.exclude:
                continue
            if isinstance(value, Block):
                value = value.part(d)
            names = self.called.get(key, (key,))
            if isinstance(value, dict):
                words |= value
            else:
                words |= zip(names, value if len(names) > 1 else [value])
        return words

    @classmethod
    def of(cls, part: Any) -> Words:
        """The block that describes a part, every key spelled out; None for a limit that is none."""
        block: Words = {}
        for key, field in cls.model_fields.items():
            if field.exclude:
                continue
            if isinstance(field.annotation, type(Block)) and key not in cls.called:
                block[key] = field.annotation.of(part)
            else:
                values = [_said(getattr(part, name)) for name in cls.called.get(key, (key,))]
                block[field.alias or key] = values if len(values) > 1 else values[0]
        return block

    @model_validator(mode="after")
    def _makes_sense(self, info: ValidationInfo) -> Self:
        if info.context:
            self.part(info.context)
        return self


class PoseBlock(Block):
    """A platform pose: rpy (spatial, fixed-axis) or angle (planar)."""

    makes = Pose

    position: Vector
    """P in the world frame [m]"""
    rpy: Triple | None = None
    """roll, pitch, yaw, fixed axes [rad]; spatial"""
    angle: float | None = None
    """counter-clockwise [rad]; planar"""

    @classmethod
    def of(cls, part: Pose) -> Words:
        turn = "angle" if part.dimension == 2 else "rpy"
        return {"position": _said(part.position), "rpy": None, "angle": None,
                turn: _said(getattr(part, turn))}


class PlatformBlock(Block):
    makes = Platform
    zeros = ("center_of_mass", "center")

    mass: Positive
    """[kg]"""
    inertia: Positive | list[float] | None = None
    """about the center of mass [kg m²]: principal (3), xx yy zz xy xz yz (6), or one number (planar); \
left out: that of a uniform box of `size`"""
    center_of_mass: Vector | None = None
    """platform frame [m]; default P"""
    size: Edges
    """edges of the box drawn and collided [m]"""
    center: Vector | None = None
    """center of that box, platform frame [m]; default P"""
    pose: PoseBlock = Field(exclude=True)
    """where the platform starts"""

    def words(self, d: int) -> Words:
        return {"inertia": box_inertia(self.mass, self.size)} | super().words(d)

    @classmethod
    def of(cls, part: Platform) -> Words:
        block = super().of(part)
        if part.inertia.ndim:
            products = part.inertia[np.triu_indices(3, 1)].tolist()
            block["inertia"] = part.inertia.diagonal().tolist() + (products
                                                                   if any(products) else [])
        return block


class LimitsBlock(Block):
    called = {"tension": ("tension_min", "tension_max"), "speed": ("speed_max",)}

    tension: Limits | None = None
    """smallest and largest tension [N]"""
    speed: Positive | None = None
    """largest cable speed [m/s]; default unlimited"""


class PulleyBlock(Block):
    makes = Pulley

    radius: Positive
    """[m]"""
    axis: Vector
    """unit, the way the cable travels towards A, in the exit point's frame"""


class CableBlock(LimitsBlock):
    exit_point: Vector
    """A, in the world frame or its base's frame [m]"""
    anchor_point: Vector
    """B, in the platform frame [m]"""
    base: str | None = None
    """name of the base that carries the exit point"""
    pulley: PulleyBlock | None = None
    """that it leaves over: at A it enters the groove; default that of `cable`, else none"""
    length_offset: float | None = None
    """what its winch's encoder reads, minus the length there is [m]; default 0"""

    @classmethod
    def of(cls, part: Cable) -> Words:
        return super().of(part) | {"length_offset": part.length_offset or None}

    def cable(self, shared: Words, d: int) -> Cable:
        """The cable, with what all share where it states nothing."""
        words = shared | self.part(d)
        if "tension_min" not in words:
            raise InvalidInput("no tension limits: give the cable its own `tension: [min, max]` or all of them "
                               "`cable_limits: {tension: [min, max]}` [N]", ("tension",))
        return Cable(**words)


class ElasticityBlock(Block):
    makes = Elasticity

    axial_stiffness: Positive | None = None
    """EA [N]; default: they do not stretch"""
    damping: NotNegative = 0.0
    """each cable's own fraction of critical damping, the whole platform on it: n in line ring with √n times it"""
    linear_density: NotNegative = Field(0.0, exclude=True)
    """[kg/m]; with it cables sag in drawings and in `sagging_lengths`"""
    pulley: PulleyBlock | None = Field(None, exclude=True)
    """for cables that state none"""

    def words(self, d: int) -> Words:
        if self.damping and self.axial_stiffness is None:
            raise InvalidInput("cables that do not stretch have no damping: give `axial_stiffness` too [N]",
                               ("damping",))
        return super().words(d)


class FrictionBlock(Block):
    coulomb: NotNegative = 0.0
    """[N m]"""
    viscous: NotNegative = 0.0
    """[N m s/rad]"""
    static: NotNegative = 0.0
    """at breakaway, where it is more than Coulomb's [N m]"""


class WinchBlock(Block):
    makes = Winch

    drum_radius: Positive
    """[m]"""
    gear_ratio: Positive = 1.0
    """motor turns per drum turn"""
    efficiency: Annotated[float, Field(gt=0, le=1)] = 1.0
    """of the gear"""
    torque: Positive | None = None
    """largest motor torque [N m]; default unlimited"""
    speed: Positive | None = None
    """largest motor speed [rad/s]; default unlimited"""
    inertia: NotNegative = 0.0
    """of all that turns, at the motor [kg m²]"""
    friction: FrictionBlock = FrictionBlock()
    """at the motor"""


class BasePoseBlock(Block):
    position: Planar
    """(x, y) on the floor, or in the plane [m]"""
    heading: float = 0.0
    """counter-clockwise [rad]"""


class BaseSpeedBlock(Block):
    rotation: NotNegative = 0.0
    """about the vertical [rad/s]; 0 holds it"""
    translation: Annotated[list[NotNegative], _TWO] = [0.0, 0.0]
    """along the base's own axes [m/s]; 0 holds a direction"""

    def words(self, d: int) -> Words:
        return {"speed_max": [self.rotation, *self.translation]}

    @classmethod
    def of(cls, part: Base) -> Words:
        rotation, *translation = part.speed_max.tolist()
        return {"rotation": rotation, "translation": translation}


class BaseBlock(Block):
    makes = Base
    zeros = ("center_of_mass",)

    name: str
    pose: BasePoseBlock
    mass: Positive
    """[kg]"""
    center_of_mass: Vector | None = None
    """base frame [m]; default its origin"""
    footprint: list[Planar] = []
    """floor contacts in order, base frame [m]"""
    speed: BaseSpeedBlock = BaseSpeedBlock()


class FrameBlock(Block):
    lower: Vector
    """one corner of the frame's outline [m]"""
    upper: Vector
    """the opposite corner [m]"""


class FloorBlock(Block):
    height: float = 0.0
    """[m]"""


class BoxBlock(Block):
    makes = Box

    name: str = ""
    position: Vector
    """center [m]"""
    size: Edges
    """edges [m]"""
    yaw: float = 0.0
    """turn about the vertical [rad]"""


class ShelfBlock(Block):
    name: str = ""
    position: Planar
    """center of the footprint [m]"""
    size: SpatialEdges
    """depth (x), width (y), height [m]"""
    levels: Annotated[list[NotNegative], Field(min_length=1)]
    """heights of the boards' tops [m]"""
    yaw: float = 0.0
    """turn about the vertical [rad]"""

    def boards(self) -> Iterator[Box]:
        """The boards and the two side walls, 2 cm thick."""
        thickness = 0.02
        depth, width, height = self.size
        turn, foot = turned_to(self.yaw, 3), np.array([*self.position, 0.0])
        walls = [((0.0, side * (width - thickness) / 2, height / 2), (depth, thickness, height))
                 for side in (-1, 1)]
        boards = [((0.0, 0.0, level - thickness / 2), (depth, width, thickness))
                  for level in self.levels]
        for center, size in walls + boards:
            yield Box(foot + turn @ center, np.array(size), self.yaw, "box", self.name)


class SceneBlock(Block):
    """What stands around the robot. Frame: drawn only; all else is drawn and collides."""

    makes = Scene

    frame: FrameBlock | None = None
    floor: FloorBlock | None = None
    """left out: a floor at height 0"""
    boxes: list[BoxBlock] = []
    """furniture, loads"""
    shelves: list[ShelfBlock] = []
    obstacles: list[BoxBlock] = []
    """to be kept clear of; drawn in red"""

    def words(self, d: int) -> Words:
        if d == 2 and self.shelves:
            raise InvalidInput("a planar scene has no shelves; use boxes", ("shelves",))
        boxes = [box.part(d) for box in self.boxes]
        boxes += [replace(box.part(d), kind="obstacle") for box in self.obstacles]
        boxes += chain.from_iterable(shelf.boards() for shelf in self.shelves)
        return {"frame": self.frame and [self.frame.lower, self.frame.upper],
                "floor_height": self.floor.height if self.floor else 0.0,
                "boxes": tuple(boxes)}

    @classmethod
    def of(cls, part: Scene) -> Words:
        frame = None if part.frame is None else dict(zip(("lower", "upper"), part.frame.tolist()))
        kinds = {key: [BoxBlock.of(box) for box in part.boxes if box.kind == kind]
                 for key, kind in (("boxes", "box"), ("obstacles", "obstacle"))}
        return {"frame": frame, "floor": {"height": part.floor_height}} | kinds


class TaskBlock(Block):
    sort: ClassVar[type[Task]] = Task

    def task(self, pose: Pose, robot: Robot) -> Task:
        """The task of a robot that stands at a pose: there it starts, and there it ends, if it names no other."""
        words: Words = {"start": pose} | self.part(robot.dimension)
        task = self.sort(**{"end": words["start"]} | words)
        task.check(robot)
        return task

    @staticmethod
    def described(part: Task) -> Words:
        """The block of whichever kind a task is."""
        kinds: dict[str, type[TaskBlock]] = {"quintic": QuinticTask, "hold": HoldTask}
        return kinds.get(part.kind, PickAndPlaceTask).of(part)


class QuinticTask(TaskBlock):
    called = {"to": ("end",)}

    kind: Literal["quintic"]
    """rest to rest along a straight line"""
    start: PoseBlock | None = Field(None, alias="from")
    """default: the platform's pose"""
    to: PoseBlock
    duration: Positive
    """of the motion [s]"""
    hold: NotNegative = 0.0
    """time held at the end [s]"""


class HoldTask(TaskBlock):
    called = {"at": ("start",)}

    kind: Literal["hold"]
    """stay at a pose"""
    at: PoseBlock | None = None
    """default: the platform's pose"""
    duration: Positive
    """[s]"""


class LoadBlock(Block):
    called = {"size": ("box_size",), "mass": ("box_mass",), "position": ("box_position",)}

    size: SpatialEdges
    """edges [m]"""
    mass: Positive
    """[kg]"""
    position: Triple
    """center where it stands, its face flush with the board's edge [m]"""


class GripperBlock(Block):
    seat: Triple
    """center of a box drawn in, platform frame [m]"""
    stroke: Triple
    """from there to the center of a box on its board, world axes, level [m]"""
    tilt: Triple
    """roll, pitch, yaw at which the platform hooks and unhooks [rad]"""
    clearance: Positive = 0.1
    """how far the platform keeps from the shelf as it moves along it [m]"""


class CoupledBlock(Block):
    base: str
    """the base that drives away"""
    pose: BasePoseBlock
    """where it stands at first, coupled to the other"""
    aside: float = 0.0
    """how far it keeps aside on its way, along its own y axis [m]"""

    def words(self, d: int) -> Words:
        # One level more: the words of a dict are those of the block around it.
        return {"coupled": {self.base: (*self.pose.position, self.pose.heading)},
                "aside": self.aside}


class PickAndPlaceTask(TaskBlock):
    sort = PickAndPlace

    kind: Literal["pick_and_place"]
    """take a box from a shelf and put it elsewhere; mobile bases"""
    start: PoseBlock | None = Field(None, alias="from")
    """default: the platform's pose"""
    coupled: CoupledBlock | None = None
    """left out: the bases stand where `bases` says"""
    box: LoadBlock
    place: Triple
    """center of the box's place [m]"""
    gripper: GripperBlock

    @classmethod
    def of(cls, part: Any) -> Words:
        coupled = None
        for base, (x, y, heading) in part.coupled.items():
            coupled = {"base": base, "pose": {"position": [x, y], "heading": heading}, "aside": part.aside}
        return super().of(part) | {"coupled": coupled}


class WorldFile(Block):
    name: str = Field(pattern=f"^{NAME.pattern}$")
    title: str = ""
    source: str = ""
    """where each number comes from"""
    engine: Literal["planar", "spatial"] | None = None
    """planar: pymunk, spatial: PyBullet; must agree with the motion pattern"""
    motion_pattern: Literal["1T", "2T", "1R2T", "3T", "2R3T", "3R3T"]
    gravity: NotNegative = STANDARD_GRAVITY
    """[m/s²]"""
    platform: PlatformBlock
    cable_limits: LimitsBlock = LimitsBlock()
    """for cables that state none"""
    cables: Annotated[list[CableBlock], Field(min_length=1, max_length=200)]
    cable: ElasticityBlock = ElasticityBlock()
    """what all cables are made of, and run over"""
    winch: WinchBlock | None = None
    bases: list[BaseBlock] = []
    scene: SceneBlock = SceneBlock()
    tasks: dict[str, Annotated[QuinticTask | HoldTask | PickAndPlaceTask, Field(discriminator="kind")]] = {}

    def words(self, d: int) -> Words:
        """The arguments of a `World`, but its document."""
        pattern = MOTION_PATTERNS[self.motion_pattern]
        if self.engine not in (None, pattern.engine):
            raise InvalidInput(f"motion pattern {pattern.name} runs in the {pattern.engine} engine, "
                               f"not {quoted(self.engine)}", ("engine",))
        cables, pulley = [], self.cable.pulley
        shared = {"pulley": pulley and pulley.part(d)} | self.cable_limits.part(d)
        for i, block in enumerate(self.cables):
            with under("cables", i):
                cables.append(block.cable(shared, d))
        robot = Robot(pattern, self.platform.part(d), tuple(cables),
                      tuple(base.part(d) for base in self.bases),
                      self.gravity, self.winch.part(d) if self.winch else None,
                      self.cable.part(d) if self.cable.axial_stiffness else None,
                      self.cable.linear_density)
        pose = self.platform.pose.part(d)
        tasks = {"default": Task("hold", pose, pose, 2.0)}
        for name, task in self.tasks.items():
            with under("tasks", name):
                tasks[name] = task.task(pose, robot)
        return {"name": self.name, "title": self.title, "source": self.source, "robot": robot,
                "pose": pose, "scene": self.scene.part(d), "tasks": tasks}

    @classmethod
    def of(cls, part: Any) -> Words:
        """Robot and pose of a `World` as the blocks of its file."""
        robot = part.robot
        return {"name": part.name, "title": part.title, "source": part.source,
                "engine": robot.pattern.engine,
                "motion_pattern": robot.motion_pattern, "gravity": robot.gravity,
                "platform": PlatformBlock.of(robot.platform) | {"pose": PoseBlock.of(part.pose)},
                "cables": [CableBlock.of(cable) for cable in robot.cables],
                "cable": ElasticityBlock.of(robot.elasticity or Elasticity()) | {
                    "linear_density": robot.linear_density},
                "winch": robot.winch and WinchBlock.of(robot.winch),
                "bases": [BaseBlock.of(base) for base in robot.bases]}


_schema = cache(WorldFile.model_json_schema)


def keys_at(location: Location) -> dict[str, Words]:
    """The keys that may stand in the block at a place of a world file, each with its JSON Schema.

    >>> keys_at(("cables", 2))["exit_point"]["description"]
    "A, in the world frame or its base's frame [m]"
    """
    blocks = [_schema()]
    for part in location:
        inner = [block.get("properties", {}).get(part) or block.get("items")
                 or block.get("additionalProperties")
                 for block in blocks]
        blocks = [found for schema in inner if schema for found in _alternatives(schema)]
    return {key: schema for block in blocks
            for key, schema in block.get("properties", {}).items()}


def _alternatives(schema: Words) -> Iterator[Words]:
    """What may stand where a schema refers to others, or to one of several."""
    for option in schema.get("anyOf") or schema.get("oneOf") or [schema]:
        yield _schema()["$defs"].get(option.get("$ref", "").rpartition("/")[2], option)


def _said(value: Any) -> Any:
    """A part's value as a file has it: "unlimited" is said by leaving it out."""
    if isinstance(value, Pose):
        return PoseBlock.of(value)
    if isinstance(value, Pulley):
        return PulleyBlock.of(value)
    known = plain(value)
    return None if known == np.inf else known
