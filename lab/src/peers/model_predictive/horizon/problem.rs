//! The problem of one tick: the predictions along a plan and their derivative, row by row.
//!
//! The problem is linearized about the plan. r are the errors, each times the square root of its
//! weight, and G is their derivative with respect to all accelerations:
//!
//! ```text
//! J(a + da) = 1/2 |r + G da|^2 + q/2 sum_j |o_j|^2 + w/2 sum_j |v_j|^2
//!             + d/2 sum_j |v_j - v_{j-1}|^2
//! ```
//!
//! A knot that counts has N rows: the errors of the tool across the path and along it. On a rapid,
//! the rows hold the tool where it is, in each axis. Each exceeded limit adds one row with the
//! excess. N more rows bring the offset back after the last knot.

use feedwright_control::vector::{bounded, dot, norm, reject, scale, sub};
use feedwright_control::{PREVIEW_KNOTS, Window};

use super::{
    Accelerations, CommandedPeriod, HorizonSettings, MAX_AXES, MAX_KNOTS, MAX_UNKNOWNS, Predictor,
    Sensitivity,
};

/// Weight of what a change of the plan moves the tool by on a rapid: less than an error of a cut,
/// so that it is in place when the next one begins.
const RAPID_WEIGHT: f64 = 0.2;
/// Least h in the knots before and behind a point where the path turns straight back.
const TURN_WEIGHT: f64 = 0.2;
/// Factor by which the nearness to such a point falls from one knot to the next.
const NEAR_TURN: f64 = 0.85;
/// A rapid counts as a cut for this part of the lag: the tool still leaves the last corner of the
/// cut.
const LATELY: f64 = 0.3;
/// e^(1/2): weight of where the offset would come to behind the horizon.
pub const END_WEIGHT: f64 = 0.3;
/// Weights of what is beyond a limit, so that a hundredth of a usual limit (0.5 mm, 400 mm/s, 4000
/// mm/s^2) counts as much as 50 um of contour error: for the deviation, mm per mm; for the speed,
/// s; for the drives, s^2.
const DEVIATION_WEIGHT: f64 = 10.0;
const SPEED_WEIGHT_S: f64 = 0.0125;
const DRIVE_WEIGHT_S2: f64 = 1e-3;

/// The problem of a tick.
#[derive(Debug, Clone)]
pub struct HorizonProblem<const N: usize> {
    /// Knots of the horizon.
    pub knots: usize,
    /// Time of a knot, s.
    pub knot_s: f64,
    /// Lag of the machine, s.
    pub lag_s: f64,
    /// Errors and weights at the end of each knot.
    pub ends: [End<N>; MAX_KNOTS],
    /// Derivative of the tool to the accelerations, s^2.
    pub sensitivity: [Sensitivity<N>; MAX_KNOTS],
    /// Derivative of the offset at the end of the last knot with respect to the acceleration of
    /// each knot, s^2. At the end of any other knot it is the same, shifted.
    pub moved_s2: [f64; MAX_KNOTS],
    /// The settings.
    pub settings: HorizonSettings<N>,
}

/// Prediction at the end of a knot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct End<const N: usize> {
    /// Errors of the tool: across the path, and last along it, mm.
    pub off_mm: [f64; N],
    /// Their directions: N - 1 normals of the path, and last the tangent.
    pub directions: [[f64; N]; N],
    /// Planned feedrate there, mm/s.
    pub feed_mm_s: f64,
    /// True if the tool cuts there, will soon cut, has just cut, or is to be on the path.
    pub counts: bool,
    /// Sharpness of the turn of the path between this knot and one beside it: 0 not at all, 1/2 at
    /// a right angle, 1 straight back.
    pub corner: f64,
    /// Reversal of the path at this knot: 0 up to a right angle, 1 straight back.
    pub turn: f64,
    /// Nearness of such a point, on the same scale.
    pub near_turn: f64,
    /// Offset, mm, and its speed, mm/s.
    pub offset_mm: [f64; N],
    /// See above.
    pub offset_mm_s: [f64; N],
    /// Predicted position of the tool, mm.
    pub tool_mm: [f64; N],
}

impl<const N: usize> End<N> {
    const NONE: Self = Self {
        off_mm: [0.0; N],
        directions: [[0.0; N]; N],
        feed_mm_s: 0.0,
        counts: false,
        corner: 0.0,
        turn: 0.0,
        near_turn: 0.0,
        offset_mm: [0.0; N],
        offset_mm_s: [0.0; N],
        tool_mm: [0.0; N],
    };
}

