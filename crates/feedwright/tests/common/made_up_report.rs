//! A report of two made-up runs, in which every text is hostile to the page.

use feedwright::{
    Assumptions, DrawnLimits, ErrorSpectrum, FullCircle, ProgramLine, Report, ReportedRun, Role,
    Roundness, RunFacts, Series, Statistics, TimelineEvent, write_html,
};
use feedwright_sim::{Commanded, Row, Sink};

pub(crate) const HOSTILE: &str =
    "</script><script>document.title='x'</script><img src=x onerror=alert(1)>\"'&\u{2028}<!--";

fn made_up_run(
    role: Role,
    controller: &str,
    axes: usize,
    rows: usize,
    size_mm: f64,
) -> ReportedRun {
    let (mut series, mut statistics) = (Series::new(), Statistics::new());
    let mut spectrum = ErrorSpectrum::new(axes, 1e-3);
    // Noise of a linear congruential generator: smooth signals would make the page smaller than a
    // real one.
    let mut state = 1u64;
    let mut noise = || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
    };
    for k in 0..rows {
        let t_s = k as f64 * 1e-3;
        let z = if axes == 3 { 5.0 * t_s.sin() } else { 0.0 };
        let path_mm = [40.0 * (1.3 * t_s).cos(), 40.0 * t_s.sin(), z];
        let act_mm = path_mm.map(|x| x + 0.1 * size_mm * noise());
        let error_mm = size_mm * ((3.0 * t_s).sin() + 0.05 * noise());
        let row = Row {
            t_s,
            s_mm: 40.0 * t_s,
            line: 10 + k as u32 / 100,
            feed_plan_mm_s: 40.0,
            programmed_mm_s: 0.0,
            cutting: k > rows / 50,
            commanded: Commanded::Cut,
            path_mm,
            cmd_mm: path_mm,
            corrected_mm: path_mm,
            act_mm,
            torque_nm: [0.1 * noise(), 0.1 * noise(), 0.1 * noise()],
            foot_mm: path_mm,
            tangent: [1.0, 0.0, 0.0],
            contour_error_mm: if axes == 3 { error_mm.abs() } else { error_mm },
        };
        series.row(&row).unwrap();
        statistics.row(&row).unwrap();
        spectrum.row(&row).unwrap();
    }
    let facts = RunFacts {
        controller: controller.to_owned(),
        machine: HOSTILE.to_owned(),
        part: HOSTILE.to_owned(),
        axes,
        role,
        drives: None,
        run: feedwright_sim::RunResult {
            time_s: rows as f64 * 1e-3,
            ..Default::default()
        },
    };
    let radial_um: Vec<_> = (0..720)
        .map(|k| Some(1e3 * size_mm * f64::from(k % 90) / 90.0))
        .collect();
    let roundness = Roundness {
        circular_deviation_um: 1e3 * size_mm,
        radial_max_um: 1e3 * size_mm,
        radial_min_um: 0.0,
        radial_um,
    };
    let event = TimelineEvent {
        t_s: 0.1,
        duration_s: 0.5,
        line: 3,
        row: HOSTILE.to_owned(),
        label: HOSTILE.to_owned(),
    };
    ReportedRun {
        summary: statistics.summary(facts, |_| HOSTILE.to_owned()),
        series,
        spectrum: spectrum.bands(),
        roundness: vec![Some(roundness)],
        events: vec![event],
    }
}

/// The same with a run of a log between the two.
pub(crate) fn report_with_log(axes: usize, rows: usize) -> Report {
    let mut report = report(axes, rows);
    report.runs.insert(
        1,
        made_up_run(Role::Measured, "measured", axes, rows, 0.025),
    );
    report
}

pub(crate) fn report(axes: usize, rows: usize) -> Report {
    Report {
        title: HOSTILE.to_owned(),
        part: HOSTILE.to_owned(),
        machine: vec![(HOSTILE.to_owned(), HOSTILE.to_owned())],
        settings: vec![(HOSTILE.to_owned(), HOSTILE.to_owned())],
        geometry: None,
        assumed: Assumptions {
            machine: HOSTILE.to_owned(),
            description: HOSTILE.to_owned(),
            machine_source: HOSTILE.to_owned(),
            model_from: HOSTILE.to_owned(),
            ..Assumptions::default()
        },
        program: (1..30)
            .map(|line| ProgramLine {
                line,
                text: HOSTILE.to_owned(),
            })
            .collect(),
        circles: vec![FullCircle {
            line: 12,
            center_mm: [0.0; 3],
            radius_mm: 40.0,
            plane: "XY",
            counter_clockwise: true,
            s_mm: [0.0, 251.0],
        }],
        tolerance_um: Some(10.0),
        limits: None,
        axis_limits: vec![
            DrawnLimits {
                torque_nm: 3.0,
                accel_mm_s2: Some(900.0)
            };
            axes
        ],
        band: None,
        runs: vec![
            made_up_run(Role::Reference, HOSTILE, axes, rows, 0.03),
            made_up_run(Role::Corrected, "corrected", axes, rows, 0.005),
        ],
    }
}

pub(crate) fn page(report: &Report) -> String {
    let mut out = Vec::new();
    write_html(&mut out, report).unwrap();
    String::from_utf8(out).unwrap()
}
