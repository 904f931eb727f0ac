//! A smooth plane curve as arcs: pairs of arcs that meet the curve and its tangent at their ends and each other smoothly.
//!
//! Between points p0, p1 with unit tangents t0, t1 the joint of the pair with equal tangent lengths d lies midway between
//! p0 + d t0 and p1 - d t1, where |p1 - p0 - d (t0 + t1)| = 2 d. Source: Bolton, "Biarc curves", Computer-Aided Design
//! 7(2), 1975, doi:10.1016/0010-4485(75)90086-X.

type P = [f64; 2];

/// Largest distance of an arc from the curve, mm. The files promise 0.5 um; a tenth of it is left for rounding and sampling.
pub(crate) const TOLERANCE_MM: f64 = 0.45e-3;

/// Points on each pair of arcs where the distance is taken; the error has a few humps only.
const SAMPLES: usize = 64;

/// An arc from the end of the one before: `end`, `center`, and the direction of turning.
pub(crate) struct ArcMove {
    pub(crate) end: P,
    /// `None` for a straight line.
    pub(crate) center: Option<P>,
    pub(crate) clockwise: bool,
}

/// A closed form: point and derivative by parameter.
pub(crate) trait Curve {
    fn point(&self, a: f64) -> P;
    fn derivative(&self, a: f64) -> P;
}

/// The curve from `from` to `to` in as few pairs of arcs as a greedy choice needs.
pub(crate) fn approximate(curve: &impl Curve, from: f64, to: f64) -> Vec<ArcMove> {
    let mut moves = Vec::new();
    let mut at = from;
    while at < to {
        let mut step = to - at;
        if error(curve, at, to) > TOLERANCE_MM {
            // Largest step within tolerance: the error grows with the step, so halve the bracket until it is a thousandth.
            let (mut good, mut bad) = (0.0, step);
            while bad - good > 1e-3 * bad {
                let middle = 0.5 * (good + bad);
                if error(curve, at, at + middle) <= TOLERANCE_MM {
                    good = middle;
                } else {
                    bad = middle;
                }
            }
            step = good;
        }
        let next = if at + step >= to { to } else { at + step };
        moves.extend(pair(curve, at, next));
        at = next;
    }
    moves
}

fn pair(curve: &impl Curve, from: f64, to: f64) -> [ArcMove; 2] {
    let (p0, p1) = (curve.point(from), curve.point(to));
    let (t0, t1) = (unit(curve.derivative(from)), unit(curve.derivative(to)));
    let v = sub(p1, p0);
    let t = [t0[0] + t1[0], t0[1] + t1[1]];
    // |v - d t|^2 = 4 d^2, the positive root.
    let (a, b, c) = (dot(t, t) - 4.0, -2.0 * dot(v, t), dot(v, v));
    let d = if a.abs() < 1e-12 { -c / b } else { (-b - (b * b - 4.0 * a * c).sqrt()) / (2.0 * a) };
    let joint = [0.5 * (p0[0] + d * t0[0] + p1[0] - d * t1[0]), 0.5 * (p0[1] + d * t0[1] + p1[1] - d * t1[1])];
    let back = arc(p1, [-t1[0], -t1[1]], joint);
    [arc(p0, t0, joint), ArcMove { end: p1, center: back.center, clockwise: !back.clockwise }]
}

/// The arc that leaves `start` along `tangent` and ends at `end`.
fn arc(start: P, tangent: P, end: P) -> ArcMove {
    let v = sub(end, start);
    let normal = [-tangent[1], tangent[0]];
    let twice_height = 2.0 * dot(v, normal);
    // A sagitta below the printed nanometre: the arc would be no different from a line.
    if twice_height.abs() / 8.0 < 1e-6 {
        return ArcMove { end, center: None, clockwise: false };
    }
    let radius = dot(v, v) / twice_height;
    ArcMove {
        end,
        center: Some([start[0] + radius * normal[0], start[1] + radius * normal[1]]),
        clockwise: radius < 0.0,
    }
}

/// Largest distance of the curve from its pair of arcs, seen from points of the curve.
fn error(curve: &impl Curve, from: f64, to: f64) -> f64 {
    let start = curve.point(from);
    let [first, second] = pair(curve, from, to);
    // The curve changes from the first arc to the second where it passes the joint.
    let along = sub(second.end, start);
    let joint = dot(sub(first.end, start), along);
    (1..SAMPLES)
        .map(|i| {
            let p = curve.point(from + (to - from) * i as f64 / SAMPLES as f64);
            if dot(sub(p, start), along) < joint { distance(p, start, &first) } else { distance(p, first.end, &second) }
        })
        .fold(0.0, f64::max)
}

fn distance(p: P, start: P, arc: &ArcMove) -> f64 {
    match arc.center {
        Some(center) => (norm(sub(p, center)) - norm(sub(arc.end, center))).abs(),
        None => {
            let along = unit(sub(arc.end, start));
            let v = sub(p, start);
            (along[0] * v[1] - along[1] * v[0]).abs()
        }
    }
}

fn sub(a: P, b: P) -> P {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: P, b: P) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn norm(a: P) -> f64 {
    a[0].hypot(a[1])
}

fn unit(a: P) -> P {
    [a[0] / norm(a), a[1] / norm(a)]
}