/// The derivative of an error to all accelerations.
pub(crate) type GradientRow = [f64; MAX_UNKNOWNS];

impl<const N: usize> HorizonProblem<N> {
    /// Rolls a plan out through a model. The tool is to be behind the plan by the lag of the model.
    pub fn new<M: Predictor<N>>(
        model: &M,
        window: &Window<'_, N>,
        accelerations_mm_s2: &Accelerations<N>,
        settings: &HorizonSettings<N>,
    ) -> Self {
        const {
            assert!(
                N >= 2 && N <= MAX_AXES,
                "a plan is made in the plane or in space"
            );
        };
        let knots = settings.knots();
        let lag_s = bounded(model.lag_s(), 0.0, PREVIEW_KNOTS as f64 * window.servo_s());
        let mut problem = Self {
            knots,
            knot_s: window.feed_period_s,
            lag_s,
            ends: [End::NONE; MAX_KNOTS],
            sensitivity: [[[0.0; N]; MAX_KNOTS]; MAX_KNOTS],
            moved_s2: [0.0; MAX_KNOTS],
            settings: *settings,
        };
        let mut model = model.clone();
        let mut stretch = CommandedPeriod::now(window);
        for knot in 0..knots {
            stretch.go_on(window, accelerations_mm_s2[knot]);
            let tool_mm = model.advance(window, &stretch, &mut problem.sensitivity[knot]);
            let end_s = (stretch.period + 1) as f64 * window.feed_period_s;
            let own = window.at(end_s - lag_s);
            // What leads up to a cut decides where the tool is when it begins.
            let soon = || window.at(end_s - 0.5 * lag_s).cutting || window.at(end_s).cutting;
            let lately = || window.at(end_s - (1.0 + LATELY) * lag_s).cutting;
            let directions = directions(own.tangent);
            let off_mm = sub(tool_mm, own.position_mm);
            problem.ends[knot] = End {
                off_mm: directions.map(|direction| dot(direction, off_mm)),
                directions,
                feed_mm_s: own.feed_mm_s,
                counts: own.cutting || soon() || lately(),
                corner: 0.0,
                turn: 0.0,
                near_turn: 0.0,
                offset_mm: stretch.offset_mm[1],
                offset_mm_s: stretch.offset_mm_s[1],
                tool_mm,
            };
        }
        for (knot, moved_s2) in problem.moved_s2.iter_mut().enumerate().take(knots) {
            *moved_s2 = stretch.moved_s2(knot, 1.0);
        }
        problem.find_turns();
        problem
    }

    /// Finds the points where the path turns back. No part of the path is nearer than the tip
    /// there, and a tool that is late leaves the tip uncut.
    fn find_turns(&mut self) {
        let knots = self.last_knot() + 1;
        let ends = &mut self.ends[..knots];
        for knot in 1..ends.len() {
            let turn = -dot(
                ends[knot - 1].directions[N - 1],
                ends[knot].directions[N - 1],
            );
            let corner = 0.5 * (1.0 + turn);
            ends[knot - 1].corner = ends[knot - 1].corner.max(corner);
            ends[knot].corner = corner;
            ends[knot - 1].turn = ends[knot - 1].turn.max(turn);
            ends[knot].turn = turn.max(0.0);
        }
        let mut near = 0.0_f64;
        for end in ends.iter_mut() {
            near = (NEAR_TURN * near).max(end.turn);
            end.near_turn = near;
        }
        near = 0.0;
        for end in ends.iter_mut().rev() {
            near = (NEAR_TURN * near).max(end.turn);
            end.near_turn = end.near_turn.max(near);
        }
    }

    /// Returns the distance of the tool from its own point in the worst of the knots that count,
    /// mm. The distance along the path counts only near a reversal.
    pub fn need_mm(&self) -> f64 {
        let mut most = 0.0_f64;
        for end in self.ends.iter().take(self.knots).filter(|end| end.counts) {
            let across: f64 = end.off_mm[..N - 1]
                .iter()
                .map(|off_mm| off_mm * off_mm)
                .sum();
            let along_mm = end.near_turn * end.off_mm[N - 1];
            most = most.max(across + along_mm * along_mm);
        }
        libm::sqrt(most)
    }

