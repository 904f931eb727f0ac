//! `feedwright open` over its socket: what a page of another site, or another program on this
//! computer, gets from it.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::{Duration, Instant};

use serde_json::Value;

use crate::command::Folder;

const PROGRAM: &str = "G21 G90 F600\nG1 X10\nM2\n";

/// The command while it serves.
struct Open {
    child: Child,
    host: String,
    secret: String,
    folder: Folder,
}

impl Open {
    fn start() -> Self {
        let folder = Folder::new();
        folder.file("part.ngc", PROGRAM);
        folder.file("private.txt", "private");
        Self::start_in(folder, &["part.ngc"])
    }

    /// Starts it in a folder, where programs are looked for, too.
    fn start_in(folder: Folder, arguments: &[&str]) -> Self {
        let mut command = folder.command();
        let path = format!(
            "{}:{}",
            folder.path().display(),
            std::env::var("PATH").unwrap()
        );
        command
            .args(["open", "--no-browser", "--quiet"])
            .args(arguments)
            .env("PATH", path)
            .stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut address = String::new();
        BufReader::new(child.stdout.take().unwrap())
            .read_line(&mut address)
            .unwrap();
        let (host, secret) = address
            .trim()
            .strip_prefix("http://")
            .unwrap()
            .split_once('/')
            .unwrap();
        let (host, secret) = (host.to_owned(), secret.trim_end_matches('/').to_owned());
        Self {
            child,
            host,
            secret,
            folder,
        }
    }

    /// Sends a request as it is, and returns the whole answer.
    fn ask(&self, request: &[u8]) -> io::Result<String> {
        let mut stream = TcpStream::connect(&self.host)?;
        // A server that refuses the rest of a request may close before it was sent.
        let _ = stream.write_all(request);
        let mut answer = Vec::new();
        stream.read_to_end(&mut answer)?;
        Ok(String::from_utf8_lossy(&answer).into_owned())
    }

    /// Asks for a path with these lines after `Host`.
    fn get(&self, path: &str, headers: &str) -> String {
        self.ask(
            format!(
                "GET {path} HTTP/1.1\r\nHost: {}\r\n{headers}\r\n",
                self.host
            )
            .as_bytes(),
        )
        .unwrap()
    }
}

