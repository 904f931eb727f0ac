//! Compares the identifier with FANN, a C library of small neural networks, on the same 10-12-2
//! network: `just bench-fann`.
//!
//! `fann/fann_bench.c` is compiled against double and single FANN, and gets the same weights and
//! samples. First, double FANN must agree in its outputs and in its weights after one step. Then
//! rounds alternate between the programs, each round in reverse order of the last; the figures are
//! medians over rounds of medians over batches. If callgrind is installed, it counts the
//! instructions of two numbers of operations, and the counts are subtracted.
//!
//! FANN has 14 more connections, from bias neurons; no setting removes them. FANN is used as its
//! distribution compiled it, the identifier as `cargo bench` compiles it, both for any x86-64.

#![expect(clippy::unwrap_used, reason = "a bench may stop")]

use std::fmt::Write as _;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use feedwright_control::{ContourIdentifier, ContourModel, Inputs};

/// Constants with the same values as in `fann_bench.c`.
const SAMPLES: usize = 64;
const BATCHES: usize = 101;
const BATCH: usize = 4096;
const LEARNING_STEP: f64 = 0.015625;

/// Number of rounds; odd, so that the median is one of them.
const ROUNDS: usize = 11;
/// Largest permitted difference: several roundings of sums of ten products below 1, and the
/// exponentials of FANN and of the identifier, 1e-15 each.
const AGREEMENT: f64 = 1e-14;
/// Numbers of operations whose instruction counts are subtracted.
const COUNTS: [u64; 2] = [1000, 3000];

type Network = ContourIdentifier<2>;
type Sample = (Inputs<2>, [f64; 2]);

/// Compared operations.
const WORK: [&str; 2] = ["forward", "learn"];

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let (net, samples) = material();
    if let [kind, work, count] = arguments.as_slice()
        && kind == "count"
    {
        let index = WORK.iter().position(|w| w == work).unwrap();
        return run(index, &mut net.clone(), &samples, count.parse().unwrap());
    }
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"));
    let file = folder.join("fann_bench.txt");
    std::fs::write(&file, text(&net, &samples)).unwrap();
    let libraries: Option<Vec<PathBuf>> = [("doublefann", "DOUBLE"), ("floatfann", "SINGLE")]
        .iter()
        .map(|(l, d)| compiled(&folder, l, d))
        .collect();
    let Some(libraries) = libraries else {
        return;
    };
    agree(&libraries[0], &file, &net, &samples[0]);
    times(&libraries, &file, &net, &samples);
    instructions(&libraries, &file);
}

/// Returns weights of the magnitude that training gives, and samples, from a linear congruential
/// sequence.
fn material() -> (Network, Vec<Sample>) {
    let mut state = 1_u32;
    let mut next = move || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state) / f64::from(u32::MAX) - 0.5
    };
    let hidden = std::array::from_fn(|_| std::array::from_fn(|_| std::array::from_fn(|_| next())));
    let output = std::array::from_fn(|_| std::array::from_fn(|_| next()));
    let mut sample = || {
        let inputs = std::array::from_fn(|_| std::array::from_fn(|_| 2.0 * next()));
        (inputs, [next(), next()])
    };
    let samples = (0..SAMPLES).map(|_| sample()).collect();
    (Network { hidden, output }, samples)
}

/// Returns the weights, hidden before output.
fn weights(net: &Network) -> Vec<f64> {
    let hidden = net.hidden.as_flattened().as_flattened();
    [hidden, net.output.as_flattened()].concat()
}

/// Returns the input of `fann_bench`, with every number to the last bit.
fn text(net: &Network, samples: &[Sample]) -> String {
    let mut text = String::new();
    let of_samples = samples
        .iter()
        .flat_map(|(inputs, error)| [inputs.as_flattened(), error].concat());
    for number in weights(net).into_iter().chain(of_samples) {
        writeln!(text, "{number:e}").unwrap();
    }
    text
}

/// Compiles `fann_bench` against one of FANN's libraries. Returns `None`, with a notice, if a
/// compiler or the library is missing.
fn compiled(folder: &Path, library: &str, define: &str) -> Option<PathBuf> {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/fann/fann_bench.c");
    let program = folder.join(format!("fann_bench_{library}"));
    let mut cc = Command::new("cc");
    cc.args(["-O2", "-std=c11", &format!("-D{define}"), "-o"])
        .args([&program, &source]);
    let why = match cc.args([&format!("-l{library}"), "-lm"]).output() {
        Ok(output) if output.status.success() => return Some(program),
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => format!("cc: {error}"),
    };
    eprintln!("SKIPPED, NOTHING WAS MEASURED: {library} does not compile.\n{why}");
    eprintln!("hint: Debian: apt-get install gcc libc6-dev libfann-dev");
    None
}

/// Returns the numbers that `fann_bench` prints.
fn numbers(program: &Path, file: &Path, what: &str) -> Vec<f64> {
    let output = Command::new(program).arg(file).arg(what).output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout)
        .unwrap()
        .split_whitespace()
        .map(|number| number.parse().unwrap())
        .collect()
}

