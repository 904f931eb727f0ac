//! A better command from the errors of a simulated cut.
//!
//! With `e` from the tool to its foot on the path, and the [lags](super::loop_lag) of the axes, the
//! command becomes
//!
//! ```text
//! c + e + T1 e' + T2 e'',
//! ```
//!
//! which the loop turns into a tool position that is moved by `e`. A Gaussian smooths `e` first: a
//! command that shakes is slow on the target control and strains the machine. At the ends of a
//! stretch the change fades out, so that the stretch starts and ends where the program says.

use std::ops::Range;

use feedwright_plan::FitPoint;
use feedwright_plan::vector::{Vector, add_scaled, distance, norm, smoothed, sub};

use super::exported::CutRow;
use super::loop_lag::LoopLag;
use super::slow_end::SlowEnd;
use super::stretches::SmoothStretch;

/// Settings of the smoothing and limits of a new command.
#[derive(Debug, Clone, Copy)]
pub(super) struct UpdateSettings {
    /// Standard deviation of the Gaussian over errors, s.
    pub(super) smoothing_s: f64,
    /// Standard deviation of the Gaussian over the command, s.
    pub(super) command_smoothing_s: f64,
    /// Time over which a change fades in and out at the ends of a stretch, s.
    pub(super) fade_s: f64,
    /// Points closer to the previous one than this are left out, mm.
    pub(super) least_mm: f64,
    /// Largest distance of the command from the path, mm.
    pub(super) most_mm: f64,
    /// Servo period, s.
    pub(super) servo_s: f64,
}

/// Smooths a sequence between two ends that stay where they are: beyond them it is mirrored at the
/// end.
fn pinned_smooth(values: &[Vector], ends_mm: [Vector; 2], sigma: f64) -> Vec<Vector> {
    let reach = (3.0 * sigma).ceil() as usize;
    let mirrored = |value: &Vector, end: Vector| std::array::from_fn(|i| 2.0 * end[i] - value[i]);
    let mut long: Vec<Vector> = values
        .iter()
        .take(reach)
        .rev()
        .map(|v| mirrored(v, ends_mm[0]))
        .collect();
    let lead = long.len();
    long.extend(values);
    long.extend(
        values
            .iter()
            .rev()
            .take(reach)
            .map(|v| mirrored(v, ends_mm[1])),
    );
    let once = smoothed(&long, sigma);
    let left: Vec<Vector> = long
        .iter()
        .zip(&once)
        .map(|(value, smooth)| sub(*value, *smooth))
        .collect();
    let more = smoothed(&left, sigma);
    (lead..lead + values.len())
        .map(|n| std::array::from_fn(|i| once[n][i] + more[n][i]))
        .collect()
}

/// The change of the command in the servo periods of a range, from the errors of the cut around it.
fn changes(
    rows: &[CutRow],
    range: Range<usize>,
    lags: &[LoopLag],
    settings: &UpdateSettings,
) -> Vec<Vector> {
    let sigma = settings.smoothing_s / settings.servo_s;
    let margin = (3.0 * sigma).ceil() as usize + 1;
    let from = range.start.saturating_sub(margin);
    let to = (range.end + margin).min(rows.len());
    let errors: Vec<Vector> = rows[from..to].iter().map(|row| row.error_mm).collect();
    let errors = smoothed(&errors, sigma);
    let last = errors.len().saturating_sub(1);
    let change = |n: usize| -> Vector {
        let (before, here, next) = (
            errors[n.saturating_sub(1)],
            errors[n],
            errors[(n + 1).min(last)],
        );
        std::array::from_fn(|i| {
            let Some(lag) = lags.get(i) else { return 0.0 };
            let first = (next[i] - before[i]) / (2.0 * settings.servo_s);
            let second =
                (next[i] - 2.0 * here[i] + before[i]) / (settings.servo_s * settings.servo_s);
            here[i] + lag.first_s * first + lag.second_s2 * second
        })
    };
    range.map(|n| change(n - from)).collect()
}

