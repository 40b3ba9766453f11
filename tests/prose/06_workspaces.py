"""Lesson 06: numbers in its prose."""

SETUP = """
W_low = cl.wrench_matrix(suspended.robot, cl.Pose([0.0, 0.3], angle=0.0))
"""
RESULTS = [
    ("$\\sum_i \\tau_i\\,u_{i,\\text{up}} = m g$ = {294} N", "suspended.robot.mass * suspended.robot.gravity"),
    ("more than about {90} N in each would lift it", "suspended.robot.mass * suspended.robot.gravity / W_low[1].sum()",
     5),
]
GIVEN = ["two pull up at 45°"]
