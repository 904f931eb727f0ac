//! The full circles of a program, and the roundness of each as cut, as in a circular test (ISO
//! 230-4).
//!
//! ```text
//! F(theta) = (tool - foot) . u        radial deviation, u the outward unit vector of the circle at the foot, theta its angle
//! Fmax, Fmin                          its largest and its least value
//! G = max - min of F - b cos(theta) - c sin(theta)      circular deviation, about the least-squares circle
//! ```
//!
//! A circular test leaves out the parts where the axes start and stop. Here the whole circle
//! counts, with its beginning and its end.

use std::f64::consts::TAU;
use std::io;

use feedwright_plan::vector::{distance, dot, norm, sub};
use feedwright_plan::{Curve, Piece, Step};
use feedwright_sim::{Row, Sink};
use serde::Serialize;

/// Largest number of circles that are kept, the longest of a program: a page shows no more.
const MOST_CIRCLES: usize = 12;
/// Arcs whose centres and radii differ by less belong to one circle, mm: programs round them.
const SAME_MM: f64 = 0.005;
/// Largest angle by which a full turn may be incomplete, rad.
const OPEN_RAD: f64 = 1e-6;
/// Largest lag of a tool behind its command, mm.
const LAG_MM: f64 = 10.0;
/// Number of parts of a turn in which a circle is recorded.
pub(super) const BINS: usize = 720;

/// A full circle of the program, of one arc or of several.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FullCircle {
    /// Line at which it begins.
    pub line: u32,
    /// Centre, mm.
    pub center_mm: [f64; 3],
    /// Radius, mm.
    pub radius_mm: f64,
    /// Its plane by the axes that span it, as in "XY".
    pub plane: &'static str,
    /// True where it turns counter-clockwise, seen from the positive normal of the plane.
    pub counter_clockwise: bool,
    /// Arc length of the path where it begins and ends, mm.
    pub s_mm: [f64; 2],
}

impl FullCircle {
    /// Returns the indices of the axes of its plane: the angle counts from the first towards the
    /// second.
    fn axes(&self) -> [usize; 2] {
        match self.plane {
            "XY" => [0, 1],
            "ZX" => [2, 0],
            _ => [1, 2],
        }
    }

    fn starting_with(piece: &Piece, arc: &feedwright_plan::Arc) -> Self {
        let axis = arc.axis();
        let planes = ["YZ", "ZX", "XY"];
        let normal = (0..3)
            .max_by(|&a, &b| axis[a].abs().total_cmp(&axis[b].abs()))
            .unwrap_or(2);
        Self {
            line: piece.line,
            center_mm: arc.center_mm(),
            radius_mm: arc.radius_mm(),
            plane: planes[normal],
            counter_clockwise: axis[normal] > 0.0,
            s_mm: [piece.s_mm, piece.s_mm + piece.length_mm],
        }
    }

    fn goes_on_with(&self, next: &Self) -> bool {
        distance(self.center_mm, next.center_mm) < SAME_MM
            && (self.radius_mm - next.radius_mm).abs() < SAME_MM
            && (self.plane, self.counter_clockwise) == (next.plane, next.counter_clockwise)
    }

    /// Returns the angle of a point of the circle as a fraction of a turn, and the outward unit
    /// vector there; none if the point is not on the circle.
    fn place(&self, point_mm: [f64; 3]) -> Option<(f64, [f64; 3])> {
        let from_center = sub(point_mm, self.center_mm);
        let [first, second] = self.axes();
        let mut across = [0.0; 3];
        (across[first], across[second]) = (from_center[first], from_center[second]);
        let radius_mm = norm(across);
        let off_mm = norm(sub(from_center, across)).max((radius_mm - self.radius_mm).abs());
        let turn = libm::atan2(across[second], across[first]) / TAU;
        (off_mm < SAME_MM).then(|| (turn.rem_euclid(1.0), across.map(|x| x / radius_mm)))
    }
}