impl Drop for Open {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

#[test]
fn only_the_page_itself_gets_the_files_that_were_named() {
    let open = Open::start();
    let (host, secret) = (&open.host, &open.secret);
    let file = open.get(&format!("/{secret}/files/0"), "");
    assert!(
        file.starts_with("HTTP/1.1 200 ") && file.ends_with(PROGRAM),
        "{file}"
    );
    // Without the headers, a page of another site could show the page in a frame or read a file as
    // a script.
    for header in [
        "frame-ancestors 'none'",
        "Cross-Origin-Resource-Policy: same-origin",
        "nosniff",
        "no-store",
    ] {
        assert!(file.contains(header), "{header}: {file}");
    }
    assert!(!file.contains("Access-Control"), "{file}");

    let refused = |answer: String, status: &str| {
        assert!(
            answer.starts_with(&format!("HTTP/1.1 {status} ")) && !answer.contains("G1"),
            "{status}: {answer}"
        );
        assert!(
            !answer.contains("private") && !answer.contains(secret),
            "{answer}"
        );
    };
    let raw = |request: String| open.ask(request.as_bytes()).unwrap();
    // A name that another site has led to this computer.
    refused(
        raw(format!(
            "GET /{secret}/files/0 HTTP/1.1\r\nHost: rebound.example\r\n\r\n"
        )),
        "403",
    );
    refused(
        open.get(
            &format!("/{secret}/files/0"),
            "Origin: https://other.example\r\n",
        ),
        "403",
    );
    refused(
        raw(format!(
            "POST /{secret}/ HTTP/1.1\r\nHost: {host}\r\nContent-Length: 2\r\n\r\n{{}}"
        )),
        "405",
    );
    refused(open.get("/files/0", ""), "403");
    let wrong = "0".repeat(secret.len());
    refused(open.get(&format!("/{wrong}/files/0"), ""), "403");
    for path in [
        "files/../private.txt",
        "../private.txt",
        "%2e%2e/private.txt",
        "files/1",
        "files//0",
        "private.txt",
    ] {
        refused(open.get(&format!("/{secret}/{path}"), ""), "404");
    }
}

#[test]
fn what_is_no_request_is_refused_and_the_page_is_served_on() {
    let open = Open::start();
    let long = format!("GET /{} HTTP/1.1\r\n\r\n", "a".repeat(100_000));
    for request in [
        &b"\x16\x03\x01\0\xff"[..],
        b"GET /\r\n\r\n",
        b"\r\n\r\n",
        b"GET / HTTP/1.1\r\nHost: \xff\r\n\r\n",
        long.as_bytes(),
    ] {
        // The operating system may drop the answer to what was not read to its end.
        let answer = open.ask(request).unwrap_or_default();
        assert!(
            answer.is_empty() || answer.starts_with("HTTP/1.1 40"),
            "{answer}"
        );
    }
    assert!(
        open.get(&format!("/{}/", open.secret), "")
            .contains("<title>feedwright</title>")
    );
}

#[test]
fn a_thousand_connections_that_say_nothing_keep_the_page_for_a_short_time_only() {
    let open = Open::start();
    let page = format!(
        "GET /{}/ HTTP/1.1\r\nHost: {}\r\n\r\n",
        open.secret, open.host
    );
    let mut kept = VecDeque::new();
    for _ in 0..1000 {
        let mut stream = TcpStream::connect(&open.host).unwrap();
        // One byte at a time would be as good; some are sent the beginning.
        let _ = stream.write_all(b"GET /");
        kept.push_back(stream);
        // A process may have no more than a few hundred files.
        kept.drain(..kept.len().saturating_sub(400));
    }
    // All are still open on this side.
    let served = (0..300).any(|_| {
        std::thread::sleep(Duration::from_millis(100));
        kept.iter_mut()
            .for_each(|stream| drop(stream.write_all(b"a")));
        open.ask(page.as_bytes())
            .is_ok_and(|answer| answer.contains("<title>feedwright</title>"))
    });
    assert!(served, "the page is not served any more");
}

/// Replaces LinuxCNC's `halcmd`: shows the pins of a file, and records the requests.
#[cfg(unix)]
const HALCMD: &str = "#!/bin/sh
while read -r command; do
    echo \"$command\" >> asked
    grep -F \"${command##* }\" pins
    echo
done
";

#[cfg(unix)]
const PINS: &str = "feedwright float IN 10 feedwright.actual-0 <== x-actual
feedwright float IN -2.5 feedwright.actual-1 <== y-actual
feedwright float IN 0 feedwright.actual-2
feedwright float OUT 0.0003 feedwright.contour-error
feedwright float OUT 0.0123 feedwright.contour-error-without
feedwright float OUT 0.04 feedwright.correction-0
feedwright float IN 0.5 feedwright.deviation-limit
feedwright bit   IN TRUE feedwright.enable
feedwright bit   OUT FALSE feedwright.fault
feedwright u32   OUT 0 feedwright.cause
feedwright u32   OUT 4 feedwright.state
";

/// The page gets what the pins say, and a reason where they say nothing. They are shown and never
/// written.
#[cfg(unix)]
#[test]
fn the_machine_is_read_and_not_written() {
    use std::os::unix::fs::PermissionsExt as _;
    let folder = Folder::new();
    folder.file("halcmd", HALCMD);
    std::fs::set_permissions(
        folder.path().join("halcmd"),
        std::fs::Permissions::from_mode(0o755),
    )
    .unwrap();
    folder.file("pins", "");
    let open = Open::start_in(folder, &["--hal=inch"]);
    let path = format!("/{}/hal/0", open.secret);
    let said = |is_so: &dyn Fn(&Value) -> bool| {
        let (began, mut now) = (Instant::now(), Value::Null);
        while began.elapsed() < Duration::from_secs(30) {
            let answer = open.get(&path, "");
            assert!(
                answer.starts_with("HTTP/1.1 200 ") && answer.contains("no-store"),
                "{answer}"
            );
            now = serde_json::from_str(answer.split_once("\r\n\r\n").unwrap().1).unwrap();
            if is_so(&now) {
                return now;
            }
            std::thread::sleep(Duration::from_millis(20));
        }
        panic!("{now}");
    };
    let trouble = |words: &'static str| {
        move |now: &Value| {
            now["trouble"]
                .as_str()
                .is_some_and(|why| why.contains(words))
        }
    };
    said(&trouble("LinuxCNC does not run"));
    open.folder
        .file("pins", "motion u32 OUT 0 motion.motion-type\n");
    said(&trouble("without the component feedwright"));
    open.folder.file("pins", PINS);
    let now = said(&|now| now["rows"].as_array().unwrap().len() > 2);
    let row: Vec<f64> = now["rows"][0]
        .as_array()
        .unwrap()
        .iter()
        .skip(1)
        .map(|number| number.as_f64().unwrap())
        .collect();
    for (number, wanted) in row.iter().zip([254.0, -63.5, 0.0, 0.3, 12.3, 4.0]) {
        assert!((number - wanted).abs() < 1e-9, "{row:?}");
    }
    assert_eq!(now["now"]["limit_um"], 500.0);
    assert!(
        now["trouble"].is_null() && now["now"]["cause"].is_null() && now["now"]["enable"] == true,
        "{now}"
    );
    // LinuxCNC ends.
    open.folder.file("pins", "");
    said(&trouble("LinuxCNC does not run"));
    let asked = open.folder.text("asked");
    assert!(
        asked
            .lines()
            .all(|line| line == "show pin feedwright." || line == "show pin motion."),
        "{asked}"
    );
    // It is for the page itself, as everything is.
    assert!(open.get("/hal/0", "").starts_with("HTTP/1.1 403 "));
    assert!(
        open.get(&path, "Origin: https://other.example\r\n")
            .starts_with("HTTP/1.1 403 ")
    );
}

#[test]
fn without_linuxcnc_there_is_no_machine_to_show() {
    let folder = Folder::new();
    let ran = folder
        .command()
        .args(["open", "--no-browser", "--hal"])
        .env("PATH", folder.path())
        .output()
        .unwrap();
    let reported = String::from_utf8_lossy(&ran.stderr);
    assert!(
        ran.status.code() == Some(2)
            && reported.contains("there is no halcmd")
            && reported.contains("hint: "),
        "{reported}"
    );
}
