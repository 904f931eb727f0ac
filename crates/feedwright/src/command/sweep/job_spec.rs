//! One job of a sweep: the keys that describe it, the address that follows from its content, and
//! its cut, as `run` makes it.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use feedwright_gcode::{AUTO, Dialect, INCH_MM, Program, ReadError, Settings, ToolTable};
use feedwright_ident::Model;
use feedwright_sim::{Cancelled, DEFAULT_MACHINE, Machine, Watch, is_machine_path};
use miette::{IntoDiagnostic, Report, Result, WrapErr, miette};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::command::controllers::{find, settings};
use crate::command::date::today;
use crate::command::faults::{fault_findings, fault_text};
use crate::controllers::{BASELINE, BEST, CONTROLLERS, Choices};
use crate::job::{Job, JobError};
use crate::recorded_model::{RecordedModelError, fitting_machines, take_recorded_model};
use crate::results_format::stamped;
use crate::store::key_of;

/// Raised whenever the same job gets another result without a new version of feedwright, or a
/// result gets another form.
const STORE_FORMAT: &str = "feedwright sweep 1";

/// A job of a sweep by the keys of JOBS.toml. Paths are relative to the folder of the list.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct JobSpec {
    /// Path of the program, and its name in the results.
    pub program: String,
    /// Text of the program; it is not read from the path then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program_text: Option<String>,
    /// Name or path of the machine, and its name in the results.
    pub machine: String,
    /// Text of the machine file; it is not read from the path then.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub machine_text: Option<String>,
    /// Name of the controller.
    pub controller: String,
    /// Name of the controller that it is compared with.
    pub against: String,
    /// Values of its parameters; those of the other controller are called `NAME.parameter`.
    pub settings: BTreeMap<String, Value>,
    /// Path of the model file.
    pub model: Option<PathBuf>,
    /// Takes the settings of the drives from the machine file.
    pub exact_settings: bool,
    /// Machines that fit the recording and are cut, too.
    pub band: u8,
    /// Seed of the recording.
    pub seed: u64,
    /// Largest contour error allowed, um.
    pub tolerance_um: Option<f64>,
    /// Feedrate in place of every programmed one, mm/s.
    pub feed_mm_s: Option<f64>,
    /// Cuts in the least time within the tolerance.
    pub fastest: bool,
    /// Name of the dialect.
    pub dialect: String,
    /// Path of the tool table.
    pub tool_table: Option<PathBuf>,
    /// The lengths in it are inches.
    pub inch_tools: bool,
    /// Folders of subroutines.
    pub subroutines: Vec<PathBuf>,
}

impl Default for JobSpec {
    fn default() -> Self {
        Self {
            program: String::new(),
            program_text: None,
            machine: DEFAULT_MACHINE.to_owned(),
            machine_text: None,
            controller: BEST.to_owned(),
            against: BASELINE.to_owned(),
            settings: BTreeMap::new(),
            model: None,
            exact_settings: false,
            band: 0,
            seed: 1,
            tolerance_um: None,
            feed_mm_s: None,
            fastest: false,
            dialect: AUTO.to_owned(),
            tool_table: None,
            inch_tools: false,
            subroutines: Vec::new(),
        }
    }
}

impl JobSpec {
    /// The same without the texts, which the address covers as contents of files.
    fn named(&self) -> Self {
        Self {
            program_text: None,
            machine_text: None,
            ..self.clone()
        }
    }

    /// Refuses names of controllers and parameters that do not exist.
    ///
    /// # Errors
    /// The first of them.
    pub fn check_names(&self) -> Result<()> {
        if self.program.is_empty() {
            return Err(miette!(
                help = "program = \"part.ngc\"",
                "a job needs a program"
            ));
        }
        self.choices().map(drop)
    }

    fn choices(&self) -> Result<Choices> {
        let (controller, against) = (
            find(&self.controller, CONTROLLERS)?,
            find(&self.against, CONTROLLERS)?,
        );
        let text = |(name, value): (&String, &Value)| match value {
            Value::String(value) => format!("{name}={value}"),
            value => format!("{name}={value}"),
        };
        let texts: Vec<String> = self.settings.iter().map(text).collect();
        let set = settings(
            &texts,
            CONTROLLERS,
            Some(controller),
            &[controller, against],
        )?;
        Ok(Choices {
            seed: self.seed,
            set,
            tries: true,
            ..Choices::default()
        })
    }
}

/// A job, and the folder that its paths are relative to.
#[derive(Debug, Clone, PartialEq)]
pub struct ListedJob {
    /// The job.
    pub spec: JobSpec,
    /// The folder of the list.
    pub folder: PathBuf,
}

impl ListedJob {
    fn at(&self, path: impl AsRef<Path>) -> PathBuf {
        self.folder.join(path)
    }

    fn program(&self) -> Program {
        match &self.spec.program_text {
            Some(text) => Program::from_text(self.spec.program.clone(), text),
            None => Program::in_file(self.at(&self.spec.program)),
        }
    }

    fn machine(&self) -> Result<Machine> {
        let name = &self.spec.machine;
        Ok(match &self.spec.machine_text {
            Some(text) => Machine::parse(name, text)?,
            None if is_machine_path(name.as_ref()) => Machine::read(&self.at(name))?,
            None => Machine::load(name.as_ref())?,
        })
    }

