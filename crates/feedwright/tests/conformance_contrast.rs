//! The colors of the pages reach the contrast ratios that WCAG 2.1 requires at level AA, 4.5 for
//! text and 3 for graphics, in light and dark.

use std::collections::BTreeMap;
use std::path::Path;

const TEXT: f64 = 4.5;
const GRAPHICS: f64 = 3.0;

fn asset(name: &str) -> String {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/assets/report")).join(name);
    std::fs::read_to_string(path).unwrap()
}

type Rgb = [f64; 3];

/// Custom properties with a color for light and one for dark.
fn colors(css: &str) -> BTreeMap<String, [Rgb; 2]> {
    let hex = |text: &str| {
        let digits = text
            .trim()
            .strip_prefix('#')
            .filter(|digits| digits.len() == 6)?;
        let part = |k: usize| {
            u8::from_str_radix(&digits[2 * k..2 * k + 2], 16)
                .ok()
                .map(f64::from)
        };
        Some([part(0)?, part(1)?, part(2)?])
    };
    let declarations = css.split(['{', ';', '}']);
    let property = |declaration: &str| {
        let (name, value) = declaration.trim().strip_prefix("--")?.split_once(':')?;
        let (light, dark) = value
            .trim()
            .strip_prefix("light-dark(")?
            .strip_suffix(')')?
            .split_once(',')?;
        Some((name.to_owned(), [hex(light)?, hex(dark)?]))
    };
    declarations.filter_map(property).collect()
}

/// Relative luminance of sRGB.
fn luminance(rgb: Rgb) -> f64 {
    let [r, g, b] = rgb.map(|x| x / 255.0).map(|x| {
        if x <= 0.04045 {
            x / 12.92
        } else {
            ((x + 0.055) / 1.055).powf(2.4)
        }
    });
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

fn contrast(a: Rgb, b: Rgb) -> f64 {
    let (a, b) = (luminance(a) + 0.05, luminance(b) + 0.05);
    a.max(b) / a.min(b)
}

fn check(css: &str, names: &[&str], behind: &[&str], least: f64) {
    let colors = colors(css);
    for name in names {
        for background in behind {
            for (k, theme) in ["light", "dark"].iter().enumerate() {
                let ratio = contrast(colors[*name][k], colors[*background][k]);
                assert!(
                    ratio >= least,
                    "--{name} on --{background}, {theme}: {ratio:.2}, at least {least}"
                );
            }
        }
    }
}

#[test]
fn ratios_are_those_of_the_standard() {
    assert!((contrast([0.0; 3], [255.0; 3]) - 21.0).abs() < 1e-9);
    // #767676 is the lightest grey that is text on white.
    assert!(contrast([118.0; 3], [255.0; 3]) > 4.5 && contrast([119.0; 3], [255.0; 3]) < 4.5);
}

#[test]
fn text_and_curves_of_the_report_stand_out_from_their_background() {
    let css = asset("colors.css");
    check(
        &css,
        &["ink", "ink-2", "ink-3", "tolerance", "accent"],
        &["bg", "panel", "hover"],
        TEXT,
    );
    let curves = [
        "path", "rapid", "run-0", "run-1", "run-2", "run-3", "run-4", "run-5",
    ];
    check(&css, &curves, &["bg", "panel"], GRAPHICS);
}

/// The scale of the error, from its first color on.
#[test]
fn every_colour_of_the_error_stands_out_from_the_panel() {
    let (css, script) = (asset("colors.css"), asset("theme.js"));
    for (name, k) in [("ON_LIGHT", 0), ("ON_DARK", 1)] {
        let list = script
            .split_once(&format!("const {name} = [["))
            .unwrap()
            .1
            .split_once("]];")
            .unwrap()
            .0;
        let stops: Vec<Vec<f64>> = list
            .split("], [")
            .map(|stop| stop.split(", ").map(|part| part.parse().unwrap()).collect())
            .collect();
        assert_eq!(stops.len(), 6, "{list}");
        for stop in stops {
            let ratio = contrast([stop[0], stop[1], stop[2]], colors(&css)["panel"][k]);
            assert!(ratio >= GRAPHICS, "{name} {stop:?}: {ratio:.2}");
        }
    }
}

#[test]
fn text_and_curves_of_the_other_pages_stand_out_from_their_background() {
    let css = asset("pages.css");
    check(
        &css,
        &["ink", "ink-2", "accent", "better", "worse"],
        &["bg", "panel"],
        TEXT,
    );
    check(
        &css,
        &["fig-0", "fig-1", "fig-2", "fig-3", "fig-4", "fig-5"],
        &["bg"],
        GRAPHICS,
    );
}
