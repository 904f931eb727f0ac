//! What `check` has found, for other programs: JSON, SARIF 2.1.0 for code scanning, and the
//! annotations of GitHub's workflows.

use feedwright_gcode::{Diagnostic, Severity, visible};
use miette::Report;
use serde_json::{Value, json};

/// Address of the schema of SARIF 2.1.0.
const SARIF_SCHEMA: &str = "https://json.schemastore.org/sarif-2.1.0.json";
/// The project's page, for viewers of SARIF.
const HOME: &str = "https://github.com/feedwright/feedwright";

/// One mistake or warning.
#[derive(Debug, Clone)]
pub(crate) struct Finding {
    pub(crate) file: String,
    pub(crate) is_error: bool,
    pub(crate) code: String,
    /// Line, from 1; 0 where the finding belongs to the file as a whole.
    pub(crate) line: u32,
    /// Column in characters, from 1; 0 where the finding belongs to the line or the file as a
    /// whole.
    pub(crate) column: u32,
    /// Characters.
    pub(crate) span: u32,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
}

impl Finding {
    /// A diagnostic of a program.
    pub(crate) fn of(diagnostic: &Diagnostic) -> Self {
        Self {
            file: diagnostic.file.to_string(),
            is_error: diagnostic.severity == Severity::Error,
            code: diagnostic.code.to_owned(),
            line: diagnostic.line,
            column: diagnostic.column,
            span: diagnostic.span,
            message: diagnostic.message.clone(),
            hint: diagnostic.hint.clone(),
        }
    }

    /// An error that belongs to a file, or to none of its lines.
    pub(crate) fn of_file(file: &str, report: &Report) -> Self {
        let shown = |text: String| visible(&text).into_owned();
        Self {
            file: file.to_owned(),
            is_error: true,
            code: report
                .code()
                .map_or_else(|| "file".to_owned(), |code| code.to_string()),
            line: 0,
            column: 0,
            span: 0,
            message: shown(report.to_string()),
            hint: report.help().map(|hint| shown(hint.to_string())),
        }
    }

    const fn level(&self) -> &'static str {
        if self.is_error { "error" } else { "warning" }
    }

    /// Returns the finding as a JSON object.
    pub(crate) fn json(&self) -> Value {
        json!({
            "severity": self.level(),
            "code": self.code,
            "line": self.line,
            "column": self.column,
            "length": self.span,
            "message": self.message,
            "hint": self.hint,
        })
    }

    /// Returns the finding as a GitHub workflow command. GitHub shows it beside the line.
    pub(crate) fn github(&self) -> String {
        let mut place = format!("file={}", github_property(&visible(&self.file)));
        if self.line > 0 {
            place += &format!(",line={}", self.line);
        }
        if self.line > 0 && self.column > 0 {
            place += &format!(
                ",col={},endColumn={}",
                self.column,
                self.column + self.span.max(1) - 1
            );
        }
        let reported = self
            .hint
            .as_ref()
            .map_or_else(String::new, |hint| format!("\nhint: {hint}"));
        format!(
            "::{} {place},title={}::{}",
            self.level(),
            github_property(&self.code),
            github_text(&format!("{}{reported}", self.message))
        )
    }

    fn sarif(&self) -> Value {
        let text = self
            .hint
            .as_ref()
            .map_or_else(String::new, |hint| format!("\nhint: {hint}"));
        let mut place = json!({ "artifactLocation": { "uri": uri(&self.file) } });
        if self.line > 0 {
            let mut region = json!({ "startLine": self.line });
            if self.column > 0 {
                region["startColumn"] = self.column.into();
                region["endColumn"] = (self.column + self.span.max(1)).into();
            }
            place["region"] = region;
        }
        json!({
            "ruleId": self.code,
            "level": self.level(),
            "message": { "text": format!("{}{text}", self.message) },
            "locations": [{ "physicalLocation": place }],
        })
    }
}

/// A log of SARIF with all findings.
pub(crate) fn sarif(findings: &[Finding]) -> Value {
    let mut rules: Vec<&str> = findings
        .iter()
        .map(|finding| finding.code.as_str())
        .collect();
    rules.sort_unstable();
    rules.dedup();
    json!({
        "$schema": SARIF_SCHEMA,
        "version": "2.1.0",
        "runs": [{
            "tool": { "driver": {
                "name": "feedwright",
                "version": env!("CARGO_PKG_VERSION"),
                "informationUri": HOME,
                "rules": rules.into_iter().map(|id| json!({ "id": id })).collect::<Vec<_>>(),
            } },
            "columnKind": "unicodeCodePoints",
            "results": findings.iter().map(Finding::sarif).collect::<Vec<_>>(),
        }],
    })
}

/// A file's name as a relative or absolute reference of URIs.
fn uri(file: &str) -> String {
    let keeps = |byte: &u8| byte.is_ascii_alphanumeric() || b"-._~/".contains(byte);
    let spelled = |byte: u8| {
        if keeps(&byte) {
            char::from(byte).to_string()
        } else {
            format!("%{byte:02X}")
        }
    };
    let path: String = file.bytes().map(spelled).collect();
    if path.starts_with('/') {
        format!("file://{path}")
    } else {
        path
    }
}

fn github_text(text: &str) -> String {
    text.replace('%', "%25")
        .replace('\r', "%0D")
        .replace('\n', "%0A")
}

fn github_property(text: &str) -> String {
    github_text(text).replace(':', "%3A").replace(',', "%2C")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn finding() -> Finding {
        Finding {
            file: "a b,c.ngc".to_owned(),
            is_error: true,
            code: "gcode::feed".to_owned(),
            line: 3,
            column: 4,
            span: 2,
            message: "50% of F".to_owned(),
            hint: Some("write F".to_owned()),
        }
    }

    #[test]
    fn annotations_escape_what_ends_a_property() {
        assert_eq!(
            finding().github(),
            "::error file=a b%2Cc.ngc,line=3,col=4,endColumn=5,title=gcode%3A%3Afeed::50%25 of F%0Ahint: write F"
        );
    }

    #[test]
    fn sarif_places_are_one_based_and_names_are_uris() {
        let log = sarif(&[finding()]);
        let result = &log["runs"][0]["results"][0];
        let place = &result["locations"][0]["physicalLocation"];
        assert_eq!(place["artifactLocation"]["uri"], "a%20b%2Cc.ngc");
        assert_eq!(
            (
                &place["region"]["startColumn"],
                &place["region"]["endColumn"]
            ),
            (&4.into(), &6.into())
        );
        assert_eq!(
            (&result["ruleId"], &result["level"]),
            (&"gcode::feed".into(), &"error".into())
        );
        assert_eq!(uri("/tmp/x.ngc"), "file:///tmp/x.ngc");
    }
}
