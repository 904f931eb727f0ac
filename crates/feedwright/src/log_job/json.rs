//! What an identification found, as JSON.

use std::io;

use feedwright_ident::{FoundAxis, FreeRunErrors, HORIZONS, NumberSource};
use serde_json::{Map, Value, json};

use super::LogIdentified;
use crate::results_format::{stamped, write_json};

/// Writes the results as JSON.
///
/// Fails if `out` fails.
pub fn write(out: &mut impl io::Write, identified: &LogIdentified) -> io::Result<()> {
    let axes: Map<String, Value> = identified
        .machine
        .axes
        .iter()
        .enumerate()
        .map(|(i, found)| (found.name.clone(), axis(identified, i, found)))
        .collect();
    let contour = identified.machine.contour.as_ref().map(|contour| {
        json!({
            "axes": contour.plane.map(|i| identified.machine.axes[i].name.clone()),
            "measured_um": contour.measured_um,
            "free_run_um": contour.grey_box_um,
            "arx": { "free_run_um": contour.arx_um },
        })
    });
    let value = json!({
        "log": identified.job.name,
        "log_format": identified.log.format.to_string(),
        "sample_time_s": identified.log.sample_time_s,
        "samples": identified.log.time_s.len(),
        "of_samples": identified.of_samples,
        "findings": identified.log.findings.iter().map(ToString::to_string).collect::<Vec<_>>(),
        "advice": identified.advice(),
        "improvements": identified.improvements(),
        "contour": contour,
        "axes": axes,
    });
    write_json(out, &stamped(value))
}

fn axis(identified: &LogIdentified, i: usize, found: &FoundAxis) -> Value {
    let scores = &found.scores;
    let arx: Vec<Value> = scores
        .arx
        .iter()
        .map(|(arx, errors)| json!({ "lags": arx.lags, "signs": arx.signs, "free_run_um": horizons(errors), "one_step_um": errors.one_step_um }))
        .collect();
    let parameters: Map<String, Value> = found
        .numbers()
        .into_iter()
        .map(|number| {
            let value = json!({
                "name": number.name,
                "value": number.value,
                "unit": number.unit,
                "interval": number.interval,
                "identifiable": number.source != NumberSource::Assumed,
                "source": number.source.word(),
            });
            (number.key.to_owned(), value)
        })
        .collect();
    let beyond = scores
        .beyond
        .map(|(um, share)| json!({ "free_run_um": um, "share": share }));
    json!({
        "following_um": scores.following_um,
        "fit_um": found.fit_um,
        "free_run_um": horizons(&scores.grey_box),
        "one_step_um": scores.grey_box.one_step_um,
        "beyond_training": beyond,
        "arx": { "free_run_um": horizons(&scores.best_arx()), "one_step_um": scores.best_arx().one_step_um, "models": arx },
        "stays": { "free_run_um": horizons(&scores.stays) },
        "whiteness": {
            "one_step_correlation": scores.innovation_correlation,
            "free_run_correlation": scores.residual_correlation,
        },
        "parameters": parameters,
        "unseen_motion": {
            "uncertain_um": found.unseen.uncertain_um,
            "left_um": found.unseen.left_um,
            "open": found.unseen.is_open(),
            "parameters": found.unseen.terms.iter().map(|term| term.key()).collect::<Vec<_>>(),
        },
        "at_bounds": found.at_bounds.iter().map(|at| json!({ "parameter": at.term.key(), "value": at.value, "bound": at.bound })).collect::<Vec<_>>(),
        "next_motion": identified
            .next_motion_of(i)
            .map(|motion| motion.parts.iter().map(|part| part.word()).collect::<Vec<_>>())
            .unwrap_or_default(),
        "verdict": identified.verdict(i),
    })
}

/// Errors by horizon; what is lost is null.
fn horizons(errors: &FreeRunErrors) -> Value {
    let mut map = Map::new();
    for ((_, name), um) in HORIZONS.iter().zip(errors.at_um) {
        map.insert((*name).to_owned(), json!(um));
    }
    map.insert("whole".to_owned(), json!(errors.whole_um));
    Value::Object(map)
}