/// Returns the full circles of a path in the order in which they are cut; if there are many, only
/// the longest.
pub(crate) fn full_circles(steps: impl Iterator<Item = Step>) -> Vec<FullCircle> {
    let mut found = Vec::new();
    let mut open: Option<(FullCircle, f64)> = None;
    let mut keep = |open: Option<(FullCircle, f64)>| {
        found.extend(
            open.filter(|(_, turned_rad)| *turned_rad > TAU - OPEN_RAD)
                .map(|(circle, _)| circle),
        );
        if found.len() > 4 * MOST_CIRCLES {
            keep_longest(&mut found);
        }
    };
    for step in steps {
        let Step::Piece(piece) = step else { continue };
        let next = match &piece.curve {
            Curve::Arc(arc) if piece.cutting && arc.is_flat() => {
                Some((FullCircle::starting_with(&piece, arc), arc.sweep_rad()))
            }
            _ => None,
        };
        match (&mut open, next) {
            (Some((circle, turned_rad)), Some((next, sweep_rad))) if circle.goes_on_with(&next) => {
                circle.s_mm[1] = next.s_mm[1];
                *turned_rad += sweep_rad;
            }
            (open, next) => keep(std::mem::replace(open, next)),
        }
    }
    keep(open);
    keep_longest(&mut found);
    found
}

fn keep_longest(circles: &mut Vec<FullCircle>) {
    let length_mm = |circle: &FullCircle| circle.s_mm[1] - circle.s_mm[0];
    circles.sort_by(|a, b| length_mm(b).total_cmp(&length_mm(a)));
    circles.truncate(MOST_CIRCLES);
    circles.sort_by(|a, b| a.s_mm[0].total_cmp(&b.s_mm[0]));
}

/// Roundness of a circle as cut.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Roundness {
    /// Circular deviation G about the least-squares circle, µm.
    pub circular_deviation_um: f64,
    /// Largest radial deviation Fmax, µm; positive is outside.
    pub radial_max_um: f64,
    /// Least radial deviation Fmin, µm.
    pub radial_min_um: f64,
    /// Radial deviation of largest magnitude in each part of a turn, starting at the first axis of
    /// the plane, µm; none in parts that were not cut.
    #[serde(skip)]
    pub radial_um: Vec<Option<f64>>,
}

/// Records the radial deviations of the circles of a program.
#[derive(Debug, Clone)]
pub(crate) struct RadialDeviations<'a> {
    circles: &'a [FullCircle],
    /// Radial deviation of each part of a turn, of least and of largest, mm.
    recorded: Vec<(Vec<Option<f64>>, [f64; 2])>,
}

impl<'a> RadialDeviations<'a> {
    /// Creates an empty record.
    pub(crate) fn of(circles: &'a [FullCircle]) -> Self {
        let none = (vec![None; BINS], [f64::INFINITY, f64::NEG_INFINITY]);
        Self {
            circles,
            recorded: vec![none; circles.len()],
        }
    }

    /// Returns the roundness of each circle; none if too little of the circle was cut.
    pub(crate) fn roundness(self) -> Vec<Option<Roundness>> {
        self.recorded
            .into_iter()
            .map(|(bins_mm, extremes_mm)| roundness(&bins_mm, extremes_mm))
            .collect()
    }
}

impl Sink for RadialDeviations<'_> {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let reached = self
            .circles
            .partition_point(|circle| circle.s_mm[0] <= row.s_mm);
        if !row.cutting || !row.act_mm.iter().all(|x| x.is_finite()) {
            return Ok(());
        }
        // The tool may still be on the previous circle when the command is on the next one.
        for i in (reached.saturating_sub(2)..reached).rev() {
            let circle = &self.circles[i];
            if row.s_mm > circle.s_mm[1] + LAG_MM {
                continue;
            }
            if let Some((turn, outward)) = circle.place(row.foot_mm) {
                let radial_mm = dot(sub(row.act_mm, row.foot_mm), outward);
                let (bins_mm, [least_mm, most_mm]) = &mut self.recorded[i];
                let bin = &mut bins_mm[((turn * BINS as f64) as usize).min(BINS - 1)];
                if bin.is_none_or(|before: f64| before.abs() < radial_mm.abs()) {
                    *bin = Some(radial_mm);
                }
                (*least_mm, *most_mm) = (least_mm.min(radial_mm), most_mm.max(radial_mm));
                break;
            }
        }
        Ok(())
    }
}

