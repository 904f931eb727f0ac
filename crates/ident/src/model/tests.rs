//! What a model file may hold, and what is said about one that holds something else.

use feedwright_control::BLOCK_FORMAT;
use feedwright_sim::toml_file::{Key, Problem};
use miette::Diagnostic;

use super::*;
use crate::identify::recording::RecordedKnot;

fn recording<const N: usize>() -> Recording<N> {
    let knot = RecordedKnot {
        command_mm: [0.3; N],
        tool_mm: [0.2; N],
        contour_mm: [0.1; N],
    };
    Recording {
        servo_s: 0.001,
        feed_period_s: 0.003,
        stretches: vec![vec![knot; 3]],
    }
}

/// Weights without symmetry, as a training gives them: not short in decimals.
fn filled<const N: usize, I: Identifier<N>>() -> I {
    let (mut net, mut number) = (I::NULL, 0.1_f64);
    net.weights(&mut |_, group| {
        for weight in group {
            number = libm::sin(7.0 * number + 0.3);
            *weight = number / 3.0;
        }
    });
    net
}

fn origin() -> Origin {
    Origin {
        source: "a \"bench\", seed 1".to_owned(),
        date: "2026-05-17".to_owned(),
    }
}

fn contour<const N: usize>() -> Model {
    let trained = contour::TrainedContour {
        net: filled(),
        fit_um: 0.1 + 0.2,
        samples: 12_345,
    };
    Model::of_contour::<N>(&recording(), &trained, 0.006, origin())
}

/// Axes like those of a machine: not short in decimals.
fn axes<const N: usize>() -> Model {
    let mut identified = IdentifiedAxes::<N>::NULL;
    identified.periods.mechanics_s = 1e-4;
    let mut number = 0.1_f64;
    for axis in &mut identified.axes {
        for of in Parameters::NUMBERS {
            let [least, most] = of.range;
            number = libm::sin(7.0 * number + 0.3);
            *(of.of)(axis) = least + (0.2 + 0.1 * number / 3.0) * (most.min(1.0) - least);
        }
        axis.kp_1_s *= 100.0;
    }
    let trained = axes::TrainedAxes {
        axes: identified,
        estimates: Vec::new(),
        fit_um: 0.1 + 0.2,
        samples: 12_345,
    };
    let recording = Recording {
        feed_period_s: 0.001,
        ..recording()
    };
    Model::of_axes::<N>(&recording, &trained, origin())
}

fn problems(text: &str) -> Vec<Problem> {
    match Model::parse("broken.model.toml", text) {
        Err(FileError::Invalid { problems, .. }) => problems,
        other => panic!("expected faults, got {other:?}"),
    }
}

fn reported(text: &str) -> Vec<String> {
    let reported = |problem: &Problem| {
        let hint = problem.hint.as_deref().unwrap_or("no hint");
        format!("{}:{}: {problem} / {hint}", problem.line, problem.column)
    };
    problems(text).iter().map(reported).collect()
}

/// Messages about a contour model of two axes once `from` is replaced by `to`.
fn reported_after(from: &str, to: &str) -> Vec<String> {
    let text = contour::<2>().text();
    assert!(text.contains(from), "the file has no '{from}'");
    reported(&text.replacen(from, to, 1))
}

#[test]
fn what_is_written_reads_back_to_the_bit() {
    for model in [contour::<2>(), contour::<3>(), axes::<2>(), axes::<3>()] {
        let read = Model::parse("written.model.toml", &model.text()).unwrap();
        assert_eq!(read, model);
        assert_eq!(read.block(None), model.block(None));
        assert_eq!(read.text(), model.text());
    }
    let net = Model::parse("m", &contour::<3>().text())
        .unwrap()
        .contour::<3>();
    assert_eq!(net, Some(filled::<3, ContourIdentifier<3>>()));
}

#[test]
fn a_file_of_an_earlier_version_without_response_time_is_read_and_says_what_is_assumed() {
    let now = contour::<2>();
    assert!(now.text().contains("\nresponse_s = 0.006\n") && now.assumed().is_none());
    let mut before = now;
    before.weights.response_s = 0.0;
    before.about.checksum = before.checksum();
    assert!(!before.text().contains("response_s"));
    let read = Model::parse("before.model.toml", &before.text()).unwrap();
    assert!(read == before && read.assumed().unwrap().contains("6 ms is assumed"));
    assert!(axes::<2>().assumed().is_none());
}

