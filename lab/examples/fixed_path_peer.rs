//! Speed alone on a fixed path, beside `time-optimal`, which may leave the path within a tolerance:
//! the second table of `just bench-plan`.
//!
//!     cargo run --release -p feedwright-lab --features copp --example fixed_path_peer [CONTOUR...]
//!
//! The peer is `copp` (Wang and others, MIT): TOPP3-SOCP, linearised about TOPP2-RA first, then
//! about its own last solution, the best of three such rounds on 1001 stations that are evenly
//! apart. It has contours of one smooth curve only: a corner or a joint has no derivatives. Each
//! axis has 200 mm/s, 2000 mm/s2 and 50,000 mm/s3. `jerk` is the largest of the third differences
//! of its motion every millisecond, as a part of the limit.

use std::time::Instant;

use copp::InterpolationMode;
use copp::path::{Jet3, Path};
use copp::robot::Robot;
use copp::solver::topp2_ra::{ReachSet2OptionsBuilder, Topp2ProblemBuilder, topp2_ra};
use copp::solver::topp3_socp::{
    ClarabelOptionsBuilder, Topp3ProblemBuilder, s_to_t_topp3, t_to_s_topp3, topp3_socp,
};
use feedwright::cycle_time_within;
use feedwright_lab::{AXIS_LIMITS as LIMITS, CORNER, contour, limited_machine};
use feedwright_plan::{Constraints, Curve, Step, Steps};

/// Contours of one smooth curve. Of the butterfly, with its tips between stations, the peer makes a
/// motion that leaps there.
const CONTOURS: [&str; 4] = ["circle", "ellipse", "eight", "star"];

const STATIONS: usize = 1001;
const ROUNDS: u32 = 3;

/// Least square of the speed that it is linearised about, (mm/s)^2: rounding makes some of its
/// squares negative.
const LEAST_SQUARE: f64 = 1e-6;

/// Axes that move.
const AXES: usize = 2;

/// Path tolerances of `time-optimal`, um: 1 um leaves next to no room; the first table uses 10 um.
const TOLERANCES_UM: [f64; 2] = [1.0, 10.0];

/// Distance of the samples of the peer's motion, s.
const SAMPLE_S: f64 = 1e-3;

type Failure = Box<dyn std::error::Error>;

/// Result of the peer.
struct PeerPlan {
    time_s: f64,
    /// Largest jerk as a part of its limit.
    jerk: f64,
    took_s: f64,
}

fn main() -> Result<(), Failure> {
    let mut names: Vec<String> = std::env::args().skip(1).collect();
    if names.is_empty() {
        names = CONTOURS.map(str::to_owned).to_vec();
    }
    println!(
        "| Contour | copp s | jerk | took s | within 1 um s | took s | within 10 um s | took s | / copp |"
    );
    println!("|---|{}", "--:|".repeat(8));
    for name in &names {
        let peer = peer(&curve_of(name)?)?;
        let [near, far] = [ours(name, TOLERANCES_UM[0])?, ours(name, TOLERANCES_UM[1])?];
        let ratio = far.0 / peer.time_s;
        println!(
            "| {name} | {:.4} | {:.3} | {:.3} | {:.4} | {:.3} | {:.4} | {:.3} | {ratio:.3} |",
            peer.time_s, peer.jerk, peer.took_s, near.0, near.1, far.0, far.1
        );
    }
    Ok(())
}

