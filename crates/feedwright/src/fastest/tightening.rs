//! Bounds on the speed for the next cut, from the results of the last one.

use feedwright_plan::SpeedCaps;

use super::cut_places::{CutPlace, CutPlaces};
use super::error_model::ErrorModel;
use super::path_grid::PathGrid;
use super::speed_profile::SpeedProfile;
use super::steepness::steepness;

/// Aim of the error, as a fraction of the tolerance.
const AIM: f64 = 0.995;

/// Time before and after a place with an error beyond the tolerance in which the aim is lowered, s:
/// as long as a servo loop remembers.
const AROUND_S: f64 = 0.03;

/// Extra factor on the aim, which is lowered by the ratio of tolerance to error. The aim stays
/// above [`LEAST_AIM`], a fraction of the tolerance.
const LOWERED: f64 = 0.997;
const LEAST_AIM: f64 = 0.2;

/// Lowest bound, mm/s: where the tool is too far away at this speed, speed is not the cause.
pub(super) const LOWEST_MM_S: f64 = 0.2;

/// A bound holds the speed if the speed reaches this fraction of it.
const HOLDS: f64 = 0.95;

/// Weight that keeps speeds near the speeds of the last cut ([`SpeedProfile::near`]): small in the
/// first cuts, then doubled each time, up to a value at which speeds change by a few percent.
/// Without it, errors that respond to the speed more steeply than in the model would oscillate.
const NEAR: f64 = 0.02;
const FREE_CUTS: i32 = 4;
const MOST_NEAR: f64 = 5.0;

/// A speed that would fall by no more than this fraction stays.
const LOWER: f64 = 2e-3;

/// Bounds for the next cut.
#[derive(Debug)]
pub(super) struct NextCaps {
    pub(super) caps: SpeedCaps,
    /// Part of the time of the last cut in which something other than these bounds limited its
    /// speed.
    pub(super) held_part: f64,
}

/// Aims of the error, place by place.
#[derive(Debug)]
pub(super) struct Tightening {
    tolerance_mm: f64,
    aims_mm: Vec<f64>,
    /// Places of the last cut.
    last: Vec<CutPlace>,
    steepness: f64,
}

impl Tightening {
    /// Creates the same aim everywhere.
    pub(super) fn new(tolerance_mm: f64, count: usize) -> Self {
        Self {
            tolerance_mm,
            aims_mm: vec![AIM * tolerance_mm; count],
            last: Vec::new(),
            steepness: 1.0,
        }
    }

    /// Lowers the aim where errors are beyond the tolerance although the speed was chosen for the
    /// current aim.
    pub(super) fn aim_lower(&mut self, cut: &CutPlaces, spacing_mm: f64) {
        let n = self.aims_mm.len();
        let mut factors = vec![1.0_f64; n];
        for (i, place) in cut
            .places
            .iter()
            .enumerate()
            .filter(|(_, place)| place.error_mm > self.tolerance_mm)
        {
            let factor = LOWERED * self.tolerance_mm / place.error_mm;
            let around = (AROUND_S * place.speed_mm_s / spacing_mm).ceil() as usize + 1;
            for of_place in &mut factors[i.saturating_sub(around)..(i + around + 1).min(n)] {
                *of_place = of_place.min(factor);
            }
        }
        for (aim_mm, factor) in self.aims_mm.iter_mut().zip(factors) {
            *aim_mm = (*aim_mm * factor).max(LEAST_AIM * self.tolerance_mm);
        }
    }

    /// Returns the speed bounds for the next cut. `cut` was made within the bounds `caps`; `cuts`
    /// is the number of cuts so far.
    pub(super) fn caps(
        &mut self,
        grid: &PathGrid,
        cut: &CutPlaces,
        caps: &SpeedCaps,
        cuts: u32,
    ) -> NextCaps {
        let squares: Vec<f64> = cut
            .places
            .iter()
            .map(|place| place.speed_mm_s * place.speed_mm_s)
            .collect();
        let cap_of = |i: usize| caps.caps_mm_s.get(i).copied().unwrap_or(f64::INFINITY);
        let held: Vec<bool> = cut
            .places
            .iter()
            .enumerate()
            .map(|(i, place)| place.speed_mm_s < HOLDS * cap_of(i))
            .collect();
        if let Some(steepness) = steepness(&self.last, &cut.places, self.tolerance_mm) {
            self.steepness = (self.steepness * steepness).sqrt();
        }
        self.last.clone_from(&cut.places);
        let model = ErrorModel::of(grid, &cut.places, self.steepness);
        let profile = SpeedProfile {
            spacing_mm: grid.spacing_mm,
            squares: &squares,
            least_square: LOWEST_MM_S * LOWEST_MM_S,
            model: &model,
            aims_mm: &self.aims_mm,
            held: &held,
            near: (NEAR * 2.0_f64.powi((cuts as i32 - FREE_CUTS).max(0))).min(MOST_NEAR),
        };
        let next = profile.solve();
        let caps_mm_s = (0..next.len())
            .map(|i| {
                let (now_mm_s, next_mm_s) = (squares[i].sqrt(), next[i].sqrt().max(LOWEST_MM_S));
                let stays = held[i] && next_mm_s > (1.0 - LOWER) * now_mm_s;
                if stays { cap_of(i) } else { next_mm_s }
            })
            .collect();
        let time_s = |held_only: bool| -> f64 {
            let places = cut
                .places
                .iter()
                .zip(&held)
                .filter(|(_, held)| **held || !held_only);
            places
                .map(|(place, _)| 1.0 / place.speed_mm_s.max(LOWEST_MM_S))
                .sum()
        };
        NextCaps {
            caps: SpeedCaps {
                spacing_mm: grid.spacing_mm,
                caps_mm_s,
            },
            held_part: time_s(true) / time_s(false),
        }
    }
}
