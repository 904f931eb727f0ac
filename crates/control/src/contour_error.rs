//! Contour error in real time: the distance of the tool from the line through the two stored
//! reference knots nearest it.
//!
//! ```text
//! eps_c = e_y cos(theta) - e_x sin(theta)   if x2 >= x1,   its negative if x2 < x1             (1)
//! theta = atan((y2 - y1) / (x2 - x1))                                                          (2)
//! ```
//!
//! with e = P2 - P: positive where the path lies to the left of the tool.
//!
//! Source: Lee and Jeon (1999); Lee, Cho and Jeon (2005), section 2.2, eqs 1 and 2.
//!
//! Departures: the foot is clamped to the stretch between the knots, so that the tool has a nearest
//! point beside a corner too; where the tangents of the two knots differ by a corner, the stretch
//! goes through the corner; in space the error is a vector, and eq. 1 is its component along the
//! left normal in the plane.
//!
//! The window has a variable size: the search starts at the age where it ended last time and covers
//! both sides as far as the tool can be, given its last distance and the speed of the reference.
//! [`MAX_ENTRIES`] bounds it.

use crate::vector::{add_scaled, bounded, dot, norm, reject, scale, sub};
use crate::window::{CORNER_COSINE, Knot, Window, corner};

/// Least number of entries searched on either side of the start: covers a feed period in which the
/// lag changes.
const MIN_REACH: i32 = 12;
/// Largest number of entries searched on either side.
const MAX_REACH: i32 = 48;
/// Largest number of register entries that one estimate searches.
pub const MAX_ENTRIES: usize = 2 * MAX_REACH as usize + 1;
/// Half width of the window in last distances: the nearest point beyond a right-angled corner is at
/// most 2.4 times the distance farther along the path.
const REACH_OF_ERROR: f64 = 3.0;
/// Least number of entries that [`locate`] searches on either side: between standstill and full
/// acceleration the lag of a servo of 20 ms changes by a third.
const MIN_LOCATE_REACH: i32 = 8;
/// Entries by which the index of a standing tool can move back beyond the knots of a feed period:
/// rounding and trembling of the tool.
const STANDING: i32 = 2;
/// Difference of distances below which the newer of two nearest points counts, mm. Where the path
/// runs back along itself, an old stretch is as near as the present one, and following it leads out
/// of the register.
const AS_NEAR_MM: f64 = 1e-4;

/// Nearest point of the path, as known from the register.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContourError<const N: usize> {
    /// Vector from the tool to the nearest point of the path (desired minus actual), mm.
    pub vector_mm: [f64; N],
    /// Unit direction of travel at the nearest point.
    pub tangent: [f64; N],
    /// Index of the nearest knot, as in [`Window::knot`].
    pub index: i32,
    /// Number of entries searched.
    pub entries: usize,
}

impl<const N: usize> ContourError<N> {
    /// Zero error before the first estimate.
    pub const NONE: Self = Self {
        vector_mm: [0.0; N],
        tangent: [0.0; N],
        index: 0,
        entries: 0,
    };

    /// Returns the error of eq. 1 with its sign: positive where the path lies to the left of the
    /// tool, in the plane of the first two axes; mm.
    pub fn signed_mm(&self) -> f64 {
        self.tangent[0] * self.vector_mm[1] - self.tangent[1] * self.vector_mm[0]
    }
}

/// Estimator of the contour error. Remembers the index of the knot nearest the tool.
#[derive(Debug, Clone, Default)]
pub struct Estimator {
    index: i32,
    distance_mm: f64,
    spacing_mm: f64,
    /// True where the tool seemed to move back along the path.
    backwards: bool,
}

impl Estimator {
    /// Returns the contour error of a tool at `tool_mm`.
    #[inline]
    pub fn estimate<const N: usize>(
        &mut self,
        window: &Window<'_, N>,
        tool_mm: [f64; N],
    ) -> ContourError<N> {
        let [first, last] = window.range();
        let start = if self.backwards { 0 } else { self.index }
            .min(last)
            .max(first);
        let reach = self.reach();
        // The search always extends toward the current knot: a tool that lags turns short of a
        // point where the path turns back, and continues from there on a newer stretch, which need
        // not begin near the old one.
        let to = (start + reach).max((start + MAX_REACH).min(0)).min(last);
        let error = nearest(window, tool_mm, (start - reach).max(first), to);
        // A tool never moves back along its path. Where it seems to, the search found an older
        // stretch beside the present one, and following that would lead out of the register. The
        // next search begins at the current knot again.
        let pushed = (window.feed_period_s / window.servo_s()) as i32;
        self.backwards = error.index < self.index - pushed - STANDING;
        self.index = error.index;
        self.distance_mm = norm(error.vector_mm);
        let before = (error.index - 1).max(first);
        self.spacing_mm = norm(sub(
            window.knot(before + 1).position_mm,
            window.knot(before).position_mm,
        ));
        error
    }