    /// The largest acceleration of the tool, in parts of what the drive of its axis can.
    pub fn drive_share(&self) -> f64 {
        let mut most = 0.0_f64;
        for knot in 0..self.knots {
            for axis in 0..N {
                let acceleration = self.acceleration_mm_s2(knot, axis).unwrap_or(0.0);
                most = most.max(acceleration.abs() / self.settings.limits.drive_mm_s2[axis]);
            }
        }
        most
    }

    /// Mean square of the contour error over the knots that count, mm^2. Of the first half of the
    /// horizon: the second is still to be planned.
    pub fn contour_mm2(&self) -> f64 {
        let (mut sum, mut number) = (0.0, 0.0);
        for end in self
            .ends
            .iter()
            .take(self.knots.div_ceil(2))
            .filter(|end| end.counts)
        {
            for off_mm in &end.off_mm[..N - 1] {
                sum += off_mm * off_mm;
            }
            number += 1.0;
        }
        if number > 0.0 { sum / number } else { sum }
    }

    /// The last knot of the horizon.
    #[inline]
    fn last_knot(&self) -> usize {
        self.knots.clamp(1, MAX_KNOTS) - 1
    }

    /// Unknowns.
    pub fn unknowns(&self) -> usize {
        (self.last_knot() + 1) * N
    }

    /// Weight of an error at the end of a knot, where it counts: 1 across the path, h along it,
    /// which is the last direction.
    #[inline]
    pub fn error_weight(&self, knot: usize, direction: usize) -> f64 {
        if direction + 1 < N {
            return 1.0;
        }
        let end = &self.ends[knot.min(MAX_KNOTS - 1)];
        let held = (TURN_WEIGHT * end.turn).max(self.settings.late_weight * end.corner);
        self.settings.weight_along(knot, end.feed_mm_s).max(held)
    }

    /// Hands every row and its error to `take`, with the knot that it belongs to: the number of its
    /// entries is `(knot + 1) * N`.
    #[inline]
    pub fn rows(&self, mut take: impl FnMut(usize, f64, &dyn Fn(&mut GradientRow))) {
        for (knot, end) in self.ends.iter().enumerate().take(self.knots) {
            for d in 0..N {
                if end.counts {
                    let weight = self.error_weight(knot, d);
                    let direction = scale(weight, end.directions[d]);
                    take(knot, weight * end.off_mm[d], &|row| {
                        self.tool_row(knot, direction, row);
                    });
                } else {
                    let mut direction = [0.0; N];
                    direction[d] = RAPID_WEIGHT;
                    take(knot, 0.0, &|row| self.tool_row(knot, direction, row));
                }
            }
            self.limit_rows(knot, end, &mut take);
        }
        self.end_rows(&mut take);
    }

    /// The rows of where the offset would come to behind the last knot.
    #[inline]
    fn end_rows(&self, take: &mut impl FnMut(usize, f64, &dyn Fn(&mut GradientRow))) {
        let knot = self.last_knot();
        let end = &self.ends[knot];
        for axis in 0..N {
            let error = END_WEIGHT * (end.offset_mm[axis] + self.lag_s * end.offset_mm_s[axis]);
            take(knot, error, &|row| {
                for (entries, moved_s2) in by_knot::<N>(row, knot).zip(&self.moved_s2) {
                    *entries = only(axis, END_WEIGHT * (moved_s2 + self.lag_s * self.knot_s));
                }
            });
        }
    }

    /// The rows of the limits that the plan is beyond.
    #[inline]
    fn limit_rows(
        &self,
        knot: usize,
        end: &End<N>,
        take: &mut impl FnMut(usize, f64, &dyn Fn(&mut GradientRow)),
    ) {
        let limits = &self.settings.limits;
        let length_mm = norm(end.offset_mm);
        if length_mm > limits.deviation_mm {
            let outward = scale(DEVIATION_WEIGHT / length_mm, end.offset_mm);
            let beyond_mm = DEVIATION_WEIGHT * (length_mm - limits.deviation_mm);
            take(knot, beyond_mm, &|row| self.offset_row(knot, outward, row));
        }
        for axis in 0..N {
            let speed = end.offset_mm_s[axis];
            let beyond = speed - bounded(speed, -limits.speed_mm_s, limits.speed_mm_s);
            if beyond != 0.0 {
                take(knot, SPEED_WEIGHT_S * beyond, &|row| {
                    self.speed_row(knot, axis, row);
                });
            }
            let most = limits.drive_mm_s2[axis];
            let Some(acceleration) = self.acceleration_mm_s2(knot, axis) else {
                continue;
            };
            let beyond = acceleration - bounded(acceleration, -most, most);
            if beyond != 0.0 {
                take(knot, DRIVE_WEIGHT_S2 * beyond, &|row| {
                    self.drive_row(knot, axis, row);
                });
            }
        }
    }

