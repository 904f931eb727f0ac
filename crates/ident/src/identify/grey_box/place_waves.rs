//! Deviations that repeat with place in a record: interpolation error of the encoder, and cogging of
//! the motor.
//!
//! The free runs have neither. A filter with the identified model follows the record, and
//! [`crate::identify::axis_statistics`] finds both in its innovations, where the record is long
//! enough and they are more likely than chance. Commands are taken as late as the position loop has
//! them; places are the measured positions, so that the delay of the record shifts no phase.

use std::f64::consts::TAU;
use std::ops::Range;

use feedwright_control::Parameters;
use feedwright_sim::Axis;

use super::axis_record::AxisRecord;
use super::axis_run::{Commands, periods};
use super::terms::{ModelTerm, TermValues};
use crate::identify::axis_statistics::{KnownWaves, of_axis};
use crate::log::Log;

/// A sine over the position of the axis: amplitude times sin(2 pi x / period + phase).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceWave {
    /// Amplitude: um, or mm/s2 of a torque over the inertia.
    pub amplitude: f64,
    /// Period, mm of travel.
    pub period_mm: f64,
    /// Phase at position zero, rad.
    pub phase_rad: f64,
}

/// Deviations that repeat with place, as far as a record shows them.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct PlaceWaves {
    /// Interpolation error of the encoder, um.
    pub interpolation: Option<PlaceWave>,
    /// Cogging torque over the inertia, mm/s2.
    pub cogging: Option<PlaceWave>,
}

/// Torque limit where the record never came to one, times what its motions took.
const SPARE: f64 = 10.0;

/// Finds what repeats with place in a log, for each axis by its model in a machine file with this
/// servo period. Actual positions are recorded `record_delay_s` later than the commands. Periods
/// that the file states are not used.
pub fn place_waves(log: &Log, axes: &[Axis], servo_s: f64, record_delay_s: f64) -> Vec<PlaceWaves> {
    let waves = |(record, axis): (AxisRecord<'_>, &Axis)| {
        let values =
            TermValues::of_axis(axis, servo_s).with(ModelTerm::RecordDelay, record_delay_s);
        let model = WaveModel {
            values: &values,
            most: record.most(),
            rad_per_mm: axis.rad_per_mm(),
            known: KnownWaves::default(),
        };
        model.waves(&record)
    };
    AxisRecord::of(log)
        .into_iter()
        .zip(axes)
        .map(waves)
        .collect()
}

/// Model of an axis, with which the waves are found.
pub(super) struct WaveModel<'a> {
    /// Values of the model, from positions alone.
    pub(super) values: &'a TermValues,
    /// Highest speed of the command, mm/s, and acceleration, mm/s2.
    pub(super) most: [f64; 2],
    /// Turn of the motor for a travel, rad/mm.
    pub(super) rad_per_mm: f64,
    /// Periods that are known.
    pub(super) known: KnownWaves,
}

impl WaveModel<'_> {
    /// Finds the waves. Finds none in a record with several servo periods in a sample, since the
    /// position loop acted on positions between.
    pub(super) fn waves(&self, record: &AxisRecord<'_>) -> PlaceWaves {
        let (periods, servo_per_sample) = periods(record.sample_s);
        if servo_per_sample > 1 {
            return PlaceWaves::default();
        }
        let rad_per_mm = self.rad_per_mm;
        let shown = of_axis(
            &self.rows(record),
            self.at_shaft(periods.mechanics_s),
            periods,
            &self.known,
        );
        let wave = |amplitude: f64, per_rad: f64, phase_rad: f64| {
            (amplitude > 0.0 && per_rad > 0.0).then(|| PlaceWave {
                amplitude,
                period_mm: TAU / (per_rad * rad_per_mm),
                phase_rad,
            })
        };
        PlaceWaves {
            interpolation: wave(
                1e3 * shown.interpolation_rad / rad_per_mm,
                shown.signal_per_rad,
                shown.interpolation_phase_rad,
            ),
            cogging: wave(
                shown.cogging_nm / rad_per_mm,
                shown.cogging_per_rev,
                shown.cogging_phase_rad,
            ),
        }
    }

    /// Returns each measured position with the command that the position loop has then, stretch by
    /// stretch, mm. Positions whose commands are not recorded are left out.
    fn rows(&self, record: &AxisRecord<'_>) -> Vec<Vec<[f64; 2]>> {
        let late = self.values.commands_late_s() / record.sample_s;
        let rows = |stretch: &Range<usize>| -> Vec<[f64; 2]> {
            let commands = Commands::new(&record.command_mm[stretch.clone()]);
            let actual = record.actual_mm[stretch.clone()].iter().enumerate();
            actual
                .skip(late.max(0.0).ceil() as usize)
                .map(|(sample, actual_mm)| [commands.at_mm(sample as f64 - late), *actual_mm])
                .collect()
        };
        let stretches = record
            .stretches
            .iter()
            .filter(|stretch| !stretch.is_empty());
        stretches
            .map(rows)
            .filter(|rows| !rows.is_empty())
            .collect()
    }

    /// Returns the model at a shaft with an inertia of 1 kg m2: a torque of 1 N m is 1 rad/s2.
    fn at_shaft(&self, mechanics_s: f64) -> Parameters {
        let (values, rad_per_mm) = (self.values, self.rad_per_mm);
        let linear = values.parameters(mechanics_s);
        let needed_mm_s2 = self.most[1]
            + values.get(ModelTerm::Coulomb)
            + values.get(ModelTerm::Viscous) * self.most[0];
        let limit = values.get(ModelTerm::AccelerationLimit);
        let limit_mm_s2 = if limit > 0.0 {
            limit
        } else {
            SPARE * needed_mm_s2.max(1.0)
        };
        Parameters {
            rad_per_mm,
            torque_limit_nm: rad_per_mm * limit_mm_s2,
            coulomb_friction_nm: rad_per_mm * linear.coulomb_friction_nm,
            coulomb_smoothing_rad_s: rad_per_mm * linear.coulomb_smoothing_rad_s,
            speed_limit_rad_s: rad_per_mm * linear.speed_limit_rad_s,
            coulomb_asymmetry_nm: rad_per_mm * linear.coulomb_asymmetry_nm,
            stribeck_nm: rad_per_mm * linear.stribeck_nm,
            stribeck_rad_s: rad_per_mm * linear.stribeck_rad_s,
            presliding_rad: rad_per_mm * linear.presliding_rad,
            backlash_rad: rad_per_mm * linear.backlash_rad,
            drive_delay_s: values.get(ModelTerm::LoopDelay),
            ..linear
        }
    }
}
