//! Trained identifiers are kept by content: the same recording and training find the same weights.
//! The recording is made anew each time, which takes a fraction of the training, so that no change
//! of machine, plant or planner finds old weights. Identified axes are found by the program that
//! identified them alone.

use feedwright_control::{ContourIdentifier, HIDDEN, INPUTS, Parameters};
use feedwright_ident::{
    AxisEstimate, AxisRecordings, Excitation, Model, NotIdentified, Origin, Recording,
    TrainContour, TrainedAxes, TrainedContour, Training, train_axes,
};
use feedwright_sim::{Known, KnownAxis, Machine};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::store::{content_key, keep, kept, program_key};

/// Raised whenever the same recording gives other weights: a change of the network or of its
/// training.
const FORMAT: u32 = 4;

#[derive(Serialize, Deserialize)]
struct StoredWeights {
    hidden: Vec<f64>,
    output: Vec<f64>,
    fit_um: f64,
    samples: usize,
}

/// Identified axes: the text of a model file, and what it leaves out.
#[derive(Serialize, Deserialize)]
struct StoredAxes {
    model: String,
    estimates: Vec<AxisEstimate>,
}

/// The identifier of a machine, from the cache where it is there.
pub fn identified<const N: usize>(
    machine: &Machine,
    excitation: &Excitation,
    training: &Training,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> TrainedContour<N>
where
    Training: TrainContour<N>,
{
    recorded_and_trained(machine, excitation, training, seed, progress).1
}

/// A recording of a machine, and the identifier that a training makes of it, from the cache where
/// it is there.
pub(crate) fn recorded_and_trained<const N: usize>(
    machine: &Machine,
    excitation: &Excitation,
    training: &Training,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> (Recording<N>, TrainedContour<N>)
where
    Training: TrainContour<N>,
{
    let (recording, rng) = excitation.record(machine, seed);
    let key = content_key(&(FORMAT, N, recording.hash(), excitation, seed, training));
    let found = key.as_deref().and_then(kept);
    if let Some(found) = found.and_then(StoredWeights::trained) {
        return (recording, found);
    }
    let trained = training.train(&recording, rng, progress);
    if let Some(key) = key {
        keep(&key, &StoredWeights::of(&trained));
    }
    (recording, trained)
}

/// The axes that are identified from recordings, from the cache where they are there.
///
/// # Errors
/// Recordings in which parameters do not show.
pub(crate) fn identified_axes<const N: usize>(
    recordings: &AxisRecordings<N>,
    known: &Known,
    used_on: &Known,
) -> Result<TrainedAxes<N>, NotIdentified> {
    let recording = recordings.joined();
    let key = program_key(&(
        "axes",
        recording.hash(),
        [known, used_on].map(|k| content(k, N)),
    ));
    let found = key
        .as_deref()
        .and_then(kept)
        .and_then(|StoredAxes { model, estimates }| {
            let model = Model::parse("cache", &model).ok()?;
            let fit = model.fit();
            let samples = usize::try_from(fit.samples).ok()?;
            Some(TrainedAxes {
                axes: model.identified_axes()?,
                estimates,
                fit_um: fit.fit_um,
                samples,
            })
        });
    if let Some(trained) = found {
        return Ok(trained);
    }
    let trained = train_axes(recordings, known, used_on)?;
    if let Some(key) = key {
        let origin = Origin {
            source: "a simulated excitation".to_owned(),
            date: "1970-01-01".to_owned(),
        };
        let stored = StoredAxes {
            model: Model::of_axes(&recording, &trained, origin).text(),
            estimates: trained.estimates.clone(),
        };
        keep(&key, &stored);
    }
    Ok(trained)
}

/// Lists what the control of a machine compensates, and where its tool is: a machine file has
/// neither.
pub(crate) fn geometry_content(machine: &Machine) -> [Option<Vec<f64>>; 2] {
    [&machine.compensated, &machine.tool].map(|geometry| {
        geometry.as_ref().map(|geometry| {
            let mut numbers = geometry.backlash_mm().to_vec();
            geometry.numbers(|number| numbers.push(number));
            numbers
        })
    })
}

/// Lists what is known of the first axes of a machine.
fn content(known: &Known, axes: usize) -> Value {
    let period = [known.period.servo_s, known.period.mechanics_s];
    let axes: Vec<_> = (0..axes).map(|i| numbers(known.axis(i))).collect();
    json!([period, known.limits, axes])
}

/// Lists what is known of an axis. Names all fields, so that a new one is not forgotten.
fn numbers(axis: &KnownAxis) -> Value {
    let KnownAxis {
        lead_mm_per_rev,
        mut nominal,
        scale_on_table,
        correction_accel_mm_s2,
        spare_torque_nm,
    } = *axis;
    let of_model: Vec<f64> = Parameters::NUMBERS
        .iter()
        .map(|number| *(number.of)(&mut nominal))
        .collect();
    json!([
        lead_mm_per_rev,
        scale_on_table,
        correction_accel_mm_s2,
        spare_torque_nm,
        of_model
    ])
}

impl StoredWeights {
    fn of<const N: usize>(trained: &TrainedContour<N>) -> Self {
        Self {
            hidden: trained.net.hidden.as_flattened().as_flattened().to_vec(),
            output: trained.net.output.as_flattened().to_vec(),
            fit_um: trained.fit_um,
            samples: trained.samples,
        }
    }

    /// The identifier; `None` if it is one of other axes.
    fn trained<const N: usize>(self) -> Option<TrainedContour<N>> {
        let Self {
            hidden,
            output,
            fit_um,
            samples,
        } = self;
        let complete = hidden.len() == N * INPUTS * HIDDEN && output.len() == N * HIDDEN;
        if !complete || hidden.iter().chain(&output).any(|w| !w.is_finite()) {
            return None;
        }
        let net = ContourIdentifier {
            hidden: std::array::from_fn(|a| {
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| hidden[(a * INPUTS + i) * HIDDEN + j])
                })
            }),
            output: std::array::from_fn(|o| std::array::from_fn(|j| output[o * HIDDEN + j])),
        };
        Some(TrainedContour {
            net,
            fit_um,
            samples,
        })
    }
}