/// Time and what it took to plan, s.
fn ours(name: &str, tolerance_um: f64) -> Result<(f64, f64), Failure> {
    let machine = limited_machine(tolerance_um);
    let steps = contour_steps(name)?;
    let begun = Instant::now();
    let all = || Ok(Box::new(steps.iter().cloned().map(Ok)) as Steps<'_>);
    let found = cycle_time_within(&machine, &Constraints::from(&machine), false, all, &())?;
    Ok((found.cutting_s, begun.elapsed().as_secs_f64()))
}

fn contour_steps(name: &str) -> Result<Vec<Step>, Failure> {
    let contour = contour(name).ok_or_else(|| format!("there is no contour {name}"))?;
    Ok(contour.steps(LIMITS[0], CORNER)?)
}

fn curve_of(name: &str) -> Result<Curve, Failure> {
    let steps = contour_steps(name)?.into_iter();
    let mut curves = steps.filter_map(|step| match step {
        Step::Piece(piece) => Some(piece.curve),
        _ => None,
    });
    match (curves.next(), curves.next()) {
        (Some(curve), None) => Ok(curve),
        _ => Err(format!("{name} is not one smooth curve").into()),
    }
}

/// The peer's plan of a curve from rest to rest.
fn peer(curve: &Curve) -> Result<PeerPlan, Failure> {
    let length_mm = curve.length_mm();
    let begun = Instant::now();
    let (on_path, stations_mm) = (curve.clone(), stations(length_mm));
    let path = Path::from_parametric(move |s| axes_at(&on_path, s), 0.0, length_mm)?;
    let mut robot = Robot::with_capacity(AXES, STATIONS);
    let [velocity, accel, jerk] = LIMITS.map(|limit| ([limit; AXES], [-limit; AXES]));
    robot
        .with_s(stations_mm.as_slice())?
        .with_q_from_path_3rd(&path, 0, STATIONS)?
        .with_axial_velocity((&velocity.0[..], STATIONS), (&velocity.1[..], STATIONS), 0)?
        .with_axial_acceleration((&accel.0[..], STATIONS), (&accel.1[..], STATIONS), 0)?
        .with_axial_jerk((&jerk.0[..], STATIONS), (&jerk.1[..], STATIONS), 0)?;
    let mut about = {
        let problem = Topp2ProblemBuilder::new(&robot, (0, STATIONS - 1), (0.0, 0.0)).build()?;
        topp2_ra(&problem, &ReachSet2OptionsBuilder::new().build()?)?
    };
    robot.constraints.amax_substitute(&about, 0)?;
    about = between_rests(&about);
    let options = ClarabelOptionsBuilder::new()
        .allow_almost_solved(true)
        .build()?;
    let mut best: Option<(f64, Vec<f64>)> = None;
    for _ in 0..ROUNDS {
        let problem = Topp3ProblemBuilder::new(&mut robot, 0, &about, (0.0, 0.0), (0.0, 0.0))
            .build_with_linearization()?;
        let profile = topp3_socp(&problem, &options)?;
        let (time_s, times_s) = s_to_t_topp3(&stations_mm, profile.as_parts(), 0.0)?;
        if best.as_ref().is_none_or(|(best_s, _)| time_s < *best_s) {
            let grid = InterpolationMode::UniformTimeGrid(0.0, SAMPLE_S, true);
            best = Some((
                time_s,
                t_to_s_topp3(&stations_mm, profile.as_parts(), &times_s, grid)?,
            ));
        }
        about = between_rests(&profile.a);
    }
    let took_s = begun.elapsed().as_secs_f64();
    let (time_s, places_mm) = best.ok_or("no round came to a solution")?;
    Ok(PeerPlan {
        time_s,
        jerk: largest_jerk(curve, &places_mm) / LIMITS[2],
        took_s,
    })
}

/// Squares of speeds to linearise about: at rest at the ends alone.
fn between_rests(squares: &[f64]) -> Vec<f64> {
    let last = squares.len() - 1;
    let least = |(i, a): (usize, &f64)| match i {
        _ if i == 0 || i == last => a.max(0.0),
        _ => a.max(LEAST_SQUARE),
    };
    squares.iter().enumerate().map(least).collect()
}

fn stations(length_mm: f64) -> Vec<f64> {
    let at = |i: usize| length_mm * i as f64 / (STATIONS - 1) as f64;
    (0..STATIONS).map(at).collect()
}

/// Each axis and its derivatives by arc length.
fn axes_at(curve: &Curve, s: Jet3) -> Vec<Jet3> {
    let (point, by_way) = (curve.at(s.v), curve.derivatives(s.v));
    let axis = |k: usize| Jet3 {
        v: point.position_mm[k],
        d1: by_way.first[k],
        d2: by_way.second_1_mm[k],
        d3: by_way.third_1_mm2[k],
    };
    (0..AXES).map(axis).collect()
}

/// Largest third difference of an axis, mm/s3; the last samples are not evenly apart.
fn largest_jerk(curve: &Curve, places_mm: &[f64]) -> f64 {
    let points: Vec<_> = places_mm
        .iter()
        .map(|&s_mm| curve.at(s_mm).position_mm)
        .collect();
    let mut largest = 0.0_f64;
    for p in points[..points.len().saturating_sub(1)].windows(4) {
        for k in 0..AXES {
            let third = p[3][k] - 3.0 * p[2][k] + 3.0 * p[1][k] - p[0][k];
            largest = largest.max(third.abs() / SAMPLE_S.powi(3));
        }
    }
    largest
}
