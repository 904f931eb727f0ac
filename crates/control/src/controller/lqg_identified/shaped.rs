//! The reference, smoothed where its ideal command needs more acceleration than the axes have.
//!
//! ```text
//! s = sum_j h_j r(k + j)      h = g - v/2 (g(j+1) - 2 g(j) + g(j-1)),   g: a box of L periods, four times over itself, with variance v
//! kp o + (kd + fv) (o - o1) / Ts + A (o - 2 o1 + o2) = (J / Kv) s'' + s' - fv (s - s1) / Ts - A (s - 2 s1 + s2)
//! ```
//!
//! A jump of the speed or of the acceleration of the reference r takes a command s + o that no drive
//! can follow. h removes what is faster than L periods, and leaves every cubic as it is: a curve
//! loses only its fourth derivative, and a straight line stays where it is, because all axes have
//! the same h. The smallest L whose command s + o stays within the acceleration of every axis is
//! used, as far around the jump as its kernel reaches. Where nothing jumps the reference is not
//! changed.
//!
//! If too little of the reference ahead is known for that choice, the longest kernel that fits is
//! used throughout.
//!
//! Source: Kaiser and Hamming (1977), "Sharpening the response of a symmetric nonrecursive filter by
//! multiple use of the same filter", for the flat kernel; the choice of its length is our own.

use crate::axis::AxisModel;
use crate::vector::{add_scaled, scale, sub};
use crate::window::Window;

use super::command_weight::CommandModel;

/// Lengths L of the boxes, servo periods.
const LENGTHS: [usize; 5] = [1, 3, 5, 9, 15];
const LEVELS: usize = LENGTHS.len();
/// Largest half width of a kernel, servo periods.
const MOST_HALF: usize = half(LENGTHS[LEVELS - 1]);
/// Part of the acceleration of an axis that its ideal command takes; the rest is the regulator's.
const SHARE: f64 = 0.85;
/// Acceleration up to which a shorter kernel is as good as a longer one, times the longer one's.
const NO_BETTER: f64 = 1.05;
/// Reach of the differences in an ideal command, servo periods.
const DIFFERENCES: usize = 2;
/// Servo periods between the last point of the reference and the last point of the result.
pub(super) const BEHIND: usize = 2 * (MOST_HALF + DIFFERENCES);
/// Number of points that are kept: as many as the preview has.
const KEPT: usize = 512;
/// Number of points that a kernel of each length is computed for before one is chosen.
const OPEN: usize = 128;

/// Half width of the kernel of a box length.
const fn half(length: usize) -> usize {
    if length == 1 { 0 } else { 2 * length - 1 }
}

/// Longest half width of a kernel, s. At a servo period of 10 ms a longer one rounds the corners of a
/// square off more than the drives do.
const LONGEST_S: f64 = 0.03;

/// Returns a box length, or the longest one whose kernel is short enough.
fn within(length: usize, servo_s: f64) -> usize {
    let is_within = |length: &usize| half(*length) as f64 * servo_s <= LONGEST_S;
    let lengths = LENGTHS.into_iter().filter(is_within);
    lengths.fold(1, usize::max).min(length)
}

/// A kernel: weights from its center on.
#[derive(Debug, Clone, Copy)]
struct Kernel {
    weights: [f64; MOST_HALF + 1],
    half: usize,
}

impl Kernel {
    fn new(length: usize) -> Self {
        let mut of_boxes = [0.0; 2 * MOST_HALF + 3];
        let center = MOST_HALF + 1;
        of_boxes[center] = 1.0;
        let reach = (length - 1) / 2;
        for _ in 0..4 {
            let before = of_boxes;
            for (i, to) in of_boxes.iter_mut().enumerate() {
                let within = i.saturating_sub(reach)..(i + reach + 1).min(before.len());
                *to = before.get(within).map_or(0.0, |part| part.iter().sum()) / length as f64;
            }
        }
        let variance = (length * length - 1) as f64 / 3.0;
        let bend = |n: usize| {
            of_boxes[center + n + 1] - 2.0 * of_boxes[center + n] + of_boxes[center + n - 1]
        };
        Self {
            weights: core::array::from_fn(|n| of_boxes[center + n] - 0.5 * variance * bend(n)),
            half: half(length),
        }
    }

    /// Returns the smoothed point of a sequence.
    fn at<const N: usize>(&self, point: u64, of: impl Fn(u64) -> [f64; N]) -> [f64; N] {
        let [center, ..] = self.weights;
        let mut sum_mm = scale(center, of(point));
        for (n, weight) in self.weights.iter().enumerate().skip(1).take(self.half) {
            let n = n as u64;
            sum_mm = add_scaled(sum_mm, *weight, of(point.saturating_sub(n)));
            sum_mm = add_scaled(sum_mm, *weight, of(point + n));
        }
        sum_mm
    }
}

