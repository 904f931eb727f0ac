//! The layout of a model file: its tables, and what holds between their values.

use feedwright_control::{
    HIDDEN, INPUTS, IdentifierKind, MAX_MECHANICS_PER_SERVO, ModelBlock, Parameters,
    position_gains_1_s,
};
use feedwright_gcode::suggestion::nearest;
use feedwright_sim::to_four_digits;
use feedwright_sim::toml_file::key::{read, read_all};
use feedwright_sim::toml_file::{Document, Fault, Table};

use super::{
    About, FORMAT, KINDS, Model, SERVO, Weights, an_identifier, identifier_name, keys, kind_named,
    version,
};

/// The model that a file holds, or every fault in it.
pub(super) fn model(document: &Document<'_>) -> Result<Model, Vec<Fault>> {
    let mut faults = Vec::new();
    of_this_format(document).map_err(|fault| vec![fault])?;
    of_a_kind_in_use(document).map_err(|fault| vec![fault])?;
    let mut root = Table::root(document, None);
    let about: About = read(keys::ABOUT, &mut root, &mut faults);
    let kind = kind(&about, &root, &mut faults);
    let period = read_all(keys::PERIOD, root.table("period", &mut faults), &mut faults);
    let fit = read_all(keys::FIT, root.table("fit", &mut faults), &mut faults);
    let mut table = root.table("weights", &mut faults);
    // Which weights there have to be is said by the kind alone.
    let weights = kind
        .map(|kind| weights(kind, about.axes, &mut table, &mut faults))
        .unwrap_or_default();
    let place = table.header();
    if kind.is_some() {
        table.finish(&mut faults);
    }
    let at_checksum = root.place("checksum");
    root.finish(&mut faults);
    if !faults.is_empty() {
        return Err(faults);
    }
    let model = Model {
        about,
        period,
        fit,
        weights,
    };
    if model.checksum() != model.about.checksum {
        return Err(vec![Fault {
            at: at_checksum,
            label: "of another content",
            message: "the checksum does not fit: the file was changed since it was written, or damaged on its way"
                .to_owned(),
            hint: Some(
                "copy it once more from where it is whole, or write it anew with 'feedwright identify'".to_owned(),
            ),
        }]);
    }
    match refused(&model) {
        Some(message) => Err(vec![Fault {
            at: place,
            label: "here",
            message,
            hint: None,
        }]),
        None => Ok(model),
    }
}

/// A file of another format has other keys: nothing but this is said of it.
fn of_this_format(document: &Document<'_>) -> Result<(), Fault> {
    let entries = document.get_ref();
    let Some(format) = entries.get("format") else {
        let is_machine = entries.contains_key("axis") || entries.contains_key("limits");
        return Err(Fault {
            at: 0..0,
            label: "missing here",
            message: "format is missing: this is no model file".to_owned(),
            hint: Some(if is_machine {
                "it looks like a machine file: give that to --machine".to_owned()
            } else {
                format!(
                    "'feedwright identify' writes model files, which have 'format = {FORMAT}' at their top"
                )
            }),
        });
    };
    let mut faults = Vec::new();
    let mut root = Table::root(document, None);
    let found = root.whole("format", "", 1.0..=1e9, &mut faults);
    // A value that is no number is reported with everything else.
    if found.is_none_or(|found| found == FORMAT) {
        return Ok(());
    }
    let writer = entries
        .get("written_by")
        .and_then(|writer| writer.get_ref().as_str())
        .unwrap_or("a later version");
    Err(Fault {
        at: format.span(),
        label: "of another version",
        message: format!(
            "the model is of format {}; {} reads format {FORMAT}",
            found.unwrap_or(0),
            version()
        ),
        hint: Some(format!(
            "{writer} wrote it and reads it; or write it anew with this version's 'feedwright identify'"
        )),
    })
}

