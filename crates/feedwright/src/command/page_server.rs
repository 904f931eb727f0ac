//! The page in a browser, served to this computer by HTTP/1.1.
//!
//! ```text
//! http://127.0.0.1:PORT/SECRET/            the page and its files, which are parts of this command
//! http://127.0.0.1:PORT/SECRET/files.json  names of the user's files, and whether there is a machine
//! http://127.0.0.1:PORT/SECRET/files/0     the first of them
//! http://127.0.0.1:PORT/SECRET/hal/0       what the machine does, from reading 0 on
//! ```
//!
//! No request names a place in the file system. A page of another site can send requests here, but
//! it neither knows the secret nor has the right `Host` (a name that is rebound to this computer)
//! and `Origin`.

use std::collections::hash_map::RandomState;
use std::fs::File;
use std::hash::BuildHasher;
use std::io::{self, Read, Write};
use std::net::{Ipv4Addr, TcpListener, TcpStream};
use std::path::PathBuf;
use std::sync::Arc;
use std::thread;
use std::time::{Duration, Instant};

use feedwright_gcode::input;
use serde_json::json;

use super::hal_watch::HalWatch;

/// Name, type and bytes of each file of the page; none where it was not built (`web/page`).
#[cfg(has_page)]
const PAGE: &[(&str, &str, &[u8])] = &[
    (
        "",
        "text/html; charset=utf-8",
        include_bytes!("../../assets/app/index.html"),
    ),
    (
        "app.css",
        "text/css; charset=utf-8",
        include_bytes!("../../assets/app/app.css"),
    ),
    (
        "app.js",
        "text/javascript; charset=utf-8",
        include_bytes!("../../assets/app/app.js"),
    ),
    (
        "engine.js",
        "text/javascript; charset=utf-8",
        include_bytes!("../../assets/app/engine.js"),
    ),
    // The page inflates it: as a type of its own no server or browser does so before.
    (
        "engine.wasm.gz",
        "application/octet-stream",
        include_bytes!("../../assets/app/engine.wasm.gz"),
    ),
];
#[cfg(not(has_page))]
const PAGE: &[(&str, &str, &[u8])] = &[];

/// True if this command was built with the page.
pub(crate) const HAS_PAGE: bool = !PAGE.is_empty();

/// Headers of every answer. Frames of other sites cannot show the page; its own policy stands in
/// `index.html`.
const HEADERS: &str = "Content-Security-Policy: frame-ancestors 'none'\r\nX-Content-Type-Options: nosniff\r\n\
    Referrer-Policy: no-referrer\r\nCross-Origin-Resource-Policy: same-origin\r\nCache-Control: no-store\r\nConnection: close\r\n";

/// Most connections at a time: a browser has six.
const CONNECTIONS: usize = 16;
/// Most bytes of a request: browsers send less than 2 kB.
const REQUEST_BYTES: usize = 16 * 1024;
/// Most bytes of a file: more does not fit into the memory of the page.
const FILE_BYTES: u64 = 512 * 1024 * 1024;
/// A connection that takes no byte of an answer for longer is closed.
const IDLE: Duration = Duration::from_secs(10);
/// A request must be complete within this time. Browsers send theirs at once, and connect again if
/// an early connection was closed.
const REQUEST_TIME: Duration = Duration::from_secs(2);

/// An answer: status, type and body.
type Answer = (&'static str, &'static str, Vec<u8>);

/// The page at an address of this computer.
#[derive(Debug)]
pub(crate) struct PageServer {
    listener: TcpListener,
    site: Arc<Site>,
}

/// The files that are served, with the port and the secret that an address must have.
#[derive(Debug)]
struct Site {
    port: u16,
    secret: String,
    files: Vec<PathBuf>,
    hal: Option<Arc<HalWatch>>,
}

impl PageServer {
    /// Takes a free port.
    ///
    /// # Errors
    /// What the operating system says.
    pub(crate) fn bind(files: Vec<PathBuf>, hal: Option<Arc<HalWatch>>) -> io::Result<Self> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0))?;
        let port = listener.local_addr()?.port();
        // Keyed with random numbers of the operating system; the key stays in here.
        let key = RandomState::new();
        let secret = format!("{:016x}{:016x}", key.hash_one(0), key.hash_one(1));
        Ok(Self {
            listener,
            site: Arc::new(Site {
                port,
                secret,
                files,
                hal,
            }),
        })
    }

    /// Returns the address of the page.
    pub(crate) fn address(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.site.port, self.site.secret)
    }

    /// Answers until the process ends.
    pub(crate) fn serve(&self) {
        for connection in self.listener.incoming().flatten() {
            // The site is held once here, and once by each connection.
            if Arc::strong_count(&self.site) > CONNECTIONS {
                continue;
            }
            let site = Arc::clone(&self.site);
            // Of a thread that does not start, the connection is closed.
            let _ = thread::Builder::new().spawn(move || site.connection(connection));
        }
    }
}

