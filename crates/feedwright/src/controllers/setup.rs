//! Inputs from which a controller is made: the known values of its machine, and a trained model.
//!
//! The machine itself stays in here. Code that makes a controller has no access to it, so that the
//! controller cannot use values that only the simulation knows. A training uses a recording of the
//! machine.
use feedwright_control::{
    AxisModel, Controller, ControllerData, ControllerRow, INVERSION_PERIOD_S, IdentifierKind,
    Knows, OffsetBounds, Part, RESPONSES_S, Trained, TrainedModel, Uncorrected, Values,
};
use feedwright_ident::{
    AxisEstimate, AxisRecordings, Excitation, Model, NotIdentified, Origin, Recording,
    TrainContour, TrainedAxes, TrainedContour, Training, an_identifier, identify_axis,
};
use feedwright_sim::{Known, KnownAxis, Machine};
use miette::Diagnostic;
use thiserror::Error;

use super::{CONTROLLERS, Choices, Entry};
use crate::identifier_cache::{identified_axes, recorded_and_trained};

/// Inputs from which a controller is made.
pub struct Setup<'a> {
    /// Known values of the controller's machine.
    pub known: Known,
    /// The user's choices.
    pub choices: &'a Choices,
    /// Machine that is recorded where a model has to be trained.
    machine: &'a Machine,
    /// Model that was trained before, and that suits.
    model: Option<&'a Model>,
    /// Receives the progress of a training, 0 to 1.
    progress: Option<&'a mut dyn FnMut(f64)>,
    /// Estimate of each axis, where axes were identified, or the reason why they could not be.
    found: Option<Result<Vec<AxisEstimate>, NotIdentified>>,
}

/// Reasons why a controller cannot be made with a model.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
pub enum ModelMisfit {
    /// The controller uses no model.
    #[error("{controller} uses no trained identifier")]
    NoIdentifier {
        /// Name of the controller.
        controller: &'static str,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The model is of another kind.
    #[error("the model holds {found}, and {controller} needs {needed}")]
    Kind {
        /// Name of the controller.
        controller: &'static str,
        /// Kind of the model.
        found: &'static str,
        /// Kind that is needed.
        needed: &'static str,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The model is for another number of axes.
    #[error("the model is for {found} axes, and {needed} are controlled")]
    Axes {
        /// Axes of the model.
        found: usize,
        /// Axes that are controlled.
        needed: usize,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The machine does not have as many axes as the model would need.
    #[error("the machine `{machine}` has {has} axes, and a model for {asked} was asked for")]
    #[diagnostic(help(
        "a program that stays in the XY plane is cut with a model for 2 axes, any other with one for 3"
    ))]
    NoSuchAxes {
        /// Name of the machine.
        machine: String,
        /// Number of axes of the machine.
        has: usize,
        /// Number of axes that the model is requested for.
        asked: usize,
    },
    /// An axis cannot be identified from the recording.
    #[error("the axes of `{machine}` cannot be identified: {cause}")]
    NotIdentified {
        /// Name of the machine.
        machine: String,
        /// Cause.
        cause: NotIdentified,
    },
    /// The model was trained for another period.
    #[error("the model was trained for a {period} of {found_s} s, and {of} has {needed_s} s")]
    Period {
        /// Servo period or feed period.
        period: &'static str,
        /// Owner of the needed period, as the message names it.
        of: &'static str,
        /// Period of the model, s.
        found_s: f64,
        /// Period that is needed, s.
        needed_s: f64,
        /// Remedy.
        #[help]
        hint: String,
    },
}

/// A controller that cuts uncorrected, and why.
#[derive(Debug, Clone, PartialEq, Error, Diagnostic)]
#[diagnostic(severity(Warning))]
pub enum CutsUncorrected {
    /// No axes were identified that the controller could use.
    #[error("{controller} cuts uncorrected: the axes of `{machine}` cannot be identified: {cause}")]
    NothingIdentified {
        /// Name of the controller.
        controller: &'static str,
        /// Name of the machine.
        machine: String,
        /// Cause.
        cause: NotIdentified,
    },
    /// The controller does not suit the machine.
    #[error(
        "{controller} does not suit `{machine}` and cuts uncorrected: no values of its parameters are better there"
    )]
    Unsuited {
        /// Name of the controller.
        controller: &'static str,
        /// Name of the machine.
        machine: String,
        /// Remedy.
        #[help]
        hint: String,
    },
}

