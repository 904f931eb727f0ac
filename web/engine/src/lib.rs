//! The library as a WebAssembly module: a request goes in as JSON, results and rows come out as text.
//!
//! ```text
//! input(n)    room for a request of n bytes: where it is in the memory of the module
//! run()       runs the request; 1 where it succeeds, 0 where output 0 is the reason why not
//! at(k), length(k)   where output k is, and its bytes: 0 the results as `run --json` has them, 1 the rows as `run --trace` has them
//! ```
//!
//! The module imports nothing: it has no files, no clock and no threads.

use std::sync::{Mutex, PoisonError};

use feedwright::gcode::Program;
use feedwright::sim::{Machine, TraceWriter};
use feedwright::{CONTROLLERS, Job};
use serde::Deserialize;

/// What is asked for.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    /// What messages call the program.
    name: String,
    /// Its text.
    program: String,
    /// Name of a built-in machine, or the text of a machine file.
    machine: String,
    /// Name of the controller; none is the default.
    controller: Option<String>,
    /// Largest contour error that is allowed, um.
    tolerance_um: Option<f64>,
    /// Seed of the recording that a controller identifies the machine from; 1 as in the command.
    #[serde(default = "first_seed")]
    seed: u64,
    /// Whether the rows are wanted.
    #[serde(default)]
    rows: bool,
}

const fn first_seed() -> u64 {
    1
}

struct Buffers {
    input: Vec<u8>,
    outputs: [Vec<u8>; 2],
}

static BUFFERS: Mutex<Buffers> = Mutex::new(Buffers { input: Vec::new(), outputs: [Vec::new(), Vec::new()] });

fn with_buffers<T>(act: impl FnOnce(&mut Buffers) -> T) -> T {
    act(&mut BUFFERS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Makes room for a request of `bytes` bytes. Returns the address in the memory of the module where
/// the caller writes the request.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> usize {
    with_buffers(|buffers| {
        buffers.input.clear();
        buffers.input.resize(bytes, 0);
        buffers.input.as_mut_ptr() as usize
    })
}

/// Runs the request that was written. 1 where it succeeds; else 0, and output 0 is the reason.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn run() -> u32 {
    let input = with_buffers(|buffers| std::mem::take(&mut buffers.input));
    let (outputs, succeeded) = match answer(&input) {
        Ok(outputs) => (outputs, 1),
        Err(error) => ([error.to_string().into_bytes(), Vec::new()], 0),
    };
    with_buffers(|buffers| buffers.outputs = outputs);
    succeeded
}

/// Where an output is in the memory of the module.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn at(output: usize) -> usize {
    with_buffers(|buffers| buffers.outputs.get(output).map_or(0, |bytes| bytes.as_ptr() as usize))
}

/// Bytes of an output.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn length(output: usize) -> usize {
    with_buffers(|buffers| buffers.outputs.get(output).map_or(0, Vec::len))
}

/// Results and rows of a request.
fn answer(input: &[u8]) -> Result<[Vec<u8>; 2], Box<dyn std::error::Error>> {
    let request: Request = serde_json::from_slice(input)?;
    let machine = if request.machine.contains('\n') {
        Machine::parse("machine", &request.machine)?
    } else {
        Machine::load(request.machine.as_ref())?
    };
    let mut job = Job::new(Program::from_text(request.name, request.program), machine);
    job.tolerance_um = request.tolerance_um;
    job.choices.seed = request.seed;
    if let Some(name) = &request.controller {
        job.controller = CONTROLLERS.find(name).ok_or_else(|| format!("no controller is called '{name}'"))?;
    }
    let checked = job.check()?;
    let (outcome, rows) = if request.rows {
        let mut trace = TraceWriter::new(Vec::new(), checked.axes())?;
        (checked.run(&mut [&mut trace], &())?, trace.finish()?)
    } else {
        (checked.run(&mut [], &())?, Vec::new())
    };
    let mut results = Vec::new();
    outcome.write_json(&job, &mut results)?;
    Ok([results, rows])
}