/// A servo identifier has keys of its own: nothing but its kind is reported.
fn of_a_kind_in_use(document: &Document<'_>) -> Result<(), Fault> {
    match document.get_ref().get("kind") {
        Some(kind) if kind.get_ref().as_str() == Some(SERVO) => Err(Fault {
            at: kind.span(),
            label: "no longer used",
            message: "the model is a servo identifier, a kind that no controller uses any more".to_owned(),
            hint: Some(
                "identify the machine again: 'feedwright identify' writes a model for lqg-identified".to_owned(),
            ),
        }),
        _ => Ok(()),
    }
}

fn kind(about: &About, root: &Table<'_, '_>, faults: &mut Vec<Fault>) -> Option<IdentifierKind> {
    let found = kind_named(&about.kind);
    if found.is_none() && !about.kind.is_empty() {
        let names = KINDS.map(identifier_name);
        faults.push(Fault {
            at: root.place("kind"),
            label: "unknown",
            message: format!(
                "no identifier is of kind '{}'; there are {}",
                about.kind,
                names.join(", ")
            ),
            hint: nearest(&about.kind, &names).map(|near| format!("did you mean '{near}'?")),
        });
    }
    found
}

fn weights(
    kind: IdentifierKind,
    axes: u64,
    table: &mut Table<'_, '_>,
    faults: &mut Vec<Fault>,
) -> Weights {
    let before = faults.len();
    let weights: Weights = read(keys::weights(kind), table, faults);
    // A number of axes that has a fault is 0 here; arrays with faults of their own get no second
    // one.
    if axes == 0 || faults.len() > before {
        return weights;
    }
    let n = axes as usize;
    let of_a_net = |number: usize| {
        if kind == IdentifierKind::Contour {
            number
        } else {
            0
        }
    };
    let expected = [
        ("hidden", &weights.hidden, of_a_net(n * INPUTS * HIDDEN)),
        ("output", &weights.output, of_a_net(n * HIDDEN)),
    ];
    // A number for each axis.
    let of_axes = keys::weights(IdentifierKind::Axes)
        .iter()
        .filter(|key| key.name != "mechanics_s");
    let of_axes = of_axes
        .zip(&weights.axes)
        .filter(|(key, found)| !(key.optional && found.is_empty()));
    let of_axes = of_axes.map(|(key, found)| (key.name, found, n));
    for (key, found, expected) in expected.into_iter().chain(of_axes) {
        if found.len() != expected {
            faults.push(Fault {
                at: table.place(key),
                label: "of another length",
                message: format!(
                    "{key} has {} numbers; {} of {n} axes has {expected}",
                    found.len(),
                    an_identifier(kind)
                ),
                hint: None,
            });
        }
    }
    weights
}

/// Why a component would not take it, where it would not.
fn refused(model: &Model) -> Option<String> {
    if model.kind() == IdentifierKind::Axes {
        return refused_axes(model);
    }
    let bytes = model.block(None);
    let error = match model.axes() {
        2 => ModelBlock::<2>::from_bytes(&bytes).err(),
        _ => ModelBlock::<3>::from_bytes(&bytes).err(),
    };
    error.map(|error| format!("no training gives these weights: {error}"))
}

/// Checks of axes beyond the range of each number.
fn refused_axes(model: &Model) -> Option<String> {
    if model.block(None).is_empty() {
        return Some(format!(
            "servo_s is no whole multiple of mechanics_s, 1 to {MAX_MECHANICS_PER_SERVO} times"
        ));
    }
    let servo_s = model.period.servo_s;
    Parameters::NUMBERS.iter().zip(&model.weights.axes).find_map(|(number, values)| {
        let (name, unit) = (number.name, number.unit);
        if name == "kp_1_s" {
            let [least, most] = position_gains_1_s(servo_s);
            let at = values.iter().position(|value| !(least..=most).contains(value))?;
            let value = values[at];
            return Some(format!(
                "{name}, number {} is {value} {unit}; with servo_s of {servo_s} s a position loop has {least} to {} {unit}",
                at + 1,
                to_four_digits(most)
            ));
        }
        let at = values.iter().position(|value| !number.holds(*value))?;
        let [least, most] = number.range;
        Some(format!(
            "{name}, number {} is {:e} {unit}; it must be 0 or lie between {least:e} and {most:e} {unit}",
            at + 1,
            values[at]
        ))
    })
}