impl CutsUncorrected {
    /// Returns the name of the controller.
    pub fn controller(&self) -> &'static str {
        match self {
            Self::NothingIdentified { controller, .. } | Self::Unsuited { controller, .. } => {
                controller
            }
        }
    }
}

/// Periods that differ by less are the same: they come from decimal numbers.
const SAME_PERIOD: f64 = 1e-9;

impl Entry {
    /// Checks that a model suits this controller, with its settings, for a machine and a number of
    /// axes.
    ///
    /// Returns the first mismatch.
    pub fn suits(
        &self,
        model: &Model,
        known: &Known,
        axes: usize,
        choices: &Choices,
    ) -> Result<(), ModelMisfit> {
        let controller = self.name;
        let needed = self.identifier.ok_or_else(|| self.no_identifier())?;
        let anew = format!(
            "'feedwright identify --controller {controller} --axes {axes}' with this machine writes one that suits"
        );
        if model.kind() != needed {
            let (found, needed) = (an_identifier(model.kind()), an_identifier(needed));
            return Err(ModelMisfit::Kind {
                controller,
                found,
                needed,
                hint: anew,
            });
        }
        if model.axes() != axes {
            return Err(ModelMisfit::Axes {
                found: model.axes(),
                needed: axes,
                hint: anew,
            });
        }
        let period = |period, of, found_s: f64, needed_s: f64, hint: String| {
            let same = (found_s - needed_s).abs() <= SAME_PERIOD * needed_s;
            if same {
                Ok(())
            } else {
                Err(ModelMisfit::Period {
                    period,
                    of,
                    found_s,
                    needed_s,
                    hint,
                })
            }
        };
        let (servo_s, feed_period_s) = (known.period.servo_s, self.feed_period_s(known, choices));
        period(
            "servo period",
            "the machine",
            model.period().servo_s,
            servo_s,
            anew.clone(),
        )?;
        let found_s = model.period().feed_period_s;
        let hint = match self.parameter("feed_period_s") {
            Some(_) => format!("--set feed_period_s={found_s} takes the one of the model; {anew}"),
            None => anew,
        };
        period("feed period", controller, found_s, feed_period_s, hint)
    }

    fn no_identifier(&self) -> ModelMisfit {
        let others = CONTROLLERS
            .iter()
            .filter(|entry| entry.identifier.is_some())
            .map(|entry| entry.name);
        let hint = format!(
            "leave --model out, or choose a controller that does: {}",
            others.collect::<Vec<_>>().join(", ")
        );
        ModelMisfit::NoIdentifier {
            controller: self.name,
            hint,
        }
    }

    /// Time between decisions of one that uses an identifier, s. One that cannot be set to another
    /// decides in each servo period.
    fn feed_period_s(&self, known: &Known, choices: &Choices) -> f64 {
        let servo_s = known.period.servo_s;
        self.parameter(INVERSION_PERIOD_S.name)
            .map_or(servo_s, |parameter| {
                let wished_s = choices.value(self, parameter);
                f64::from(known.period.servo_periods(wished_s)) * servo_s
            })
    }
}

impl<'a> Setup<'a> {
    /// Prepares a setup for a machine. The machine is recorded where a model has to be trained.
    pub fn new(machine: &'a Machine, choices: &'a Choices) -> Self {
        Self {
            known: machine.known(),
            choices,
            machine,
            model: None,
            progress: None,
            found: None,
        }
    }

    /// Reports the progress of a training to `progress`, 0 to 1.
    pub fn reporting(self, progress: &'a mut dyn FnMut(f64)) -> Self {
        Self {
            progress: Some(progress),
            ..self
        }
    }

