"""FASTKIT's mission: coupled to the shelf, deployed, a box picked and placed, folded, coupled home."""
