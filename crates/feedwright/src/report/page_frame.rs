//! Beginning and end of every page. A page is one file without references to anything outside it,
//! and its content security policy names the style and the scripts that a browser may use, by their
//! hash (CSP3, section 8.3). So nothing else runs, whatever a program or a log brings into the
//! page.

use std::io::{self, Write};

use base64::display::Base64Display;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use super::text::escaped;

/// The style and the scripts of a kind of page.
pub(super) struct PageFrame {
    style: String,
    scripts: Vec<String>,
}

impl PageFrame {
    /// Creates a frame from styles, which are joined, and scripts, which run one after the other.
    pub(super) fn new(styles: &[&str], scripts: Vec<String>) -> Self {
        Self {
            style: styles.join("\n"),
            scripts,
        }
    }

    /// Writes the head, up to the body.
    pub(super) fn write_head(&self, out: &mut impl Write, title: &str) -> io::Result<()> {
        let scripts: String = self.scripts.iter().map(|script| allowed(script)).collect();
        write!(
            out,
            r#"<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src{style}; script-src{scripts}; img-src data:; base-uri 'none'; form-action 'none'">
<meta name="viewport" content="width=device-width, initial-scale=1">
<meta name="color-scheme" content="light dark">
<meta name="generator" content="feedwright {version}">
<link rel="icon" href="data:,">
<title>{title}</title>
<style>{}</style>
</head>
"#,
            self.style,
            style = allowed(&self.style),
            version = env!("CARGO_PKG_VERSION"),
            title = escaped(title),
        )
    }

    /// Writes the scripts and the end of the page.
    pub(super) fn write_end(&self, out: &mut impl Write) -> io::Result<()> {
        for script in &self.scripts {
            writeln!(out, "<script>{script}</script>")?;
        }
        out.write_all(b"</body>\n</html>\n")
    }
}

/// Puts scripts into one scope of their own. Their exports are for the page in a browser.
pub(super) fn in_one_scope(scripts: &[&str]) -> String {
    format!(
        "(async () => {{\n\"use strict\";\n{}}})();\n",
        scripts.concat().replace("\nexport ", "\n")
    )
}

/// Returns the expression of a policy that allows `text`.
fn allowed(text: &str) -> String {
    format!(
        " 'sha256-{}'",
        Base64Display::new(&Sha256::digest(text), &STANDARD)
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The example of CSP3, section 8.3: `alert('Hello, world.');`.
    #[test]
    fn a_hash_agrees_with_the_standard() {
        assert_eq!(
            allowed("alert('Hello, world.');"),
            " 'sha256-qznLcsROx4GACP2dm0UCKCzCG+HiZ1guq6ZZDob/Tng='"
        );
    }
}