    /// Forgets where the tool was.
    pub fn reset(&mut self) {
        *self = Self::default();
    }

    /// Returns the number of entries to search on either side of the last index.
    fn reach(&self) -> i32 {
        if self.spacing_mm <= 0.0 {
            return MAX_REACH;
        }
        // The cast saturates where the float is too large or NaN.
        MIN_REACH
            + ((REACH_OF_ERROR * self.distance_mm / self.spacing_mm) as i32)
                .min(MAX_REACH - MIN_REACH)
    }
}

/// Returns the contour error of a predicted tool whose nearest knot is near the index `near`: the
/// nearest point within `reach` entries, 8 to 48. The search stays within that reach, so that
/// beside a corner the time of the tool decides on which side of the corner it is, not the
/// distance.
#[inline]
pub(crate) fn locate<const N: usize>(
    window: &Window<'_, N>,
    tool_mm: [f64; N],
    near: i32,
    reach: i32,
) -> ContourError<N> {
    let reach = reach.clamp(MIN_LOCATE_REACH, MAX_REACH);
    let [first, last] = window.range();
    let near = near.min(last).max(first);
    let (mut index, mut least) = (near, f64::INFINITY);
    for candidate in (near - reach).max(first)..=(near + reach).min(last) {
        let d = sub(window.knot(candidate).position_mm, tool_mm);
        if dot(d, d) < least {
            (index, least) = (candidate, dot(d, d));
        }
    }
    ContourError {
        index,
        ..nearest_foot(window, tool_mm, index)
    }
}

/// Carries a vector across the path along it from one tangent to another by the smallest rotation
/// between them. After a corner only the part across the new stretch remains.
pub fn carried<const N: usize>(across: [f64; N], from: [f64; N], to: [f64; N]) -> [f64; N] {
    let cosine = dot(from, to);
    if cosine < CORNER_COSINE {
        return reject(across, to);
    }
    let both = add_scaled(from, 1.0, to);
    reject(
        add_scaled(across, -dot(across, to) / (1.0 + cosine), both),
        to,
    )
}

/// Returns the nearest point of the path near the knots of a range. Widens the range while the
/// nearest knot is at an end of it. Of two equally near points it returns the newer.
#[inline]
fn nearest<const N: usize>(
    window: &Window<'_, N>,
    tool_mm: [f64; N],
    from: i32,
    to: i32,
) -> ContourError<N> {
    let minima = minima(window, tool_mm, from, to);
    let at = |index: i32| ContourError {
        index,
        entries: minima.entries,
        ..nearest_foot(window, tool_mm, index)
    };
    let newest = at(minima.newest);
    // The nearer knot need not have the nearer foot: where the path turns back, both stretches are
    // examined.
    let older = minima.older.map_or(newest, at);
    if norm(newest.vector_mm) <= norm(older.vector_mm) + AS_NEAR_MM {
        newest
    } else {
        older
    }
}

/// Knots at which the distance to the tool has a minimum.
struct Minima {
    /// Newest minimum.
    newest: i32,
    /// Nearest of the older minima.
    older: Option<i32>,
    /// Number of entries searched.
    entries: usize,
}

#[inline]
fn minima<const N: usize>(window: &Window<'_, N>, tool_mm: [f64; N], from: i32, to: i32) -> Minima {
    let square = |index: i32| {
        let d = sub(window.knot(index).position_mm, tool_mm);
        dot(d, d)
    };
    let (mut newest, mut newest_square) = (to, square(to));
    while newest > from && square(newest - 1) < newest_square {
        newest -= 1;
        newest_square = square(newest);
    }
    let (mut older, mut older_square) = (None, f64::INFINITY);
    let mut last_square = newest_square;
    for index in (from..newest).rev() {
        let s = square(index);
        if s < last_square && s < older_square {
            (older, older_square) = (Some(index), s);
        }
        last_square = s;
    }
    let mut entries = (to - from + 1) as usize;
    let [first, last] = window.range();
    let nearer_older = older.filter(|_| older_square < newest_square);
    let (mut best, mut best_square) =
        nearer_older.map_or((newest, newest_square), |older| (older, older_square));
    let direction = if best == from { -1 } else { 1 };
    if best == from || best == to {
        while entries < MAX_ENTRIES && (first..=last).contains(&(best + direction)) {
            entries += 1;
            let s = square(best + direction);
            if s >= best_square {
                break;
            }
            (best, best_square) = (best + direction, s);
        }
    }
    if nearer_older.is_some() {
        older = Some(best);
    } else {
        newest = best;
    }
    Minima {
        newest,
        older,
        entries,
    }
}

