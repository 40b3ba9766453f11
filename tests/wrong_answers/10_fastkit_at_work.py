"""Plausible mistakes in lesson 10; each must earn nothing."""

CLEARANCE = '''
def clearance(occupied, cell):
    """Wrong on purpose."""
    walled = np.pad({grid}, 1, constant_values={ring})
    centers = distance_transform_edt({free}, sampling={edge})[1:-1, 1:-1]
    return {promise}
'''
RIGHT_CLEARANCE = {"grid": "occupied", "ring": "True", "free": "~walled", "edge": "cell",
                   "promise": "np.maximum(centers - np.sqrt(2) * cell, 0.0)"}

MATCH = '''
def match_step(pose, predicted, covariance, points, feet, normals, sigma):
    """Wrong on purpose."""
    c, s = np.cos(pose[2]), np.sin(pose[2])
    arms = points @ np.array([[c, -s], [s, c]]){turn}
    e = (({moved} - feet) * normals).sum(axis=1)
    J = np.column_stack([normals, {slope}])
    before = np.linalg.inv({belief})
    H = before + J.T @ J / {weight}
    g = {pull} + J.T @ e / {weight}
    return {begin} {sign} np.linalg.solve(H, g), {after}
'''
RIGHT_MATCH = {"turn": ".T", "moved": "pose[:2] + arms", "belief": "covariance", "weight": "sigma**2",
               "slope": "normals[:, 1] * arms[:, 0] - normals[:, 0] * arms[:, 1]",
               "pull": "before @ (pose - predicted)", "begin": "pose", "sign": "-", "after": "np.linalg.inv(H)"}

GUARD = '''
def guard_at_the_shelf(berth, believed, deviations, allowed):
    """Wrong on purpose."""
    off = np.abs(berth - believed)
    off[2] = {turn}
    {test}
    return {reason}
'''
RIGHT_GUARD = {"turn": "abs((berth[2] - believed[2] + np.pi) % (2 * np.pi) - np.pi)",
               "test": "if (off + 2 * deviations <= allowed).all():\n        return ''",
               "reason": "f'it may be {1e3 * off.max():.0f} mm off'"}

DRIVE = '''
def rest_to_rest(t, way, speed, acceleration):
    """Wrong on purpose."""
    peak = {peak}
    duration = {duration}
    rise_and_fall = np.minimum(acceleration * t, acceleration * (duration - t))
    return {sign} * {shape}, duration
'''
RIGHT_DRIVE = {"peak": "min(speed, np.sqrt(acceleration * abs(way)))", "sign": "np.sign(way)",
               "duration": "abs(way) / peak + peak / acceleration", "shape": "np.clip(rise_and_fall, 0, peak)"}

LANDMARK = '''
def landmark(hall, way, doubt, allowed, free):
    """Wrong on purpose."""
    steps = np.linspace(-3, 3, 13)
    for x, y, angle in product(steps, steps, (0.2, 0.9)):
        pallet = np.array([way[-1][0] + x, way[-1][1] + y, angle])
        if {clear}:
            if {sure}:
                return pallet
    {none}
'''
RIGHT_LANDMARK = {"clear": "keeps_clear(hall, pallet, way, free)", "none": "raise ValueError('none')",
                  "sure": "np.all(2 * sure_after(with_pallet(hall, pallet), way[-1], doubt) <= allowed)"}


def wrong(template, right, **mistake):
    """A right answer with something in it that is not."""
    return template.format(**{**right, **mistake})


