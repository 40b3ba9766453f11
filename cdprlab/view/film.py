"""Stills and films of a run: the camera's picture with title, time, tension scale and axes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image, ImageColor, ImageDraw, ImageFont
from PIL.PngImagePlugin import PngInfo

from ..arrays import Array
from ..errors import InvalidInput
from .camera import INK, SLACK_COLOR, TRAIL, Camera, extents, tension_colors
from .planar_camera import PlanarCamera
from .style import AXIS_COLORS

LARGEST_FILE = 3_000_000
"""Bytes: what mail, chat and slides take without complaint."""

_LONGEST = 12.0
_ECONOMIES = ((1, 128), (1, 80), (2, 80), (3, 64), (4, 64), (8, 48), (16, 48))
"""(every how many frames, colors), tried in turn until the film is small enough."""


def save_film(run: Any, path: str | Path, seconds: float | None = None, fps: int = 12, width: int = 640) -> Path:
    """An animated GIF of a run, below ``LARGEST_FILE``: fewer colors, then fewer pictures, where it must be.

    run : Run
    path : ends in .gif
    seconds : length of the film [s]; default that of the run, at most 12
    fps : pictures per second
    width : [pixels]
    Raises InvalidInput for a bad path or numbers that make no film.
    """
    target = _checked_path(path, ".gif")
    lasting = float(run.time[-1]) if len(run.time) else 0.0
    length = min(lasting, _LONGEST) if seconds is None else float(seconds)
    if not (0 < length < np.inf and fps > 0):
        raise InvalidInput(f"a film needs a positive length and rate, got {length:g} s and {fps} pictures per second")
    times = np.linspace(0.0, lasting, max(12, round(length * fps)) + 1)
    frames = list(_frames(run, times, width))
    duration = 1000 * length / (len(times) - 1)
    for every, colors in _ECONOMIES:
        _write_gif(frames[::every], target, colors, duration * every, _caption(run))
        if target.stat().st_size < LARGEST_FILE:
            break
    return target


def still(run: Any, path: str | Path, t: float = 0.0, width: int = 960) -> Path:
    """A PNG of a run at time ``t`` [s], laid out as a frame of the film, with a text description inside.

    path : ends in .png
    width : [pixels]
    """
    target = _checked_path(path, ".png")
    description = PngInfo()
    description.add_itxt("Description", f"{_caption(run)} State at t = {t:.2f} s.")
    next(_frames(run, np.array([t]), width)).save(target, pnginfo=description, optimize=True)
    return target


# --- frames -----------------------------------------------------------------------------------------------
def _frames(run: Any, times: Array, width: int) -> Iterator[Image.Image]:
    """One picture for each time [s]."""
    camera: Camera | PlanarCamera = _planar_camera(run) if run.world.engine == "planar" else Camera(run.world)
    ticks = _ticks(run)
    limits = float(ticks[0]), float(ticks[-1])
    scale = width / 640
    height = 2 * round(215 * scale)
    indices = np.clip(np.searchsorted(run.time, times - 1e-9), 0, len(run.time) - 1)
    for index in indices:
        trail = run.poses.position[np.unique(np.linspace(0, index, 50).astype(int))]
        shown = run.poses[index], _shown_tensions(run, index), width, height, limits, trail, _rope_lengths(run, index)
        if isinstance(camera, PlanarCamera):
            picture = camera.picture(*shown, robot=run.robot_at(index))
        else:
            picture = camera.picture(*shown)
        frame = Image.new("RGB", (width, height + round(86 * scale)), "white")
        frame.paste(Image.fromarray(picture), (0, round(30 * scale)))
        drawing = ImageDraw.Draw(frame)
        _write_title(drawing, run, float(run.time[index]), width, scale)
        if isinstance(camera, Camera):  # a planar picture has its grid
            _draw_axes(drawing, camera, width, height, scale)
        _draw_scale(drawing, ticks, width, height + round(30 * scale), scale)
        yield frame


def _planar_camera(run: Any) -> PlanarCamera:
    """Wide enough for all that moves: the platform, and bases that drive."""
    some = np.unique(np.linspace(0, len(run.time) - 1, 20).astype(int))
    places = [run.poses.position]
    if run.base_poses is not None:
        for robot in map(run.robot_at, some):
            places += [robot.exit_points, *(base.to_world(base.footprint) for base in robot.bases)]
    return PlanarCamera(run.world, np.concatenate(places))


def _rope_lengths(run: Any, index: int) -> Array | None:
    """What is let out as a control step begins, None where tensions are commanded."""
    commanded = getattr(run, "commanded_lengths", None)
    if commanded is None:
        return None
    return np.asarray(commanded[index - 1] if index else run.lengths[0])


def _shown_tensions(run: Any, index: int) -> Array:
    # The last row is measured at the end of its step like all others; a cut cable is NaN there and shown as slack.
    return np.asarray(run.measured_tensions[index])


def _write_title(drawing: ImageDraw.ImageDraw, run: Any, time: float, width: int, scale: float) -> None:
    font = _font(16 * scale)
    y = round(7 * scale)
    clock = f"t = {time:5.2f} s"
    room = width - drawing.textlength(clock, font=font) - 34 * scale
    title = str(run.world.title)
    while title and drawing.textlength(title, font=font) > room:
        title = title[:-2].rstrip(" ,") + "…" if len(title) > 2 else ""
    drawing.text((12 * scale, y), title, fill=INK, font=font)
    drawing.text((width - 12 * scale, y), clock, fill=INK, font=font, anchor="ra")


def _draw_axes(drawing: ImageDraw.ImageDraw, camera: Camera, width: int, height: int, scale: float) -> None:
    """World axes at the lowest corner, drawn small."""
    low, high = extents(camera.world)
    length = 0.11 * float(np.max(high - low))
    tips = low + length * np.concatenate([np.zeros((1, 3)), np.eye(3), 1.3 * np.eye(3)])
    pixels = camera.project(tips, width, height) + np.array([0, round(30 * scale)])
    for name, color, tip, label in zip("xyz", AXIS_COLORS, pixels[1:4], pixels[4:]):
        drawing.line([tuple(pixels[0]), tuple(tip)], fill=color, width=max(2, round(3 * scale)))
        drawing.text(tuple(label), name, fill=color, font=_font(15 * scale), anchor="mm",
                     stroke_width=max(1, round(scale)), stroke_fill="white")


def _draw_scale(drawing: ImageDraw.ImageDraw, ticks: Array, width: int, top: int, scale: float) -> None:
    """Color bar with its ticks [N], and the key."""
    font, small = _font(14 * scale), _font(13 * scale)
    x0, x1, y0, y1 = (round(v) for v in (150 * scale, 0.70 * width, top + 10 * scale, top + 24 * scale))
    drawing.text((12 * scale, (y0 + y1) / 2), "cable tension [N]", fill=INK, font=font, anchor="lm")
    limits = float(ticks[0]), float(ticks[-1])
    shades = tension_colors(np.linspace(max(limits[0], 1e-9), limits[1], 48), limits)
    edges = np.linspace(x0, x1, 49).round().astype(int)
    for left, right, color in zip(edges[:-1], edges[1:], shades):
        drawing.rectangle([left, y0, right, y1], fill=tuple(color.tolist()))
    for tick in ticks:
        x = x0 + (x1 - x0) * (tick - limits[0]) / (limits[1] - limits[0])
        drawing.line([(x, y1), (x, y1 + 4 * scale)], fill=INK, width=max(1, round(scale)))
        drawing.text((x, y1 + 6 * scale), f"{tick:g}", fill=INK, font=small, anchor="ma")
    _draw_key(drawing, x1 + 28 * scale, top + 12 * scale, scale)


def _draw_key(drawing: ImageDraw.ImageDraw, x: float, y: float, scale: float) -> None:
    """What grey dashes and the thin line mean."""
    font, thick = _font(14 * scale), max(2, round(2.5 * scale))
    for start in range(3):
        left = x + 13 * start * scale
        drawing.line([(left, y), (left + 8 * scale, y)], fill=SLACK_COLOR, width=thick)
    drawing.text((x + 42 * scale, y), "slack or cut", fill=INK, font=font, anchor="lm")
    below = y + 21 * scale
    drawing.line([(x, below), (x + 34 * scale, below)], fill=TRAIL, width=thick)
    drawing.text((x + 42 * scale, below), "path of P so far", fill=INK, font=font, anchor="lm")


def _ticks(run: Any) -> Array:
    """Round numbers around all tensions of the run [N]; one scale for the whole film."""
    tau = np.asarray(run.measured_tensions)
    taut = tau[np.isfinite(tau) & (tau > 0)]
    low, high = (float(taut.min()), float(np.percentile(taut, 99.8))) if taut.size else (0.0, 1.0)
    rough = max(high - low, 1e-3 * high) / 4
    decade = 10.0 ** np.floor(np.log10(rough))
    step = decade * next(factor for factor in (1, 2, 5, 10) if factor * decade >= rough)
    return np.asarray(step * np.arange(np.floor(low / step), np.ceil(high / step) + 1).round(9))


# --- files ------------------------------------------------------------------------------------------------
def _write_gif(frames: Sequence[Image.Image], path: Path, colors: int, duration: float, caption: str) -> None:
    palette = _palette(frames, colors)
    flat = [frame.quantize(palette=palette, dither=Image.Dither.NONE) for frame in frames]
    # GIF counts time in 10 ms; the last picture stays for a moment before the film starts again.
    tick = max(20, 10 * round(duration / 10))
    flat[0].save(path, save_all=True, append_images=flat[1:], loop=0, optimize=False, disposal=1,
                 duration=[tick] * (len(flat) - 1) + [max(tick, 1000)], comment=caption.encode("ascii", "replace"))


def _palette(frames: Sequence[Image.Image], colors: int) -> Image.Image:
    """One palette for all frames, so that colors do not flicker.

    The colors that carry meaning are in it as they are: thin lines would lose theirs to large grey surfaces.
    """
    meaning = [*tension_colors(np.linspace(1e-9, 1, 24), (0.0, 1.0)).tolist(), (255, 255, 255), INK, SLACK_COLOR, TRAIL,
               *(ImageColor.getrgb(color) for color in AXIS_COLORS)]
    chosen = [frames[i] for i in np.unique(np.linspace(0, len(frames) - 1, 4).astype(int))]
    sheet = Image.fromarray(np.concatenate([np.asarray(frame) for frame in chosen]))
    others = sheet.quantize(colors - len(meaning), method=Image.Quantize.MEDIANCUT).getpalette() or []
    pure = [255 if value > 246 else value for value in others]  # white stays white, not tinted
    palette = Image.new("P", (1, 1))
    palette.putpalette([int(value) for color in meaning for value in color] + pure)
    return palette


def _checked_path(path: str | Path, ending: str) -> Path:
    target = Path(path)
    if target.suffix.lower() != ending:
        raise InvalidInput(f"the path must end in {ending}, got {target}")
    if not target.parent.is_dir():
        raise InvalidInput(f"cannot save {target}: there is no folder {target.parent}")
    return target


def _caption(run: Any) -> str:
    side = "front" if run.world.engine == "planar" else "front and above"
    return (f"{run.world.title}, task {run.task}: platform, frame and {run.world.robot.n_cables} cables colored by "
            f"tension, seen from the {side}.")


def _font(size: float) -> Any:
    return ImageFont.load_default(size=max(8.0, size))
