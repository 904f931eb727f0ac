//! What every report page keeps to: complete without scripts, no request, nothing from a program becomes markup, equal
//! reports give equal bytes, bounded size.

#![expect(clippy::unwrap_used, reason = "a test stops at what it did not expect")]

#[path = "common/missing.rs"]
mod missing;

use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use feedwright::report::{Outcome, Report, ReportedRun, RunFacts, Series, Statistics, TimelineEvent, write_html};
use feedwright::trace::{Commanded, Row, Sink};
use missing::missing;

const HOSTILE: &str = "</script><script>document.title='x'</script><img src=x onerror=alert(1)>\"'&\u{2028}<!--";

/// Largest page for two controllers and three axes at full resolution, bytes.
const LARGEST_PAGE: usize = 3_000_000;

fn run(controller: &str, axes: usize, rows: usize, size_mm: f64) -> ReportedRun {
    let (mut series, mut statistics) = (Series::new(), Statistics::new());
    // Noise of a linear congruential generator: smooth signals would make the page smaller than a real one.
    let mut state = 1u64;
    let mut noise = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
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
            cutting: k > rows / 50,
            commanded: Commanded::Cut,
            path_mm,
            cmd_mm: path_mm,
            act_mm,
            torque_nm: [0.1 * noise(), 0.1 * noise(), 0.1 * noise()],
            foot_mm: path_mm,
            tangent: [1.0, 0.0, 0.0],
            contour_error_mm: if axes == 3 { error_mm.abs() } else { error_mm },
        };
        series.row(&row).unwrap();
        statistics.row(&row).unwrap();
    }
    let facts = RunFacts {
        controller: controller.to_owned(),
        machine: HOSTILE.to_owned(),
        part: HOSTILE.to_owned(),
        axes,
        run: feedwright::simulate::RunResult { time_s: rows as f64 * 1e-3, ..Default::default() },
    };
    let event =
        TimelineEvent { t_s: 0.1, duration_s: 0.5, line: 3, row: HOSTILE.to_owned(), label: HOSTILE.to_owned() };
    ReportedRun { summary: statistics.summary(facts, |_| HOSTILE.to_owned()), series, events: vec![event] }
}

fn report(axes: usize, rows: usize) -> Report {
    Report {
        assumed: feedwright::report::Assumptions::default(),
        title: HOSTILE.to_owned(),
        part: HOSTILE.to_owned(),
        machine: vec![(HOSTILE.to_owned(), HOSTILE.to_owned())],
        settings: vec![(HOSTILE.to_owned(), HOSTILE.to_owned())],
        tolerance_um: Some(10.0),
        runs: vec![run(HOSTILE, axes, rows, 0.03), run("corrected", axes, rows, 0.005)],
    }
}

fn page(report: &Report) -> String {
    let mut out = Vec::new();
    write_html(&mut out, report).unwrap();
    String::from_utf8(out).unwrap()
}

/// The data of a page.
fn embedded_data(page: &str) -> serde_json::Value {
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    serde_json::from_str(&page[start..end]).unwrap()
}

fn column(value: &serde_json::Value, unit: f64) -> Vec<f64> {
    let mut sum = 0;
    let add = |d: &serde_json::Value| {
        sum += d.as_i64().unwrap();
        sum as f64 * unit
    };
    value.as_array().unwrap().iter().map(add).collect()
}

#[test]
fn program_text_never_becomes_markup() {
    let page = page(&report(2, 500));
    assert_eq!((page.matches("<script").count(), page.matches("</script>").count()), (3, 3));
    assert_eq!((page.matches("<img").count(), page.matches("<!--").count()), (0, 0));
    assert_eq!(embedded_data(&page)["meta"]["runs"][0]["controller"], HOSTILE);
}

#[test]
fn nothing_is_fetched() {
    let page = page(&report(2, 500));
    assert!(page.contains("default-src 'none'"));
    for reference in [" src=\"", "@import", "url(", "href=\"http", "fetch(", "XMLHttpRequest"] {
        assert!(!page.contains(reference), "{reference}");
    }
}

