//! Trained identifiers are kept by content: the same recording and training find the same weights.
//! The recording is made anew each time, which takes a fraction of the training, so that no change
//! of machine, plant or planner finds old weights. Identified axes are found by the program that
//! identified them alone.
//!
//! Anything that cannot be read, is damaged or does not hold an identifier is trained anew. Without
//! the feature `files`, only the results of machine logs are kept, by [`keep_in`].

#[cfg(feature = "files")]
pub(crate) mod files;
#[cfg(not(feature = "files"))]
mod no_files;
mod kept_texts;

use feedwright_control::{ContourIdentifier, HIDDEN, INPUTS};
use feedwright_ident::{
    AxisEstimate, AxisRecordings, Excitation, Model, NotIdentified, Origin, Recording, Rng,
    TrainedAxes, TrainedContour, Training, train_axes, train_contour,
};
use feedwright_sim::{Known, Machine};
use serde::{Deserialize, Serialize};

use crate::checked_json::{checked, with_check};
pub use kept_texts::{KeptTexts, keep_in};
#[cfg(not(feature = "files"))]
use no_files as files;

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
) -> TrainedContour<N> {
    let (recording, rng) = excitation.record(machine, seed);
    trained(&recording, training, rng, progress)
}

/// The identifier that a training makes of a recording, from the cache where it is there.
pub fn trained<const N: usize>(
    recording: &Recording<N>,
    training: &Training,
    rng: Rng,
    progress: &mut dyn FnMut(f64),
) -> TrainedContour<N> {
    let name = format!("{}.json", key(recording, training, &rng));
    if let Some(found) = files::read(&name).and_then(|text| stored(&text)) {
        return found;
    }
    let identified = train_contour(recording, training, rng, progress);
    if let Ok(text) = text(&identified) {
        files::write(&name, &text);
    }
    identified
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
    let content = || format!("axes {} {known:?}{used_on:?}", recording.hash());
    let kept = kept_text(&content()).and_then(|text| {
        let StoredAxes { model, estimates } = serde_json::from_str(&text).ok()?;
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
    if let Some(trained) = kept {
        return Ok(trained);
    }
    let trained = train_axes(recordings, known, used_on)?;
    let origin = Origin {
        source: "a simulated excitation".to_owned(),
        date: "1970-01-01".to_owned(),
    };
    let model = Model::of_axes(&recording, &trained, origin).text();
    if let Ok(text) = serde_json::to_string(&StoredAxes {
        model,
        estimates: trained.estimates.clone(),
    }) {
        keep_text(&content(), &text);
    }
    Ok(trained)
}

/// Returns the text that this program kept for a content; `None` if there is no such text or it is
/// damaged.
pub(crate) fn kept_text(content: &str) -> Option<String> {
    checked(&kept_texts::read(&name_of(content)?)?)
}

/// Keeps a JSON object by the content that it follows from.
pub(crate) fn keep_text(content: &str, object: &str) {
    if let Some(name) = name_of(content) {
        kept_texts::write(&name, &with_check(object));
    }
}

/// The name of a file of this program, where there is a cache.
fn name_of(content: &str) -> Option<String> {
    let program = kept_texts::program()?;
    Some(format!(
        "{}.json",
        key_of(&[program.as_bytes(), content.as_bytes()])
    ))
}

/// A name for what depends on these parts.
pub fn key_of(parts: &[&[u8]]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex().to_string()
}

fn key<const N: usize>(recording: &Recording<N>, training: &Training, rng: &Rng) -> String {
    let content = serde_json::json!([FORMAT, N, recording.hash(), format!("{rng:?}"), training]);
    blake3::hash(content.to_string().as_bytes())
        .to_hex()
        .to_string()
}

/// The identifier in a file of the cache.
fn stored<const N: usize>(text: &str) -> Option<TrainedContour<N>> {
    let stored: StoredWeights = serde_json::from_str(&checked(text)?).ok()?;
    let complete = stored.hidden.len() == N * INPUTS * HIDDEN && stored.output.len() == N * HIDDEN;
    if !complete
        || stored
            .hidden
            .iter()
            .chain(&stored.output)
            .any(|w| !w.is_finite())
    {
        return None;
    }
    let net = ContourIdentifier {
        hidden: std::array::from_fn(|a| {
            std::array::from_fn(|i| {
                std::array::from_fn(|j| stored.hidden[(a * INPUTS + i) * HIDDEN + j])
            })
        }),
        output: std::array::from_fn(|o| std::array::from_fn(|j| stored.output[o * HIDDEN + j])),
    };
    Some(TrainedContour {
        net,
        fit_um: stored.fit_um,
        samples: stored.samples,
    })
}

/// The file of an identifier.
fn text<const N: usize>(identified: &TrainedContour<N>) -> serde_json::Result<String> {
    let stored = StoredWeights {
        hidden: identified.net.hidden.as_flattened().as_flattened().to_vec(),
        output: identified.net.output.as_flattened().to_vec(),
        fit_um: identified.fit_um,
        samples: identified.samples,
    };
    Ok(with_check(&serde_json::to_string(&stored)?))
}
