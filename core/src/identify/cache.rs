//! Trained identifiers are kept by content: the same machine, programme, training and seed find the same weights.
//!
//! One small JSON file each, in the user's cache folder, or in `$FEEDWRIGHT_CACHE` where that is set. A file that cannot
//! be read or does not hold a network is trained anew; one that cannot be written is not an error.

use std::path::PathBuf;

use feedwright_control::identifier::contour::ContourIdentifier;
use feedwright_control::identifier::{HIDDEN, INPUTS};
use serde::{Deserialize, Serialize};

use super::Programme;
use super::contour::{Identified, Training, identify};
use crate::machine::Machine;

/// Raised whenever the same key would stand for other weights: a change of the plant, the planner or the training.
const FORMAT: u32 = 3;

#[derive(Serialize, Deserialize)]
struct Stored {
    hidden: Vec<f64>,
    output: Vec<f64>,
    fit_um: f64,
    samples: usize,
}

/// The identifier of a machine, from the cache where it is there.
pub fn identified<const N: usize>(
    machine: &Machine,
    programme: &Programme,
    training: &Training,
    seed: u64,
    progress: &mut dyn FnMut(f64),
) -> Identified<N> {
    let file = folder().map(|folder| folder.join(format!("{}.json", key::<N>(machine, programme, training, seed))));
    if let Some(found) = file.as_ref().and_then(load) {
        return found;
    }
    let identified = identify(machine, programme, training, seed, progress);
    if let Some(file) = file {
        // A cache that cannot be written costs time, nothing else.
        let _ = store(&file, &identified);
    }
    identified
}

fn folder() -> Option<PathBuf> {
    match std::env::var_os("FEEDWRIGHT_CACHE") {
        Some(folder) => Some(PathBuf::from(folder)),
        None => directories::ProjectDirs::from("", "", "feedwright").map(|dirs| dirs.cache_dir().to_owned()),
    }
}

fn key<const N: usize>(machine: &Machine, programme: &Programme, training: &Training, seed: u64) -> String {
    let content = serde_json::json!([FORMAT, N, machine.fingerprint(), programme, training, seed]);
    blake3::hash(content.to_string().as_bytes()).to_hex().to_string()
}

fn load<const N: usize>(file: &PathBuf) -> Option<Identified<N>> {
    let stored: Stored = serde_json::from_slice(&std::fs::read(file).ok()?).ok()?;
    let complete = stored.hidden.len() == N * INPUTS * HIDDEN && stored.output.len() == N * HIDDEN;
    if !complete || stored.hidden.iter().chain(&stored.output).any(|w| !w.is_finite()) {
        return None;
    }
    let net = ContourIdentifier {
        hidden: std::array::from_fn(|a| {
            std::array::from_fn(|i| std::array::from_fn(|j| stored.hidden[(a * INPUTS + i) * HIDDEN + j]))
        }),
        output: std::array::from_fn(|o| std::array::from_fn(|j| stored.output[o * HIDDEN + j])),
    };
    Some(Identified { net, fit_um: stored.fit_um, samples: stored.samples })
}

fn store<const N: usize>(file: &std::path::Path, identified: &Identified<N>) -> std::io::Result<()> {
    let Some(folder) = file.parent() else { return Ok(()) };
    std::fs::create_dir_all(folder)?;
    let stored = Stored {
        hidden: identified.net.hidden.as_flattened().as_flattened().to_vec(),
        output: identified.net.output.as_flattened().to_vec(),
        fit_um: identified.fit_um,
        samples: identified.samples,
    };
    let beside = tempfile::NamedTempFile::new_in(folder)?;
    serde_json::to_writer(&beside, &stored)?;
    beside.persist(file)?;
    Ok(())
}