#[test]
fn the_block_is_what_control_takes() {
    let taken = ModelBlock::<3>::from_bytes(&contour::<3>().block(None)).unwrap();
    assert_eq!(Some(taken.model), contour::<3>().control::<3>());
    let taken = ModelBlock::<3>::from_bytes(&axes::<3>().block(None)).unwrap();
    assert_eq!(Some(taken.model), axes::<3>().control::<3>());
}

#[test]
fn a_model_gives_nothing_but_what_it_holds() {
    assert!(contour::<3>().contour::<2>().is_none() && contour::<2>().contour::<3>().is_none());
    assert!(
        axes::<2>().identified_axes::<3>().is_none()
            && axes::<3>().identified_axes::<2>().is_none()
    );
    assert!(
        axes::<2>().contour::<2>().is_none() && contour::<2>().identified_axes::<2>().is_none()
    );
    assert!(
        axes::<2>().identified_axes::<2>().is_some()
            && axes::<3>().identified_axes::<3>().is_some()
    );
}

#[test]
fn line_ends_comments_and_the_order_of_keys_change_nothing() {
    let text = contour::<2>().text();
    for other in [
        text.replace('\n', "\r\n"),
        format!("# mine\n{text}"),
        text.replace(",\n", ",\n\n"),
    ] {
        assert_eq!(Model::parse("other", &other).unwrap(), contour::<2>());
    }
    let (about, tables) = text.split_once("\n[period]").unwrap();
    let mut lines: Vec<&str> = about.lines().collect();
    lines.reverse();
    assert_eq!(
        Model::parse("other", &format!("{}\n[period]{tables}", lines.join("\n"))).unwrap(),
        contour::<2>()
    );
}

#[test]
fn the_date_is_no_part_of_the_content_and_everything_else_is() {
    let text = contour::<2>().text();
    let dated = Model::parse("m", &text.replace("2026-05-17", "2030-01-01")).unwrap();
    assert_eq!(
        (dated.about.checksum, dated.weights),
        (contour::<2>().about.checksum, contour::<2>().weights)
    );
    let weight = format!("{:?}", contour::<2>().weights.hidden[7]);
    for (from, to) in [
        ("seed 1", "seed 2"),
        ("feed_period_s = 0.003", "feed_period_s = 0.004"),
        ("samples = 12345", "samples = 12346"),
        (weight.as_str(), "0.25"),
        ("training_data = \"", "training_data = \"0"),
    ] {
        let reported = reported_after(from, to);
        assert_eq!(reported.len(), 1, "{reported:?}");
        assert!(
            reported[0].starts_with("8:12: the checksum does not fit: the file was changed"),
            "{reported:?}"
        );
        assert!(
            reported[0].contains("write it anew with 'feedwright identify'"),
            "{reported:?}"
        );
    }
}

#[test]
fn every_fault_is_reported_at_its_place_with_a_remedy() {
    let text = contour::<2>()
        .text()
        .replace("axes = 2", "axis = 2")
        .replace("servo_s = 0.001", "servo_s = 1")
        .replace("samples = 12345", "samples = 1.5")
        .replace("[fit]", "more = 3\n[fit]");
    assert_eq!(
        reported(&text),
        [
            "1:1: axes is missing / is 'axis' meant to be it?",
            "4:1: unknown key 'axis' in the file / did you mean 'axes'?",
            "11:11: servo_s is 1 s; it must lie between 1e-5 and 0.1 s / is the unit right? this key is in s",
            "14:1: unknown key 'more' in [period] / [period] holds servo_s, feed_period_s",
            "17:11: samples is 1.5; it must be a whole number / no hint",
        ]
    );
    assert_eq!(
        problems(&text)[0].code().unwrap().to_string(),
        "model::file"
    );
}

#[test]
fn numbers_of_an_array_have_places_and_bounds() {
    let weight = format!("{:?}", contour::<2>().weights.hidden[1]);
    for (to, what) in [
        (
            "nan",
            "is NaN; it must lie between -1e6 and 1e6 / write a finite number",
        ),
        (
            "-inf",
            "is -inf; it must lie between -1e6 and 1e6 / write a finite number",
        ),
        ("1e7", "is 1e7; it must lie between -1e6 and 1e6 / no hint"),
        ("'1.5'", "is a string, not a number / no hint"),
        ("[1.0]", "is an array, not a number / no hint"),
    ] {
        let reported = reported_after(&weight, to);
        assert_eq!(reported.len(), 1, "{reported:?}");
        assert!(
            reported[0].contains(&format!("hidden, number 2 {what}")),
            "{reported:?}"
        );
        assert!(reported[0].starts_with("20:"), "{reported:?}");
    }
    assert_eq!(
        reported_after(&weight, "1,5").len(),
        1,
        "a decimal comma makes two numbers of one"
    );
    let short = reported_after(&format!(" {weight},"), "");
    assert_eq!(short.len(), 1);
    assert!(
        short[0]
            .ends_with("hidden has 119 numbers; a contour identifier of 2 axes has 120 / no hint"),
        "{short:?}"
    );
    let mut wild = contour::<2>();
    wild.weights.hidden.fill(f64::NAN);
    let reported = reported(&wild.text().replace("NaN", "nan"));
    assert_eq!(reported.len(), 3, "{reported:?}");
    assert!(
        reported[2].contains("117 more of hidden are as wrong"),
        "{reported:?}"
    );
}

