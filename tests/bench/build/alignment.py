# SPDX-License-Identifier: Apache-2.0
"""Least-squares alignment of 2D points, as complex numbers."""

import cmath
import math


def fit_motion(source, target, with_scale):
    """(factor, shift) of target = factor * source + shift by least squares; |factor| is 1 without scale."""
    count = len(source)
    source_mean = sum(source) / count
    target_mean = sum(target) / count
    product = sum((t - target_mean) * (s - source_mean).conjugate() for s, t in zip(source, target))
    square = sum(abs(s - source_mean) ** 2 for s in source)
    if with_scale:
        factor = product / square if square > 0 else 1.0
    else:
        factor = cmath.exp(1j * cmath.phase(product))
    return factor, target_mean - factor * source_mean


def distances_after_fit(source, target, with_scale):
    factor, shift = fit_motion(source, target, with_scale)
    return [abs(factor * s + shift - t) for s, t in zip(source, target)]


def rms(values):
    return math.sqrt(sum(v * v for v in values) / len(values))


def geometric_error(positions, truth, with_scale):
    """RMS and largest error of the names in both dictionaries after alignment, in the truth's unit; None below 3 names.

    with_scale: positions are in any unit and may be mirrored, such as pixels.
    """
    names = sorted(set(positions) & set(truth))
    if len(names) < 3:
        return None  # two points always fit
    target = [truth[name] for name in names]
    source = [positions[name] for name in names]
    candidates = [distances_after_fit(source, target, with_scale)]
    if with_scale:
        candidates.append(distances_after_fit([s.conjugate() for s in source], target, with_scale))
    best = min(candidates, key=rms)
    return rms(best), max(best)
