//! Model files: a trained identifier and its origin, as a text that is checked value by value.
//!
//! Training writes a model file. [`feedwright::Setup`] takes one in place of a training.
//! [`Model::block`] converts it to the bytes that a component in a servo thread reads
//! ([`feedwright_control::model`]). docs/model-file.md explains every key.
//!
//! The checksum covers every key as written, except the date, the version that wrote the file, and
//! the checksum itself. It detects manual edits and damaged copies; it is not a signature.

pub(crate) mod exact;
pub(crate) mod keys;
mod layout;

use std::path::Path;

use feedwright_control::{
    ContourIdentifier, IdentifiedAxes, Identifier, IdentifierKind, KnownGeometry, ModelBlock,
    Number, Parameters, Trained, TrainedModel,
};
use feedwright_gcode::input;
use feedwright_sim::toml_file::key::write;
use feedwright_sim::toml_file::{self, FileError, read_text};
use serde::Serialize;

use crate::identify::recording::Recording;
use crate::identify::{axes, contour};

/// The format that is read and written. It is raised whenever a file of before would be read
/// otherwise.
pub(crate) const FORMAT: u64 = 1;

/// A model file, for messages.
pub(crate) const FILE: toml_file::Kind = toml_file::Kind {
    name: "model file",
    is: "a model file is some pages of TOML text, as 'feedwright identify' writes it",
    code: "model::file",
    where_to_find: "'feedwright identify --out FILE.model.toml' writes one",
};

/// A trained identifier and where it comes from. Made by a training or read from a file, and whole
/// either way.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct Model {
    pub(crate) about: About,
    pub(crate) period: ModelPeriods,
    pub(crate) fit: Fit,
    pub(crate) weights: Weights,
}

/// Description of a model and its origin.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub struct About {
    /// Format of the file.
    pub(crate) format: u64,
    /// Version of feedwright that wrote it.
    pub(crate) written_by: String,
    /// Kind of the identifier, see [`name`].
    pub(crate) kind: String,
    /// Number of axes.
    pub(crate) axes: u64,
    /// Description of the training data.
    pub source: String,
    /// Date of the training, as year-month-day.
    pub date: String,
    /// Hash of the recording that it was trained on.
    pub(crate) training_data: String,
    /// Checksum of the content.
    pub(crate) checksum: String,
}

/// Periods that it was trained for.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct ModelPeriods {
    /// Servo period of the machine, s.
    pub servo_s: f64,
    /// Time between decisions of the controller, s.
    pub feed_period_s: f64,
}

/// Quality of the fit.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize)]
pub struct Fit {
    /// RMS of the prediction error of one knot, um per axis.
    pub fit_um: f64,
    /// Samples it was trained on.
    pub samples: u64,
}

/// The numbers, row by row.
#[derive(Debug, Clone, Default, PartialEq, Serialize)]
pub(crate) struct Weights {
    pub(crate) hidden: Vec<f64>,
    pub(crate) output: Vec<f64>,
    /// Response time of the slowest speed loop, s; 0 where an earlier version wrote the model.
    pub(crate) response_s: f64,
    pub(crate) mechanics_s: f64,
    /// Each of [`Parameters::NUMBERS`], axis by axis; one that is optional and zero on all axes
    /// is empty.
    pub(crate) axes: Vec<Vec<f64>>,
}

impl Weights {
    /// Returns the weights of a group of [`Identifier::weights`].
    fn group(&mut self, name: &str) -> &mut Vec<f64> {
        match name {
            "hidden" => &mut self.hidden,
            _ => &mut self.output,
        }
    }

    fn of<const N: usize>(mut net: impl Identifier<N>) -> Self {
        let mut weights = Self::default();
        net.weights(&mut |name, group| *weights.group(name) = group.to_vec());
        weights
    }

    fn of_axes<const N: usize>(mut identified: IdentifiedAxes<N>) -> Self {
        let of = |number: &Number| -> Vec<f64> {
            let values: Vec<f64> = identified
                .axes
                .iter_mut()
                .map(|axis| *(number.of)(axis))
                .collect();
            let is_there = !number.optional || values.iter().any(|value| *value != 0.0);
            if is_there { values } else { Vec::new() }
        };
        let axes = Parameters::NUMBERS.iter().map(of).collect();
        Self {
            mechanics_s: identified.periods.mechanics_s,
            axes,
            ..Self::default()
        }
    }

    /// Takes what a number is, axis by axis.
    fn set_of_axes(&mut self, index: usize, numbers: Vec<f64>) {
        self.axes.resize(Parameters::NUMBERS.len(), Vec::new());
        self.axes[index] = numbers;
    }

