//! The pages in a browser: no fault in the console, and each action with mouse, keys and fingers
//! has its effect.

use std::io::Write;
use std::path::PathBuf;

use crate::browser::Browser;
use feedwright::{
    COLORS, CaptionedFigure, Figure, PagePart, Panel, Polyline, write_figure_page, write_foot,
    write_head, write_table_end, write_table_head,
};
use serde_json::json;

/// A page as a file in a folder that lives as long.
fn file(html: &str) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("page.html");
    std::fs::write(&path, html).unwrap();
    (folder, path)
}

/// Script that returns true if every canvas of the page has something on it.
const ALL_PAINTED: &str = "[...document.querySelectorAll('#plots canvas, #others canvas, .path-view canvas:first-of-type')].every((canvas) => {
    const empty = Object.assign(document.createElement('canvas'), { width: canvas.width, height: canvas.height });
    return canvas.toDataURL() !== empty.toDataURL();
})";

const WITHIN_THE_SCREEN: &str = "document.documentElement.scrollWidth <= innerWidth";

/// Returns the picture on a canvas.
fn picture(browser: &mut Browser, selector: &str) -> String {
    let drawn = browser.value(&format!(
        "document.querySelector({}).toDataURL()",
        json!(selector)
    ));
    drawn.as_str().unwrap().to_owned()
}

fn text(browser: &mut Browser, selector: &str) -> String {
    browser
        .value(&format!(
            "document.querySelector({}).textContent",
            json!(selector)
        ))
        .as_str()
        .unwrap()
        .to_owned()
}

fn ready(browser: &mut Browser) {
    browser.until("document.documentElement.dataset.ready === ''");
    browser.frames();
}

#[test]
fn the_report_answers_mouse_and_keys() {
    let (_folder, path) = file(&crate::made_up_report::page(
        &crate::made_up_report::report(2, 3000),
    ));
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.screen(1400, 1000, false);
    for fragment in ["#theme=dark", "#theme=light&error=log", ""] {
        browser.open(&path, fragment);
        ready(&mut browser);
        browser.until(ALL_PAINTED);
        assert_eq!(browser.faults(), [""; 0], "{fragment}");
    }
    assert_eq!(
        browser.value("document.querySelectorAll('.polar').length"),
        2
    );
    legend(&mut browser);
    scales(&mut browser);
    play(&mut browser);
    zoom(&mut browser);
    assert_eq!(browser.faults(), [""; 0]);
}

/// Script that returns the largest overlap of the path panel with the charts below it, over all
/// scroll positions, px.
const OVERLAP: &str = "(() => {
    const box = (selector) => document.querySelector(selector).getBoundingClientRect();
    let most = -Infinity;
    for (let y = 0; y < document.documentElement.scrollHeight; y += 50) {
        scrollTo(0, y);
        most = Math.max(most, box('.path-panel').bottom - box('#others').top);
    }
    scrollTo(0, 0);
    return most;
})()";

/// The picture of the part is on the first screen, and the panel that stays beside the curves
/// covers no chart.
#[test]
fn the_part_is_on_the_first_screen_and_covers_nothing() {
    let (_folder, path) = file(&crate::made_up_report::page(
        &crate::made_up_report::report(2, 3000),
    ));
    let Some(mut browser) = Browser::start() else {
        return;
    };
    for (width, height) in [(1440, 900), (1920, 1080)] {
        browser.screen(width, height, false);
        browser.open(&path, "");
        ready(&mut browser);
        let end = browser
            .value("document.querySelector('#views').getBoundingClientRect().bottom")
            .as_f64()
            .unwrap();
        assert!(
            end <= f64::from(height),
            "{width} by {height}: the picture ends at {end}"
        );
        let overlap = browser.value(OVERLAP).as_f64().unwrap();
        assert!(
            overlap <= 0.0,
            "{width} by {height}: {overlap} px of the charts are covered"
        );
    }
    let titles = text(&mut browser, "#plots");
    assert!(
        titles.contains("Torque X, N m · limit ±3.00")
            && titles.contains("Command acceleration X, m/s² · limit ±0.90")
    );
    assert_eq!(browser.faults(), [""; 0]);
}