/// Returns the nearest point on the stretches before and after the knot of this index.
fn nearest_foot<const N: usize>(
    window: &Window<'_, N>,
    tool_mm: [f64; N],
    index: i32,
) -> ContourError<N> {
    let [first, last] = window.range();
    let knot = window.knot(index);
    let mut best = foot_on(knot.position_mm, knot.position_mm, knot.tangent, tool_mm);
    for (before, after) in [(index - 1, index), (index, index + 1)] {
        if before < first || after > last {
            continue;
        }
        for foot in feet_between(window.knot(before), window.knot(after), tool_mm) {
            if dot(foot.vector_mm, foot.vector_mm) < dot(best.vector_mm, best.vector_mm) {
                best = foot;
            }
        }
    }
    best
}

/// Returns the nearest points on the path between two knots: on the chord, or at a corner on its
/// two sides.
fn feet_between<const N: usize>(
    from: &Knot<N>,
    to: &Knot<N>,
    tool_mm: [f64; N],
) -> [ContourError<N>; 2] {
    let (p, q) = (from.position_mm, to.position_mm);
    if let Some(to_corner_mm) = corner(from, to) {
        let corner_mm = add_scaled(p, to_corner_mm, from.tangent);
        return [
            foot_on(p, corner_mm, from.tangent, tool_mm),
            foot_on(corner_mm, q, to.tangent, tool_mm),
        ];
    }
    let chord = sub(q, p);
    let length = norm(chord);
    let direction = if length > 0.0 {
        scale(1.0 / length, chord)
    } else {
        to.tangent
    };
    [foot_on(p, q, direction, tool_mm); 2]
}