WRONG_ANSWERS: dict[str, list[tuple[str, str]]] = {
    "clearance-answer": [
        ("from center to center", wrong(CLEARANCE, RIGHT_CLEARANCE, promise="centers")),
        ("half a diagonal for one of the two points only",
         wrong(CLEARANCE, RIGHT_CLEARANCE, promise="np.maximum(centers - cell / np.sqrt(2), 0.0)")),
        ("an edge instead of a diagonal", wrong(CLEARANCE, RIGHT_CLEARANCE, promise="np.maximum(centers - cell, 0.0)")),
        ("no wall around the floor", wrong(CLEARANCE, RIGHT_CLEARANCE, ring="False")),
        ("in cells, not in meters", wrong(CLEARANCE, RIGHT_CLEARANCE, edge="1.0")),
        ("inside the obstacles", wrong(CLEARANCE, RIGHT_CLEARANCE, free="walled")),
        ("below zero", wrong(CLEARANCE, RIGHT_CLEARANCE, promise="centers - np.sqrt(2) * cell")),
        ("twice as careful as needed",
         wrong(CLEARANCE, RIGHT_CLEARANCE, promise="np.maximum(centers - 2 * np.sqrt(2) * cell, 0.0)")),
    ],
    "match-answer": [
        ("points turned the other way", wrong(MATCH, RIGHT_MATCH, turn="")),
        ("points not turned at all", wrong(MATCH, RIGHT_MATCH, moved="pose[:2] + points")),
        ("slope of the heading with the wrong sign", wrong(
            MATCH, RIGHT_MATCH, slope="normals[:, 0] * arms[:, 1] - normals[:, 1] * arms[:, 0]")),
        ("arms in the vehicle's frame", wrong(
            MATCH, RIGHT_MATCH, slope="normals[:, 1] * points[:, 0] - normals[:, 0] * points[:, 1]")),
        ("belief forgotten in the gradient", wrong(MATCH, RIGHT_MATCH, pull="0 * pose")),
        ("covariance taken for its inverse", wrong(MATCH, RIGHT_MATCH, belief="np.linalg.inv(covariance)")),
        ("sigma not squared", wrong(MATCH, RIGHT_MATCH, weight="sigma")),
        ("uphill", wrong(MATCH, RIGHT_MATCH, sign="+")),
        ("the step begins at the prediction", wrong(MATCH, RIGHT_MATCH, begin="predicted")),
        ("H returned for the covariance", wrong(MATCH, RIGHT_MATCH, after="H")),
    ],
    "guard-answer": [
        ("never asks how sure it is",
         wrong(GUARD, RIGHT_GUARD, test="if (off <= allowed).all():\n        return ''")),
        ("one deviation", wrong(GUARD, RIGHT_GUARD,
                                test="if (off + deviations <= allowed).all():\n        return ''")),
        ("place and doubt each for itself", wrong(
            GUARD, RIGHT_GUARD, test="if (np.maximum(off, 2 * deviations) <= allowed).all():\n        return ''")),
        ("the long way round", wrong(GUARD, RIGHT_GUARD, turn="off[2]")),
        ("heading forgotten", wrong(GUARD, RIGHT_GUARD,
                                    test="if (off + 2 * deviations <= allowed)[:2].all():\n        return ''")),
        ("one component is enough", wrong(GUARD, RIGHT_GUARD,
                                          test="if (off + 2 * deviations <= allowed).any():\n        return ''")),
        ("meters and radians in one length", wrong(
            GUARD, RIGHT_GUARD, test="if np.linalg.norm(off + 2 * deviations) <= np.linalg.norm(allowed):\n"
                                     "        return ''")),
        ("yes or no instead of a reason", wrong(GUARD, RIGHT_GUARD, test="",
                                                reason="bool((off + 2 * deviations <= allowed).all())")),
        ("always open", wrong(GUARD, RIGHT_GUARD, test="", reason="''")),
        ("always shut", wrong(GUARD, RIGHT_GUARD, test="", reason="'not sure'")),
    ],
    "drive-answer": [
        ("a trapezoid also where the way is too short", wrong(DRIVE, RIGHT_DRIVE, peak="speed")),
        ("a triangle of half the height", wrong(
            DRIVE, RIGHT_DRIVE, peak="min(speed, np.sqrt(acceleration * abs(way) / 2))")),
        ("time to speed up forgotten", wrong(DRIVE, RIGHT_DRIVE, duration="abs(way) / peak")),
        ("time to speed up counted twice",
         wrong(DRIVE, RIGHT_DRIVE, duration="abs(way) / peak + 2 * peak / acceleration")),
        ("never backwards", wrong(DRIVE, RIGHT_DRIVE, sign="1.0")),
        ("full speed from the first moment", wrong(DRIVE, RIGHT_DRIVE, shape="np.where((t >= 0) & (t <= duration), "
                                                                             "peak, 0.0)")),
        ("drives on behind the end", wrong(DRIVE, RIGHT_DRIVE, shape="np.minimum(rise_and_fall, peak)")),
        ("soft, and later there", wrong(DRIVE, RIGHT_DRIVE, duration="2 * (abs(way) / peak)",
                                        shape="way / duration * np.sign(way) * (1 - np.cos(2 * np.pi * np.clip(t / "
                                              "duration, 0, 1)))")),
    ],
    "landmark-answer": [
        ("in the way", wrong(LANDMARK, RIGHT_LANDMARK, clear="True")),
        ("half as far off the way", wrong(LANDMARK, RIGHT_LANDMARK, clear="keeps_clear(hall, pallet, way, free / 2)")),
        ("one deviation", wrong(LANDMARK, RIGHT_LANDMARK, sure=RIGHT_LANDMARK["sure"].replace("2 * ", ""))),
        ("one component is enough", wrong(LANDMARK, RIGHT_LANDMARK,
                                          sure=RIGHT_LANDMARK["sure"].replace("np.all", "np.any"))),
        ("sure at the start of the way", wrong(LANDMARK, RIGHT_LANDMARK,
                                               sure=RIGHT_LANDMARK["sure"].replace("way[-1]", "way[0]"))),
        ("anywhere", wrong(LANDMARK, RIGHT_LANDMARK, sure="True")),
        ("no answer where no place will do", wrong(LANDMARK, RIGHT_LANDMARK, none="return None")),
    ],
}
