"""Explorers: sliders, a picture that answers at once, and the numbers as text. One file an explorer."""