#[test]
fn kinds_have_their_own_weights() {
    let reported = reported_after("kind = \"contour\"", "kind = \"axes\"");
    assert!(
        reported
            .iter()
            .any(|reported| reported.contains("unknown key 'hidden' in [weights]")),
        "{reported:?}"
    );
    let reported = reported_after("kind = \"contour\"", "kind = \"contours\"");
    assert_eq!(
        reported,
        [
            "3:8: no identifier is of kind 'contours'; there are contour, axes / did you mean 'contour'?"
        ]
    );
    let reported = reported_after("axes = 2", "axes = 3");
    assert!(
        reported.len() == 2
            && reported[0]
                .contains("hidden has 120 numbers; a contour identifier of 3 axes has 180"),
        "{reported:?}"
    );
}

#[test]
fn every_number_of_an_axis_has_its_key_its_bounds_and_one_for_each_axis() {
    let text = axes::<2>().text();
    let array = |name: &str| {
        let (_, rest) = text
            .split_once(&format!("\n{name} = ["))
            .unwrap_or_else(|| panic!("no {name}"));
        rest.split_once(']').unwrap().0.to_owned()
    };
    for number in Parameters::NUMBERS {
        let (name, was) = (number.name, array(number.name));
        let after = |to: &str| {
            reported(&text.replacen(&format!("{name} = [{was}]"), &format!("{name} = {to}"), 1))
        };
        let beyond = after(&format!(
            "[{:?}, {:?}]",
            number.range[0],
            2.0 * number.range[1]
        ));
        assert!(
            beyond.len() == 1 && beyond[0].contains(&format!("{name}, number 2 is")),
            "{beyond:?}"
        );
        let short = after(&format!("[{:?}]", number.range[0]));
        let said = format!("{name} has 1 numbers; an axes identifier of 2 axes has 2");
        assert!(short.len() == 1 && short[0].contains(&said), "{short:?}");
    }
    let reported = reported(&text.replacen("mechanics_s = 0.0001", "mechanics_s = 0", 1));
    assert!(
        reported.len() == 1
            && reported[0].contains("mechanics_s is 0 s; it must lie between 1e-7 and 0.1 s"),
        "{reported:?}"
    );
}

/// Messages about a model with the checksum that belongs to it.
fn reported_of(mut model: Model) -> Vec<String> {
    model.about.checksum = model.checksum();
    reported(&model.text())
}

#[test]
fn axes_that_cannot_be_computed_with_are_refused() {
    let mut uneven = axes::<2>();
    uneven.weights.mechanics_s = 0.0003;
    let mut divides = axes::<2>();
    let presliding = Parameters::NUMBERS
        .iter()
        .position(|number| number.name == "presliding_rad")
        .unwrap();
    divides.weights.axes[presliding][1] = 1e-300;
    let gain = Parameters::NUMBERS
        .iter()
        .position(|number| number.name == "kp_1_s")
        .unwrap();
    let [mut slow, mut diverging] = [axes::<2>(), axes::<2>()];
    slow.weights.axes[gain][0] = 0.0036;
    diverging.weights.axes[gain][1] = 5500.0;
    for (model, said) in [
        (
            slow,
            "kp_1_s, number 1 is 0.0036 1/s; with servo_s of 0.001 s a position loop has 0.5 to 5000 1/s",
        ),
        (
            diverging,
            "kp_1_s, number 2 is 5500 1/s; with servo_s of 0.001 s a position loop has 0.5 to 5000 1/s",
        ),
        (
            uneven,
            "servo_s is no whole multiple of mechanics_s, 1 to 1000 times",
        ),
        (
            divides,
            "presliding_rad, number 2 is 1e-300 rad; it must be 0 or lie between 1e-12 and 1e4 rad",
        ),
    ] {
        let reported = reported_of(model);
        assert!(
            reported.len() == 1 && reported[0].contains(said),
            "{reported:?}"
        );
    }
}

