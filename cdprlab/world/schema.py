"""The shape of a world file, as pydantic models: keys, types and units. What the numbers mean is checked in `robot`."""

from __future__ import annotations

from typing import Annotated, Literal

from pydantic import BaseModel, ConfigDict, Field

from ..robot import STANDARD_GRAVITY

Number = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[Number, Field(gt=0)]
NotNegative = Annotated[Number, Field(ge=0)]
Vector = Annotated[list[Number], Field(min_length=2, max_length=3)]
Planar = Annotated[list[Number], Field(min_length=2, max_length=2)]
Triple = Annotated[list[Number], Field(min_length=3, max_length=3)]
Edges = Annotated[list[Positive], Field(min_length=2, max_length=3)]
SpatialEdges = Annotated[list[Positive], Field(min_length=3, max_length=3)]
Limits = Annotated[list[NotNegative], Field(min_length=2, max_length=2)]


class _Part(BaseModel):
    """Unknown keys are refused, and a string is no number."""

    model_config = ConfigDict(extra="forbid", strict=True)


class PoseBlock(_Part):
    """A platform pose: rpy (spatial, fixed-axis) or angle (planar)."""

    position: Vector = Field(description="P in the world frame [m]")
    rpy: Triple | None = Field(None, description="roll, pitch, yaw, fixed axes [rad]; spatial")
    angle: Number | None = Field(None, description="counter-clockwise [rad]; planar")


class PlatformBlock(_Part):
    mass: Positive = Field(description="[kg]")
    inertia: Positive | list[Number] | None = Field(
        None, description="about the center of mass [kg m²]: principal (3), xx yy zz xy xz yz (6), or one number "
                          "(planar); left out: that of a uniform box of `size`")
    center_of_mass: Vector | None = Field(None, description="platform frame [m]; default P")
    size: Edges = Field(description="edges of the box drawn and collided [m]")
    center: Vector | None = Field(None, description="center of that box, platform frame [m]; default P")
    pose: PoseBlock = Field(description="where the platform starts")


class LimitsBlock(_Part):
    tension: Limits | None = Field(None, description="smallest and largest tension [N]")
    speed: Positive | None = Field(None, description="largest cable speed [m/s]; default unlimited")


class CableBlock(LimitsBlock):
    exit_point: Vector = Field(description="A, in the world frame or its base's frame [m]")
    anchor_point: Vector = Field(description="B, in the platform frame [m]")
    base: str | None = Field(None, description="name of the base that carries the exit point")


class ElasticityBlock(_Part):
    axial_stiffness: Positive = Field(description="EA [N]")
    damping: NotNegative = Field(0.0, description="fraction of critical damping")


class FrictionBlock(_Part):
    coulomb: NotNegative = Field(0.0, description="[N m]")
    viscous: NotNegative = Field(0.0, description="[N m s/rad]")
    static: NotNegative = Field(0.0, description="at breakaway, where it is more than Coulomb's [N m]")


class WinchBlock(_Part):
    drum_radius: Positive = Field(description="[m]")
    gear_ratio: Positive = Field(1.0, description="motor turns per drum turn")
    efficiency: Annotated[Number, Field(gt=0, le=1)] = Field(1.0, description="of the gear")
    torque: Positive | None = Field(None, description="largest motor torque [N m]; default unlimited")
    speed: Positive | None = Field(None, description="largest motor speed [rad/s]; default unlimited")
    inertia: NotNegative = Field(0.0, description="of all that turns, at the motor [kg m²]")
    friction: FrictionBlock = Field(default_factory=FrictionBlock, description="at the motor")


class BasePoseBlock(_Part):
    position: Planar = Field(description="(x, y) on the floor, or in the plane [m]")
    heading: Number = Field(0.0, description="counter-clockwise [rad]")


class BaseSpeedBlock(_Part):
    rotation: NotNegative = Field(0.0, description="about the vertical [rad/s]; 0 holds it")
    translation: Annotated[list[NotNegative], Field(min_length=2, max_length=2)] = Field(
        default_factory=lambda: [0.0, 0.0], description="along the base's own axes [m/s]; 0 holds a direction")


class BaseBlock(_Part):
    name: str
    pose: BasePoseBlock
    mass: Positive = Field(description="[kg]")
    center_of_mass: Vector | None = Field(None, description="base frame [m]; default its origin")
    footprint: list[Planar] = Field(default_factory=list, description="floor contacts in order, base frame [m]")
    speed: BaseSpeedBlock = Field(default_factory=BaseSpeedBlock)