impl Site {
    /// Answers one request. A browser that went away needs no answer.
    fn connection(&self, mut stream: TcpStream) {
        if stream.set_write_timeout(Some(IDLE)).is_err() {
            return;
        }
        let Ok(request) = read_head(&mut InTime {
            stream: &stream,
            until: Instant::now() + REQUEST_TIME,
        }) else {
            return;
        };
        let (status, kind, body) = request.map_or_else(
            || reported("400 Bad Request"),
            |request| self.answer(&request),
        );
        let length = body.len();
        let head = format!(
            "HTTP/1.1 {status}\r\nContent-Type: {kind}\r\nContent-Length: {length}\r\n{HEADERS}\r\n"
        );
        let _ = stream
            .write_all(head.as_bytes())
            .and_then(|()| stream.write_all(&body));
    }

    fn answer(&self, request: &str) -> Answer {
        let mut lines = request.split("\r\n");
        let mut words = lines.next().unwrap_or_default().split(' ');
        let (Some(method), Some(target), Some("HTTP/1.1"), None) =
            (words.next(), words.next(), words.next(), words.next())
        else {
            return reported("400 Bad Request");
        };
        if method != "GET" {
            return reported("405 Method Not Allowed");
        }
        let headers: Vec<_> = lines.filter_map(|line| line.split_once(':')).collect();
        let named = |name: &str| {
            let of_name = headers
                .iter()
                .filter(move |(header, _)| header.eq_ignore_ascii_case(name));
            of_name.map(|(_, value)| value.trim()).collect::<Vec<_>>()
        };
        let host = format!("127.0.0.1:{}", self.port);
        if named("host") != [host.as_str()]
            || named("origin")
                .iter()
                .any(|origin| *origin != format!("http://{host}"))
        {
            return reported("403 Forbidden");
        }
        let secret = target
            .strip_prefix('/')
            .and_then(|path| path.split_once('/'));
        match secret.filter(|(secret, _)| *secret == self.secret) {
            Some((_, path)) => self.file(path),
            None => reported("403 Forbidden"),
        }
    }

    /// A file of the page, or one of the user's.
    fn file(&self, path: &str) -> Answer {
        if let Some((_, kind, bytes)) = PAGE.iter().find(|(name, ..)| *name == path) {
            return ("200 OK", kind, bytes.to_vec());
        }
        if path == "files.json" {
            let names: Vec<_> = self
                .files
                .iter()
                .map(|file| file.file_name().unwrap_or_default())
                .collect();
            let names: Vec<_> = names.iter().map(|name| name.to_string_lossy()).collect();
            let served = json!({ "files": names, "hal": self.hal.is_some() });
            return (
                "200 OK",
                "application/json",
                served.to_string().into_bytes(),
            );
        }
        let number = |folder: &str| {
            path.strip_prefix(folder)
                .and_then(|number| number.parse::<u32>().ok())
        };
        if let (Some(hal), Some(from)) = (&self.hal, number("hal/")) {
            return (
                "200 OK",
                "application/json",
                hal.since(from.into()).to_string().into_bytes(),
            );
        }
        let Some(file) = number("files/").and_then(|number| self.files.get(number as usize)) else {
            return reported("404 Not Found");
        };
        match content(file) {
            Ok(bytes) => ("200 OK", "application/octet-stream", bytes),
            Err(_) => reported("404 Not Found"),
        }
    }
}

/// A file of the user, as it is now.
fn content(path: &PathBuf) -> io::Result<Vec<u8>> {
    if input::is_standard_input(path) {
        return Ok(input::standard_input()?.to_vec());
    }
    let mut bytes = Vec::new();
    File::open(path)?.take(FILE_BYTES).read_to_end(&mut bytes)?;
    if bytes.len() as u64 == FILE_BYTES {
        Err(io::ErrorKind::FileTooLarge.into())
    } else {
        Ok(bytes)
    }
}

