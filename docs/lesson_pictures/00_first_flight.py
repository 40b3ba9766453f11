"""The title picture of lesson 00: CAROCA in the middle of its flight. Writes it into the lesson's source.

Run: python docs/lesson_pictures/00_first_flight.py
"""

import tempfile
from pathlib import Path

from attachment import attach
from PIL import Image

import cdprlab as cl
from cdprlab.view import still

COLORS = 96  # with as many the picture looks the same and takes a third of the bytes


def picture() -> bytes:
    """The PNG."""
    flight = cl.run(cl.load_world("caroca"))
    with tempfile.TemporaryDirectory() as folder:
        path = still(flight, Path(folder) / "flight.png", t=2.0, width=800)
        Image.open(path).convert("RGB").quantize(COLORS, dither=Image.Dither.NONE).save(path, optimize=True)
        return path.read_bytes()


if __name__ == "__main__":
    attach("00_first_flight", "first_flight.png", picture())