    /// Returns the remark on a controller that was made from this setup and cuts uncorrected.
    pub fn remark(&self, entry: &Entry) -> Option<CutsUncorrected> {
        let (controller, machine) = (entry.name, self.machine.name.clone());
        if self.is_unsuited(entry) {
            let hint = entry
                .parameters
                .first()
                .map(|parameter| format!("--set {}={}", parameter.name, parameter.default));
            let hint = format!("{} cuts with it all the same", hint.unwrap_or_default());
            return Some(CutsUncorrected::Unsuited {
                controller,
                machine,
                hint,
            });
        }
        let Some(Err(cause)) = &self.found else {
            return None;
        };
        Some(CutsUncorrected::NothingIdentified {
            controller,
            machine,
            cause: *cause,
        })
    }

    /// Returns true if a controller cuts uncorrected because it does not suit the machine.
    pub(super) fn is_unsuited(&self, entry: &Entry) -> bool {
        self.choices.unsuited.iter().any(|name| name == entry.name)
    }

    /// Returns the estimate of each axis from the last training of a model of axes, or the reason
    /// why it failed; `None` if there was no such training.
    pub fn found(&self) -> Option<&Result<Vec<AxisEstimate>, NotIdentified>> {
        self.found.as_ref()
    }

    fn report_progress(&mut self, part: f64) {
        if let Some(progress) = &mut self.progress {
            progress(part);
        }
    }

    /// Returns the true values of the machine's axes, for the limit alone. A screw with a scale on
    /// the table counts as rigid.
    pub fn truth<const N: usize>(&self) -> [AxisModel; N] {
        std::array::from_fn(|i| {
            let (known, all) = (self.known.axis(i), self.machine.axis(i).parameters());
            let parts: &[Part] = if known.scale_on_table {
                &[Part::Noise]
            } else {
                &[Part::Noise, Part::Screw]
            };
            AxisModel::new(
                known.nominal.taking(parts, &all),
                self.known.period.periods(),
            )
        })
    }

    /// Takes a model in place of a training, of the controller that is made next.
    ///
    /// # Errors
    /// A model that does not suit it.
    pub(super) fn take(
        &mut self,
        model: &'a Model,
        entry: &Entry,
        axes: usize,
    ) -> Result<(), ModelMisfit> {
        entry.suits(model, &self.known, axes, self.choices)?;
        self.model = Some(model);
        Ok(())
    }

    /// Takes inertia and friction of the first N axes from a recording of the machine, in place of
    /// those of its data sheets; what its drives are set to stays known.
    ///
    /// # Errors
    /// A machine that does not move so that its parameters show.
    pub fn identify_parameters<const N: usize>(&mut self) -> Result<(), NotIdentified> {
        let excitation = Excitation::axis_parameters(self.machine);
        let (recording, _) = excitation.record::<N>(self.machine, self.choices.seed);
        let found = |i: usize| {
            let found = identify_axis(&recording, i, &self.known)?;
            Ok(found.assumed(self.known.axis(i)))
        };
        let axes = (0..N).map(found).collect::<Result<Vec<_>, _>>()?;
        self.known = self
            .known
            .with_axes(|i, known| axes.get(i).copied().unwrap_or(*known));
        Ok(())
    }