/// Checks that both agree: outputs, and weights after one step.
fn agree(double: &Path, file: &Path, net: &Network, (inputs, error): &Sample) {
    let mut net = net.clone();
    let mut ours = net.predict(inputs).error.to_vec();
    let before = weights(&net);
    net.learn(inputs, *error, LEARNING_STEP);
    ours.extend(weights(&net));
    let theirs = numbers(double, file, "check");
    assert_eq!(ours.len(), theirs.len());
    let apart = ours
        .iter()
        .zip(&theirs)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    let moved = before
        .iter()
        .zip(&ours[2..])
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(
        apart <= AGREEMENT,
        "they compute different things: {apart:e}"
    );
    println!(
        "agreement with double FANN: {apart:.1e} in outputs and weights; the step moved a weight by {moved:.1e}"
    );
}

/// Prints the medians of the rounds and their ratios.
fn times(libraries: &[PathBuf], file: &Path, net: &Network, samples: &[Sample]) {
    // First index: program (the identifier, then the libraries). Second index: operation.
    let mut rounds = vec![[Vec::new(), Vec::new()]; 1 + libraries.len()];
    for round in 0..ROUNDS {
        let mut order: Vec<usize> = (0..rounds.len()).collect();
        if round % 2 == 1 {
            order.reverse();
        }
        for program in order {
            let each_ns = match program {
                0 => [0, 1].map(|work| time_ns(work, net, samples)).to_vec(),
                _ => numbers(&libraries[program - 1], file, "time"),
            };
            for work in 0..WORK.len() {
                rounds[program][work].push(each_ns[work]);
            }
        }
    }
    println!("{ROUNDS} rounds      identifier   double FANN (ratio)    float FANN (ratio)");
    for (work, name) in WORK.iter().enumerate() {
        let each: Vec<f64> = rounds
            .iter_mut()
            .map(|program| median(&mut program[work]))
            .collect();
        row(name, "ns", 1, &each);
    }
}

fn row(name: &str, unit: &str, digits: usize, each: &[f64]) {
    print!("{name:10} {:12.digits$} {unit}", each[0]);
    each[1..]
        .iter()
        .for_each(|theirs| print!(" {theirs:11.digits$} {unit} ({:4.1})", theirs / each[0]));
    println!();
}

/// Returns the median over the batches of the time of one operation, ns.
fn time_ns(work: usize, net: &Network, samples: &[Sample]) -> f64 {
    let mut net = net.clone();
    let mut each_ns: Vec<f64> = (0..BATCHES)
        .map(|_| {
            let start = Instant::now();
            run(work, &mut net, samples, BATCH as u64);
            start.elapsed().as_nanos() as f64 / BATCH as f64
        })
        .collect();
    median(&mut each_ns)
}

#[inline(never)]
fn run(work: usize, net: &mut Network, samples: &[Sample], count: u64) {
    for (inputs, error) in samples.iter().cycle().take(count as usize) {
        if work == 0 {
            black_box(net.predict(black_box(inputs)));
        } else {
            black_box(net.learn(black_box(inputs), black_box(*error), LEARNING_STEP));
        }
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Prints the instructions of one forward pass and of one step.
fn instructions(libraries: &[PathBuf], file: &Path) {
    for (work, name) in WORK.iter().enumerate() {
        let ours = |count: u64| {
            let mut command = vec![std::env::current_exe().unwrap().into_os_string()];
            command.extend(["count".into(), WORK[work].into(), count.to_string().into()]);
            command
        };
        let mut each = vec![counted(ours)];
        for library in libraries {
            each.push(counted(|count| {
                vec![
                    library.into(),
                    file.into(),
                    WORK[work].into(),
                    count.to_string().into(),
                ]
            }));
        }
        let Some(each) = each.into_iter().collect::<Option<Vec<f64>>>() else {
            eprintln!(
                "no instructions counted: valgrind does not run\nhint: Debian: apt-get install valgrind"
            );
            return;
        };
        row(name, "instr", 0, &each);
    }
}

/// Returns the instructions of one operation, from the command that runs a number of them.
fn counted(command: impl Fn(u64) -> Vec<std::ffi::OsString>) -> Option<f64> {
    let total = |count: u64| {
        let valgrind = ["--tool=callgrind", "--callgrind-out-file=/dev/null"];
        let output = Command::new("valgrind")
            .args(valgrind)
            .args(command(count))
            .output()
            .ok()?;
        let report = String::from_utf8_lossy(&output.stderr).into_owned();
        report.lines().find_map(|line| {
            line.split_once("Collected : ")?
                .1
                .trim()
                .parse::<f64>()
                .ok()
        })
    };
    Some((total(COUNTS[1])? - total(COUNTS[0])?) / (COUNTS[1] - COUNTS[0]) as f64)
}
