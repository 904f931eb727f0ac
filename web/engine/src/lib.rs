//! The library as a WebAssembly module: a request goes in as JSON, results come out as bytes.
//!
//! ```text
//! input(n)    makes room for a request of n bytes; returns its address in the memory of the module
//! program(n)  the same for its program or log, since a text in JSON would need the room twice
//! run()       answers the request; returns 1, or 0 with the reason of the failure in output 0
//! at(k), length(k)   address of output k, and its length in bytes
//! ```
//!
//! The outputs of a request follow from its `task`:
//!
//! | `task` | output 0 | output 1 | output 2 | output 3 | output 4 |
//! |---|---|---|---|---|---|
//! | `run` | results, as `run --json` | rows, as `run --trace` | the page of the report | the table of `run` and the verdict, as JSON | what is drawn, as JSON |
//! | `check` | findings, as JSON | programmed path: x, y, z in mm, as 32-bit floats | line and kind of each point | | |
//! | `correct` | results, as JSON | the corrected program | | | |
//! | `identify` | numbers of the axes, as JSON | the machine file | the page of the identification | | |
//! | `lists` | machines, controllers and controls, as JSON | | | | |
//!
//! The module imports functions of the page, such as `page.progress` and `page.cut`: see `page`. It
//! has no files, no clock and no threads.

mod page;
mod request;
mod lists;
mod check;
mod correct;
mod cut;
mod identify;

use std::sync::{Mutex, PoisonError};

use request::{Outputs, PageRequest, Task};

struct Buffers {
    input: Vec<u8>,
    program: Vec<u8>,
    outputs: Outputs,
}

static BUFFERS: Mutex<Buffers> = Mutex::new(Buffers {
    input: Vec::new(),
    program: Vec::new(),
    outputs: Vec::new(),
});

fn with_buffers<T>(act: impl FnOnce(&mut Buffers) -> T) -> T {
    act(&mut BUFFERS.lock().unwrap_or_else(PoisonError::into_inner))
}

/// Makes room for a request of `bytes` bytes. Returns the address in the memory of the module where
/// the caller writes the request.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn input(bytes: usize) -> usize {
    with_buffers(|buffers| room(&mut buffers.input, bytes))
}

/// Makes room for the program of the request. Returns the address where the caller writes it before
/// `run`.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn program(bytes: usize) -> usize {
    with_buffers(|buffers| room(&mut buffers.program, bytes))
}

fn room(buffer: &mut Vec<u8>, bytes: usize) -> usize {
    buffer.clear();
    buffer.resize(bytes, 0);
    buffer.as_mut_ptr() as usize
}

/// Answers the request that was written. Returns 1 on success; otherwise 0, with the reason in
/// output 0.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn run() -> u32 {
    let (input, program) = with_buffers(|buffers| {
        (
            std::mem::take(&mut buffers.input),
            std::mem::take(&mut buffers.program),
        )
    });
    let (outputs, succeeded) = match answer(&input, program) {
        Ok(outputs) => (outputs, 1),
        Err(error) => (vec![reported(&error).into_bytes()], 0),
    };
    with_buffers(|buffers| buffers.outputs = outputs);
    succeeded
}

/// Returns the address of an output in the memory of the module; 0 if there is no such output.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn at(output: usize) -> usize {
    with_buffers(|buffers| {
        buffers
            .outputs
            .get(output)
            .map_or(0, |bytes| bytes.as_ptr() as usize)
    })
}

/// Returns the length of an output, bytes; 0 if there is no such output.
#[expect(unsafe_code, reason = "the attribute exports the function")]
#[unsafe(no_mangle)]
pub extern "C" fn length(output: usize) -> usize {
    with_buffers(|buffers| buffers.outputs.get(output).map_or(0, Vec::len))
}

fn answer(input: &[u8], program: Vec<u8>) -> miette::Result<Outputs> {
    let mut request: PageRequest =
        serde_json::from_slice(input).map_err(|error| miette::miette!("{error}"))?;
    request.program = program;
    feedwright::keep_in(&page::PageTexts);
    match request.task {
        Task::Run => cut::run(&mut request),
        Task::Check => check::check(&mut request),
        Task::Correct => correct::correct(&mut request),
        Task::Identify => identify::identify(&request),
        Task::Lists => lists::lists(),
    }
}

/// Returns an error as text, with the errors that belong to it and the remedy.
fn reported(error: &miette::Report) -> String {
    let related = error
        .related()
        .into_iter()
        .flatten()
        .map(|fault| format!("\n{fault}"));
    let hint = error.help().map(|hint| format!("\nhint: {hint}"));
    std::iter::once(error.to_string())
        .chain(related)
        .chain(hint)
        .collect()
}