/// A run from a log has no torque. The page shows a dash for it and reports no faults.
#[test]
fn a_measured_run_is_drawn_without_torque() {
    let (_folder, path) = file(&crate::made_up_report::page(
        &crate::made_up_report::report_with_log(2, 1500),
    ));
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.screen(1400, 1000, false);
    browser.open(&path, "#error=linear");
    ready(&mut browser);
    browser.until(ALL_PAINTED);
    browser.press("ArrowRight", 39);
    let torque = "[...document.querySelectorAll('.plot')].find((plot) => plot.textContent.includes('Torque X')).querySelector('.live').textContent";
    let reported = browser.value(torque);
    assert!(reported.as_str().unwrap().contains('–'), "{reported}");
    assert!(text(&mut browser, ".badge").contains("log"));
    assert_eq!(browser.faults(), [""; 0]);
}

/// A click on a run in the legend switches it off, another one on; one stays.
fn legend(browser: &mut Browser) {
    let curve = "#plots canvas";
    let both = picture(browser, curve);
    browser.click("#key button:nth-of-type(1)");
    let one = picture(browser, curve);
    assert_ne!(one, both);
    assert_eq!(
        browser.value("document.querySelectorAll('.polar').length"),
        1
    );
    browser.click("#key button:nth-of-type(2)");
    assert_eq!(
        browser.value("document.querySelectorAll('#key button[aria-pressed=true]').length"),
        1
    );
    assert_eq!(
        picture(browser, curve),
        one,
        "the last run cannot be switched off"
    );
    browser.click("#key button:nth-of-type(1)");
    assert_eq!(picture(browser, curve), both);
}

/// Runs with an enlargement of their own, and the logarithmic axis.
fn scales(browser: &mut Browser) {
    browser.click("#scale button:nth-of-type(1)");
    assert_eq!(text(browser, "#gain-value").matches('×').count(), 2);
    assert_eq!(
        browser.value("document.querySelectorAll('.legend').length"),
        2
    );
    browser.click("#scale button:nth-of-type(2)");
    assert_eq!(text(browser, "#gain-value").matches('×').count(), 1);
    browser.click("#error-axis button:nth-of-type(2)");
    assert!(text(browser, ".plot figcaption b").contains("logarithmic"));
    browser.until(ALL_PAINTED);
    browser.click("#error-axis button:nth-of-type(1)");
}

/// Space plays and stops, arrows step, and the line of the program goes along.
fn play(browser: &mut Browser) {
    // So slowly that the end is a minute away, however late the second press comes.
    browser.value("document.querySelector('#play-speed').value = '0.05'");
    browser.value("document.activeElement.blur()");
    browser.press(" ", 32);
    browser.until("Number(document.querySelector('#play-time').value) > 20");
    browser.press(" ", 32);
    assert_eq!(text(browser, "#play"), "Play");
    let before = text(browser, "#readout");
    browser.press("ArrowRight", 39);
    let after = text(browser, "#readout");
    assert_ne!(before, after);
    let line = browser.value("document.querySelector('#listing [aria-current]').value");
    assert!(
        after.starts_with(&format!("line {line} ")),
        "{after}, {line}"
    );
    assert_eq!(
        text(browser, "#listing [aria-current]"),
        crate::made_up_report::HOSTILE
    );
    browser.press("ArrowLeft", 37);
    let back = text(browser, "#readout");
    assert_eq!(
        back.split_once('·').unwrap().0,
        before.split_once('·').unwrap().0
    );
    // What is drawn anew shows the same place.
    browser.click("#error-axis button:nth-of-type(2)");
    browser.click("#error-axis button:nth-of-type(1)");
    browser.frames();
    assert_eq!(text(browser, "#readout"), back);
}

/// Keys zoom the path and a curve, and show all again.
fn zoom(browser: &mut Browser) {
    for (selector, focus) in [
        (".path-view canvas", ".path-view canvas:last-of-type"),
        ("#plots canvas", "#plots .plot-body"),
    ] {
        browser.value(&format!("document.querySelector({}).focus()", json!(focus)));
        let whole = picture(browser, selector);
        browser.press("+", 0);
        assert_ne!(picture(browser, selector), whole, "{selector}");
        browser.press("0", 48);
        assert_eq!(picture(browser, selector), whole, "{selector}");
    }
}