    fn reader(&self) -> Result<Settings> {
        let JobSpec {
            dialect,
            tool_table,
            inch_tools,
            subroutines,
            ..
        } = &self.spec;
        let unit_mm = if *inch_tools { INCH_MM } else { 1.0 };
        let tools = tool_table
            .as_ref()
            .map(|path| ToolTable::read(&self.at(path), unit_mm))
            .transpose()?;
        Ok(Settings {
            dialect: Dialect::named(dialect)?,
            tools: tools.unwrap_or_default(),
            subroutine_paths: subroutines.iter().map(|folder| self.at(folder)).collect(),
            ..Settings::default()
        })
    }

    /// Returns the address of the result in the store: a hash of the keys of the job, the version
    /// of feedwright, and the contents of all files that the job reads, including the subroutines
    /// that the program calls.
    ///
    /// # Errors
    /// A file that cannot be read.
    pub fn address(&self) -> Result<String> {
        let spec = &self.spec;
        let read = |path: &Path| {
            let hint = "the path of a job starts in the folder of its list";
            std::fs::read(path).map_err(|error| {
                miette!(help = hint, "{}: cannot be read: {error}", path.display())
            })
        };
        let mut parts: Vec<Cow<'_, [u8]>> = vec![
            STORE_FORMAT.as_bytes().into(),
            env!("CARGO_PKG_VERSION").as_bytes().into(),
            serde_json::to_vec(&spec.named()).into_diagnostic()?.into(),
        ];
        parts.push(match &spec.program_text {
            Some(text) => text.as_bytes().into(),
            None => read(&self.at(&spec.program))?.into(),
        });
        // A machine with mistakes is its own text, any other what all its bases make of it.
        parts.push(match (self.machine(), &spec.machine_text) {
            (Ok(machine), _) => machine.text().into_bytes().into(),
            (Err(_), Some(text)) => text.as_bytes().into(),
            (Err(_), None) if is_machine_path(spec.machine.as_ref()) => {
                read(&self.at(&spec.machine))?.into()
            }
            (Err(_), None) => Cow::default(),
        });
        for path in spec.model.iter().chain(&spec.tool_table) {
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
    /// What does not follow from the job: a file that cannot be read, or a cancellation.
    pub(super) fn result(&self, address: &str, watch: &dyn Watch) -> Result<Value> {
        let mut result = match self.cut(&Unwatched(watch)) {
            Ok(result) => result,
            Err(error) if passes(&error) => return Err(error),
            Err(error) => self.error_result(&error),
        };
        result["address"] = address.into();
        result["job"] = json!(self.spec.named());
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
        let JobSpec {
            program,
            machine,
            model,
            tool_table,
            subroutines,
            ..
        } = &self.spec;
        let listed = [Path::new(program), Path::new(machine)]
            .into_iter()
            .map(Path::to_owned);
        let files = listed.chain(model.iter().chain(tool_table).chain(subroutines).cloned());
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
        let spec = &self.spec;
        let machine = self.machine()?;
        let mut job = Job::new(self.program(), machine.clone());
        (job.controller, job.against) = (
            find(&spec.controller, CONTROLLERS)?,
            find(&spec.against, CONTROLLERS)?,
        );
        job.machine_file = is_machine_path(spec.machine.as_ref()).then(|| spec.machine.clone());
        job.choices = spec.choices()?;
        let both = [job.controller, job.against].into_iter();
        let recorded =
            both.filter_map(|entry| Some((entry, CONTROLLERS.recorded(&machine, entry)?)));
        job.choices
            .take_recorded(recorded.collect::<Vec<_>>().into_iter());
        job.model = spec
            .model
            .as_ref()
            .map(|path| Model::read(&self.at(path)))
            .transpose()?;
        (job.tolerance_um, job.feed_mm_s, job.fastest) =
            (spec.tolerance_um, spec.feed_mm_s, spec.fastest);
        job.reader = self.reader()?;
        let read = job.check()?;
        let (axes, summary) = (read.axes(), read.into_summary());
        if !spec.exact_settings {
            let model = take_recorded_model(&mut job, &machine, axes, today()?, watch)?;
            if model.is_some() && spec.band > 0 {
                job.fitting =
                    fitting_machines(&machine, axes, spec.seed, usize::from(spec.band), watch)?;
            }
        }
        let outcome = job.check_read(summary)?.run(&mut [], watch)?;
        let mut text = Vec::new();
        outcome.write_json(&job, &mut text).into_diagnostic()?;
        let result = serde_json::from_slice(&text)
            .into_diagnostic()
            .wrap_err("a result of feedwright is no JSON")?;
        Ok(match &job.model {
            Some(model) if spec.model.is_none() => undated(result, &model.about().date),
            _ => result,
        })
    }
}

/// A result without the day on which its model was identified: that follows from the cache, not
/// from the job.
fn undated(mut result: Value, date: &str) -> Value {
    for told in ["/assumed/model_from", "/settings/Model"] {
        if let Some(Value::String(text)) = result.pointer_mut(told)
            && let Some(before) = text.strip_suffix(&format!(", {date}"))
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
    use JobError::{Cancelled as Ended, Read, Reread, Write};
    let of_job = matches!(
        error.downcast_ref(),
        Some(Read(ReadError::Io { .. }) | Reread { .. } | Write(_) | Ended(_))
    );
    of_job
        || matches!(error.downcast_ref(), Some(RecordedModelError::Cancelled(_)))
        || error.downcast_ref::<Cancelled>().is_some()
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
