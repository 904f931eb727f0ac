//! The machine file that is identified from a log of the machine.

use std::path::Path;

use feedwright::ident::{Columns, Log};
use feedwright::sim::Machine;
use feedwright::{LogJob, machine_text, write_page};
use miette::IntoDiagnostic;
use serde_json::json;

use crate::page::PageWatch;
use crate::request::{Outputs, PageRequest, json};

pub(crate) fn identify(request: &PageRequest) -> miette::Result<Outputs> {
    let (watch, name, bytes) = (
        PageWatch::default(),
        Path::new(&request.name),
        request.program.as_slice(),
    );
    let log = Log::from_reader(name, bytes, bytes.len() as u64, &Columns::default(), &watch)?;
    let findings: Vec<String> = log.findings.iter().map(ToString::to_string).collect();
    let identified = LogJob {
        name: request.name.clone(),
        ..LogJob::default()
    }
    .run(log, &watch)?;
    let stem = name.file_stem().unwrap_or_default().to_string_lossy();
    let text = machine_text(&identified, &stem);
    Machine::parse(&format!("{stem}.toml"), &text)?;
    let mut page = Vec::new();
    write_page(&mut page, &identified).into_diagnostic()?;
    let axes = (0..identified.machine.axes.len()).map(|axis| {
        json!({
            "name": identified.machine.axes[axis].name,
            "verdict": identified.verdict(axis),
            "numbers": identified.rows(axis),
        })
    });
    let answer = json!({
        "axes": axes.collect::<Vec<_>>(),
        "findings": findings,
        "improvements": identified.improvements(),
        "advice": identified.advice(),
    });
    Ok(vec![json(&answer), text.into_bytes(), page])
}
