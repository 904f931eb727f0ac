//! Sweeps: many jobs of `run`, each result a file of its own.
//!
//! A job's result is stored under the hash of everything that it follows from. Any number of
//! processes on any number of computers may therefore work on one folder: what is there is not
//! computed again, and no process waits for another.
//!
//! | File | What |
//! |---|---|
//! | `sweep/job_result.rs` | the result of one job, and its address |
//! | `sweep/job_list.rs` | the list of jobs, JOBS.toml, and shards |
//! | `sweep/result_table.rs` | the results as rows of a table |

pub(crate) mod job_result;
pub(crate) mod job_list;
pub(crate) mod result_table;

use feedwright_sim::Watch;
use miette::Result;
use serde_json::Value;

use crate::request::JobRequest;
use crate::results_format::spelled_out;
use crate::store::Store;

/// A job whose result is in the store.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct JobDone {
    /// Address of the result.
    pub address: String,
    /// True if the result was already in the store.
    pub found: bool,
    /// The message of the error that is the result, if it is one.
    pub error: Option<String>,
}

/// Does a job, unless its result is in the store.
///
/// # Errors
/// A file that cannot be read, a result that cannot be written, or a cancellation: nothing is
/// stored, and the job may be done again. The mistakes of a program, a machine or a model are a
/// result.
pub fn do_job(store: &Store, job: &JobRequest, watch: &dyn Watch) -> Result<JobDone> {
    let address = job.address()?;
    let found = store
        .text(&address)
        .and_then(|text| serde_json::from_str::<Value>(&text).ok());
    if let Some(result) = found.filter(|result| result["address"] == address) {
        return Ok(JobDone {
            address,
            found: true,
            error: job_result::error_of(&result),
        });
    }
    let result = job.result(&address, watch)?;
    store.put_text(&address, &format!("{}\n", spelled_out(&result.to_string())))?;
    Ok(JobDone {
        address,
        found: false,
        error: job_result::error_of(&result),
    })
}
