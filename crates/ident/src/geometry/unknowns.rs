//! The unknowns that a measurement can determine, each as the geometry that it has when it is 1.
//!
//! The scales of n axes are fitted as n - 1 differences and their mean. A ball bar of unknown
//! length does not determine the mean, which is then dropped; the differences remain, split evenly.

use feedwright_sim::{AXIS_NAMES, GeometryFile, Observation};

/// Kind of an unknown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum UnknownKind {
    /// Squareness of a pair: 0 xy, 1 xz, 2 yz.
    Squareness(usize),
    /// A difference of scales, or their mean.
    ScaleDifference,
    /// See there.
    MeanScale,
    /// Backlash of an axis.
    Backlash(usize),
    /// Pitch error of an axis that is zero at position 0.
    PitchSine(usize),
    /// Pitch error of an axis that is greatest at position 0.
    PitchCosine(usize),
}

/// An unknown.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Unknown {
    pub(super) kind: UnknownKind,
    /// Geometry of one um/m, um or urad of it.
    pub(super) unit: GeometryFile,
}

/// Steps of a turn of the screw that a measurement has at least, to show what happens within a
/// turn.
const STEPS_PER_TURN: f64 = 5.0;

/// Returns true if steps of this length along an axis resolve a turn of the screw.
pub(super) fn shows_turns(observations: &[Observation], axis: usize, lead_mm: f64) -> bool {
    let moves = observations
        .windows(2)
        .map(|pair| (pair[1].places[0].at_mm[axis] - pair[0].places[0].at_mm[axis]).abs());
    let mut moves: Vec<f64> = moves.filter(|step_mm| *step_mm > 1e-6).collect();
    moves.sort_by(f64::total_cmp);
    moves
        .get(moves.len() / 2)
        .is_some_and(|median_mm| *median_mm <= lead_mm / STEPS_PER_TURN)
}

/// Returns the unknowns of some axes and planes, the best determined ones first.
pub(super) fn unknowns(
    axes: &[usize],
    planes: &[[usize; 2]],
    turns: [Option<f64>; 3],
) -> Vec<Unknown> {
    let of = |kind, change: &dyn Fn(&mut GeometryFile)| {
        let mut unit = GeometryFile::default();
        change(&mut unit);
        Unknown { kind, unit }
    };
    let mut all = Vec::new();
    for plane in planes {
        let (pair, kind) = match plane {
            [0, 1] => (0, UnknownKind::Squareness(0)),
            [0, 2] => (1, UnknownKind::Squareness(1)),
            _ => (2, UnknownKind::Squareness(2)),
        };
        all.push(of(kind, &|file| *angle(file, pair) = 1.0));
    }
    for k in 1..axes.len() {
        // The k-th axis against the mean of those before.
        let whole = (k + 1) as f64;
        all.push(of(UnknownKind::ScaleDifference, &|file| {
            axes[..k]
                .iter()
                .for_each(|&axis| file.axes[axis].scale_um_m = -1.0 / whole);
            file.axes[axes[k]].scale_um_m = k as f64 / whole;
        }));
    }
    all.push(of(UnknownKind::MeanScale, &|file| {
        axes.iter()
            .for_each(|&axis| file.axes[axis].scale_um_m = 1.0);
    }));
    for &axis in axes {
        all.push(of(UnknownKind::Backlash(axis), &|file| {
            file.axes[axis].backlash_um = 1.0;
        }));
    }
    for &axis in axes {
        let Some(lead_mm) = turns[axis] else { continue };
        for (kind, phase_deg) in [
            (UnknownKind::PitchSine(axis), 0.0),
            (UnknownKind::PitchCosine(axis), 90.0),
        ] {
            all.push(of(kind, &|file| {
                let axis = &mut file.axes[axis];
                (
                    axis.pitch_error_um,
                    axis.pitch_phase_deg,
                    axis.lead_mm_per_rev,
                ) = (1.0, phase_deg, lead_mm);
            }));
        }
    }
    all
}

/// The angle of a pair.
pub(super) fn angle(file: &mut GeometryFile, pair: usize) -> &mut f64 {
    match pair {
        0 => &mut file.squareness.squareness_xy_urad,
        1 => &mut file.squareness.squareness_xz_urad,
        _ => &mut file.squareness.squareness_yz_urad,
    }
}

/// Names of the pairs.
pub(super) const PAIRS: [&str; 3] = ["xy", "xz", "yz"];

impl UnknownKind {
    /// Name for people.
    pub(super) fn name(self) -> String {
        match self {
            Self::Squareness(pair) => format!("squareness {}", PAIRS[pair]),
            Self::ScaleDifference => "difference of scales".to_owned(),
            Self::MeanScale => "mean scale".to_owned(),
            Self::Backlash(axis) => format!("backlash {}", AXIS_NAMES[axis]),
            Self::PitchSine(axis) | Self::PitchCosine(axis) => {
                format!("pitch error {}", AXIS_NAMES[axis])
            }
        }
    }
}