    /// Makes a controller of the family by what is known of the machine. It is uncorrected where the
    /// machine does not move so that its axes show, see [`Self::found`].
    pub(super) fn member<const N: usize>(
        &mut self,
        row: &ControllerRow,
        values: Values<'_>,
        make: impl FnOnce(&ControllerData<'_, N>) -> Option<Box<dyn Controller<N>>>,
    ) -> Box<dyn Controller<N>>
    where
        Training: TrainContour<N>,
    {
        let model = self.model_for::<N>(row, values);
        let is_exact = row.knows == Knows::ExactModel;
        let inverse = is_exact.then(|| self.known.inverse());
        let made = make(&ControllerData {
            model: model.as_ref(),
            inverse: inverse.as_ref(),
            bounds: self.offset_bounds(),
            tries: self.choices.tries,
            is_known: true,
        });
        made.unwrap_or_else(|| Box::new(Uncorrected))
    }

    /// Returns the bounds that the supervisor applies to an offset.
    pub fn offset_bounds(&self) -> OffsetBounds {
        let limits = self.known.limits;
        OffsetBounds {
            largest_mm: limits.max_deviation_mm,
            fastest_mm_s: limits.rapid_mm_s,
            acceleration_mm_s2: self.machine.command_accel_mm_s2(),
        }
    }

    /// The model that was given, or one that is trained, of the kind that a controller uses.
    fn model_for<const N: usize>(
        &mut self,
        row: &ControllerRow,
        values: Values<'_>,
    ) -> Option<TrainedModel<N>>
    where
        Training: TrainContour<N>,
    {
        let kind = row.identifier?;
        if let Some(model) = self.model {
            return model.control();
        }
        let servo_s = self.known.period.servo_s;
        match kind {
            IdentifierKind::Axes => {
                let (_, trained) = self.train_axes::<N>().ok()?;
                Some(TrainedModel::of_axes(
                    trained.axes.at_servo_period(servo_s)?,
                ))
            }
            IdentifierKind::Contour => {
                let feed_period_s = values(&INVERSION_PERIOD_S);
                let (_, TrainedContour { net, .. }) = self.train_contour::<N>(feed_period_s);
                let servo_periods = self.known.period.servo_periods(feed_period_s);
                Some(TrainedModel {
                    servo_s,
                    feed_period_s: f64::from(servo_periods) * servo_s,
                    trained: Trained::Contour {
                        net,
                        response_s: self.response_s::<N>(),
                    },
                })
            }
        }
    }

    /// Time in which the slowest speed loop of the first N axes responds, s: its time constant, and
    /// the delays of bus and encoder.
    fn response_s<const N: usize>(&self) -> f64 {
        let [least_s, most_s] = RESPONSES_S;
        let response_s = |KnownAxis { nominal, .. }: KnownAxis| {
            let damping_nm_s = nominal.kv_nm_s_per_rad + nominal.viscous_friction_nm_s;
            nominal.inertia_kg_m2 / damping_nm_s
                + nominal.drive_delay_s
                + nominal.measurement_delay_s
        };
        let axes_s = self.known.axes::<N>().map(response_s);
        axes_s
            .into_iter()
            .fold(0.0, f64::max)
            .clamp(least_s, most_s)
    }

    /// Records the machine and identifies its axes, or finds them kept.
    fn train_axes<const N: usize>(
        &mut self,
    ) -> Result<(AxisRecordings<N>, TrainedAxes<N>), NotIdentified> {
        let recordings = AxisRecordings::of(self.machine, self.choices.seed);
        let trained = identified_axes(&recordings, &self.machine.known(), &self.known);
        self.found = Some(
            trained
                .as_ref()
                .map(|trained| trained.estimates.clone())
                .map_err(|cause| *cause),
        );
        Ok((recordings, trained?))
    }

    /// Records the machine and trains the identifier of its contour error for decisions every
    /// `feed_period_s`, or finds it kept.
    fn train_contour<const N: usize>(
        &mut self,
        feed_period_s: f64,
    ) -> (Recording<N>, TrainedContour<N>)
    where
        Training: TrainContour<N>,
    {
        let excitation = Excitation {
            feed_period_s,
            ..Excitation::general()
        };
        recorded_and_trained(
            self.machine,
            &excitation,
            &Training::default(),
            self.choices.seed,
            &mut |part| self.report_progress(part),
        )
    }

    /// Trains the model that a controller uses on a recording of the simulated machine. `date`
    /// becomes the date in the model file.
    ///
    /// # Errors
    /// Fails if the controller uses no model, if `axes` is not 2 or 3, if the machine has fewer
    /// axes, or if its axes cannot be identified.
    pub fn train(
        &mut self,
        entry: &Entry,
        axes: usize,
        date: String,
    ) -> Result<Model, ModelMisfit> {
        let has = self.machine.axis_count();
        match axes {
            2 => self.train_for::<2>(entry, date),
            3 if has >= 3 => self.train_for::<3>(entry, date),
            _ => Err(ModelMisfit::NoSuchAxes {
                machine: self.machine.name.clone(),
                has,
                asked: axes,
            }),
        }
    }

    fn train_for<const N: usize>(
        &mut self,
        entry: &Entry,
        date: String,
    ) -> Result<Model, ModelMisfit>
    where
        Training: TrainContour<N>,
    {
        let kind = entry.identifier.ok_or_else(|| entry.no_identifier())?;
        let feed_period_s = entry.feed_period_s(&self.known, self.choices);
        let seed = self.choices.seed;
        let source = format!("simulated excitation of {}, seed {seed}", self.machine.name);
        let origin = Origin { source, date };
        Ok(match kind {
            IdentifierKind::Axes => {
                let not_identified = |cause| ModelMisfit::NotIdentified {
                    machine: self.machine.name.clone(),
                    cause,
                };
                let (recordings, trained) = self.train_axes::<N>().map_err(not_identified)?;
                Model::of_axes(&recordings.joined(), &trained, origin)
            }
            IdentifierKind::Contour => {
                let (recording, trained) = self.train_contour::<N>(feed_period_s);
                Model::of_contour(&recording, &trained, self.response_s::<N>(), origin)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use feedwright_sim::Period;

    use super::*;

    #[test]
    fn every_controller_that_was_identified_names_its_kind_and_trains_a_model_that_suits_it_and_no_other_kind()
     {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let choices = Choices::default();
        let contour = Setup::new(&machine, &choices).train(
            CONTROLLERS.find("two-dimensional").unwrap(),
            2,
            "today".to_owned(),
        );
        let axes = Setup::new(&machine, &choices).train(
            CONTROLLERS.find("lqg-identified").unwrap(),
            2,
            "today".to_owned(),
        );
        for (model, kind) in [
            (contour.unwrap(), IdentifierKind::Contour),
            (axes.unwrap(), IdentifierKind::Axes),
        ] {
            for entry in CONTROLLERS {
                assert_eq!(
                    entry.identifier.is_some(),
                    entry.knows == Knows::Identified,
                    "{}",
                    entry.name
                );
                let suits = entry.suits(&model, &machine.known(), 2, &choices);
                assert_eq!(
                    suits.is_ok(),
                    entry.identifier == Some(kind),
                    "{}: {suits:?}",
                    entry.name
                );
                assert!(
                    entry.suits(&model, &machine.known(), 3, &choices).is_err(),
                    "{}",
                    entry.name
                );
            }
        }
    }

    #[test]
    fn what_differs_in_the_simulation_alone_is_not_known() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let mut other = machine.clone();
        for axis in &mut other.axes {
            (axis.disturbance_hz, axis.encoder_step_um, axis.cogging_nm) = (3.0, 5.0, 0.1);
            (axis.torque_bits, axis.transmission) = (Some(9), Some(Default::default()));
        }
        assert!(other != machine && other.known() == machine.known());
        other.axes[1].inertia_kg_m2 *= 2.0;
        assert!(other.known() != machine.known());
    }

    #[test]
    fn where_nothing_is_identified_the_training_fails_and_the_controller_reports_that_it_cuts_uncorrected()
     {
        let mut machine = Machine::load("tnv40".as_ref()).unwrap();
        // The loop takes longer to settle than the excitation lasts; with long servo periods its
        // recording is short.
        machine.axes.iter_mut().for_each(|axis| axis.kp_1_s = 0.1);
        machine.period = Period {
            servo_s: 0.01,
            mechanics_s: 0.001,
            mechanics_per_servo: 10,
        };
        let (choices, entry) = (
            Choices::default(),
            CONTROLLERS.find("lqg-identified").unwrap(),
        );
        let mut setup = Setup::new(&machine, &choices);
        let refused = setup
            .train(entry, 2, "today".to_owned())
            .unwrap_err()
            .to_string();
        assert!(
            refused.starts_with("the axes of `tnv40` cannot be identified: 0 stretches are longer"),
            "{refused}"
        );
        let mut setup = Setup::new(&machine, &choices);
        assert_eq!(setup.remark(entry), None);
        let _ = entry.in_plane(&mut setup);
        let reported = setup.remark(entry).unwrap().to_string();
        assert!(
            reported.starts_with("lqg-identified cuts uncorrected: the axes of `tnv40` cannot"),
            "{reported}"
        );
    }
}
