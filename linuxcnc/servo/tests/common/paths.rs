//! Paths, the commands along them, and the distance of a tool from them.

use std::f64::consts::TAU;

use crate::common::SERVO_S;

/// Feedrate and acceleration of the programs, mm/s and mm/s2.
pub(crate) const FEED_MM_S: f64 = 50.0;
pub(crate) const ACCELERATION_MM_S2: f64 = 2000.0;
/// Servo periods of rest before and after a program.
pub(crate) const REST: usize = 300;
/// Points of a path.
const POINTS: usize = 4000;

/// Returns the points of a curve whose parameter goes from 0 to 1.
fn curve(at: impl Fn(f64) -> [f64; 2]) -> Vec<[f64; 2]> {
    (0..=POINTS).map(|k| at(k as f64 / POINTS as f64)).collect()
}

pub(crate) fn circle() -> Vec<[f64; 2]> {
    curve(|t| [10.0 - 10.0 * (TAU * t).cos(), 10.0 * (TAU * t).sin()])
}

pub(crate) fn eight() -> Vec<[f64; 2]> {
    curve(|t| [20.0 * (TAU * t).sin(), 10.0 * (2.0 * TAU * t).sin()])
}

pub(crate) fn star() -> Vec<[f64; 2]> {
    curve(|t| {
        let radius = 12.0 + 4.0 * (5.0 * TAU * t).cos();
        [radius * (TAU * t).cos() - 16.0, radius * (TAU * t).sin()]
    })
}

/// Returns points along the sides of a square.
pub(crate) fn square() -> Vec<[f64; 2]> {
    curve(|t| match 4.0 * t {
        way if way < 1.0 => [20.0 * way, 0.0],
        way if way < 2.0 => [20.0, 20.0 * (way - 1.0)],
        way if way < 3.0 => [20.0 * (3.0 - way), 20.0],
        way => [0.0, 20.0 * (4.0 - way)],
    })
}

/// Returns the commands of a program that stops `times` times along points at equal distances, with
/// rest before and after.
pub(crate) fn stopping(points: &[[f64; 2]], times: usize) -> Vec<[f64; 2]> {
    let pieces = points
        .windows(points.len() / times + 1)
        .step_by(points.len() / times);
    let mut commands = vec![points[0]; REST];
    pieces.for_each(|piece| {
        let way = self::commands(piece);
        commands.extend(&way[REST..way.len() - REST]);
    });
    commands.extend(vec![points[points.len() - 1]; REST]);
    commands
}

/// Returns the lengths along points, mm.
fn lengths(points: &[[f64; 2]]) -> Vec<f64> {
    let mut length_mm = 0.0;
    let step = |pair: &[[f64; 2]]| {
        length_mm += distance(pair[0], pair[1]);
        length_mm
    };
    std::iter::once(0.0)
        .chain(points.windows(2).map(step))
        .collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// Returns the distance traveled from rest to rest at the feedrate, after `t_s`, mm.
pub(crate) fn way_mm(t_s: f64, length_mm: f64) -> f64 {
    let (ramp_s, whole_s) = (
        FEED_MM_S / ACCELERATION_MM_S2,
        length_mm / FEED_MM_S + FEED_MM_S / ACCELERATION_MM_S2,
    );
    let t_s = t_s.clamp(0.0, whole_s);
    if t_s < ramp_s {
        0.5 * ACCELERATION_MM_S2 * t_s * t_s
    } else if t_s > whole_s - ramp_s {
        length_mm - 0.5 * ACCELERATION_MM_S2 * (whole_s - t_s).powi(2)
    } else {
        FEED_MM_S * (t_s - 0.5 * ramp_s)
    }
}

/// Returns the commands of a program along points, with rest before and after.
pub(crate) fn commands(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let lengths = lengths(points);
    let whole_mm = lengths[lengths.len() - 1];
    let periods =
        ((whole_mm / FEED_MM_S + FEED_MM_S / ACCELERATION_MM_S2) / SERVO_S).ceil() as usize;
    let at = |n: usize| {
        let way_mm = way_mm((n as f64 - REST as f64) * SERVO_S, whole_mm);
        let k = lengths
            .partition_point(|length| *length <= way_mm)
            .clamp(1, points.len() - 1);
        let part = (way_mm - lengths[k - 1]) / (lengths[k] - lengths[k - 1]);
        std::array::from_fn(|i| points[k - 1][i] + part * (points[k][i] - points[k - 1][i]))
    };
    (0..periods + 2 * REST).map(at).collect()
}

/// Returns the distance of a tool from the path, mm, near the point that was nearest before.
pub(crate) fn error_mm(points: &[[f64; 2]], near: &mut usize, tool_mm: [f64; 2]) -> f64 {
    let about = near.saturating_sub(20)..(*near + 40).min(points.len());
    *near = about
        .min_by(|a, b| distance(points[*a], tool_mm).total_cmp(&distance(points[*b], tool_mm)))
        .unwrap_or(0);
    let pieces = near.saturating_sub(1)..(*near + 1).min(points.len() - 1);
    pieces
        .map(|k| to_piece_mm(points[k], points[k + 1], tool_mm))
        .fold(f64::INFINITY, f64::min)
}

fn to_piece_mm(a: [f64; 2], b: [f64; 2], p: [f64; 2]) -> f64 {
    let (d, square) = ([b[0] - a[0], b[1] - a[1]], distance(a, b).powi(2));
    let t = (((p[0] - a[0]) * d[0] + (p[1] - a[1]) * d[1]) / square).clamp(0.0, 1.0);
    distance([a[0] + t * d[0], a[1] + t * d[1]], p)
}