/// Earlier versions wrote servo identifiers, with more keys.
#[test]
fn a_servo_identifier_is_refused_by_its_kind_alone() {
    let reported = reported_after("kind = \"contour\"", "kind = \"servo\"\nlinear = [0.5]");
    assert_eq!(
        reported,
        [
            "3:8: the model is a servo identifier, a kind that no controller uses any more / identify the machine again: \
          'feedwright identify' writes a model for lqg-identified"
        ]
    );
}

#[test]
fn another_format_is_reported_by_its_reader_and_by_nothing_else() {
    let reported = reported_after("format = 1", "format = 2\nkey_of_the_future = true");
    let version = version();
    assert_eq!(
        reported,
        [format!(
            "1:10: the model is of format 2; {version} reads format 1 / {version} wrote it and reads it; or write it anew with this \
             version's 'feedwright identify'"
        )]
    );
    let reported = reported_after("format = 1", "format = 'one'");
    assert!(
        reported[0].starts_with("1:10: format has to be a number, but is a string"),
        "{reported:?}"
    );
}

#[test]
fn other_files_are_distinguished() {
    let (_, machine) = feedwright_sim::BUILT_IN_MACHINES[0];
    let machine = reported(machine);
    assert_eq!(
        machine,
        [
            "1:1: format is missing: this is no model file / it looks like a machine file: give that to --machine"
        ]
    );
    assert!(reported("")[0].contains("'feedwright identify' writes model files"));
    let program = reported(&"G0 X1 Y2\n".repeat(100));
    assert!(
        program.len() == 5
            && program[4].ends_with("95 more places are not TOML: was another file meant?"),
        "{program:?}"
    );
    let text = contour::<2>().text();
    for length in (0..text.len()).step_by(97) {
        assert!(Model::parse("cut", &text[..length]).is_err(), "{length}");
    }
}

#[test]
fn a_file_that_cannot_be_read_is_reported_as_a_model_file() {
    let folder = tempfile::tempdir().unwrap();
    let reported = |name: &str, content: Option<&[u8]>| {
        let path = folder.path().join(name);
        content
            .into_iter()
            .for_each(|content| std::fs::write(&path, content).unwrap());
        let error = Model::read(&path).unwrap_err();
        (
            error.to_string(),
            error
                .help()
                .map(|help| help.to_string())
                .unwrap_or_default(),
        )
    };
    let (message, hint) = reported("none.model.toml", None);
    assert!(
        message.starts_with("cannot read model file") && hint.contains("identify --out"),
        "{message} {hint}"
    );
    let (message, hint) = reported("huge", Some(&vec![b' '; 2 << 20]));
    assert!(
        message.ends_with("this is no model file") && hint.contains("pages of TOML"),
        "{message} {hint}"
    );
    let (message, hint) = reported("block", Some(&contour::<2>().block(None)));
    assert!(
        message.contains("is not text") && hint.contains("a model file is TOML text"),
        "{message} {hint}"
    );
}

/// The document's tables begin `| `key` | unit | range |`.
#[test]
fn the_document_has_the_units_and_ranges_of_all_keys() {
    fn rows<T>(keys: &[Key<T>]) -> Vec<String> {
        let number = |value: f64| match value {
            value if value == 0.0 || (0.01..1000.0).contains(&value.abs()) => format!("{value}"),
            value => format!("{value:e}"),
        };
        let row = |key: &Key<T>| match key.range {
            [least, most] if least < most => format!(
                "| `{}` | {} | {} to {} |",
                key.name,
                key.unit,
                number(least),
                number(most)
            )
            .replace("|  |", "| |"),
            _ => format!("| `{}` | | text |", key.name),
        };
        keys.iter().map(row).collect()
    }
    let document = include_str!("../../../../docs/model-file.md");
    let weights = KINDS.map(|kind| rows(keys::weights(kind))).concat();
    for row in [
        rows(keys::ABOUT),
        rows(keys::PERIOD),
        rows(keys::FIT),
        weights,
    ]
    .concat()
    {
        assert!(
            document.contains(&row),
            "docs/model-file.md has no row that begins {row}"
        );
    }
    for (line, text) in [
        ("format", FORMAT.to_string()),
        ("format", BLOCK_FORMAT.to_string()),
    ] {
        assert!(
            document.contains(&format!("{line} {text}")),
            "docs/model-file.md does not describe the {line}"
        );
    }
}
