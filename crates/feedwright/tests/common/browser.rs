//! Chromium without a window, driven through its debugging pipe: two pipes that carry JSON, each
//! message ended by a zero.

use std::fs::File;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::Duration;

use serde_json::{Value, json};

use crate::missing::missing;

const BROWSERS: [&str; 3] = ["chromium", "chromium-browser", "google-chrome"];
/// A browser that says nothing for so long is stuck, however busy the machine is.
const PATIENCE: Duration = Duration::from_secs(600);

pub(crate) struct Browser {
    process: Child,
    commands: File,
    answers: Receiver<Value>,
    sent: u64,
    session: Option<String>,
    faults: Vec<String>,
    _folder: tempfile::TempDir,
}

impl Browser {
    /// None where there is no browser: it says so, and under CI fails.
    pub(crate) fn start() -> Option<Self> {
        let there = |name: &&&str| {
            Command::new(name)
                .arg("--version")
                .stdout(Stdio::null())
                .stderr(Stdio::null())
                .status()
                .is_ok()
        };
        let Some(name) = BROWSERS.iter().find(there) else {
            missing(&format!("none of {BROWSERS:?} is installed"));
            return None;
        };
        let folder = tempfile::tempdir().unwrap();
        let pipes = ["in", "out"].map(|name| folder.path().join(name));
        assert!(
            Command::new("mkfifo")
                .args(&pipes)
                .status()
                .unwrap()
                .success()
        );
        // The shell opens the pipes as the descriptors that the browser takes.
        let process = Command::new("sh")
            .args([
                "-c",
                "exec \"$0\" \"$@\" 3<\"$PIPE_IN\" 4>\"$PIPE_OUT\"",
                name,
            ])
            .args([
                "--headless",
                "--no-sandbox",
                "--disable-gpu",
                "--disable-quic",
                "--no-first-run",
                "--disable-sync",
            ])
            .args([
                "--disable-background-networking",
                "--disable-component-update",
                "--remote-debugging-pipe",
            ])
            .arg(format!(
                "--user-data-dir={}",
                folder.path().join("profile").display()
            ))
            .env("PIPE_IN", &pipes[0])
            .env("PIPE_OUT", &pipes[1])
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let commands = File::options().write(true).open(&pipes[0]).unwrap();
        let mut out = BufReader::new(File::open(&pipes[1]).unwrap());
        let (sender, answers) = channel();
        std::thread::spawn(move || {
            let mut message = Vec::new();
            while out
                .read_until(0, &mut message)
                .is_ok_and(|length| length > 0)
            {
                message.pop();
                if sender
                    .send(serde_json::from_slice(&message).unwrap())
                    .is_err()
                {
                    return;
                }
                message.clear();
            }
        });
        let mut browser = Self {
            process,
            commands,
            answers,
            sent: 0,
            session: None,
            faults: Vec::new(),
            _folder: folder,
        };
        let targets = browser.call("Target.getTargets", &json!({}));
        let page = targets["targetInfos"]
            .as_array()
            .unwrap()
            .iter()
            .find(|target| target["type"] == "page")
            .unwrap();
        let attached = browser.call(
            "Target.attachToTarget",
            &json!({"targetId": page["targetId"], "flatten": true}),
        );
        browser.session = Some(attached["sessionId"].as_str().unwrap().to_owned());
        for domain in ["Page", "Runtime", "Log"] {
            browser.call(&format!("{domain}.enable"), &json!({}));
        }
        Some(browser)
    }

    /// Sends a command and waits for its result.
    pub(crate) fn call(&mut self, method: &str, parameters: &Value) -> Value {
        self.sent += 1;
        let mut message = json!({"id": self.sent, "method": method, "params": parameters});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.commands
            .write_all(message.to_string().as_bytes())
            .unwrap();
        self.commands.write_all(&[0]).unwrap();
        loop {
            let answer = self.next();
            if answer["id"] == self.sent {
                assert!(answer["error"].is_null(), "{method}: {answer}");
                return answer["result"].clone();
            }
        }
    }

