//! `feedwright open` over its socket: what a page of another site, or another program on this computer, gets from it.

use std::collections::VecDeque;
use std::io::{self, BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::command::Folder;

const PROGRAM: &str = "G21 G90 F600\nG1 X10\nM2\n";

/// The command while it serves.
struct Open {
    child: Child,
    host: String,
    secret: String,
    _folder: Folder,
}

impl Open {
    fn start() -> Self {
        let folder = Folder::new();
        folder.file("part.ngc", PROGRAM);
        folder.file("private.txt", "private");
        let mut command = folder.command();
        command.args(["open", "--no-browser", "--quiet", "part.ngc"]).stdout(Stdio::piped());
        let mut child = command.spawn().unwrap();
        let mut address = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut address).unwrap();
        let (host, secret) = address.trim().strip_prefix("http://").unwrap().split_once('/').unwrap();
        let (host, secret) = (host.to_owned(), secret.trim_end_matches('/').to_owned());
        Self { child, host, secret, _folder: folder }
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
        self.ask(format!("GET {path} HTTP/1.1\r\nHost: {}\r\n{headers}\r\n", self.host).as_bytes()).unwrap()
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
    assert!(file.starts_with("HTTP/1.1 200 ") && file.ends_with(PROGRAM), "{file}");
    // Without the headers, a page of another site could show the page in a frame or read a file as a script.
    for header in ["frame-ancestors 'none'", "Cross-Origin-Resource-Policy: same-origin", "nosniff", "no-store"] {
        assert!(file.contains(header), "{header}: {file}");
    }
    assert!(!file.contains("Access-Control"), "{file}");

    let refused = |answer: String, status: &str| {
        assert!(answer.starts_with(&format!("HTTP/1.1 {status} ")) && !answer.contains("G1"), "{status}: {answer}");
        assert!(!answer.contains("private") && !answer.contains(secret), "{answer}");
    };
    let raw = |request: String| open.ask(request.as_bytes()).unwrap();
    // A name that another site has led to this computer.
    refused(raw(format!("GET /{secret}/files/0 HTTP/1.1\r\nHost: rebound.example\r\n\r\n")), "403");
    refused(open.get(&format!("/{secret}/files/0"), "Origin: https://other.example\r\n"), "403");
    refused(raw(format!("POST /{secret}/ HTTP/1.1\r\nHost: {host}\r\nContent-Length: 2\r\n\r\n{{}}")), "405");
    refused(open.get("/files/0", ""), "403");
    let wrong = "0".repeat(secret.len());
    refused(open.get(&format!("/{wrong}/files/0"), ""), "403");
    for path in ["files/../private.txt", "../private.txt", "%2e%2e/private.txt", "files/1", "files//0", "private.txt"] {
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
        assert!(answer.is_empty() || answer.starts_with("HTTP/1.1 40"), "{answer}");
    }
    assert!(open.get(&format!("/{}/", open.secret), "").contains("<title>feedwright</title>"));
}

#[test]
fn a_thousand_connections_that_say_nothing_keep_the_page_for_a_short_time_only() {
    let open = Open::start();
    let page = format!("GET /{}/ HTTP/1.1\r\nHost: {}\r\n\r\n", open.secret, open.host);
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
        kept.iter_mut().for_each(|stream| drop(stream.write_all(b"a")));
        open.ask(page.as_bytes()).is_ok_and(|answer| answer.contains("<title>feedwright</title>"))
    });
    assert!(served, "the page is not served any more");
}