/// Waits until the page stops scrolling and returns its scroll position: the page scrolls on for a
/// while behind a finger.
fn at_rest(browser: &mut Browser) -> f64 {
    let (mut place, mut still) = (f64::NAN, 0);
    for _ in 0..MOST_FRAMES {
        browser.frames();
        let now = browser.value("scrollY").as_f64().unwrap();
        still = if now == place { still + 1 } else { 0 };
        place = now;
        if still == STILL_FRAMES {
            break;
        }
    }
    place
}

/// Frames in which nothing moves, and that are waited for at the most.
const STILL_FRAMES: u32 = 10;
const MOST_FRAMES: u32 = 600;

/// A finger on the path scrolls the page, and moves the part where that was asked for; nothing is
/// wider than the screen.
#[test]
fn the_report_scrolls_on_a_phone() {
    let (_folder, path) = file(&crate::made_up_report::page(
        &crate::made_up_report::report(3, 3000),
    ));
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.screen(390, 844, true);
    browser.open(&path, "");
    ready(&mut browser);
    assert_eq!(browser.value(WITHIN_THE_SCREEN), true);
    let swipe = |browser: &mut Browser| {
        browser.value("document.querySelector('.path-view').scrollIntoView({ block: 'center' })");
        let before = at_rest(browser);
        browser.swipe_up(195.0, 520.0, 300.0);
        at_rest(browser) - before
    };
    assert!(swipe(&mut browser) > 100.0);
    browser.click("#touch-moves");
    assert!(swipe(&mut browser).abs() < 1.0);
    assert_eq!(browser.faults(), [""; 0]);
}

/// A page with six tables of made-up numbers, the first two unfolded.
fn tables_html() -> String {
    let part = |i: usize| PagePart {
        folded: i > 1,
        ..PagePart::new(&format!("cell-{i}"), "circle on tnv40")
    };
    let parts: Vec<PagePart> = (0..6).map(part).collect();
    let mut html = Vec::new();
    write_head(&mut html, "tables", "Tables", "Made up.", &parts).unwrap();
    for part in &parts {
        part.begin(&mut html).unwrap();
        write_table_head(
            &mut html,
            [
                "",
                "time s",
                "RMS um",
                "largest error um",
                "uncut um",
                "torque N m",
            ],
        )
        .unwrap();
        for (controller, rms_um) in [
            ("uncorrected", "16"),
            ("cross-coupled", "2"),
            ("lqg-identified", "0.1"),
        ] {
            writeln!(
                html,
                "<tr><td>{controller}</td><td>1.7</td>{}</tr>",
                format!("<td>{rms_um}</td>").repeat(4)
            )
            .unwrap();
        }
        write_table_end(&mut html).unwrap();
        PagePart::end(&mut html).unwrap();
    }
    write_foot(&mut html).unwrap();
    String::from_utf8(html).unwrap()
}

/// Parts are folded and a link opens them, tables are sorted, and a phone has them within its
/// screen.
#[test]
fn tables_fold_and_sort() {
    let (_folder, path) = file(&tables_html());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    for (width, phone) in [(1400, false), (390, true)] {
        browser.screen(width, 900, phone);
        browser.open(&path, "");
        ready(&mut browser);
        assert_eq!(browser.value(WITHIN_THE_SCREEN), true, "{width}");
        assert!(
            browser
                .value("document.documentElement.scrollHeight")
                .as_f64()
                .unwrap()
                < 3000.0
        );
        assert_eq!(
            browser.value("document.querySelectorAll('details.part[open]').length"),
            2
        );
        browser.click(".contents a[href='#cell-3']");
        browser.until("document.querySelector('#cell-3').open");
        let column = "[...document.querySelectorAll('#cell-3 tbody tr')].map((row) => parseFloat(row.cells[2].textContent)).join()";
        let sort = "#cell-3 th:nth-child(3) button";
        assert_eq!(browser.value(column), "16,2,0.1");
        browser.click(sort);
        assert_eq!(browser.value(column), "0.1,2,16");
        assert_eq!(
            browser.value("document.querySelector('#cell-3 th:nth-child(3)').ariaSort"),
            "ascending"
        );
        browser.click(sort);
        assert_eq!(browser.value(column), "16,2,0.1");
        browser.click("#unfold");
        assert_eq!(
            browser.value("document.querySelectorAll('details.part:not([open])').length"),
            0
        );
    }
    assert_eq!(browser.faults(), [""; 0]);
}

