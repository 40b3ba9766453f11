"""The same computed torque as `control`, for one spatial platform at a time, in plain floats.

A control loop asks for it a thousand times a second; on vectors of three, numpy's fixed cost per call is then what
counts, and written out the same sums take half the time.
"""

from __future__ import annotations

import math

import numpy as np

from ..arrays import Array
from ..robot import Robot
from ..simulate.state import State
from .trajectory import Reference


def applies_to(robot: Robot) -> bool:
    """Six degrees of freedom and the center of mass at P."""
    return robot.motion_pattern == "3R3T" and not robot.platform.is_off_center


def computed_torque(kp: list[float], kd: list[float], state: State, reference: Reference) -> Array | None:
    """(6,) as `ComputedTorque` gives it; None near half a turn, where the rotation error needs more care.

    kp, kd : six gains each [1/s², 1/s]
    """
    body = state.robot.platform
    (a, b, c), (d, e, f), (g, h, i) = state.rotation.tolist()
    (A, B, C), (D, E, F), (G, H, I) = reference.pose.rotation.tolist()  # noqa: E741
    # R_d Rᵀ: sin θ from its skew part, cos θ from its trace.
    x, y, z = G*d + H*e + I*f - D*g - E*h - F*i, A*g + B*h + C*i - G*a - H*b - I*c, D*a + E*b + F*c - A*d - B*e - C*f
    sine, cosine = math.sqrt(x*x + y*y + z*z), A*a + B*b + C*c + D*d + E*e + F*f + G*g + H*h + I*i - 1
    if cosine < -1.98:
        return None
    factor = math.atan2(sine, cosine) / sine if sine > 2e-9 else 0.5
    px, py, pz = (reference.pose.position - state.position).tolist()
    twist = state.twist.tolist()
    ax, ay, az, u, v, w = [
        acceleration + k_d * (wanted - actual) + k_p * error
        for acceleration, k_d, wanted, actual, k_p, error in zip(
            reference.acceleration.tolist(), kd, reference.twist.tolist(), twist,
            kp, (px, py, pz, x * factor, y * factor, z * factor))]
    # Turning in platform axes, where the inertia is constant: I α + ω × I ω.
    _, _, _, x, y, z = twist
    p, q, r = a*x + d*y + g*z, b*x + e*y + h*z, c*x + f*y + i*z
    u, v, w = a*u + d*v + g*w, b*u + e*v + h*w, c*u + f*v + i*w
    (A, B, C), (D, E, F), (G, H, I) = body.inertia.tolist()  # noqa: E741
    x, y, z = A*p + B*q + C*r, D*p + E*q + F*r, G*p + H*q + I*r
    u, v, w = A*u + B*v + C*w + q*z - r*y, D*u + E*v + F*w + r*x - p*z, G*u + H*v + I*w + p*y - q*x
    mass = body.mass
    return np.array([mass * ax, mass * ay, mass * (az + state.robot.gravity),
                     a*u + b*v + c*w, d*u + e*v + f*w, g*u + h*v + i*w])


def mass_and_bias(robot: Robot, rotation: Array, twist: Array) -> tuple[Array, Array]:
    """M and h of W τ = M a + h, the same equation as `inverse_dynamics`, for a spatial platform with its mass anywhere.

    rotation : (3, 3); twist : (6,) of P in world axes
    Returns (6, 6) and (6,), weight included [kg, kg m, kg m²; N, N m].
    """
    body = robot.platform
    mass = body.mass
    x, y, z = c = rotation.dot(body.center_of_mass)
    arm = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    inertia = rotation.dot(body.inertia).dot(rotation.T) - mass * arm.dot(arm)   # about P
    p, q, r = spin = twist[3:]
    turn = np.array([[0.0, -r, q], [r, 0.0, -p], [-q, p, 0.0]])
    matrix = np.empty((6, 6))
    matrix[:3, :3] = mass * _EYE
    matrix[3:, :3] = mass * arm
    matrix[:3, 3:] = -mass * arm
    matrix[3:, 3:] = inertia
    weight = mass * robot.gravity
    bias = np.empty(6)
    bias[:3] = mass * turn.dot(turn.dot(c))
    bias[2] += weight
    bias[3:] = turn.dot(inertia.dot(spin))
    bias[3] += y * weight
    bias[4] -= x * weight
    return matrix, bias


def turn_between(rotation: Array, wanted: Array) -> tuple[float, float, float]:
    """log(R_d Rᵀ), less than half a turn [rad]."""
    (_, a, b), (c, _, d), (e, f, _) = rows = wanted.dot(rotation.T).tolist()
    x, y, z = f - d, b - e, c - a
    sine = math.sqrt(x*x + y*y + z*z)
    factor = math.atan2(sine, rows[0][0] + rows[1][1] + rows[2][2] - 1) / sine if sine > 2e-9 else 0.5
    return x * factor, y * factor, z * factor


_EYE = np.eye(3)