/// An answer that says no more than its status.
fn reported(status: &'static str) -> Answer {
    (status, "text/plain", format!("{status}\n").into_bytes())
}

/// A stream that is read until a time, however slowly it comes.
struct InTime<'a> {
    stream: &'a TcpStream,
    until: Instant,
}

impl Read for InTime<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let left = self.until.saturating_duration_since(Instant::now());
        // Zero is refused: the time is over.
        self.stream.set_read_timeout(Some(left))?;
        self.stream.read(buffer)
    }
}

/// The lines of a request; none where they are too long or no text.
fn read_head(stream: &mut impl Read) -> io::Result<Option<String>> {
    let mut head = Vec::new();
    let mut buffer = [0; 2048];
    loop {
        let end = head.windows(4).position(|bytes| bytes == b"\r\n\r\n");
        if let Some(end) = end {
            head.truncate(end);
            return Ok(String::from_utf8(head).ok());
        }
        if head.len() > REQUEST_BYTES {
            return Ok(None);
        }
        match stream.read(&mut buffer)? {
            0 => return Ok(None),
            count => head.extend(&buffer[..count]),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn site() -> Site {
        let file = tempfile::Builder::new().suffix(".ngc").tempfile().unwrap();
        std::fs::write(file.path(), "G1\n").unwrap();
        let (_, path) = file.keep().unwrap();
        Site {
            port: 99,
            secret: "abc".to_owned(),
            files: vec![path],
            hal: None,
        }
    }

    fn status(request: &str) -> String {
        site().answer(&request.replace('\n', "\r\n")).0[..3].to_owned()
    }

    #[test]
    fn the_page_is_for_its_own_host_origin_and_secret() {
        let get = |path: &str, headers: &str| status(&format!("GET {path} HTTP/1.1\n{headers}"));
        // The list of files is there without the page, too.
        assert_eq!(get("/abc/files.json", "Host: 127.0.0.1:99"), "200");
        assert_eq!(
            get(
                "/abc/files/0",
                "host: 127.0.0.1:99\nOrigin: http://127.0.0.1:99"
            ),
            "200"
        );
        assert_eq!(
            get("/abc/", "Host: 127.0.0.1:99\nOrigin: http://example.org"),
            "403"
        );
        assert_eq!(get("/abc/", "Host: 127.0.0.1:99\nOrigin: null"), "403");
        assert_eq!(get("/abc/", "Host: example.org:99"), "403");
        assert_eq!(get("/abc/", "Host: 127.0.0.1:99\nHost: example.org"), "403");
        assert_eq!(get("/abc/", "Accept: */*"), "403");
        assert_eq!(get("/abd/", "Host: 127.0.0.1:99"), "403");
        assert_eq!(get("/", "Host: 127.0.0.1:99"), "403");
        assert_eq!(status("POST /abc/ HTTP/1.1\nHost: 127.0.0.1:99"), "405");
        assert_eq!(status("GET /abc/"), "400");
        assert_eq!(status(""), "400");
    }

    #[test]
    fn no_path_leads_out_of_the_listed_files() {
        let get = |path: &str| status(&format!("GET /abc/{path} HTTP/1.1\nHost: 127.0.0.1:99"));
        assert_eq!([get("files.json"), get("files/0")], ["200", "200"]);
        for path in [
            "hal/0",
            "files/1",
            "files/-1",
            "files/",
            "files/../../etc/passwd",
            "../etc/passwd",
            "/etc/passwd",
            "%2e%2e/x",
        ] {
            assert_eq!(get(path), "404", "{path}");
        }
    }

    #[test]
    fn a_request_without_end_is_refused() {
        assert_eq!(read_head(&mut io::repeat(b'a')).unwrap(), None);
        assert_eq!(read_head(&mut &b"GET / HTTP/1.1\r\n"[..]).unwrap(), None);
        assert_eq!(
            read_head(&mut &b"GET / HTTP/1.1\r\nA: b\r\n\r\nbody"[..])
                .unwrap()
                .unwrap(),
            "GET / HTTP/1.1\r\nA: b"
        );
    }

    #[test]
    fn secrets_differ() {
        let address = || PageServer::bind(vec![], None).unwrap().address();
        let (one, other) = (address(), address());
        assert_ne!(one.rsplit('/').nth(1), other.rsplit('/').nth(1));
        assert_eq!(one.rsplit('/').nth(1).unwrap().len(), 32);
    }
}