/// Coefficients of an axis in its ideal command.
#[derive(Debug, Clone, Copy)]
struct IdealCommand {
    command_model: CommandModel,
    /// Factors on s(k+1), s, s1 and s2.
    of_points: [f64; 4],
    servo_s: f64,
}

impl IdealCommand {
    fn new(axis_model: &AxisModel) -> Self {
        let (parameters, servo_s) = (&axis_model.parameters, axis_model.periods.servo_s);
        let command_model = CommandModel::new(axis_model);
        let by_change = command_model.by_change_1_s();
        let forward = parameters.velocity_feedforward / servo_s;
        let torque_s = parameters.inertia_kg_m2 / parameters.kv_nm_s_per_rad;
        let (speed, torque) = (1.0 / servo_s, torque_s / (servo_s * servo_s));
        Self {
            command_model,
            of_points: [
                speed + torque,
                -speed - 2.0 * torque - forward - by_change,
                torque + forward + 2.0 * by_change,
                -by_change,
            ],
            servo_s,
        }
    }

    /// Returns o of the points after the leads o1 and o2.
    fn lead(&self, points: [f64; 4], last: [f64; 2]) -> f64 {
        let needed: f64 = self.of_points.iter().zip(points).map(|(k, s)| k * s).sum();
        self.command_model.solved(needed, last)
    }
}

/// The smoothed reference.
#[derive(Debug, Clone)]
pub(super) struct Shaped<const N: usize> {
    kernels: [Kernel; LEVELS],
    ideal: [IdealCommand; N],
    /// The reference by each kernel, and the leads and the acceleration of its ideal command.
    open_mm: [[[f64; N]; OPEN]; LEVELS],
    leads_mm: [[[f64; 2]; N]; LEVELS],
    last_mm_s2: [[f64; N]; LEVELS],
    /// The kernel of each point that is due, by its place in [`LENGTHS`].
    levels: [u8; OPEN],
    points_mm: [[f64; N]; KEPT],
    /// Next point of the reference by each kernel, and next point of the result. The result begins
    /// at `first`.
    next_open: u64,
    next: u64,
    first: Option<u64>,
}

impl<const N: usize> Shaped<N> {
    /// Creates the smoothing for axes with these models.
    pub(super) fn new(axis_models: [AxisModel; N]) -> Self {
        let servo_s = axis_models.first().map_or(0.0, |axis| axis.periods.servo_s);
        Self {
            kernels: LENGTHS.map(|length| Kernel::new(within(length, servo_s))),
            ideal: axis_models.each_ref().map(IdealCommand::new),
            open_mm: [[[0.0; N]; OPEN]; LEVELS],
            leads_mm: [[[0.0; 2]; N]; LEVELS],
            last_mm_s2: [[0.0; N]; LEVELS],
            levels: [0; OPEN],
            points_mm: [[0.0; N]; KEPT],
            next_open: 0,
            next: 0,
            first: None,
        }
    }

    /// Begins anew with the next reference.
    pub(super) fn forget(&mut self) {
        self.first = None;
    }

    /// Takes in the reference as far as it is known. The ideal command of each axis may accelerate
    /// by `limit_mm_s2`; `needed_s` is the time from now up to which the result is needed.
    pub(super) fn take_in(&mut self, window: &Window<'_, N>, limit_mm_s2: f64, needed_s: f64) {
        if limit_mm_s2 == f64::INFINITY {
            self.first = None;
            return;
        }
        let (now, _) = window.preview.place(window.tau_s);
        let [_, ahead] = window.range();
        let known = now + u64::from(ahead.unsigned_abs());
        let (needed, _) = window.preview.place(window.tau_s + needed_s);
        let reference = |point: u64| window.preview.grid(point).position_mm;
        if self.first.is_none() || self.next > known + 1 || self.next + KEPT as u64 <= known {
            let first = now.saturating_sub(DIFFERENCES as u64);
            self.first = Some(first);
            (self.next, self.next_open) = (first, first);
            self.levels = [0; OPEN];
            self.leads_mm = [[[0.0; 2]; N]; LEVELS];
            self.last_mm_s2 = [[0.0; N]; LEVELS];
        }
        if needed + BEHIND as u64 > known {
            let room = known.saturating_sub(needed) as usize;
            let fitting = self.kernels.iter().rposition(|kernel| kernel.half <= room);
            let kernel = self.kernels[fitting.unwrap_or(0)];
            while self.next + kernel.half as u64 <= known {
                self.points_mm[(self.next % KEPT as u64) as usize] =
                    kernel.at(self.next, reference);
                self.next += 1;
            }
            self.next_open = self.next;
            return;
        }
        while self.next_open + MOST_HALF as u64 <= known {
            for (open_mm, kernel) in self.open_mm.iter_mut().zip(&self.kernels) {
                open_mm[(self.next_open % OPEN as u64) as usize] =
                    kernel.at(self.next_open, reference);
            }
            let first = self.first.unwrap_or(0);
            if self.next_open >= first + 2 * DIFFERENCES as u64 {
                self.choose(self.next_open - DIFFERENCES as u64, limit_mm_s2);
            }
            self.next_open += 1;
            let chosen = self
                .next_open
                .saturating_sub((MOST_HALF + 2 * DIFFERENCES) as u64);
            while self.next < chosen {
                let level = core::mem::take(&mut self.levels[(self.next % OPEN as u64) as usize]);
                self.points_mm[(self.next % KEPT as u64) as usize] =
                    self.open(usize::from(level), self.next);
                self.next += 1;
            }
        }
    }