/// The button goes from the system's theme to light and dark.
fn dark(browser: &mut Browser) {
    let background = "getComputedStyle(document.body).backgroundColor";
    browser.click("#theme");
    assert_eq!(browser.value(background), "rgb(255, 255, 255)");
    browser.click("#theme");
    assert_eq!(browser.value(background), "rgb(19, 21, 25)");
    let curve =
        "getComputedStyle(document.querySelector('figure svg [stroke=\"#111111\"]')).stroke";
    assert_eq!(browser.value(curve), "rgb(236, 238, 241)");
}

#[test]
fn figures_have_contents_and_a_dark_side() {
    let points = (0..=100)
        .map(|k| [f64::from(k), f64::from(k % 7)])
        .collect();
    let curve = Polyline {
        points,
        color: COLORS[0].to_owned(),
        ..Polyline::default()
    };
    let figure = Figure {
        panels: vec![Panel {
            curves: vec![curve],
            ..Panel::default()
        }],
        ..Figure::default()
    };
    let entry = |number: &str| {
        let (number, caption) = (number.to_owned(), "Seven.".to_owned());
        CaptionedFigure {
            figure: figure.clone(),
            number,
            caption,
        }
    };
    let mut html = Vec::new();
    write_figure_page(
        &mut html,
        "Figures",
        "Made up.",
        &[entry("Figure 7"), entry("Figure 8")],
    )
    .unwrap();
    let (_folder, path) = file(&String::from_utf8(html).unwrap());
    let Some(mut browser) = Browser::start() else {
        return;
    };
    browser.screen(390, 844, true);
    browser.open(&path, "");
    ready(&mut browser);
    assert_eq!(browser.value(WITHIN_THE_SCREEN), true);
    assert_eq!(
        browser.value("document.querySelectorAll('.contents li a').length"),
        2
    );
    dark(&mut browser);
    assert_eq!(browser.faults(), [""; 0]);
}

/// Checks that injected content does not run: a script, the handler of an element, an address, a
/// style. Each is reported as a violation of the policy. The page itself violates nothing, as the
/// other tests check, and keeps working.
#[test]
fn what_is_injected_into_a_page_does_not_run() {
    const INJECTED: &str = "<script>window.injected = 1</script><p id=\"handler\" onclick=\"window.injected = 2\">x</p>\
        <a id=\"address\" href=\"javascript:window.injected = 3\">x</a><i id=\"styled\" style=\"color: red\">x</i></main>";
    let report = crate::made_up_report::page(&crate::made_up_report::report(2, 3000));
    for (html, button) in [(report, "#play"), (tables_html(), "#theme")] {
        let (_folder, path) = file(&html.replacen("</main>", INJECTED, 1));
        let Some(mut browser) = Browser::start() else {
            return;
        };
        browser.open(&path, "");
        ready(&mut browser);
        for selector in ["#handler", "#address"] {
            browser.click(selector);
        }
        assert_eq!(browser.value("'injected' in window"), false);
        assert_ne!(
            browser.value("getComputedStyle(document.querySelector('#styled')).color"),
            "rgb(255, 0, 0)"
        );
        let before = text(&mut browser, button);
        browser.click(button);
        assert_ne!(text(&mut browser, button), before);
        let faults = browser.faults();
        assert!(
            faults.len() == 4
                && faults
                    .iter()
                    .all(|fault| fault.contains("Content Security Policy")),
            "{faults:#?}"
        );
    }
}
