"""The equations: cables, kinematics, statics, dynamics, trajectories, redundancy, winches."""