#[test]
fn the_numbers_are_there_without_scripts() {
    let report = report(3, 8000);
    let page = page(&report);
    let markup = &page[..page.find("<script").unwrap()];
    assert!(markup.contains("<noscript>"));
    for run in &report.runs {
        assert!(run.summary.worst.len() >= 5, "{:?}", run.summary.worst);
        for place in &run.summary.worst {
            assert!(markup.contains(&format!("{:.2}</td>", place.error_um)), "{place:?}");
            assert!(markup.contains(&format!("<td>{:.3}</td>", place.t_s)), "{place:?}");
        }
    }
    assert!(markup.contains("Peak torque Z") && markup.contains("µm"));
}

#[test]
fn equal_reports_give_equal_bytes() {
    assert_eq!(page(&report(3, 3000)), page(&report(3, 3000)));
}

#[test]
fn the_data_are_the_series() {
    let report = report(3, 3000);
    let data = embedded_data(&page(&report));
    let units = &data["meta"]["units"];
    let unit = |name: &str| units[name].as_f64().unwrap();
    for (run, columns) in report.runs.iter().zip(data["runs"].as_array().unwrap()) {
        let points: Vec<_> = run.series.points().collect();
        let times = column(&columns["t"], unit("time_s"));
        let errors = column(&columns["e"], unit("error_mm"));
        let foot_z = column(&columns["fz"], unit("point_mm"));
        assert!(columns.as_object().unwrap().values().all(|c| c.as_array().unwrap().len() == points.len()));
        for (i, p) in points.iter().enumerate() {
            assert!((times[i] - p.t_s).abs() <= 0.51 * unit("time_s"));
            assert!((errors[i] - p.error_mm).abs() <= 0.51 * unit("error_mm"));
            assert!((foot_z[i] - p.foot_mm[2]).abs() <= 0.51 * unit("point_mm"));
        }
    }
}

#[test]
fn a_full_record_is_a_page_of_bounded_size() {
    let report = report(3, Series::MAX_POINTS);
    assert_eq!(report.runs[0].series.points().len(), Series::MAX_POINTS);
    let size = page(&report).len();
    println!("two controllers, three axes, {} points each: {size} bytes", Series::MAX_POINTS);
    assert!(size < LARGEST_PAGE, "{size}");
}

#[test]
fn a_report_without_runs_or_rows_is_still_a_page() {
    let empty = Report { runs: vec![], ..report(2, 1) };
    assert!(page(&empty).contains("No run was made"));
    let mut bare = report(2, 1);
    bare.runs[1].series = Series::new();
    bare.runs[1].summary.outcome = Outcome::Diverged { at_s: 0.25 };
    assert!(page(&bare).contains("diverged at 0.25 s"));
}

/// The page's scripts run to their end in a browser. Where there is none, it says so, and under CI fails.
#[test]
fn the_scripts_run_in_a_browser() {
    let directory = tempfile::tempdir().unwrap();
    let file = directory.path().join("page.html");
    std::fs::write(&file, page(&report(3, 2000))).unwrap();
    let browsers = ["chromium", "chromium-browser", "google-chrome"];
    let Some(mut child) = browsers.iter().find_map(|browser| {
        Command::new(browser)
            .args(["--headless", "--no-sandbox", "--disable-gpu", "--no-first-run"])
            .arg("--disable-background-networking")
            .arg(format!("--user-data-dir={}", directory.path().join("profile").display()))
            .args(["--virtual-time-budget=5000", "--dump-dom"])
            .arg(format!("file://{}", file.display()))
            .stdout(std::fs::File::create(directory.path().join("dom.html")).unwrap())
            .stderr(Stdio::null())
            .spawn()
            .ok()
    }) else {
        missing(&format!("none of {browsers:?} is installed"));
        return;
    };
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > Duration::from_secs(60) {
            child.kill().unwrap();
            child.wait().unwrap();
            missing("the browser did not answer");
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    let dom = std::fs::read_to_string(directory.path().join("dom.html")).unwrap();
    if dom.is_empty() {
        missing("the browser did not start");
        return;
    }
    let head = &dom[..dom.find("<head").unwrap()];
    assert!(head.contains("data-ready"), "the scripts stopped: {head}");
    assert!(dom.contains("path-view") && dom.contains("u-over"));
}