    /// Fills an identifier; none where the numbers are not as many as it has.
    fn fill<const N: usize, I: Identifier<N>>(&self) -> Option<I> {
        let (mut net, mut weights, mut fits) = (I::NULL, self.clone(), true);
        net.weights(&mut |name, group| {
            let own = weights.group(name);
            fits &= own.len() == group.len();
            group
                .iter_mut()
                .zip(own)
                .for_each(|(weight, own)| *weight = *own);
        });
        fits.then_some(net)
    }
}

/// Returns the name of a kind in files and messages.
pub fn identifier_name(kind: IdentifierKind) -> &'static str {
    match kind {
        IdentifierKind::Contour => "contour",
        IdentifierKind::Axes => "axes",
    }
}

/// An identifier of a kind, with its article.
pub fn an_identifier(kind: IdentifierKind) -> &'static str {
    match kind {
        IdentifierKind::Contour => "a contour identifier",
        IdentifierKind::Axes => "an axes identifier",
    }
}

/// All kinds.
pub(crate) const KINDS: [IdentifierKind; 2] = [IdentifierKind::Contour, IdentifierKind::Axes];
/// Kind of the servo identifier, which earlier versions wrote.
pub(crate) const SERVO: &str = "servo";

/// The kind of a name.
pub(crate) fn kind_named(name_of_kind: &str) -> Option<IdentifierKind> {
    KINDS
        .into_iter()
        .find(|kind| identifier_name(*kind) == name_of_kind)
}

/// Origin of a training.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Origin {
    /// Description of the recording.
    pub source: String,
    /// Date of the recording, as year-month-day.
    pub date: String,
}

impl Model {
    /// Makes a model of an identifier of the contour error that was trained on a recording, for
    /// axes whose speed loops respond within `response_s`.
    pub fn of_contour<const N: usize>(
        recording: &Recording<N>,
        trained: &contour::TrainedContour<N>,
        response_s: f64,
        origin: Origin,
    ) -> Self {
        let fit = Fit {
            fit_um: trained.fit_um,
            samples: trained.samples as u64,
        };
        Self::sealed(
            IdentifierKind::Contour,
            recording,
            fit,
            Weights {
                response_s,
                ..Weights::of(trained.net.clone())
            },
            origin,
        )
    }

    /// Makes a model of axes that were identified from a recording.
    pub fn of_axes<const N: usize>(
        recording: &Recording<N>,
        identified: &axes::TrainedAxes<N>,
        origin: Origin,
    ) -> Self {
        let fit = Fit {
            fit_um: identified.fit_um,
            samples: identified.samples as u64,
        };
        Self::sealed(
            IdentifierKind::Axes,
            recording,
            fit,
            Weights::of_axes(identified.axes),
            origin,
        )
    }

    /// This model of axes with other numbers of them; `None` of another kind, and for another
    /// number of axes.
    pub fn with_axes<const N: usize>(
        &self,
        axes: IdentifiedAxes<N>,
        Origin { source, date }: Origin,
    ) -> Option<Self> {
        self.identified_axes::<N>()?;
        let about = About {
            written_by: version(),
            source,
            date,
            ..self.about.clone()
        };
        let mut model = Self {
            about,
            weights: Weights::of_axes(axes),
            ..self.clone()
        };
        model.about.checksum = model.checksum();
        Some(model)
    }

    fn sealed<const N: usize>(
        kind: IdentifierKind,
        recording: &Recording<N>,
        fit: Fit,
        weights: Weights,
        Origin { source, date }: Origin,
    ) -> Self {
        let about = About {
            format: FORMAT,
            written_by: version(),
            kind: identifier_name(kind).to_owned(),
            axes: N as u64,
            source,
            date,
            training_data: recording.hash(),
            checksum: String::new(),
        };
        let period = ModelPeriods {
            servo_s: recording.servo_s,
            feed_period_s: recording.feed_period_s,
        };
        let mut model = Self {
            about,
            period,
            fit,
            weights,
        };
        model.about.checksum = model.checksum();
        model
    }

    /// A model from a file.
    ///
    /// # Errors
    /// A file that cannot be read or is not text, and every fault found in its text.
    pub fn read(path: &Path) -> Result<Self, FileError> {
        Self::parse(&input::name(path), &read_text(&FILE, path)?)
    }

    /// A model from the text of a model file; `file` is its name in messages.
    ///
    /// # Errors
    /// Every fault found in the text, in one go.
    pub fn parse(file: &str, text: &str) -> Result<Self, FileError> {
        let invalid = |faults| FileError::invalid(&FILE, file, text, faults);
        let document = toml_file::document(text).map_err(invalid)?;
        layout::model(&document).map_err(invalid)
    }