    /// Acceleration of the tool in an axis about the knot before this one, mm/s^2; none at the
    /// first two.
    #[inline]
    fn acceleration_mm_s2(&self, knot: usize, axis: usize) -> Option<f64> {
        let [now, before, first] = [0, 1, 2].map(|back: usize| knot.checked_sub(back));
        let at = |knot: Option<usize>| {
            self.ends
                .get(knot?)
                .and_then(|end| end.tool_mm.get(axis).copied())
        };
        Some((at(now)? - 2.0 * at(before)? + at(first)?) / (self.knot_s * self.knot_s))
    }

    fn tool_row(&self, knot: usize, direction: [f64; N], row: &mut GradientRow) {
        for (entries, sensitivity) in
            by_knot::<N>(row, knot).zip(&self.sensitivity[knot.min(MAX_KNOTS - 1)])
        {
            for axis in 0..N {
                entries[axis] = direction[axis] * sensitivity[axis];
            }
        }
    }

    fn offset_row(&self, knot: usize, direction: [f64; N], row: &mut GradientRow) {
        let shift = self.last_knot().saturating_sub(knot);
        for (entries, moved_s2) in by_knot::<N>(row, knot).zip(&self.moved_s2[shift..]) {
            for axis in 0..N {
                entries[axis] = direction[axis] * moved_s2;
            }
        }
    }

    fn speed_row(&self, knot: usize, axis: usize, row: &mut GradientRow) {
        for entries in by_knot::<N>(row, knot) {
            *entries = only(axis, SPEED_WEIGHT_S * self.knot_s);
        }
    }

    fn drive_row(&self, knot: usize, axis: usize, row: &mut GradientRow) {
        let gain = DRIVE_WEIGHT_S2 / (self.knot_s * self.knot_s);
        for (j, entries) in by_knot::<N>(row, knot).enumerate() {
            let sensitivity = |back: usize| {
                self.sensitivity
                    .get(knot.saturating_sub(back))
                    .and_then(|sensitivity| sensitivity.get(j)?.get(axis))
            };
            let [now, before, first] =
                [0, 1, 2].map(|back| sensitivity(back).copied().unwrap_or(0.0));
            *entries = only(axis, gain * (now - 2.0 * before + first));
        }
    }
}

/// The entries of a row, axis by axis, of each knot up to this one.
#[inline]
fn by_knot<const N: usize>(
    row: &mut GradientRow,
    knot: usize,
) -> impl Iterator<Item = &mut [f64; N]> {
    row.as_chunks_mut().0.iter_mut().take(knot + 1)
}

/// An axis alone.
#[inline]
fn only<const N: usize>(axis: usize, value: f64) -> [f64; N] {
    core::array::from_fn(|i| if i == axis { value } else { 0.0 })
}

/// The normals of a tangent, and last itself: in the plane the left one; in space the one nearest
/// to an axis, and the one across both.
fn directions<const N: usize>(tangent: [f64; N]) -> [[f64; N]; N] {
    let mut directions = [[0.0; N]; N];
    directions[N - 1] = tangent;
    if N == 2 {
        (directions[0][0], directions[0][1]) = (-tangent[1], tangent[0]);
        return directions;
    }
    // The axis that the path runs least along.
    let least = (0..N).fold(0, |best, i| {
        if tangent[i].abs() < tangent[best].abs() {
            i
        } else {
            best
        }
    });
    let mut axis = [0.0; N];
    axis[least] = 1.0;
    let first = reject(axis, tangent);
    let first = scale(1.0 / norm(first).max(f64::MIN_POSITIVE), first);
    directions[0] = first;
    directions[1] = core::array::from_fn(|i| {
        let (j, k) = ((i + 1) % N, (i + 2) % N);
        tangent[j] * first[k] - tangent[k] * first[j]
    });
    directions
}
