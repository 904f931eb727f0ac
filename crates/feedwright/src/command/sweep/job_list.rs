//! The list of jobs of a sweep: every program on every machine with every controller, and single
//! jobs.
//!
//! Jobs are made when they are asked for by their numbers: a list of a million jobs takes no
//! memory.

use std::path::{Path, PathBuf};

use glob::Pattern;
use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde::Deserialize;
use toml::{Table, Value};

use crate::command::args::sweep::JobShard;
use crate::command::files_to_check::FilesToCheck;
use crate::controllers::CONTROLLERS;
use crate::request::JobRequest;
use crate::store::key_of;

/// Content of JOBS.toml.
#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields, default)]
struct JobFile {
    programs: Vec<String>,
    machines: Option<Vec<Value>>,
    controllers: Option<Vec<Value>>,
    seeds: Option<Vec<Value>>,
    tolerances_um: Option<Vec<Value>>,
    feeds_mm_s: Option<Vec<Value>>,
    settings: Option<Vec<Value>>,
    /// Keys of all jobs.
    each: Table,
    /// Single jobs.
    job: Vec<Table>,
}

/// A list of jobs.
#[derive(Debug)]
pub struct JobList {
    folder: PathBuf,
    each: Table,
    /// The values of each key that the jobs are the product of; those of the last key change
    /// fastest.
    product: Vec<(&'static str, Vec<Value>)>,
    single: Vec<JobRequest>,
}

impl JobList {
    /// Reads a list.
    ///
    /// # Errors
    /// A file that cannot be read, keys and names that do not exist, a pattern that no program
    /// fits.
    pub fn read(path: &Path) -> Result<Self> {
        let text = std::fs::read_to_string(path)
            .map_err(|error| miette!("{}: cannot be read: {error}", path.display()))?;
        let folder = path.parent().unwrap_or(Path::new("")).to_owned();
        let in_file = || path.display().to_string();
        let file: JobFile = toml::from_str(&text)
            .map_err(|error| miette!("{error}"))
            .wrap_err_with(in_file)?;
        Self::of(file, folder).wrap_err_with(in_file)
    }

    fn of(file: JobFile, folder: PathBuf) -> Result<Self> {
        let programs = programs(&file.programs, &folder)?;
        let keys = [
            ("machine", file.machines),
            ("controller", file.controllers),
            ("tolerance_um", file.tolerances_um),
            ("feed_mm_s", file.feeds_mm_s),
            ("settings", file.settings),
            ("seed", file.seeds),
        ];
        let listed = keys
            .into_iter()
            .filter_map(|(key, values)| Some((key, values?)));
        let product: Vec<_> = std::iter::once(("program", programs))
            .chain(listed)
            .collect();
        let single = file.job.into_iter().enumerate().map(|(i, job)| {
            spec(file.each.clone().into_iter().chain(job).collect())
                .wrap_err_with(|| format!("[[job]] {}", i + 1))
        });
        let single = single.collect::<Result<_>>()?;
        let list = Self {
            folder,
            each: file.each,
            product,
            single,
        };
        list.check()?;
        Ok(list)
    }

    /// Makes each value that is listed once, with the first of all others.
    fn check(&self) -> Result<()> {
        if self.len() == 0 {
            let help = "programs = [\"parts/*.ngc\"] names programs, and [[job]] with program = \"part.ngc\" is a single job";
            return Err(miette!(help = help, "the list has no job"));
        }
        let mut stride = self.product_len();
        let product = if stride > 0 { &self.product[..] } else { &[] };
        for (_, values) in product {
            stride /= values.len();
            (0..values.len()).try_for_each(|i| spec(self.table(i * stride)).map(drop))?;
        }
        let check = |job: &JobRequest| job.check_names(CONTROLLERS);
        self.single.iter().try_for_each(check)
    }

    fn product_len(&self) -> usize {
        self.product
            .iter()
            .map(|(_, values)| values.len())
            .product()
    }

    /// Number of jobs.
    #[expect(
        clippy::len_without_is_empty,
        reason = "a list without a job is refused when it is read"
    )]
    pub fn len(&self) -> usize {
        self.product_len() + self.single.len()
    }

    /// The keys of a job of the product.
    fn table(&self, mut number: usize) -> Table {
        let mut table = self.each.clone();
        for (key, values) in self.product.iter().rev() {
            table.insert((*key).to_owned(), values[number % values.len()].clone());
            number /= values.len();
        }
        table
    }

    /// A job by its number, from 0; `None` beyond the last.
    ///
    /// # Errors
    /// A combination of values that is no job.
    pub fn job(&self, number: usize) -> Result<Option<JobRequest>> {
        let of_product = self.product_len();
        let job = if number < of_product {
            Some(spec(self.table(number))?)
        } else {
            self.single.get(number - of_product).cloned()
        };
        Ok(job.map(|job| JobRequest {
            folder: self.folder.clone(),
            ..job
        }))
    }
}

/// The job that these keys describe.
fn spec(table: Table) -> Result<JobRequest> {
    let job = JobRequest::deserialize(table)
        .map_err(|error| miette!("{}", error.to_string().trim_end()))?;
    job.check_names(CONTROLLERS)?;
    Ok(job)
}

/// The programs that paths, folders and patterns name, each by its path from the folder of the
/// list.
fn programs(places: &[String], folder: &Path) -> Result<Vec<Value>> {
    let mut found: Vec<PathBuf> = Vec::new();
    for place in places {
        let path = folder.join(place);
        if path.exists() {
            found.push(path);
            continue;
        }
        let base = Pattern::escape(&folder.to_string_lossy());
        let pattern = Path::new(&base).join(place);
        let files = glob::glob(&pattern.to_string_lossy())
            .map_err(|error| miette!("programs: '{place}': {error}"))?;
        let before = found.len();
        found.extend(
            files
                .collect::<Result<Vec<_>, _>>()
                .into_diagnostic()?
                .into_iter()
                .filter(|file| file.is_file()),
        );
        if found.len() == before {
            let help = "paths start in the folder of the list; * stands for any part of a name, ** for any folders";
            return Err(miette!(
                help = help,
                "programs: no file is called '{place}', and none fits it"
            ));
        }
    }
    let files = FilesToCheck::find(&found);
    if let Some(fault) = files.faults.first() {
        return Err(miette!("programs: {fault}"));
    }
    let name = |file: &PathBuf| {
        let file = file.strip_prefix(folder).unwrap_or(file);
        file.to_str()
            .map(Value::from)
            .ok_or_else(|| miette!("programs: {}: the name is no UTF-8", file.display()))
    };
    files.files.iter().map(name).collect()
}

impl JobRequest {
    /// Returns true if the job belongs to this shard. The hash of its keys decides. A job therefore
    /// stays in its shard when jobs are added to the list or removed from it, and no file is read
    /// for this.
    pub(crate) fn is_in(&self, shard: JobShard) -> bool {
        let keys = serde_json::json!(self).to_string();
        let hash = u64::from_str_radix(&key_of(&[keys.as_bytes()])[..16], 16).unwrap_or_default();
        hash % shard.of == shard.number - 1
    }
}
