//! The report that CI systems read: JUnit's XML, in the form that Jenkins, GitLab and others agree on.

use std::fmt::Write as _;

use super::{
    outcome::{Case, Outcome, Totals},
    text::details,
};

/// One suite with a case for each scene. New scenes count as failures, scenes that cannot be rendered as errors.
pub(super) fn junit(cases: &[Case], totals: &Totals) -> String {
    let seconds: f64 = cases.iter().map(|case| case.took.as_secs_f64()).sum();
    let (tests, failures) = (totals.scenes(), totals.changed + totals.new);
    let counts = format!(
        r#"tests="{tests}" failures="{failures}" errors="{}" time="{seconds:.3}""#,
        totals.failed
    );
    let mut xml = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"rtscript\" {counts}>\n  <testsuite name=\"rtscript\" {counts}>\n"
    );
    for case in cases {
        let (folder, name) = case.name.rsplit_once('/').unwrap_or((".", &case.name));
        // Writing into a String does not fail.
        let _ = write!(
            xml,
            "    <testcase classname=\"{}\" name=\"{}\" time=\"{:.3}\"",
            escaped(folder),
            escaped(name),
            case.took.as_secs_f64()
        );
        let inner = match &case.outcome {
            _ if case.accepted => None,
            Outcome::Passed | Outcome::Tolerated(_) => None,
            Outcome::Changed(change) => Some(("failure", "changed", details(change).join("\n"))),
            Outcome::New(_) => Some(("failure", "new", "there is no snapshot yet".to_owned())),
            Outcome::Failed(error) => Some(("error", "failed", error.to_string())),
        };
        match inner {
            None => xml.push_str("/>\n"),
            Some((element, kind, text)) => {
                let message = text.lines().next().unwrap_or_default();
                let _ = writeln!(
                    xml,
                    ">\n      <{element} type=\"{kind}\" message=\"{}\">{}</{element}>\n    </testcase>",
                    escaped(message),
                    escaped(&text)
                );
            }
        }
    }
    xml.push_str("  </testsuite>\n</testsuites>\n");
    xml
}

/// Text as XML may hold it, in an attribute too. What XML cannot hold at all becomes the replacement character.
fn escaped(text: &str) -> String {
    let mut xml = String::new();
    for c in text.chars() {
        match c {
            '<' => xml.push_str("&lt;"),
            '>' => xml.push_str("&gt;"),
            '&' => xml.push_str("&amp;"),
            '"' => xml.push_str("&quot;"),
            '\n' => xml.push_str("&#10;"),
            '\t' => xml.push(c),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => {
                xml.push(char::REPLACEMENT_CHARACTER)
            }
            c => xml.push(c),
        }
    }
    xml
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_breaks_out_of_an_attribute() {
        assert_eq!(
            escaped("a<\"&'>\n\t\u{0}\u{1b}é"),
            "a&lt;&quot;&amp;'&gt;&#10;\t\u{fffd}\u{fffd}é"
        );
    }
}
