//! What an identification writes: JSON with what it promises, a machine file that reads back, a
//! page that refers to nothing outside.

use crate::identification_log::{commands_mm, drawn, log_of};
use feedwright::{LogJob, LogJobError, machine_text, write_json, write_page};
use feedwright_sim::Machine;

/// Needs 11 s of processor time: identifies two axes.
#[test]
fn files_hold_what_they_promise() {
    let machine = Machine::load("stiff".as_ref()).unwrap();
    let found = LogJob {
        name: "a <log>\n.csv".to_owned(),
        ..LogJob::default()
    }
    .run(log_of(&machine, 5.0, 1.0, 5), &())
    .unwrap();
    let mut json = vec![];
    write_json(&mut json, &found).unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    for name in ["x", "y"] {
        let axis = &json["axes"][name];
        assert!(axis["following_um"].as_f64().unwrap() > 0.0);
        for horizon in ["20ms", "50ms", "100ms", "whole"] {
            assert!(
                axis["free_run_um"][horizon].as_f64().unwrap() >= 0.0,
                "{name} {horizon}"
            );
            let arx = &axis["arx"]["free_run_um"][horizon];
            assert!(
                arx.is_null() || arx.as_f64().unwrap() >= 0.0,
                "{name} {horizon}"
            );
        }
        let parameters = axis["parameters"].as_object().unwrap();
        for key in [
            "kp_kv_over_j_1_s2",
            "kv_plus_b_over_j_1_s",
            "fc_over_j_mm_s2",
            "offset_over_j_mm_s2",
        ] {
            assert!(parameters[key]["identifiable"].as_bool().unwrap(), "{key}");
            assert_eq!(
                parameters[key]["interval"].as_array().unwrap().len(),
                2,
                "{key}"
            );
        }
        assert_eq!(parameters["inertia_kg_m2"]["identifiable"], false);
        assert!(!axis["verdict"].as_str().unwrap().is_empty());
    }
    let mine = Machine::parse("mine.toml", &machine_text(&found, "mine")).unwrap();
    assert_eq!(
        (mine.axis_count(), mine.period.servo_s),
        (2, machine.period.servo_s)
    );
    let mut page = vec![];
    write_page(&mut page, &found).unwrap();
    let page = String::from_utf8(page).unwrap();
    assert!(page.contains("a &lt;log&gt;") && !page.contains("NaN"));
    // The name space of a drawing is no reference.
    assert!(
        !page
            .replace("http://www.w3.org/2000/svg", "")
            .contains("://")
    );
}

#[test]
fn what_determines_no_model_is_refused_with_the_reason() {
    let machine = Machine::load("tnv40".as_ref()).unwrap();
    let good = log_of(&machine, 4.0, 0.0, 9);
    let refused = |log, job: LogJob| match job.run(log, &()).unwrap_err() {
        LogJobError::NotFound(reason) => reason.to_string(),
        LogJobError::Cancelled(_) => panic!("nobody ended it"),
    };
    let times = |from: f64, to: f64| LogJob {
        times_s: Some([from..to, 3.0..4.0]),
        ..LogJob::default()
    };
    let text = refused(good.clone(), times(10.0, 20.0));
    assert!(
        text.starts_with("--fit has 0 samples") && text.contains("0.000 to 3.999 s"),
        "{text}"
    );
    let mut still = good.clone();
    still.axes[1].command_mm.fill(1.0);
    let text = refused(still, times(0.0, 3.0));
    assert!(text.starts_with("axis y does not move"), "{text}");
    // The actual position of another motion.
    let mut strange = good;
    let mut state = 1;
    strange.axes[0].actual_mm = commands_mm(0.001, 4.0, 99)
        .iter()
        .map(|mm| mm + 5.0 * drawn(&mut state))
        .collect();
    strange.axes.truncate(1);
    let text = match times(0.0, 3.0).run(strange, &()) {
        Err(LogJobError::NotFound(reason)) => reason.to_string(),
        Err(LogJobError::Cancelled(_)) => panic!("nobody ended it"),
        Ok(found) => found.verdict(0),
    };
    let is_none = text.starts_with("not known") || text.starts_with("not good enough for control");
    assert!(text.contains("leaves") || is_none, "{text}");
}