/// Computes the roundness of a circle; none if a quarter of it was not cut at all.
fn roundness(bins_mm: &[Option<f64>], [least_mm, most_mm]: [f64; 2]) -> Option<Roundness> {
    let angle = |i: usize| (i as f64 + 0.5) / bins_mm.len() as f64 * TAU;
    let places: Vec<([f64; 3], f64)> = (0..bins_mm.len())
        .filter_map(|i| {
            bins_mm[i].map(|radial_mm| ([1.0, libm::cos(angle(i)), libm::sin(angle(i))], radial_mm))
        })
        .collect();
    let quarters: [bool; 4] = std::array::from_fn(|q| {
        bins_mm[q * bins_mm.len() / 4..(q + 1) * bins_mm.len() / 4]
            .iter()
            .any(Option::is_some)
    });
    if places.len() < 8 || quarters.contains(&false) {
        return None;
    }
    let circle = least_squares(&places)?;
    let left = |(at, radial_mm): &([f64; 3], f64)| radial_mm - dot(circle, *at);
    let highest = places.iter().map(left).fold(f64::NEG_INFINITY, f64::max);
    let lowest = places.iter().map(left).fold(f64::INFINITY, f64::min);
    Some(Roundness {
        circular_deviation_um: (highest - lowest) * 1e3,
        radial_max_um: most_mm * 1e3,
        radial_min_um: least_mm * 1e3,
        radial_um: bins_mm.iter().map(|mm| mm.map(|mm| mm * 1e3)).collect(),
    })
}

