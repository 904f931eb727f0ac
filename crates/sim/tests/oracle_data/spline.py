"""Makes spline.json: a rational B-spline by the recursion of Cox and de Boor in 25 digits, with mpmath.

Run: python3 spline.py > spline.json

For each spline: its length, and at several arc lengths the position, the unit tangent, the curvature and the second and third
derivative by arc length (numerical differences of the tangent in 40 digits); the arc length is inverted by Newton on the integral
of |C'|. Nothing is shared with the Rust code: no Bezier form, no table.
"""

import json

from mpmath import diff, mp, mpf, quad, sqrt, workdps

mp.dps = 25

SPLINES = [
    {
        "name": "cubic",
        "degree": 3,
        "knots": [0, 0, 0, 0, 0.2, 0.35, 0.35, 0.8, 1, 1, 1, 1],
        "control_mm": [[0, 0, 0], [5, 12, 1], [14, 9, 3], [16, -4, 2], [25, -6, -3], [33, 4, -1], [30, 15, 0], [40, 20, 5]],
        "weights": [1, 1.5, 0.7, 1, 2, 0.4, 1, 1.1],
    },
    {
        "name": "quintic, unclamped",
        "degree": 5,
        "knots": [-3, -2, -1.2, -0.7, -0.1, 0, 1, 2.5, 3, 4, 4.4, 5, 6, 7],
        "control_mm": [[0, 0, 0], [10, 10, 0], [20, -10, 4], [30, 10, 4], [40, -10, 4], [50, 10, 0], [60, 0, -9], [70, 5, 0]],
        "weights": [1, 1, 3, 1, 0.5, 1, 1, 1],
    },
    {
        "name": "conic",
        "degree": 2,
        "knots": [0, 0, 0, 1, 2, 2, 2],
        "control_mm": [[0, 0, 0], [10, 0, 0], [10, 7, 0], [-3, 9, 0]],
        "weights": [1, 0.6, 5, 1],
    },
]


def basis(i, p, u, knots, span, order):
    """Derivative of some order of the basis function i of degree p."""
    if p == 0:
        return mpf(1) if i == span and order == 0 else mpf(0)
    left, right = knots[i + p] - knots[i], knots[i + p + 1] - knots[i + 1]
    total = mpf(0)
    if order == 0:
        if left > 0:
            total += (u - knots[i]) / left * basis(i, p - 1, u, knots, span, 0)
        if right > 0:
            total += (knots[i + p + 1] - u) / right * basis(i + 1, p - 1, u, knots, span, 0)
    else:
        if left > 0:
            total += p / left * basis(i, p - 1, u, knots, span, order - 1)
        if right > 0:
            total -= p / right * basis(i + 1, p - 1, u, knots, span, order - 1)
    return total


def compute(spline):
    degree = spline["degree"]
    knots = [mpf(str(k)) for k in spline["knots"]]
    control = [[mpf(x) for x in point] for point in spline["control_mm"]]
    weights = [mpf(str(w)) for w in spline["weights"]]
    spans = [i for i in range(degree, len(control)) if knots[i] < knots[i + 1]]

    def homogeneous(u, span, order):
        parts = [basis(i, degree, u, knots, span, order) * weights[i] for i in range(span - degree, span + 1)]
        point = [sum(b * control[span - degree + i][k] for i, b in enumerate(parts)) for k in range(3)]
        return point, sum(parts)

    def jet(u, span):
        (a0, w0), (a1, w1), (a2, w2) = (homogeneous(u, span, order) for order in range(3))
        c0 = [a / w0 for a in a0]
        c1 = [(a - w1 * c) / w0 for a, c in zip(a1, c0)]
        c2 = [(a - 2 * w1 * d - w2 * c) / w0 for a, d, c in zip(a2, c1, c0)]
        return c0, c1, c2

    def speed(u, span):
        return sqrt(sum(d * d for d in jet(u, span)[1]))

    def length(span, lo, hi):
        parts = [lo + (hi - lo) * i / 8 for i in range(9)]
        return quad(lambda u: speed(u, span), parts, method="gauss-legendre", maxdegree=5)

    lengths = [length(span, knots[span], knots[span + 1]) for span in spans]
    total = sum(lengths)
    samples = []
    for part in ["0.013", "0.21", "0.37", "0.5", "0.64", "0.83", "0.99"]:
        s = mpf(part) * total
        rest = s
        for span, of_span in zip(spans, lengths):
            if rest <= of_span:
                break
            rest -= of_span
        lo, hi = knots[span], knots[span + 1]
        u = lo + rest / of_span * (hi - lo)
        for _ in range(50):
            step = (length(span, lo, u) - rest) / speed(u, span)
            u = min(max(u - step, lo), hi)
            if abs(step) < mpf("1e-18") * (hi - lo):
                break
        else:
            raise ValueError("no root")
        position, d1, d2 = jet(u, span)
        cross = [d1[1] * d2[2] - d1[2] * d2[1], d1[2] * d2[0] - d1[0] * d2[2], d1[0] * d2[1] - d1[1] * d2[0]]
        v = sqrt(sum(d * d for d in d1))

        def tangent(k, u, span=span):
            return jet(u, span)[1][k] / speed(u, span)

        def bend(k, u, span=span):
            return diff(lambda u: tangent(k, u), u) / speed(u, span)

        with workdps(40):
            second = [float(bend(k, u)) for k in range(3)]
            third = [float(diff(lambda u: bend(k, u), u, h=mpf("1e-8")) / v) for k in range(3)]
        samples.append(
            {
                "s_mm": float(s),
                "position_mm": [float(x) for x in position],
                "tangent": [float(d / v) for d in d1],
                "curvature_1_mm": float(sqrt(sum(c * c for c in cross)) / v**3),
                "second_1_mm": second,
                "third_1_mm2": third,
            }
        )
    return {**spline, "length_mm": float(total), "samples": samples}


print(json.dumps([compute(spline) for spline in SPLINES], indent=1))
