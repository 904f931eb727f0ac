//! What every report page keeps to: complete without scripts, no request, nothing from a program
//! becomes markup, equal reports give equal bytes, bounded size.

use crate::made_up_report::{HOSTILE, page, report, report_with_log};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use feedwright::{PageUnits, Report, Series, write_html_in};
use feedwright_sim::Outcome;

/// Largest page for two controllers and three axes at full resolution, bytes.
const LARGEST_PAGE: usize = 2_000_000;

/// The data of a page.
fn embedded_data(page: &str) -> serde_json::Value {
    let start = page.find("id=\"data\">").unwrap() + "id=\"data\">".len();
    let end = start + page[start..].find("</script>").unwrap();
    let json =
        miniz_oxide::inflate::decompress_to_vec(&STANDARD.decode(&page[start..end]).unwrap())
            .unwrap();
    serde_json::from_slice(&json).unwrap()
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
    assert_eq!(
        (
            page.matches("<script").count(),
            page.matches("</script>").count()
        ),
        (3, 3)
    );
    assert_eq!(
        (page.matches("<img").count(), page.matches("<!--").count()),
        (0, 0)
    );
    assert_eq!(
        embedded_data(&page)["meta"]["runs"][0]["controller"],
        HOSTILE
    );
}

#[test]
fn nothing_is_fetched() {
    let page = page(&report(2, 500));
    assert!(page.contains("default-src 'none'"));
    for reference in [
        " src=\"",
        "@import",
        "url(",
        "href=\"http",
        "fetch(",
        "XMLHttpRequest",
        "unsafe-",
        " style=\"",
    ] {
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
            assert!(
                markup.contains(&format!("{:.2}</td>", place.error_um)),
                "{place:?}"
            );
            assert!(
                markup.contains(&format!("<td>{:.3}</td>", place.t_s)),
                "{place:?}"
            );
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
    for (i, (run, columns)) in report
        .runs
        .iter()
        .zip(data["runs"].as_array().unwrap())
        .enumerate()
    {
        let error_mm = data["meta"]["runs"][i]["error_mm"].as_f64().unwrap();
        assert!(error_mm * 5e2 < run.summary.max_um * 1e-3, "{error_mm}");
        let points: Vec<_> = run.series.points().collect();
        let times = column(&columns["t"], unit("time_s"));
        let errors = column(&columns["e"], error_mm);
        let foot_z = column(&columns["fz"], unit("point_mm"));
        assert!(
            columns
                .as_object()
                .unwrap()
                .values()
                .all(|c| c.as_array().unwrap().len() == points.len())
        );
        for (i, p) in points.iter().enumerate() {
            assert!((times[i] - p.t_s).abs() <= 0.51 * unit("time_s"));
            assert!((errors[i] - p.error_mm).abs() <= 0.51 * error_mm);
            assert!((foot_z[i] - p.foot_mm[2]).abs() <= 0.51 * unit("point_mm"));
        }
    }
}

/// The headline says that it is simulated, what it costs and what was assumed; a log has no torque,
/// in the table nor in the data.
#[test]
fn the_headline_states_the_cost_and_a_log_has_no_torque() {
    let simulated = page(&report(2, 2000));
    for text in [
        ">simulated</span>",
        "uncut path",
        "peak torque of",
        "command beside the program",
        "largest acceleration",
    ] {
        assert!(simulated.contains(text), "{text}");
    }
    assert!(simulated.contains("<b>Assumed</b> the machine is"));
    let report = report_with_log(2, 2000);
    let with_log = page(&report);
    assert!(
        with_log.contains("simulated, beside a log")
            && with_log.contains("Measured on the machine")
    );
    let row = with_log.split("role=\"rowheader\"").nth(2).unwrap();
    assert!(
        row.contains("data-label=\"Peak torque X, N m\">–</td>"),
        "{}",
        row.split("</tr>").next().unwrap()
    );
    let data = embedded_data(&with_log);
    let has_torque = |run: usize| {
        data["runs"][run]
            .as_object()
            .unwrap()
            .contains_key("torque_x")
    };
    assert!(has_torque(0) && !has_torque(1) && has_torque(2));
    assert!(
        serde_json::to_value(&report.runs[1].summary)
            .unwrap()
            .get("peak_torque_nm")
            .is_none()
    );
}

#[test]
fn a_full_record_is_a_page_of_bounded_size() {
    let report = report(3, Series::MAX_POINTS);
    assert_eq!(report.runs[0].series.points().len(), Series::MAX_POINTS);
    let size = page(&report).len();
    println!(
        "two controllers, three axes, {} points each: {size} bytes",
        Series::MAX_POINTS
    );
    assert!(size < LARGEST_PAGE, "{size}");
}

#[test]
fn a_report_without_runs_or_rows_is_still_a_page() {
    let empty = Report {
        runs: vec![],
        ..report(2, 1)
    };
    assert!(page(&empty).contains("No run was made"));
    let mut bare = report(2, 1);
    bare.runs[1].series = Series::new();
    bare.runs[1].summary.outcome = Outcome::Diverged { at_s: 0.25 };
    assert!(page(&bare).contains("diverged at 0.25 s"));
}

/// An inch is to a thousandth what a millimeter is to a micrometer.
const INCH_MM: f64 = 25.4;

#[test]
fn a_page_in_inches_is_the_metric_page_with_other_numbers_and_units() {
    let report = report(3, 2000);
    let mut inches = Vec::new();
    write_html_in(&mut inches, &report, PageUnits::Inch).unwrap();
    let (metric, inches) = (page(&report), String::from_utf8(inches).unwrap());
    let markup = |page: &str| page[..page.find("<script").unwrap()].to_owned();
    let tables = |page: &str| markup(page).matches("<table").count();
    assert_eq!(tables(&metric), tables(&inches));
    for unit in ["<i>µm</i>", "<i>mm</i>", " µm<", " µm)", ", µm\""] {
        assert!(!markup(&inches).contains(unit), "{unit}");
    }
    assert!(markup(&inches).contains("<i>thou</i>") && markup(&inches).contains("<i>in</i>"));
    for place in &report.runs[0].summary.worst {
        let error = format!("{:.3}</td>", place.error_um / INCH_MM);
        let length = format!("<td>{:.3}</td></tr>", place.s_mm / INCH_MM);
        assert!(
            markup(&inches).contains(&error) && markup(&inches).contains(&length),
            "{error} {length}"
        );
    }
    let [metric, inches] = [metric, inches].map(|page| embedded_data(&page));
    assert_eq!(
        inches["meta"]["names"],
        serde_json::json!(["thou", "in", "in/min"])
    );
    assert_eq!(
        metric["meta"]["names"],
        serde_json::json!(["µm", "mm", "mm/min"])
    );
    // The columns are the same counts of other units.
    assert_eq!(metric["runs"], inches["runs"]);
    for key in [
        "/meta/units/length_mm",
        "/meta/units/feed_mm_s",
        "/meta/tolerance_um",
        "/meta/runs/0/max_um",
        "/meta/circles/0/radius_mm",
    ] {
        let [of_metric, of_inches] =
            [&metric, &inches].map(|data| data.pointer(key).unwrap().as_f64().unwrap());
        assert!(
            (of_metric / of_inches - INCH_MM).abs() < 1e-9 * INCH_MM,
            "{key}: {of_metric} {of_inches}"
        );
    }
    assert_eq!(
        metric["meta"]["units"]["accel_m_s2"],
        inches["meta"]["units"]["accel_m_s2"]
    );
}
