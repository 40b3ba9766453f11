"""Where mobile bases must stand so that the cables can do what is wanted at every wanted pose, and stay upright."""

from .place import place_bases

__all__ = ["place_bases"]
