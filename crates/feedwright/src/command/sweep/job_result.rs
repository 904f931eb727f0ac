//! Result of one job of a sweep: the address that follows from the content of its request, and its
//! figures, as `run` makes them.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use feedwright_gcode::ReadError;
use feedwright_sim::{Cancelled, Watch, is_machine_path};
use miette::{IntoDiagnostic, Report, Result, WrapErr, miette};
use serde_json::{Value, json};

use crate::command::date::today;
use crate::command::faults::{fault_findings, fault_text};
use crate::controllers::CONTROLLERS;
use crate::job::JobError;
use crate::recorded_model::RecordedModelError;
use crate::request::JobRequest;
use crate::results_format::stamped;
use crate::store::key_of;

/// Raised whenever the same job gets another result without a new version of feedwright, or a
/// result gets another form.
const STORE_FORMAT: &str = "feedwright sweep 1";

impl JobRequest {
    /// The same without the texts, which the address covers as contents of files.
    fn named(&self) -> Self {
        Self {
            program_text: None,
            machine_text: None,
            ..self.clone()
        }
    }

    /// Returns the address of the result in the store: a hash of the keys of the job, the version
    /// of feedwright, and the contents of all files that the job reads, including the subroutines
    /// that the program calls.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn address(&self) -> Result<String> {
        let read = |path: &Path| {
            let hint = "the path of a job starts in the folder of its list";
            std::fs::read(path).map_err(|error| {
                miette!(help = hint, "{}: cannot be read: {error}", path.display())
            })
        };
        let mut parts: Vec<Cow<'_, [u8]>> = vec![
            STORE_FORMAT.as_bytes().into(),
            env!("CARGO_PKG_VERSION").as_bytes().into(),
            serde_json::to_vec(&self.named()).into_diagnostic()?.into(),
        ];
        parts.push(match &self.program_text {
            Some(text) => text.as_bytes().into(),
            None => read(&self.at(&self.program))?.into(),
        });
        // A machine with mistakes is its own text, any other what all its bases make of it.
        parts.push(match (self.machine(), &self.machine_text) {
            (Ok(machine), _) => machine.text().into_bytes().into(),
            (Err(_), Some(text)) => text.as_bytes().into(),
            (Err(_), None) if is_machine_path(&self.machine) => {
                read(&self.at(&self.machine))?.into()
            }
            (Err(_), None) => Cow::default(),
        });
        for (_, path) in self.files() {
            parts.push(read(&self.at(path))?.into());
        }
        for path in self.subroutine_files() {
            let name = path
                .file_name()
                .unwrap_or_default()
                .as_encoded_bytes()
                .to_owned();
            parts.extend([name.into(), read(&path)?.into()]);
        }
        Ok(key_of(&parts.iter().map(AsRef::as_ref).collect::<Vec<_>>()))
    }

    /// Returns the files of the subroutines that the program calls. The list is empty if the
    /// program cannot be read; the result of the job then has the error.
    fn subroutine_files(&self) -> Vec<PathBuf> {
        let Some(mut reader) = self
            .reader()
            .ok()
            .and_then(|settings| self.program().reader(settings).ok())
        else {
            return vec![];
        };
        (&mut reader).for_each(drop);
        reader.subroutine_files().map(Path::to_owned).collect()
    }

    /// Returns the result: the figures that `run --json` writes, or the error of the job.
    ///
    /// # Errors
    /// Fails where the error does not follow from the job: if a file cannot be read, or if the work is
    /// canceled.
    pub(super) fn result(&self, address: &str, watch: &dyn Watch) -> Result<Value> {
        let mut result = match self.cut(&Unwatched(watch)) {
            Ok(result) => result,
            Err(error) if passes(&error) => return Err(error),
            Err(error) => self.error_result(&error),
        };
        result["address"] = address.into();
        result["job"] = json!(self.named());
        Ok(result)
    }

    fn error_result(&self, error: &Report) -> Value {
        let shown = |text: &str| self.relative(text);
        let mut findings = fault_findings(error);
        for value in findings
            .iter_mut()
            .filter_map(Value::as_object_mut)
            .flat_map(|finding| finding.values_mut())
        {
            if let Value::String(text) = value {
                *text = shown(text);
            }
        }
        stamped(json!({ "error": { "message": shown(&fault_text(error)), "findings": findings } }))
    }

    /// A message whose paths are those of the list: the same wherever the folder of the list is.
    fn relative(&self, text: &str) -> String {
        let files = [&self.program, &self.machine]
            .into_iter()
            .chain(self.files().map(|(_, path)| path))
            .chain(&self.subroutines);
        let files = files
            .map(|path| self.at(path))
            .chain(self.subroutine_files());
        files.fold(text.to_owned(), |text, path| {
            match path.strip_prefix(&self.folder) {
                Ok(inside) => {
                    text.replace(&path.display().to_string(), &inside.display().to_string())
                }
                Err(_) => text,
            }
        })
    }

    fn cut(&self, watch: &dyn Watch) -> Result<Value> {
        let job = self.job(CONTROLLERS, &today()?, watch)?;
        let outcome = job.check()?.run(&mut [], watch)?;
        let mut text = Vec::new();
        outcome.write_json(&job, &mut text).into_diagnostic()?;
        let result = serde_json::from_slice(&text)
            .into_diagnostic()
            .wrap_err("a result of feedwright is no JSON")?;
        Ok(if job.model.is_none() {
            undated(result)
        } else {
            result
        })
    }
}

/// A result without the day on which its model was identified: that follows from the cache, not
/// from the job.
fn undated(mut result: Value) -> Value {
    if result.pointer("/settings/Model").is_none() {
        return result;
    }
    for dated in ["/assumed/model_from", "/settings/Model"] {
        if let Some(Value::String(text)) = result.pointer_mut(dated)
            && let Some((before, _)) = text.rsplit_once(", ")
        {
            *text = before.to_owned();
        }
    }
    result
}

/// The message of the error that a result is, if it is one.
pub(super) fn error_of(result: &Value) -> Option<String> {
    Some(
        result.get("error")?["message"]
            .as_str()
            .unwrap_or_default()
            .to_owned(),
    )
}

/// Returns true if another attempt may succeed: the error is not a result of the job.
fn passes(error: &Report) -> bool {
    use JobError::{Cancelled as Ended, Read, Recorded, Reread, Write};
    let of_job = matches!(
        error.downcast_ref(),
        Some(
            Read(ReadError::Io { .. })
                | Reread { .. }
                | Write(_)
                | Ended(_)
                | Recorded(RecordedModelError::Cancelled(_))
        )
    );
    of_job || error.downcast_ref::<Cancelled>().is_some()
}

/// Ends work as another watch does, and shows no progress and no time: a result has no clock.
struct Unwatched<'a>(&'a dyn Watch);

impl Watch for Unwatched<'_> {
    fn begin(&self, _: &str, _: u64) {}

    fn advance(&self, _: u64) {}

    fn is_cancelled(&self) -> bool {
        self.0.is_cancelled()
    }
}
