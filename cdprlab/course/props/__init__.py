"""Small robots and experiments that lessons are built around."""
