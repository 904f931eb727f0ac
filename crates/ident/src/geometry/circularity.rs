//! Circular deviations of a ball bar, by ISO 230-4.
//!
//! ```text
//! G = max r - min r about the center of each direction      F = [min, max] of r - R about the center of both
//! H = max |r_ccw - r_cw| at the same angle about the center of both
//! ```
//!
//! r is the mean radius over 1 degree, R the nominal one. The center is the center of a
//! least-squares circle. F needs a calibrated bar, and H both directions. Source: ISO 230-4 (2005),
//! circular tests for numerically controlled machine tools, clause 3.

use feedwright_sim::{MeasuredSet, RankedLeastSquares, to_four_digits};

/// Circular deviations of a set, um.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Circularity {
    /// Circular deviation G, counterclockwise and clockwise; none where a direction was not
    /// measured.
    pub(crate) deviation_um: [Option<f64>; 2],
    /// Circular hysteresis H; none where only one direction was measured.
    pub(crate) hysteresis_um: Option<f64>,
    /// Least and greatest radial deviation F; none where the length of the bar is not known.
    pub(crate) radial_um: Option<[f64; 2]>,
}

/// Angles, a degree each.
const PLACES: usize = 360;

impl Circularity {
    /// Computes the deviations of a set; `None` if it does not come from a ball bar.
    pub fn of(set: &MeasuredSet) -> Option<Self> {
        if set.kind != "bar" {
            return None;
        }
        let ways = [1.0, -1.0].map(|way| means_um(set, way));
        let deviation_um = ways.each_ref().map(|radii| {
            let range_um = range(&about_center(std::slice::from_ref(radii)));
            range_um.map(|[least, most]| most - least)
        });
        let common = about_center(&ways);
        let at = |way: usize, place: usize| {
            common
                .iter()
                .find(|of| of.0 == way && of.1 == place)
                .map(|of| of.2)
        };
        let apart = (0..PLACES).filter_map(|place| Some((at(0, place)? - at(1, place)?).abs()));
        let both = deviation_um.iter().all(Option::is_some);
        Some(Self {
            deviation_um,
            hysteresis_um: both.then(|| apart.fold(0.0, f64::max)),
            radial_um: range(&common).filter(|_| set.calibrated),
        })
    }

    /// Writes them as a line for the user.
    pub fn line(&self) -> String {
        let [ccw, cw] = self
            .deviation_um
            .map(|um| um.map_or_else(|| "-".to_owned(), to_four_digits));
        let hysteresis = self
            .hysteresis_um
            .map_or_else(String::new, |um| format!(", H {} um", to_four_digits(um)));
        let radial = self.radial_um.map_or_else(String::new, |[least, most]| {
            format!(
                ", F {} to {} um",
                to_four_digits(least),
                to_four_digits(most)
            )
        });
        format!(
            "circularity (ISO 230-4): G {ccw} um counterclockwise, {cw} um clockwise{hysteresis}{radial}"
        )
    }
}

/// Mean deviation at each place in a direction, um.
fn means_um(set: &MeasuredSet, way: f64) -> Vec<(usize, f64)> {
    let mut sums = [[0.0; 2]; PLACES];
    for row in set.rows.iter().filter(|row| row[1] == way) {
        let part = row[0] / 360.0 - (row[0] / 360.0).floor();
        // A part of a turn below 1 is a place.
        let sum = &mut sums[((part * PLACES as f64) as usize).min(PLACES - 1)];
        *sum = [sum[0] + 1.0, sum[1] + row[2]];
    }
    let places = sums
        .iter()
        .enumerate()
        .filter(|(_, [count, _])| *count > 0.0);
    places
        .map(|(place, [count, sum_um])| (place, sum_um / count))
        .collect()
}

/// Direction, place and deviation about the center of all, um.
fn about_center(ways: &[Vec<(usize, f64)>]) -> Vec<(usize, usize, f64)> {
    let all: Vec<(usize, usize, f64)> = ways
        .iter()
        .enumerate()
        .flat_map(|(way, radii)| radii.iter().map(move |&(place, um)| (way, place, um)))
        .collect();
    let angles = all
        .iter()
        .map(|of| libm::sincos((of.1 as f64 + 0.5).to_radians()));
    let [sines, cosines]: [Vec<f64>; 2] = [
        angles.clone().map(|(sin, _)| sin).collect(),
        angles.map(|(_, cos)| cos).collect(),
    ];
    let right: Vec<f64> = all.iter().map(|of| of.2).collect();
    let fit = RankedLeastSquares::new(
        &[vec![1.0; all.len()], cosines.clone(), sines.clone()],
        &right,
    );
    let [_, x_um, y_um] = [0, 1, 2].map(|i| fit.values[i]);
    let moved = all.iter().zip(cosines.iter().zip(&sines));
    moved
        .map(|(&(way, place, um), (cos, sin))| (way, place, um - x_um * cos - y_um * sin))
        .collect()
}

/// Least and greatest deviation, um; none of nothing.
fn range(all: &[(usize, usize, f64)]) -> Option<[f64; 2]> {
    let fold =
        |[least, most]: [f64; 2], of: &(usize, usize, f64)| [least.min(of.2), most.max(of.2)];
    (!all.is_empty()).then(|| all.iter().fold([f64::INFINITY, f64::NEG_INFINITY], fold))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An ellipse of +-3 um whose center is off by 40 and -20 um, 5 um too large, with clockwise 2
    /// um smaller.
    fn set(calibrated: bool, ways: &[f64]) -> MeasuredSet {
        let row = |way: f64, i: u32| {
            let angle_deg = f64::from(i) + 0.5;
            let (sin, cos) = libm::sincos(angle_deg.to_radians());
            let ellipse = 3.0 * (cos * cos - sin * sin);
            vec![
                angle_deg,
                way,
                5.0 + ellipse + 40.0 * cos - 20.0 * sin + if way < 0.0 { -2.0 } else { 0.0 },
            ]
        };
        let rows = ways
            .iter()
            .flat_map(|&way| (0..360).map(move |i| row(way, i)))
            .collect();
        MeasuredSet {
            kind: "bar".to_owned(),
            calibrated,
            rows,
            ..MeasuredSet::default()
        }
    }

    #[test]
    fn an_ellipse_off_center_has_the_deviations_of_the_ellipse() {
        let near = |a: f64, b: f64| (a - b).abs() < 1e-2;
        let found = Circularity::of(&set(true, &[1.0, -1.0])).unwrap();
        assert!(
            found.deviation_um.iter().all(|um| near(um.unwrap(), 6.0)),
            "{found:?}"
        );
        assert!(near(found.hysteresis_um.unwrap(), 2.0), "{found:?}");
        let [least_um, most_um] = found.radial_um.unwrap();
        assert!(near(least_um, 0.0) && near(most_um, 8.0), "{found:?}");
        let one = Circularity::of(&set(false, &[-1.0])).unwrap();
        assert_eq!(
            (one.deviation_um[0], one.hysteresis_um, one.radial_um),
            (None, None, None)
        );
        assert!(near(one.deviation_um[1].unwrap(), 6.0), "{one:?}");
    }

    #[test]
    fn what_is_no_ball_bar_has_none() {
        assert_eq!(
            Circularity::of(&MeasuredSet {
                kind: "grid".to_owned(),
                ..set(true, &[1.0])
            }),
            None
        );
    }
}
