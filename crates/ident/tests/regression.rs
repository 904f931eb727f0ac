//! One test for each repaired fault.

use crate::sweep::part_or_whole;
use feedwright_ident::{
    AxisFacts, Fitness, FoundAxis, GreyBoxOptions, Log, LogAxis, LogFormat, ModelTerm,
    ModelVerdict, NotFound, SearchBound, TorqueUnit, identify_machine,
};

/// Kp Kv / J, 1/s2, (Kv + B) / J, 1/s, and Fc / J, mm/s2, of the axis that is recorded.
const MODEL: [f64; 3] = [8000.0, 160.0, 50.0];
/// Ends of strokes, mm, and their speeds, mm/s.
const STROKES: [[f64; 2]; 8] = [
    [15.0, 100.0],
    [0.0, 100.0],
    [8.0, 20.0],
    [0.0, 60.0],
    [15.0, 40.0],
    [3.0, 10.0],
    [12.0, 80.0],
    [0.0, 30.0],
];
const ACCEL_MM_S2: f64 = 1500.0;
const REST_S: f64 = 0.2;
/// Steps of the integration in a sample.
const STEPS: usize = 20;

/// Commands: strokes with a trapezoidal speed and rests between them, mm.
fn command_mm(sample_s: f64, samples: usize) -> Vec<f64> {
    let mut way_mm = vec![0.0];
    for [end_mm, speed_mm_s] in STROKES.into_iter().cycle() {
        let from_mm = way_mm[way_mm.len() - 1];
        let (length_mm, way): (f64, f64) = ((end_mm - from_mm).abs(), (end_mm - from_mm).signum());
        let peak_mm_s = speed_mm_s.min((ACCEL_MM_S2 * length_mm).sqrt());
        let (ramp_s, time_s) = (
            peak_mm_s / ACCEL_MM_S2,
            length_mm / peak_mm_s + peak_mm_s / ACCEL_MM_S2,
        );
        let gone_mm = |t: f64| match time_s - t {
            left if left <= 0.0 => length_mm,
            left if left < ramp_s => length_mm - 0.5 * ACCEL_MM_S2 * left * left,
            _ if t < ramp_s => 0.5 * ACCEL_MM_S2 * t * t,
            _ => peak_mm_s * (t - 0.5 * ramp_s),
        };
        let count = ((time_s + REST_S) / sample_s) as usize;
        way_mm.extend((1..=count).map(|k| from_mm + way * gone_mm(k as f64 * sample_s)));
        if way_mm.len() >= samples {
            way_mm.truncate(samples);
            return way_mm;
        }
    }
    way_mm
}

/// Actual positions of the axis on these commands, in steps of 10 nm, mm.
fn actual_mm(command_mm: &[f64], sample_s: f64) -> Vec<f64> {
    let [gain, damping, friction] = MODEL;
    let (mut at_mm, mut speed_mm_s) = (command_mm[0], 0.0_f64);
    let step_s = sample_s / STEPS as f64;
    let follow = |&command_mm: &f64| {
        let before_mm = at_mm;
        for _ in 0..STEPS {
            let force = gain * (command_mm - at_mm)
                - damping * speed_mm_s
                - friction * (speed_mm_s / 0.1).tanh();
            speed_mm_s += step_s * force;
            at_mm += step_s * speed_mm_s;
        }
        (before_mm * 1e5).round() / 1e5
    };
    command_mm.iter().map(follow).collect()
}