    /// Chooses the kernel for a point, and as far around it as this kernel reaches.
    fn choose(&mut self, point: u64, limit_mm_s2: f64) {
        let takes_mm_s2: [f64; LEVELS] =
            core::array::from_fn(|level| self.takes_mm_s2(level, point));
        let least_mm_s2 = takes_mm_s2.into_iter().fold(f64::INFINITY, f64::min);
        let enough_mm_s2 = (SHARE * limit_mm_s2).max(NO_BETTER * least_mm_s2);
        let level = takes_mm_s2
            .iter()
            .position(|takes_mm_s2| *takes_mm_s2 <= enough_mm_s2)
            .unwrap_or(0);
        let reach = (self.kernels[level].half + DIFFERENCES) as u64;
        for near in point.saturating_sub(reach).max(self.next)..=point + reach {
            let kept = &mut self.levels[(near % OPEN as u64) as usize];
            *kept = (*kept).max(level as u8);
        }
    }

    /// Returns the largest acceleration of an axis in the ideal command of a kernel, or the largest
    /// change of it within a servo period, mm/s2.
    fn takes_mm_s2(&mut self, level: usize, point: u64) -> f64 {
        let around_mm = [
            point + 1,
            point,
            point.saturating_sub(1),
            point.saturating_sub(2),
        ]
        .map(|near| self.open(level, near));
        let mut most_mm_s2 = 0.0_f64;
        for (axis, ideal) in self.ideal.iter().enumerate() {
            let points = around_mm.map(|at_mm| at_mm[axis]);
            let [_, here, last, before] = points;
            let leads = &mut self.leads_mm[level][axis];
            let [lead_last, lead_before] = *leads;
            let lead = ideal.lead(points, *leads);
            *leads = [lead, lead_last];
            let change = (here - 2.0 * last + before) + (lead - 2.0 * lead_last + lead_before);
            let mm_s2 = change / (ideal.servo_s * ideal.servo_s);
            let last_mm_s2 = core::mem::replace(&mut self.last_mm_s2[level][axis], mm_s2);
            most_mm_s2 = most_mm_s2.max(mm_s2.abs()).max((mm_s2 - last_mm_s2).abs());
        }
        most_mm_s2
    }

    fn open(&self, level: usize, point: u64) -> [f64; N] {
        self.open_mm[level.min(LEVELS - 1)][(point % OPEN as u64) as usize]
    }

    /// Returns the smoothed point of the grid, or the reference where it is not smoothed.
    fn point_mm(&self, window: &Window<'_, N>, point: u64) -> [f64; N] {
        let is_kept = self.first.is_some_and(|first| point >= first)
            && point < self.next
            && point + KEPT as u64 > self.next;
        if is_kept {
            self.points_mm[(point % KEPT as u64) as usize]
        } else {
            window.preview.grid(point).position_mm
        }
    }

    /// Returns the smoothed reference `ahead_s` from now, mm: a cubic between the points of the
    /// grid.
    pub(super) fn at_mm(&self, window: &Window<'_, N>, ahead_s: f64) -> [f64; N] {
        let (point, part) = window.preview.place(window.tau_s + ahead_s);
        if point < self.first.unwrap_or(u64::MAX) || point >= self.next {
            return window.at(ahead_s).position_mm;
        }
        let there_mm = self.point_mm(window, point);
        if part == 0.0 {
            return there_mm;
        }
        let [before_mm, after_mm, beyond_mm] =
            [point.saturating_sub(1), point + 1, point + 2].map(|near| self.point_mm(window, near));
        let [from_mm, to_mm] = [
            scale(0.5, sub(after_mm, before_mm)),
            scale(0.5, sub(beyond_mm, there_mm)),
        ];
        let rest = 1.0 - part;
        let straight_mm = add_scaled(
            there_mm,
            part * part * (1.0 + 2.0 * rest),
            sub(after_mm, there_mm),
        );
        let bent_mm = add_scaled(straight_mm, part * rest * rest, from_mm);
        add_scaled(bent_mm, -part * part * rest, to_mm)
    }
}
