"""Lesson 09: numbers in its prose."""

SETUP = """
from math import comb

here = planar.pose

def payload_of(mass, high=100.0, low=1.0):
    "Payload where the explorer starts, with two bases of that mass [kg]; NaN where the empty platform is not held."
    robot = with_base_mass(planar, mass).robot
    A, b = all_rows(robot, here)
    return largest_payload(cl.wrench_matrix(robot, here), cl.gravity_wrench(robot, here), np.array([0.0, -9.81]),
                           np.full(4, low), np.full(4, high), A, b)[0]

def never_tips(mass):
    robot = with_base_mass(planar, mass).robot
    A, b = all_rows(robot, here)
    return bool((np.maximum(A * robot.tension_max, A * robot.tension_min).sum(axis=1) + b <= 0).all())

def least(holds, low, high):
    "The smallest mass that holds, to a gram [kg]."
    while high - low > 1e-3:
        middle = (low + high) / 2
        low, high = (low, middle) if holds(middle) else (middle, high)
    return high

light_moments = np.abs(standing[:, 1:3]).max()
exit_height = planar.robot.exit_points[:, 1].min()
fastkit_rows = cl.tipping_moments(fastkit.robot, fastkit.pose, np.full(8, 0.0))["active"][3]
fastkit_slope = cl.tipping_moments(fastkit.robot, fastkit.pose, np.full(8, 1.0))["active"][3] - fastkit_rows
"""
RESULTS = [
    ("All {120} directions end in the same eight points", "len(found)"),
    ("choices, {112} facets", "2 * comb(8, 5)"),
    ("least room is upwards, {95} N or {9.65} kg of payload; downwards it is {142} N",
     "room[1, 1], room[1, 1] / 9.81, -room[1, 0]"),
    ("ends at {165} N, but with the load in balance only {142} N can be added", "reach[0, 1], room[0, 1]"),
    ("a base of half the mass would go at half the tension, {27} N", "-fastkit_rows / fastkit_slope / 2"),
    ("With bases of 30 kg the payload is down to {1.65} kg", "payload_of(30)"),
    ("Above {72.6} kg no tensions within the limits can tip a base", "least(never_tips, 30, 200)"),
    ("they leave their mast at {0.25} m", "exit_height"),
    ("Below about {17} kg the robot cannot even hold", "least(lambda mass: payload_of(mass) >= 0, 5, 30)"),
    ("the payload stays at {1.65} kg", "payload_of(30, 150)"),
    ("10 kg more in each gives {1.28} kg more payload", "payload_of(40) - payload_of(30)"),
    ("It falls to {0.02} kg", "payload_of(30, low=10.0)"),
    ("There wheels cost up to {2.7} kg", "np.nanmax(maps[0] - maps[1])"),
    ("differ by {4} mN m, of up to {68} N m",
     "1e3 * np.median(np.abs(standing[:, 1] - standing[:, 2])), light_moments"),
    ("With least norm the base goes at {3.1} kg, though no cable is near its limit and your program found tensions for "
     "{4.3} kg. With those it goes at {4.3} kg",
     "np.interp(0.0, loaded['least norm'][:, 2], loaded['least norm'][:, 0]), most, "
     "np.interp(0.0, loaded['yours'][:, 2], loaded['yours'][:, 0])"),
    ("Bolted down, the robot would carry {11.3} kg", "bolted"),
]
