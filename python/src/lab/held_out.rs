//! Held-out work by seeds, and a page of tables.

use feedwright::{
    JobError, PagePart, escaped, write_foot, write_head, write_table_end, write_table_head,
};
use feedwright_lab::Class;
use feedwright_lab::held_out::{machines, programs};
use miette::IntoDiagnostic;
use pyo3::prelude::*;

use crate::fault::exception;
use crate::files::{PythonMachine, PythonProgram};

/// Returns the program of a seed; none if it leaves the plane.
#[pyfunction]
pub(crate) fn held_out_program(seed: u64) -> PyResult<Option<PythonProgram>> {
    let drawn = programs::program(seed);
    let program = PythonProgram::named(format!("{}.ngc", drawn.name), drawn.text)?;
    let read = program
        .program
        .check(program.settings.clone())
        .map_err(JobError::from);
    let read = read.map_err(|error| exception(&error.into()))?;
    Ok((!read.moves[2]).then_some(program))
}

/// Returns the machine of a seed; none if it has no noise.
#[pyfunction]
pub(crate) fn held_out_machine(seed: u64) -> PyResult<Option<PythonMachine>> {
    let drawn = machines::machine(seed, Class::Realistic);
    let machine = PythonMachine::parsed(&format!("{}.toml", drawn.name), &drawn.text());
    let machine = machine.map_err(|error| exception(&error.into()))?;
    Ok(machine.machine.is_noisy().then_some(machine))
}

/// Returns the parameters of a controller that the search of the laboratory finds on a machine
/// whose values it knows. Takes seconds to minutes.
#[cfg(feature = "peers")]
#[pyfunction]
pub(crate) fn searched_settings(
    py: Python<'_>,
    controller: String,
    machine: Py<PythonMachine>,
) -> PyResult<std::collections::BTreeMap<String, f64>> {
    crate::watched::watched(py, None, move |watch| {
        let entry = feedwright::command::find(&controller, feedwright_lab::CONTROLLERS)?;
        let tuned = feedwright_lab::compare::tuning::search(
            entry,
            &machine.get().machine,
            super::task::RECORDING_SEED,
            watch,
        );
        let settings = tuned.into_diagnostic()?.settings(entry);
        Ok(settings
            .iter()
            .map(|setting| (setting.name.to_owned(), setting.value))
            .collect())
    })
}

/// Part of a page: target of a link, heading, heads of its table, rows.
type TablePart = (String, String, Vec<String>, Vec<Vec<String>>);

/// Returns a page of tables, which needs no other file.
#[pyfunction]
pub(crate) fn tables_page(
    title: &str,
    introduction: &str,
    parts: Vec<TablePart>,
) -> PyResult<String> {
    let pages: Vec<PagePart> = parts
        .iter()
        .map(|(id, title, ..)| PagePart::new(id, title.as_str()))
        .collect();
    let mut page = Vec::new();
    write_head(&mut page, "tables", title, introduction, &pages)?;
    for (part, (_, _, heads, rows)) in pages.iter().zip(&parts) {
        part.begin(&mut page)?;
        write_table_head(&mut page, heads.iter().map(String::as_str))?;
        for row in rows {
            let cells: Vec<String> = row
                .iter()
                .map(|cell| format!("<td>{}</td>", escaped(cell)))
                .collect();
            page.extend_from_slice(format!("<tr>{}</tr>\n", cells.concat()).as_bytes());
        }
        write_table_end(&mut page)?;
        PagePart::end(&mut page)?;
    }
    write_foot(&mut page)?;
    String::from_utf8(page)
        .into_diagnostic()
        .map_err(|error| exception(&error))
}
