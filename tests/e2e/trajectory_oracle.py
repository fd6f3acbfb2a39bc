# SPDX-License-Identifier: Apache-2.0
"""Independent implementation of the trajectory errors, to check `floorloc-mapbuilder evaluate`.

Poses are (stamp, position, quaternion wxyz). Alignment uses Horn's quaternion method (1987) instead of Umeyama's
singular value decomposition, rotation angles use quaternions and full errors 4x4 matrices.
"""

import math
import random
import statistics


def add(a, b):
    return [x + y for x, y in zip(a, b)]


def sub(a, b):
    return [x - y for x, y in zip(a, b)]


def scaled(k, a):
    return [k * x for x in a]


def dot(a, b):
    return sum(x * y for x, y in zip(a, b))


def norm(a):
    return math.sqrt(dot(a, a))


def multiply(p, q):
    return [
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    ]


def conjugate(q):
    return [q[0], -q[1], -q[2], -q[3]]


def rotate(q, x):
    return multiply(multiply(q, [0.0, *x]), conjugate(q))[1:]


def angle(q):
    return 2.0 * math.atan2(norm(q[1:]), abs(q[0]))


def about(axis, angle_rad):
    return [math.cos(angle_rad / 2), *scaled(math.sin(angle_rad / 2) / norm(axis), axis)]


def between(a, b):
    """a^-1 * b for poses (position, quaternion)."""
    inverse = conjugate(a[1])
    return rotate(inverse, sub(b[0], a[0])), multiply(inverse, b[1])


def matrix(motion):
    columns = [rotate(motion[1], axis) for axis in ([1, 0, 0], [0, 1, 0], [0, 0, 1])] + [motion[0]]
    rows = [[column[i] for column in columns] for i in range(3)]
    return [*rows, [0.0, 0.0, 0.0, 1.0]]


def errors_of(reference, estimate):
    """Translation, rotation and full error of one pose (or motion) against another."""
    difference = between(reference, estimate)
    entries = matrix(difference)
    full = math.sqrt(sum((entries[i][j] - (i == j)) ** 2 for i in range(4) for j in range(4)))
    return norm(difference[0]), angle(difference[1]), full


def summary(values):
    ordered = sorted(values)
    place = 0.99 * (len(ordered) - 1)
    below = int(place)
    above = min(below + 1, len(ordered) - 1)
    squares = sum(value * value for value in values)
    return {
        "rmse": math.sqrt(squares / len(values)), "mean": statistics.fmean(values),
        "median": statistics.median(values), "std": statistics.pstdev(values), "min": ordered[0], "max": ordered[-1],
        "sse": squares, "p99": ordered[below] + (place - below) * (ordered[above] - ordered[below]),
    }


def horn_rotation(references, estimates):
    """Rotation from centred estimates to centred references: the eigenvector of the largest eigenvalue of Horn's
    matrix, by power iteration."""
    s = [[sum(e[i] * r[j] for e, r in zip(estimates, references)) for j in range(3)] for i in range(3)]
    n = [
        [s[0][0] + s[1][1] + s[2][2], s[1][2] - s[2][1], s[2][0] - s[0][2], s[0][1] - s[1][0]],
        [s[1][2] - s[2][1], s[0][0] - s[1][1] - s[2][2], s[0][1] + s[1][0], s[2][0] + s[0][2]],
        [s[2][0] - s[0][2], s[0][1] + s[1][0], s[1][1] - s[0][0] - s[2][2], s[1][2] + s[2][1]],
        [s[0][1] - s[1][0], s[2][0] + s[0][2], s[1][2] + s[2][1], s[2][2] - s[0][0] - s[1][1]],
    ]
    shift = sum(abs(value) for row in n for value in row)  # so that the largest eigenvalue has the largest magnitude
    powers = [[value / shift + (i == j) for j, value in enumerate(row)] for i, row in enumerate(n)]
    for _ in range(40):  # repeated squaring of the matrix
        powers = [[dot(row, column) for column in zip(*powers)] for row in powers]
        largest = max(abs(value) for row in powers for value in row)
        powers = [[value / largest for value in row] for row in powers]
    q = max(powers, key=norm)
    return scaled(1.0 / norm(q), q)


def centred(points):
    mean = scaled(1.0 / len(points), [sum(values) for values in zip(*points)])
    return mean, [sub(point, mean) for point in points]