/// The points of a new command for a stretch that was commanded in the rows of `range`, from one
/// end of the stretch to the other, along the axes of the stretch's plane; none where the command
/// would leave the path by more than it may.
pub(super) fn new_command(
    rows: &[CutRow],
    range: Range<usize>,
    lags: &[LoopLag],
    stretch: &SmoothStretch,
    settings: &UpdateSettings,
    slow_end: Option<SlowEnd>,
) -> Option<Vec<FitPoint>> {
    let changes = changes(rows, range.clone(), lags, settings);
    let rows = &rows[range];
    let (first, last) = (rows.first()?, rows.last()?);
    let fade = |t_s: f64| {
        let part = (t_s / settings.fade_s).clamp(0.0, 1.0);
        part * part * (3.0 - 2.0 * part)
    };
    let wanted: Vec<Vector> = rows
        .iter()
        .zip(&changes)
        .map(|(row, change)| {
            let share = fade(row.t_s - first.t_s).min(fade(last.t_s - row.t_s));
            add_scaled(row.cmd_mm, share, *change)
        })
        .collect();
    let ends_mm = [stretch.start_mm(), stretch.end_mm()];
    let wanted = pinned_smooth(
        &wanted,
        ends_mm,
        settings.command_smoothing_s / settings.servo_s,
    );
    let leaves =
        |(at_mm, row): (&Vector, &CutRow)| distance(*at_mm, row.path_mm) > settings.most_mm;
    if wanted.iter().zip(rows).any(leaves) {
        return None;
    }
    let mut points = thinned(&wanted, rows, stretch, settings.least_mm);
    if let Some(slow) = slow_end {
        slow.slow_down(&mut points);
    }
    Some(points)
}

/// Points that are not too near to each other, with their tangents.
fn thinned(
    wanted: &[Vector],
    rows: &[CutRow],
    stretch: &SmoothStretch,
    least_mm: f64,
) -> Vec<FitPoint> {
    let axes = stretch.plane().axes();
    let along = |place: Vector| axes.map(|axis| place[axis]);
    let [start_mm, end_mm] = [stretch.start_mm(), stretch.end_mm()].map(along);
    let point = |at_mm: Vector, feed_mm_s: f64| FitPoint {
        at_mm,
        tangent: [0.0; 2],
        feed_mm_s,
    };
    let mut points = vec![point(start_mm, stretch.motions[0].feed_mm_s)];
    let half = wanted.len() / 2;
    for (n, (at_mm, row)) in wanted
        .iter()
        .map(|at_mm| along(*at_mm))
        .zip(rows)
        .enumerate()
    {
        let near = |other: Vector| distance(other, at_mm) < least_mm;
        if near(points[points.len() - 1].at_mm) || n > half && near(end_mm) {
            continue;
        }
        points.push(point(at_mm, row.feed_mm_s));
    }
    points.push(point(
        end_mm,
        stretch.motions[stretch.motions.len() - 1].feed_mm_s,
    ));
    set_tangents(&mut points, stretch.directions().map(along));
    points
}

/// Tangents by the neighbours of each point; at the ends those of the program.
fn set_tangents(points: &mut [FitPoint], directions: [Vector; 2]) {
    let last = points.len() - 1;
    for n in 0..=last {
        let way = if n == 0 {
            directions[0]
        } else if n == last {
            directions[1]
        } else {
            tangent_of(points[n - 1].at_mm, points[n].at_mm, points[n + 1].at_mm)
        };
        let flat = norm([way[0], way[1]]);
        let is_flat = flat > 1e-3 * norm(way);
        points[n].tangent = if is_flat {
            [way[0] / flat, way[1] / flat]
        } else {
            [0.0; 2]
        };
    }
}

/// Direction in the middle of three points, by the parabola through them over their distances.
fn tangent_of(before: Vector, here: Vector, next: Vector) -> Vector {
    let (arriving, leaving) = (sub(here, before), sub(next, here));
    let (a, b) = (norm(arriving).max(1e-12), norm(leaving).max(1e-12));
    std::array::from_fn(|i| (arriving[i] / a * b + leaving[i] / b * a) / (a + b))
}