/// Returns the nearest point on the stretch from `p` to `q` along the unit vector `direction`.
fn foot_on<const N: usize>(
    p: [f64; N],
    q: [f64; N],
    direction: [f64; N],
    tool_mm: [f64; N],
) -> ContourError<N> {
    let along = bounded(dot(sub(tool_mm, p), direction), 0.0, norm(sub(q, p)));
    let foot = add_scaled(p, along, direction);
    ContourError {
        vector_mm: sub(foot, tool_mm),
        tangent: direction,
        index: 0,
        entries: 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::{Preview, Register};

    /// Eqs 1 and 2 as they are printed.
    fn printed([x1, y1]: [f64; 2], [x2, y2]: [f64; 2], [x, y]: [f64; 2]) -> f64 {
        let theta = libm::atan((y2 - y1) / (x2 - x1));
        let (ex, ey) = (x2 - x, y2 - y);
        let eps = ey * libm::cos(theta) - ex * libm::sin(theta);
        if x2 >= x1 { eps } else { -eps }
    }

    /// Knots of a path, all of them pushed, and the window at the last.
    struct Behind {
        register: Register<2>,
        preview: Preview<2>,
    }

    impl Behind {
        fn new(knots: impl Iterator<Item = Knot<2>>) -> Self {
            let mut behind = Self {
                register: Register::default(),
                preview: Preview::new(0.001),
            };
            for knot in knots {
                behind.register.push(knot);
            }
            behind
        }

        fn estimate(&self, tool_mm: [f64; 2]) -> ContourError<2> {
            let window = Window {
                register: &self.register,
                preview: &self.preview,
                tau_s: 0.0,
                feed_period_s: 0.01,
                offset_mm: [0.0; 2],
                offset_mm_s: [0.0; 2],
            };
            Estimator::default().estimate(&window, tool_mm)
        }
    }

    fn on_circle(a: f64) -> Knot<2> {
        let (sin, cos) = (libm::sin(a), libm::cos(a));
        Knot {
            position_mm: [10.0 * (1.0 - cos), 10.0 * sin],
            tangent: [sin, cos],
            feed_mm_s: 50.0,
            cutting: true,
        }
    }

    #[test]
    fn agrees_with_the_printed_equations_in_all_quadrants() {
        let step = 0.005;
        for knots in (30..1200).step_by(7) {
            let behind = Behind::new((0..knots).map(|i| on_circle(f64::from(i) * step)));
            let a = (f64::from(knots) - 20.3) * step;
            let tool = [10.0 - 9.97 * libm::cos(a), 9.97 * libm::sin(a)];
            let error = behind.estimate(tool);
            let on = |i: i32| on_circle(f64::from(i) * step).position_mm;
            let eps = printed(on(knots - 21), on(knots - 20), tool);
            assert!(
                (error.signed_mm() - eps).abs() < 1e-9,
                "{knots}: {} {eps}",
                error.signed_mm()
            );
            assert!((norm(error.vector_mm) - 0.03).abs() < 1e-4);
        }
    }

    #[test]
    fn a_corner_between_two_knots_is_not_cut_off() {
        let in_x = (0..20).map(|i| Knot {
            position_mm: [-0.995 + 0.05 * f64::from(i), 0.0],
            tangent: [1.0, 0.0],
            feed_mm_s: 50.0,
            cutting: true,
        });
        let in_y = (0..20).map(|i| Knot {
            position_mm: [0.0, 0.005 + 0.05 * f64::from(i)],
            tangent: [0.0, 1.0],
            feed_mm_s: 50.0,
            cutting: true,
        });
        let error = Behind::new(in_x.chain(in_y)).estimate([0.03, -0.04]);
        assert!((norm(error.vector_mm) - 0.05).abs() < 1e-12, "{error:?}");
    }

    #[test]
    fn a_path_that_runs_back_along_itself_is_followed_where_the_tool_is() {
        let there_and_back = |i: i32| {
            let (x, back) = if i <= 300 {
                (0.05 * f64::from(i), 1.0)
            } else {
                (0.05 * f64::from(600 - i) + 0.01, -1.0)
            };
            Knot {
                position_mm: [x, 0.0],
                tangent: [back, 0.0],
                feed_mm_s: 50.0,
                cutting: true,
            }
        };
        let mut behind = Behind::new((0..300).map(there_and_back));
        let mut estimator = Estimator::default();
        for i in 300..560 {
            behind.register.push(there_and_back(i));
            if (319..=322).contains(&i) {
                continue;
            }
            let [x, _] = there_and_back(i - 20).position_mm;
            let window = Window {
                register: &behind.register,
                preview: &behind.preview,
                tau_s: 0.0,
                feed_period_s: 0.001,
                offset_mm: [0.0; 2],
                offset_mm_s: [0.0; 2],
            };
            let error = estimator.estimate(&window, [x + 0.013, 0.02]);
            assert!(
                (norm(error.vector_mm) - 0.02).abs() < 1e-9,
                "{i}: {error:?}"
            );
            assert!(i < 323 || error.tangent[0] == -1.0, "{i}: {error:?}");
        }
    }

    #[test]
    fn a_tool_nowhere_gives_an_error_that_is_not_a_number_in_bounded_work() {
        let behind = Behind::new((0..300).map(|i| on_circle(f64::from(i) * 0.005)));
        let error = behind.estimate([f64::NAN, 0.0]);
        assert!(error.entries <= MAX_ENTRIES && !norm(error.vector_mm).is_finite());
    }

    #[test]
    fn what_is_carried_keeps_its_length_and_its_side_of_the_path() {
        for step in -50..=50 {
            let a = 0.001 * f64::from(step);
            let to = [libm::cos(a), libm::sin(a)];
            let normal = carried([0.0, 2.0], [1.0, 0.0], to);
            assert!(
                norm(sub(normal, [-2.0 * to[1], 2.0 * to[0]])) < 1e-12,
                "{a}: {normal:?}"
            );
        }
        // In space, what lies along the axis of the rotation stays.
        let to = [libm::cos(0.05), libm::sin(0.05), 0.0];
        assert!(
            norm(sub(
                carried([0.0, 0.0, 3.0], [1.0, 0.0, 0.0], to),
                [0.0, 0.0, 3.0]
            )) < 1e-15
        );
        // After a right-angled corner nothing remains; where the path runs back, everything
        // remains.
        assert_eq!(carried([0.0, 2.0], [1.0, 0.0], [0.0, 1.0]), [0.0, 0.0]);
        assert_eq!(carried([0.0, 2.0], [1.0, 0.0], [-1.0, 0.0]), [0.0, 2.0]);
    }
}