/// Returns the least-squares factors, from the normal equations of three unknowns, which are nearly
/// diagonal here.
fn least_squares(places: &[([f64; 3], f64)]) -> Option<[f64; 3]> {
    let mut rows = [[0.0; 4]; 3];
    for (at, value) in places {
        for i in 0..3 {
            (0..3).for_each(|k| rows[i][k] += at[i] * at[k]);
            rows[i][3] += at[i] * value;
        }
    }
    for i in 0..3 {
        if rows[i][i].abs() < 1e-9 {
            return None;
        }
        let pivot = rows[i].map(|x| x / rows[i][i]);
        rows[i] = pivot;
        for k in (0..3).filter(|&k| k != i) {
            let factor = rows[k][i];
            (0..4).for_each(|column| rows[k][column] -= factor * pivot[column]);
        }
    }
    Some([rows[0][3], rows[1][3], rows[2][3]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::row;
    use feedwright_plan::Pieces;
    use feedwright_plan::vector::add_scaled;

    fn circles_of(program: &str) -> Vec<FullCircle> {
        let reader = feedwright_gcode::Reader::from_text(
            "part.ngc",
            program,
            feedwright_gcode::Settings::default(),
        )
        .unwrap();
        full_circles(Pieces::new(reader.map(Result::unwrap)).map(Result::unwrap))
    }

    #[test]
    fn a_circle_is_found_in_one_arc_and_in_several() {
        let one = circles_of("G0 X0 Y0\nG2 X0 Y0 I10 J0 F3000\nM2\n");
        let four = circles_of(
            "G0 X0 Y0\nG2 X10 Y10 I10 J0 F3000\nX20 Y0 I0 J-10\nX10 Y-10 I-10 J0\nX0 Y0 I0 J10\nM2\n",
        );
        for circles in [&one, &four] {
            assert_eq!(circles.len(), 1);
            let FullCircle {
                center_mm,
                radius_mm,
                plane,
                counter_clockwise,
                line,
                s_mm,
            } = &circles[0];
            assert!(
                distance(*center_mm, [10.0, 0.0, 0.0]) < 1e-9 && (radius_mm - 10.0).abs() < 1e-9
            );
            assert_eq!((*plane, *counter_clockwise, *line), ("XY", false, 2));
            assert!((s_mm[1] - s_mm[0] - 10.0 * TAU).abs() < 1e-9);
        }
    }

    #[test]
    fn half_circles_helices_and_rapids_are_not_circles() {
        let none = "G0 X0 Y0\nG2 X20 Y0 I10 J0 F3000\nG3 X40 Y0 I10 J0\nG2 X40 Y0 Z-1 I10 J0\nG0 X0 Y0\nM2\n";
        assert_eq!(circles_of(none), []);
        let many: String = (0..100)
            .map(|n| format!("G0 X{n} Y0\nG2 I{} F500\n", 0.1 * f64::from(n + 1)))
            .collect();
        let found = circles_of(&(many + "M2\n"));
        assert_eq!(found.len(), MOST_CIRCLES);
        assert!(
            found.iter().all(|circle| circle.radius_mm > 8.7),
            "{found:?}"
        );
    }

    /// The tool cuts an ellipse of 3 um with a shifted center and a wrong radius. Only the ellipse
    /// counts as circular deviation.
    #[test]
    fn the_circular_deviation_leaves_out_size_and_place() {
        let circles = circles_of("G0 X20 Y0\nG3 X20 Y0 I-10 J0 F3000\nM2\n");
        let mut recorded = RadialDeviations::of(&circles);
        for k in 0..4000 {
            let angle = TAU * f64::from(k) / 4000.0;
            let outward = [libm::cos(angle), libm::sin(angle), 0.0];
            let foot_mm = add_scaled([10.0, 0.0, 0.0], 10.0, outward);
            let radial_mm = 0.005 + 0.004 * libm::cos(angle) + 0.003 * libm::cos(2.0 * angle);
            let act_mm = add_scaled(foot_mm, radial_mm, outward);
            let s_mm = circles[0].s_mm[0] + 10.0 * angle + 0.5;
            recorded
                .row(&Row {
                    foot_mm,
                    act_mm,
                    s_mm,
                    ..row(f64::from(k))
                })
                .unwrap();
        }
        let roundness = recorded.roundness()[0].clone().unwrap();
        assert!(
            (roundness.circular_deviation_um - 6.0).abs() < 0.02,
            "{roundness:?}"
        );
        assert!(
            (roundness.radial_max_um - 12.0).abs() < 1e-6 && roundness.radial_min_um < 5.0,
            "{roundness:?}"
        );
        assert!((roundness.radial_um[0].unwrap() - 12.0).abs() < 0.01);
    }

    #[test]
    fn least_squares_have_no_rest_along_any_of_their_columns() {
        // A part of a circle: no two columns are orthogonal. What is left of the values is, to all
        // of them.
        let at = |k: u32| {
            [
                1.0,
                libm::cos(0.1 * f64::from(k)),
                libm::sin(0.1 * f64::from(k)),
            ]
        };
        let places: Vec<([f64; 3], f64)> = (0..30)
            .map(|k| (at(k), libm::sin(f64::from(k * k))))
            .collect();
        let found = least_squares(&places).unwrap();
        for i in 0..3 {
            let along = |(at, value): &([f64; 3], f64)| {
                at[i] * (value - (0..3).map(|k| at[k] * found[k]).sum::<f64>())
            };
            let rest: f64 = places.iter().map(along).sum();
            assert!(rest.abs() < 1e-9, "{rest} along column {i} of {found:?}");
        }
        assert_eq!(least_squares(&places[..1]), None);
    }

    #[test]
    fn a_circle_that_was_hardly_cut_has_none() {
        let circles = circles_of("G0 X0 Y0\nG2 X0 Y0 I10 J0 F3000\nM2\n");
        assert_eq!(RadialDeviations::of(&circles).roundness(), [None]);
    }
}
