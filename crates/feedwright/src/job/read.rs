//! Reading: every mistake of program, reference and log is known before anything is identified or
//! cut.

use std::borrow::Cow;

use feedwright_gcode::{Diagnostic, Summary};

use super::{Job, JobError};
use crate::job_error::axes_that_move;

/// A job whose program was read to its end and has no mistakes.
#[derive(Debug)]
pub struct CheckedJob<'a> {
    /// The job; its machine has the geometry that is compensated.
    pub(super) job: Cow<'a, Job>,
    pub(super) summary: Summary,
    pub(super) axes: usize,
}

impl Job {
    /// Reads the program and the reference to their ends and looks whether the log is one of the
    /// program.
    ///
    /// # Errors
    /// A value out of its range, a program with mistakes, axes that the machine does not have, a
    /// model or a geometry that does not suit, and a log of another program.
    pub fn check(&self) -> Result<CheckedJob<'_>, JobError> {
        self.check_values()?;
        let summary = self.program.check(self.reader.clone())?;
        let axes = axes_that_move(&self.program, &summary, &self.machine)?;
        self.check_model(axes)?;
        let job = self.compensating(&summary)?;
        if let Some(reference) = &self.reference {
            reference.check(self.reader.clone())?;
        }
        job.measured_run(axes, &mut [], &())?;
        Ok(CheckedJob { job, summary, axes })
    }

    /// Refuses a model that does not suit.
    pub(super) fn check_model(&self, axes: usize) -> Result<(), JobError> {
        if let Some(model) = &self.model {
            let known = self.machine.known();
            self.controller.suits(model, &known, axes, &self.choices)?;
        }
        Ok(())
    }

    /// The job with the geometry that its control compensates.
    fn compensating(&self, summary: &Summary) -> Result<Cow<'_, Self>, JobError> {
        let machine = self.compensation.on(&self.machine, summary.box_mm)?;
        let as_it_is = machine.tool.is_none()
            && machine.compensated.is_none()
            && self.machine.compensated.is_none();
        Ok(if as_it_is {
            Cow::Borrowed(self)
        } else {
            Cow::Owned(Self {
                machine,
                ..self.clone()
            })
        })
    }
}

impl CheckedJob<'_> {
    /// Axes that are controlled: two where the program stays in the XY plane, else three.
    pub const fn axes(&self) -> usize {
        self.axes
    }

    /// Returns the summary of the program from its reading.
    pub const fn summary(&self) -> &Summary {
        &self.summary
    }

    /// Returns the warnings of the reader.
    pub(super) fn warnings(&self) -> Vec<Diagnostic> {
        let warnings = self.summary.warnings.iter().cloned();
        warnings.chain(self.summary.uncontrolled()).collect()
    }
}
