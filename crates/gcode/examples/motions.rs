//! Prints every motion of a program: `cargo run -p feedwright-gcode --example motions -- part.ngc`.

use std::path::Path;
use std::process::ExitCode;

use feedwright_gcode::canon::Canon;
use feedwright_gcode::{ReadError, Reader, Settings};

fn main() -> Result<ExitCode, ReadError> {
    let path = std::env::args_os()
        .nth(1)
        .unwrap_or_else(|| "part.ngc".into());
    let mut code = ExitCode::SUCCESS;
    for step in Reader::open(Path::new(&path), Settings::default())? {
        match step {
            Ok(Canon::Motion(motion)) => {
                let [x, y, z] = motion.end_mm;
                println!(
                    "line {}: to X{x:.3} Y{y:.3} Z{z:.3}, {:.3} mm",
                    motion.line,
                    motion.length_mm()
                );
            }
            Ok(Canon::Event(event)) => println!("line {}: {:?}", event.line, event.kind),
            Err(fault) => {
                eprintln!("line {}: {}", fault.line, fault.message);
                code = ExitCode::FAILURE;
            }
        }
    }
    Ok(code)
}