class FrameBlock(_Part):
    lower: Vector = Field(description="one corner of the frame's outline [m]")
    upper: Vector = Field(description="the opposite corner [m]")


class FloorBlock(_Part):
    height: Number = Field(0.0, description="[m]")


class BoxBlock(_Part):
    name: str = ""
    position: Vector = Field(description="center [m]")
    size: Edges = Field(description="edges [m]")
    yaw: Number = Field(0.0, description="turn about the vertical [rad]")


class ShelfBlock(_Part):
    name: str = ""
    position: Planar = Field(description="center of the footprint [m]")
    size: SpatialEdges = Field(description="depth (x), width (y), height [m]")
    levels: Annotated[list[NotNegative], Field(min_length=1)] = Field(description="heights of the boards' tops [m]")
    yaw: Number = Field(0.0, description="turn about the vertical [rad]")


class SceneBlock(_Part):
    """What stands around the robot. Frame: drawn only; all else is drawn and collides."""

    frame: FrameBlock | None = None
    floor: FloorBlock | None = Field(None, description="left out: a floor at height 0")
    boxes: list[BoxBlock] = Field(default_factory=list, description="furniture, loads")
    shelves: list[ShelfBlock] = Field(default_factory=list)
    obstacles: list[BoxBlock] = Field(default_factory=list, description="to be kept clear of; drawn in red")


class QuinticTask(_Part):
    kind: Literal["quintic"] = Field(description="rest to rest along a straight line")
    start: PoseBlock | None = Field(None, alias="from", description="default: the platform's pose")
    to: PoseBlock
    duration: Positive = Field(description="of the motion [s]")
    hold: NotNegative = Field(0.0, description="time held at the end [s]")


class HoldTask(_Part):
    kind: Literal["hold"] = Field(description="stay at a pose")
    at: PoseBlock | None = Field(None, description="default: the platform's pose")
    duration: Positive = Field(description="[s]")


class LoadBlock(_Part):
    size: SpatialEdges = Field(description="edges [m]")
    mass: Positive = Field(description="[kg]")
    position: Triple = Field(description="center where it stands, its face flush with the board's edge [m]")


class GripperBlock(_Part):
    seat: Triple = Field(description="center of a box drawn in, platform frame [m]")
    stroke: Triple = Field(description="from there to the center of a box on its board, world axes, level [m]")
    tilt: Triple = Field(description="roll, pitch, yaw at which the platform hooks and unhooks [rad]")
    clearance: Positive = Field(0.1, description="how far the platform keeps from the shelf as it moves along it [m]")


class CoupledBlock(_Part):
    base: str = Field(description="the base that drives away")
    pose: BasePoseBlock = Field(description="where it stands at first, coupled to the other")
    aside: Number = Field(0.0, description="how far it keeps aside on its way, along its own y axis [m]")


class PickAndPlaceTask(_Part):
    kind: Literal["pick_and_place"] = Field(description="take a box from a shelf and put it elsewhere; mobile bases")
    start: PoseBlock | None = Field(None, alias="from", description="default: the platform's pose")
    coupled: CoupledBlock | None = Field(None, description="left out: the bases stand where `bases` says")
    box: LoadBlock
    place: Triple = Field(description="center of the box's place [m]")
    gripper: GripperBlock


class WorldFile(_Part):
    name: str = Field(pattern=r"^[A-Za-z0-9_\-]+$")
    title: str = ""
    source: str = Field("", description="where each number comes from")
    engine: Literal["planar", "spatial"] | None = Field(
        None, description="planar: pymunk, spatial: PyBullet; must agree with the motion pattern")
    motion_pattern: Literal["1T", "2T", "1R2T", "3T", "2R3T", "3R3T"]
    gravity: NotNegative = Field(STANDARD_GRAVITY, description="[m/s²]")
    platform: PlatformBlock
    cable_limits: LimitsBlock = Field(default_factory=LimitsBlock, description="for cables that state none")
    cables: Annotated[list[CableBlock], Field(min_length=1)]
    cable: ElasticityBlock | None = Field(None, description="elastic cables")
    winch: WinchBlock | None = None
    bases: list[BaseBlock] = Field(default_factory=list)
    scene: SceneBlock = Field(default_factory=SceneBlock)
    tasks: dict[str, Annotated[QuinticTask | HoldTask | PickAndPlaceTask, Field(discriminator="kind")]] = Field(
        default_factory=dict)
