//! What went wrong once, as small as it could be made.

use feedwright::gcode::{Reader, Settings};

/// Found by mutation: each call made two more and an error, and the reader counted millions of them.
#[test]
fn a_program_that_errs_ever_more_often_is_given_up() {
    let text = "o<twice> sub\nG1 [oops\no<twice> call\no<twice> call\no<twice> endsub\nG1 X1 F100\no<twice> call\nM2\n";
    let mut reader = Reader::from_text("twice.ngc", text, Settings::default()).unwrap();
    let faults: Vec<_> = reader.by_ref().filter_map(Result::err).collect();
    let last = faults.last().unwrap();
    assert!(last.message.contains("the rest of the program was not read"), "{}", last.message);
    assert!(reader.lines() < 1_000_000, "{} lines", reader.lines());
}