def alignment(pairs, mode):
    """(scale, quaternion, translation) from estimates to references."""
    identity = (1.0, [1.0, 0.0, 0.0, 0.0], [0.0, 0.0, 0.0])
    if mode == "none":
        return identity
    if mode == "origin":
        reference, estimate = pairs[0]
        q = multiply(reference[1], conjugate(estimate[1]))
        return 1.0, q, sub(reference[0], rotate(q, estimate[0]))
    flat = [1, 1, 0] if mode == "se2" else [1, 1, 1]
    reference_mean, references = centred([[x * f for x, f in zip(r[0], flat)] for r, _ in pairs])
    estimate_mean, estimates = centred([[x * f for x, f in zip(e[0], flat)] for _, e in pairs])
    if mode == "se2":
        cosine = sum(r[0] * e[0] + r[1] * e[1] for r, e in zip(references, estimates))
        sine = sum(r[1] * e[0] - r[0] * e[1] for r, e in zip(references, estimates))
        q = about([0, 0, 1], math.atan2(sine, cosine))
    else:
        q = horn_rotation(references, estimates)
    scale = 1.0
    if mode in ("sim3", "scale"):
        scale = sum(dot(r, rotate(q, e)) for r, e in zip(references, estimates)) / sum(dot(e, e) for e in estimates)
    if mode == "scale":
        return scale, identity[1], identity[2]
    return scale, q, sub(reference_mean, scaled(scale, rotate(q, estimate_mean)))


def associate(reference, estimate, max_diff):
    """Pairs every pose of the shorter trajectory with the pose of the longer one nearest in time."""
    estimate_longer = len(estimate) > len(reference)
    longer, shorter = (estimate, reference) if estimate_longer else (reference, estimate)
    pairs = []
    for pose in shorter:
        nearest = min(longer, key=lambda other: abs(other[0] - pose[0]))
        if abs(nearest[0] - pose[0]) <= max_diff:
            pairs.append((pose[1:], nearest[1:]) if estimate_longer else (nearest[1:], pose[1:]))
    return pairs


def motions(poses, delta, unit, all_pairs, tolerance=0.1):
    """Index pairs as described in evo's documentation; a simple quadratic implementation."""
    count = len(poses)
    if unit == "frames":
        return [(i, i + delta) for i in range(0, count - delta, 1 if all_pairs else delta)]
    if unit == "deg":
        delta, unit = math.radians(delta), "rad"
    if all_pairs and unit == "rad":
        return [(i, j) for i in range(count) for j in range(i + 1, count)
                if abs(angle(between(poses[i], poses[j])[1]) - delta) <= tolerance * delta]
    if all_pairs:
        path = [0.0]
        for before, after in zip(poses, poses[1:]):
            path.append(path[-1] + norm(sub(after[0], before[0])))
        found = []
        for i in range(count - 1):
            j = min(range(i + 1, count), key=lambda j: abs(path[j] - path[i] - delta))
            if abs(path[j] - path[i] - delta) <= tolerance * delta:
                found.append((i, j))
        return found
    marks, driven = [0] if unit == "rad" else [], 0.0
    for i in range(1, count):
        step = between(poses[i - 1], poses[i])
        driven += angle(step[1]) if unit == "rad" else norm(step[0])
        if driven >= delta:
            marks.append(i)
            driven = 0.0
    return list(zip(marks, marks[1:]))


def evaluate(reference, estimate, align="none", max_diff=0.01, motions_of=None):
    """Summaries of the translation, rotation and full errors: absolute, or relative over motions_of(poses)."""
    pairs = associate(reference, estimate, max_diff)
    scale, q, translation = alignment(pairs, align)
    moved = [(r, (add(scaled(scale, rotate(q, e[0])), translation), multiply(q, e[1]))) for r, e in pairs]
    if motions_of is None:
        errors = [errors_of(r, e) for r, e in moved]
    else:
        ends = motions_of([e for _, e in moved])
        errors = [errors_of(between(moved[i][0], moved[j][0]), between(moved[i][1], moved[j][1])) for i, j in ends]
    names = ("translation", "rotation", "full")
    return {name: summary(values) for name, values in zip(names, zip(*errors))}, len(errors), scale


def random_drive(seed, count=120):
    """A 3D drive with large rotations, and an estimate: scaled, transformed, noisy, with jittered times and gaps."""
    rng = random.Random(seed)
    place, q = [0.0, 0.0, 0.0], about([0, 0, 1], 1.0)
    there, turned = [3.0, -2.0, 0.5], about([1, 2, -3], 0.8)
    reference, estimate = [], []
    for i in range(count):
        stamp = 1000.0 + 0.1 * i
        reference.append((stamp, place, q))
        if rng.random() < 0.85:
            noisy = [x + rng.gauss(0, 0.02) for x in place]
            tilt = about([rng.gauss(0, 1) for _ in range(3)], rng.gauss(0, 0.02))
            estimate.append((round(stamp + rng.uniform(-0.012, 0.012), 6),
                             add(scaled(0.7, rotate(turned, noisy)), there), multiply(turned, multiply(q, tilt))))
        q = multiply(q, about([rng.gauss(0, 0.3), rng.gauss(0, 0.3), 1], rng.gauss(0.05, 0.1)))
        place = add(place, rotate(q, [rng.uniform(0.02, 0.12), 0, 0]))
    return reference, estimate


def as_tum(trajectory):
    return "".join(f"{t:.6f} {p[0]!r} {p[1]!r} {p[2]!r} {q[1]!r} {q[2]!r} {q[3]!r} {q[0]!r}\n" for t, p, q in trajectory)