    /// The next message; faults of the page are kept.
    fn next(&mut self) -> Value {
        let message = self.answers.recv_timeout(PATIENCE).unwrap();
        if ["Runtime.exceptionThrown", "Log.entryAdded"]
            .iter()
            .any(|fault| message["method"] == *fault)
        {
            self.faults.push(message["params"].to_string());
        }
        message
    }

    /// Sets the size of the screen in pixels; `phone` turns on touch input and the mobile mode.
    pub(crate) fn screen(&mut self, width: u32, height: u32, phone: bool) {
        let metrics =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": phone});
        self.call("Emulation.setDeviceMetricsOverride", &metrics);
        self.call(
            "Emulation.setTouchEmulationEnabled",
            &json!({ "enabled": phone }),
        );
    }

    /// Opens a file and waits until it is loaded and has been drawn.
    pub(crate) fn open(&mut self, file: &Path, fragment: &str) {
        self.call("Page.navigate", &json!({"url": "about:blank"}));
        self.call(
            "Page.navigate",
            &json!({"url": format!("file://{}{fragment}", file.display())}),
        );
        self.until("document.readyState === 'complete' && location.protocol === 'file:'");
        self.frames();
    }

    /// Waits until an expression is true.
    pub(crate) fn until(&mut self, condition: &str) {
        let start = std::time::Instant::now();
        while self.value(condition) != true {
            assert!(start.elapsed() < PATIENCE, "never: {condition}");
            std::thread::sleep(Duration::from_millis(20));
        }
    }

    /// Waits until what was changed is drawn.
    pub(crate) fn frames(&mut self) {
        self.value("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(() => done(true))))");
    }

    /// The value of an expression in the page.
    pub(crate) fn value(&mut self, expression: &str) -> Value {
        let asked = json!({"expression": expression, "returnByValue": true, "awaitPromise": true});
        let result = self.call("Runtime.evaluate", &asked);
        assert!(
            result["exceptionDetails"].is_null(),
            "{expression}: {result}"
        );
        result["result"]["value"].clone()
    }

    /// Clicks what a selector finds, and waits for the drawings.
    pub(crate) fn click(&mut self, selector: &str) {
        self.value(&format!(
            "document.querySelector({}).click()",
            json!(selector)
        ));
        self.frames();
    }

    /// Presses a key where the focus is, and waits for the drawings.
    pub(crate) fn press(&mut self, key: &str, code: u32) {
        let text = if key.chars().count() == 1 {
            json!(key)
        } else {
            Value::Null
        };
        for kind in ["keyDown", "keyUp"] {
            let mut event = json!({"type": kind, "key": key, "windowsVirtualKeyCode": code});
            if kind == "keyDown" && !text.is_null() {
                event["text"] = text.clone();
            }
            self.call("Input.dispatchKeyEvent", &event);
        }
        self.frames();
    }

    /// A finger that goes down, moves up by `way` pixels and is lifted.
    pub(crate) fn swipe_up(&mut self, x: f64, y: f64, way: f64) {
        const STEPS: u32 = 12;
        let touch = |kind: &str, y: f64| json!({"type": kind, "touchPoints": [{"x": x, "y": y}]});
        self.call("Input.dispatchTouchEvent", &touch("touchStart", y));
        for k in 1..=STEPS {
            self.call(
                "Input.dispatchTouchEvent",
                &touch("touchMove", y - way * f64::from(k) / f64::from(STEPS)),
            );
            self.frames();
        }
        self.call(
            "Input.dispatchTouchEvent",
            &json!({"type": "touchEnd", "touchPoints": []}),
        );
        self.frames();
    }

    /// Returns the errors that the page's scripts threw, and those in the console.
    pub(crate) fn faults(&mut self) -> &[String] {
        self.frames();
        &self.faults
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