/// Identifies a record whose actual positions are `late` samples later than its commands, in
/// addition to the delay of the axis.
fn found(
    sample_s: f64,
    seconds: f64,
    late: isize,
    facts: AxisFacts,
) -> Result<FoundAxis, NotFound> {
    let all_mm = command_mm(sample_s, (seconds / sample_s) as usize);
    let actual_mm = actual_mm(&all_mm, sample_s);
    let cut = late.unsigned_abs();
    let kept = all_mm.len() - cut;
    let [command_mm, actual_mm] = if late < 0 {
        [&all_mm[..kept], &actual_mm[cut..]]
    } else {
        [&all_mm[cut..], &actual_mm[..kept]]
    };
    let axis = LogAxis {
        name: "x".to_owned(),
        command_mm: command_mm.to_vec(),
        actual_mm: actual_mm.to_vec(),
        torque: None,
        torque_unit: TorqueUnit::Unknown,
        step_mm: 1e-5,
        verdict: Fitness::ForControl,
    };
    let log = Log {
        format: LogFormat::TextTable,
        sample_time_s: sample_s,
        stretches: std::iter::once(0..kept).collect(),
        time_s: (0..kept).map(|k| k as f64 * sample_s).collect(),
        axes: vec![axis],
        still: vec![],
        findings: vec![],
    };
    let options = GreyBoxOptions {
        facts: vec![facts],
        ..GreyBoxOptions::default()
    };
    let mut machine = identify_machine(&log, &options, |_| true)?;
    Ok(machine.axes.remove(0))
}

/// Returns true if the verdict permits the use of the model.
fn holds(axis: &FoundAxis) -> bool {
    matches!(
        ModelVerdict::of(axis),
        ModelVerdict::ModelHolds | ModelVerdict::LinearSuffices
    )
}

/// The largest part by which the two gains are off.
fn off(axis: &FoundAxis) -> f64 {
    let part = |term, wanted: f64| (axis.axis_model().get(term) / wanted - 1.0).abs();
    part(ModelTerm::LoopGain, MODEL[0]).max(part(ModelTerm::Damping, MODEL[1]))
}

/// The gains of a record of 3 ms are known to this part: the axis is sampled coarsely.
const GAINS: f64 = 0.1;

/// A search that ended at 0.1 s gave 4,174 1/s2 of 8,000 for a record that is 0.105 s late, and
/// reported that the model holds.
#[test]
fn a_record_that_is_a_tenth_of_a_second_late_gives_the_model_of_the_axis() {
    let all = [(0.003, 9.0, 35), (0.003, 9.0, 80), (0.002, 6.0, 75)];
    for &(sample_s, seconds, late) in &all[..part_or_whole(1, all.len())] {
        let axis = found(sample_s, seconds, late, AxisFacts::default()).unwrap();
        let wanted_s = late as f64 * sample_s;
        let late_s = axis.axis_model().get(ModelTerm::RecordDelay);
        assert!(
            (late_s - wanted_s).abs() < 2e-3,
            "{late_s} s, not {wanted_s} s"
        );
        assert!(
            off(&axis) < GAINS,
            "{late_s} s late: {:?}",
            axis.axis_model()
        );
        assert!(axis.at_bounds.is_empty(), "{:?}", axis.at_bounds);
    }
}

/// A model with a value at an end of its search was once accepted, however wrong its other values
/// were.
#[test]
fn a_value_that_ends_where_its_search_ends_never_holds() {
    let on_time = AxisFacts {
        record_delay_s: Some(0.0),
        ..AxisFacts::default()
    };
    let all = [
        // Actual positions before their commands.
        (-3, AxisFacts::default(), ModelTerm::RecordDelay),
        (-6, AxisFacts::default(), ModelTerm::RecordDelay),
        // A record that is late, and said to be on time.
        (20, on_time, ModelTerm::LoopDelay),
    ];
    for &(late, facts, at) in &all[..part_or_whole(1, all.len())] {
        let axis = found(0.003, 9.0, late, facts).unwrap();
        assert!(off(&axis) > GAINS, "{late}: {:?}", axis.axis_model());
        assert!(!holds(&axis), "{late}: {:?}", axis.axis_model());
        let bound = axis.at_bounds.iter().find(|bound| bound.term == at);
        let SearchBound { value, .. } =
            bound.unwrap_or_else(|| panic!("{late}: {:?}", axis.at_bounds));
        let words = ModelVerdict::of(&axis).words(&axis);
        let unit = format!("{value:.4} s, where its search ends");
        assert!(
            words.contains(&unit) && words.contains(bound.unwrap().remedy()),
            "{words}"
        );
    }
}