    /// The text of a model file that reads as this model.
    pub fn text(&self) -> String {
        let Self {
            about, period, fit, ..
        } = self;
        let (about, period, fit) = (
            write(keys::ABOUT, about),
            write(keys::PERIOD, period),
            write(keys::FIT, fit),
        );
        let weights = write(keys::weights(self.kind()), &self.weights);
        format!("{about}\n[period]\n{period}\n[fit]\n{fit}\n[weights]\n{weights}")
    }

    /// The checksum of its content.
    pub(crate) fn checksum(&self) -> String {
        let [written_by, date, checksum] = [const { String::new() }; 3];
        let about = About {
            written_by,
            date,
            checksum,
            ..self.about.clone()
        };
        blake3::hash(
            Self {
                about,
                ..self.clone()
            }
            .text()
            .as_bytes(),
        )
        .to_hex()
        .to_string()
    }

    /// Returns the description of the model and its origin.
    pub fn about(&self) -> &About {
        &self.about
    }

    /// Kind of the identifier.
    pub fn kind(&self) -> IdentifierKind {
        // What is read is one of the names; a default is a contour identifier without weights.
        kind_named(&self.about.kind).unwrap_or(IdentifierKind::Contour)
    }

    /// Number of axes.
    pub fn axes(&self) -> usize {
        usize::try_from(self.about.axes).unwrap_or(usize::MAX)
    }

    /// Periods that it was trained for.
    pub fn period(&self) -> ModelPeriods {
        self.period
    }

    /// Returns the quality of the fit.
    pub fn fit(&self) -> Fit {
        self.fit
    }

    /// The identifier of the contour error that it holds; none where it holds another, or for
    /// another number of axes.
    fn contour<const N: usize>(&self) -> Option<ContourIdentifier<N>> {
        self.weights
            .fill()
            .filter(|_| self.is(IdentifierKind::Contour, N))
    }

    /// Returns what is assumed in place of a number that a model of an earlier version does not
    /// state, if anything is.
    pub fn assumed(&self) -> Option<&'static str> {
        let is_unstated = self.kind() == IdentifierKind::Contour && self.weights.response_s == 0.0;
        is_unstated.then_some("it states no response time of the speed loops, and 6 ms is assumed")
    }

    /// The axes that it holds; none where it holds another kind, or another number of them.
    pub fn identified_axes<const N: usize>(&self) -> Option<IdentifiedAxes<N>> {
        let Weights {
            mechanics_s, axes, ..
        } = &self.weights;
        let mut identified = IdentifiedAxes::<N>::NULL;
        identified.periods.mechanics_s = *mechanics_s;
        let mut fits = self.is(IdentifierKind::Axes, N) && axes.len() == Parameters::NUMBERS.len();
        for (number, values) in Parameters::NUMBERS.iter().zip(axes) {
            fits &= values.len() == N || (number.optional && values.is_empty());
            identified
                .axes
                .iter_mut()
                .zip(values)
                .for_each(|(axis, value)| *(number.of)(axis) = *value);
        }
        identified
            .at_servo_period(self.period.servo_s)
            .filter(|_| fits)
    }

    fn is(&self, kind: IdentifierKind, axes: usize) -> bool {
        (self.kind(), self.axes()) == (kind, axes)
    }

    /// Returns the model in the form that `control` takes; `None` where it is for another number of
    /// axes.
    pub fn control<const N: usize>(&self) -> Option<TrainedModel<N>> {
        let trained = match self.kind() {
            IdentifierKind::Contour => Trained::Contour {
                net: self.contour()?,
                response_s: self.weights.response_s,
            },
            IdentifierKind::Axes => Trained::Axes(self.identified_axes()?),
        };
        let ModelPeriods {
            servo_s,
            feed_period_s,
        } = self.period;
        Some(TrainedModel {
            servo_s,
            feed_period_s,
            trained,
        })
    }

    /// The block of bytes that a component in a servo thread is given, with the geometry that it
    /// compensates.
    pub fn block(&self, geometry: Option<&KnownGeometry<3>>) -> Vec<u8> {
        let mut bytes = Vec::new();
        let put = |more: &[u8]| bytes.extend_from_slice(more);
        if let Some(model) = self.control::<2>() {
            let geometry = exact::of_a_block(geometry);
            ModelBlock { model, geometry }.to_bytes(put);
        } else if let Some(model) = self.control::<3>() {
            let geometry = exact::of_a_block(geometry);
            ModelBlock { model, geometry }.to_bytes(put);
        }
        bytes
    }
}

/// This version, as files name it.
pub(crate) fn version() -> String {
    format!("feedwright {}", env!("CARGO_PKG_VERSION"))
}

#[cfg(test)]
mod tests;
