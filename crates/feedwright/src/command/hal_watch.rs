//! What the component `feedwright` of a running LinuxCNC does: the values of its pins, 25 times a
//! second. LinuxCNC's `halcmd` reads them, as a process of its own that only ever gets the command
//! `show pin`. Nothing is read while no page asks.

use std::collections::{HashMap, VecDeque};
use std::io::{self, BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread;
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Time between two readings. A reading takes 0.1 ms.
const PERIOD: Duration = Duration::from_millis(40);
/// Wait before the next attempt after a failed reading.
const AGAIN: Duration = Duration::from_secs(1);
/// A page asks five times a second. When the last one is gone, reading ends.
const UNASKED: Duration = Duration::from_secs(3);
/// A `halcmd` that answers later than this is stuck.
const LATE: Duration = Duration::from_secs(3);
/// Readings that a page gets that comes later: those of a minute.
const KEPT: usize = 1500;
/// File with the text of each fault, as the component installs it.
const FAULTS: &str = "/usr/share/feedwright/faults.h";

const NOT_RUNNING: &str =
    "LinuxCNC does not run on this computer. Start it, and this page goes on.";
const NOT_LOADED: &str = "LinuxCNC runs without the component feedwright. 'feedwright linuxcnc setup' says how to add it to your machine.";
const STUCK: &str = "halcmd does not answer. Start LinuxCNC again.";

/// Reads the pins while pages ask for them.
#[derive(Debug)]
pub(crate) struct HalWatch {
    /// Millimeters in a unit of the joints.
    unit_mm: f64,
    fault_words: Vec<String>,
    recent: Mutex<RecentPins>,
}

/// The last readings.
#[derive(Debug)]
struct RecentPins {
    began: Instant,
    asked: Instant,
    tried: Instant,
    /// Number of the next row.
    next: u64,
    /// Time in s, position in mm, contour error with and without the correction in um, state.
    rows: VecDeque<[f64; 7]>,
    now: Value,
    trouble: Option<String>,
}

impl HalWatch {
    /// Begins to watch.
    ///
    /// Fails if `halcmd` cannot be started.
    pub(crate) fn start(unit_mm: f64) -> io::Result<Arc<Self>> {
        let halcmd = Halcmd::start()?;
        let now = Instant::now();
        let recent = RecentPins {
            began: now,
            asked: now,
            tried: now,
            next: 0,
            rows: VecDeque::new(),
            now: Value::Null,
            trouble: None,
        };
        let watch = Arc::new(Self {
            unit_mm,
            fault_words: fault_words(),
            recent: Mutex::new(recent),
        });
        let reader = Arc::clone(&watch);
        thread::Builder::new().spawn(move || reader.read_on(Some(halcmd)))?;
        Ok(watch)
    }

    /// The readings from number `from` on, and what holds now, as JSON.
    pub(crate) fn since(&self, from: u64) -> Value {
        let mut recent = self.recent();
        recent.asked = Instant::now();
        let first = recent.next - recent.rows.len() as u64;
        let rows: Vec<_> = recent
            .rows
            .iter()
            .skip(from.saturating_sub(first) as usize)
            .collect();
        let trouble = if recent.tried.elapsed() > LATE {
            Some(STUCK)
        } else {
            recent.trouble.as_deref()
        };
        json!({ "next": recent.next, "rows": rows, "now": recent.now, "trouble": trouble })
    }

    fn recent(&self) -> MutexGuard<'_, RecentPins> {
        self.recent.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn read_on(&self, mut halcmd: Option<Halcmd>) {
        loop {
            let is_asked = {
                let mut recent = self.recent();
                recent.tried = Instant::now();
                recent.asked.elapsed() < UNASKED
            };
            if !is_asked {
                // A process that stays would be one more user of HAL.
                halcmd = None;
                thread::sleep(PERIOD);
                continue;
            }
            match read(&mut halcmd) {
                Ok(pins) => self.keep(&pins),
                Err(trouble) => {
                    // After another start of LinuxCNC, its memory is another one.
                    halcmd = None;
                    let mut recent = self.recent();
                    (recent.now, recent.trouble) = (Value::Null, Some(trouble));
                    drop(recent);
                    thread::sleep(AGAIN);
                }
            }
            thread::sleep(PERIOD);
        }
    }

    fn keep(&self, pins: &Pins) {
        let pin = |name: &str| pins.get(name).copied().unwrap_or(0.0);
        let vector =
            |name: &str, factor: f64| [0, 1, 2].map(|axis| factor * pin(&format!("{name}-{axis}")));
        let cause = pin("cause") as usize;
        let words = self
            .fault_words
            .get(cause)
            .map_or_else(|| format!("cause {cause}"), Clone::clone);
        let now = json!({
            "state": pin("state"),
            "enable": pin("enable") != 0.0,
            "cause": (cause > 0).then_some(words),
            "fault": pin("fault") != 0.0,
            "correction_um": vector("correction", 1e3),
            "limit_um": 1e3 * pin("deviation-limit"),
        });
        let [x, y, z] = vector("actual", self.unit_mm);
        let errors = ["contour-error", "contour-error-without"].map(|name| 1e3 * pin(name));
        let mut recent = self.recent();
        let t_s = recent.began.elapsed().as_secs_f64();
        recent
            .rows
            .push_back([t_s, x, y, z, errors[0], errors[1], pin("state")]);
        if recent.rows.len() > KEPT {
            recent.rows.pop_front();
        }
        recent.next += 1;
        (recent.now, recent.trouble) = (now, None);
    }
}

/// Values of the pins of the component, by their names in it. Of a bit, on is 1.
type Pins = HashMap<String, f64>;

/// Reads the pins once. Starts `halcmd` if it is not running.
fn read(halcmd: &mut Option<Halcmd>) -> Result<Pins, String> {
    let started = match halcmd.take() {
        Some(halcmd) => halcmd,
        None => Halcmd::start().map_err(|error| format!("halcmd does not start: {error}"))?,
    };
    let halcmd = halcmd.insert(started);
    // LinuxCNC ends it together with itself.
    let mut show = |of: &str| halcmd.show(of).map_err(|_| NOT_RUNNING.to_owned());
    let pins = show("feedwright.")?;
    if pins.contains_key("state") {
        return Ok(pins);
    }
    Err(if show("motion.")?.is_empty() {
        NOT_RUNNING
    } else {
        NOT_LOADED
    }
    .to_owned())
}

/// The program, waiting for commands.
struct Halcmd {
    child: Child,
    commands: Option<ChildStdin>,
    answers: BufReader<ChildStdout>,
}

impl Halcmd {
    fn start() -> io::Result<Self> {
        let mut command = Command::new("halcmd");
        command
            .args(["-s", "-f"])
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::null());
        let mut child = command.spawn()?;
        let (commands, answers) = (
            child.stdin.take(),
            child.stdout.take().ok_or(io::ErrorKind::BrokenPipe)?,
        );
        Ok(Self {
            child,
            commands,
            answers: BufReader::new(answers),
        })
    }

    /// The pins of a component. An answer ends with an empty line; a line is `OWNER TYPE DIRECTION
    /// VALUE NAME` and what it is connected to.
    fn show(&mut self, component: &str) -> io::Result<Pins> {
        let commands = self.commands.as_mut().ok_or(io::ErrorKind::BrokenPipe)?;
        commands.write_all(format!("show pin {component}\n").as_bytes())?;
        commands.flush()?;
        let mut pins = Pins::new();
        loop {
            let mut line = String::new();
            if self.answers.read_line(&mut line)? == 0 {
                return Err(io::ErrorKind::UnexpectedEof.into());
            }
            let words: Vec<_> = line.split_whitespace().collect();
            let &[_, _, _, value, name, ..] = words.as_slice() else {
                return Ok(pins);
            };
            let value = match value {
                "TRUE" => Some(1.0),
                "FALSE" => Some(0.0),
                number => number.parse().ok(),
            };
            if let (Some(name), Some(value)) = (name.strip_prefix(component), value) {
                pins.insert(name.to_owned(), value);
            }
        }
    }
}

impl Drop for Halcmd {
    /// Closes the input of `halcmd`, which then leaves HAL by itself. A killed process would not.
    fn drop(&mut self) {
        drop(self.commands.take());
        let _ = self.child.wait();
    }
}

/// The causes in words, by number; none where the component is not installed here.
fn fault_words() -> Vec<String> {
    let text = std::fs::read_to_string(FAULTS).unwrap_or_default();
    let list = text
        .split_once("words[] = {")
        .and_then(|(_, rest)| rest.split_once("};"))
        .map_or("", |(list, _)| list);
    list.lines()
        .filter_map(|line| {
            line.trim()
                .strip_prefix('"')?
                .strip_suffix("\",")
                .map(str::to_owned)
        })
        .collect()
}
