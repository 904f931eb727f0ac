//! The job of a request: its files are read, and its names looked up.

use std::sync::Arc;

use feedwright_gcode::Program;
use feedwright_ident::Model;
use feedwright_sim::Watch;
use miette::{Result, miette};

use super::Job;
use crate::controllers::{Controllers, Entry};
use crate::correct::corrected_for;
use crate::request::JobRequest;
use crate::request::named::find_control;

impl JobRequest {
    /// Makes the job: reads the files of the request, and looks its names up. `today` dates the
    /// models that come of it.
    ///
    /// # Errors
    /// A name that does not exist, and a file that cannot be read or has mistakes.
    pub fn job(&self, table: Controllers, today: &str, watch: &dyn Watch) -> Result<Job> {
        self.job_of(self.controllers(table)?, table, today, watch)
    }

    /// Makes the job with these controllers in place of the named ones.
    ///
    /// # Errors
    /// See [`JobRequest::job`].
    pub fn job_of(
        &self,
        both: [&'static Entry; 2],
        table: Controllers,
        today: &str,
        watch: &dyn Watch,
    ) -> Result<Job> {
        let mut choices = self.choices(both, table)?;
        let target = self.target.as_deref().map(find_control).transpose()?;
        let machine = self.machine()?;
        let recorded = both
            .into_iter()
            .filter_map(|entry| Some((entry, table.recorded(&machine, entry)?)));
        choices.take_recorded(recorded);
        let compensation = self.compensation()?;
        self.check_file_error()?;
        let model = self.model.as_ref().map(|path| Model::read(&self.at(path)));
        let model = model.transpose()?;
        let program = self.program();
        let reference = self.reference.as_ref();
        let planned_as = reference.and_then(|_| corrected_for(&program));
        let reader = self.reader()?;
        let mut logs = self.measured(watch)?.into_iter();
        let log = logs.next().map(Arc::new);
        if logs.next().is_some() {
            return Err(miette!("a cut is compared with one log"));
        }
        let [controller, against] = both;
        Ok(Job {
            // The program has the text.
            request: Self {
                program_text: None,
                ..self.clone()
            },
            today: today.to_owned(),
            controller,
            against,
            choices,
            compensation: match planned_as {
                Some(_) => compensation.in_program(),
                None => compensation,
            },
            model,
            target,
            reference: reference.map(|path| Program::in_file(self.at(path))),
            planned_as,
            reader,
            log,
            ..Job::new(program, machine)
        })
    }
}
