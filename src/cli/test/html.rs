//! The report of a test run as one HTML file that needs nothing else: pictures, styles and the script are in it.
//!
//! Nothing from scenes or file names reaches the page unescaped, and the page itself forbids its browser to load or
//! run anything but what is in it. The same cases give the same bytes.

mod card;
mod diff;
mod escape;
mod picture;

use self::escape::escape;
use super::outcome::{Case, Outcome, Totals};
use crate::cli::{measures::count, stats};

const STYLE: &str = include_str!("report.css");
const SCRIPT: &str = include_str!("report.js");

/// The keys that the page's script knows, several for one thing with a space between, and what they do.
const KEYS: [(&str, &str); 10] = [
    ("j k", "next, previous"),
    ("s", "slider"),
    ("x", "side by side"),
    ("b", "blink"),
    ("d", "difference"),
    ("h", "heat"),
    ("z", "zoom to the change"),
    ("o", "outline"),
    ("+ - 0", "zoom"),
    ("/", "search"),
];

/// The kinds of outcome, in the order of their importance to a reader.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Failed,
    Changed,
    New,
    Tolerated,
    Accepted,
    Passed,
}

impl Kind {
    const ALL: [Self; 6] = [
        Self::Failed,
        Self::Changed,
        Self::New,
        Self::Tolerated,
        Self::Accepted,
        Self::Passed,
    ];

    fn of(case: &Case) -> Self {
        match case.outcome {
            _ if case.accepted => Self::Accepted,
            Outcome::Failed(_) => Self::Failed,
            Outcome::Changed(_) => Self::Changed,
            Outcome::New(_) => Self::New,
            Outcome::Tolerated(_) => Self::Tolerated,
            Outcome::Passed => Self::Passed,
        }
    }

    /// The word on the page, which is its name in the style sheet too.
    fn name(self) -> &'static str {
        match self {
            Self::Failed => "failed",
            Self::Changed => "changed",
            Self::New => "new",
            Self::Tolerated => "tolerated",
            Self::Accepted => "accepted",
            Self::Passed => "passed",
        }
    }
}

/// The report: a summary, then what failed, changed, is new, was tolerated and was accepted, each in the order given,
/// then the names of what passed.
pub(super) fn html(cases: &[Case], totals: &Totals) -> String {
    let body = body(cases, totals);
    // The browser runs the one script and takes the one style sheet that carry this number. It depends on everything
    // in the page, so that nothing in the page can know it.
    let nonce = &blake3::hash(body.as_bytes()).to_hex()[..32];
    let title = escape(&totals.text());
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; \
         style-src 'nonce-{nonce}'; script-src 'nonce-{nonce}'; base-uri 'none'; form-action 'none'\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style nonce=\"{nonce}\">\n{STYLE}</style>\n</head>\n<body>\n{body}\
         <script nonce=\"{nonce}\">\n{SCRIPT}</script>\n</body>\n</html>\n"
    )
}

fn body(cases: &[Case], totals: &Totals) -> String {
    let of = |kind: Kind| cases.iter().filter(move |case| Kind::of(case) == kind);
    let mut body = top(totals, Kind::ALL.map(|kind| (kind, of(kind).count())));
    body += "<main>\n";
    let cards = Kind::ALL.into_iter().filter(|kind| *kind != Kind::Passed);
    for (i, (kind, case)) in cards
        .flat_map(|kind| of(kind).map(move |case| (kind, case)))
        .enumerate()
    {
        body += &card::card(i, case, kind);
    }
    body += &passed(of(Kind::Passed));
    body += "<p class=\"nothing\" hidden>No case matches.</p>\n</main>\n";
    body
}

/// Title, counts that are filters, search, and the keys.
fn top(totals: &Totals, counts: [(Kind, usize); 6]) -> String {
    let mut filters = filter("all", totals.scenes(), true);
    for (kind, number) in counts.into_iter().filter(|(_, number)| *number > 0) {
        filters += &filter(kind.name(), number, false);
    }
    let verdict = if totals.all_passed() { "good" } else { "bad" };
    let keys: String = KEYS
        .iter()
        .map(|(keys, what)| {
            let keys: String = keys.split(' ').map(|key| format!("<kbd>{key}</kbd> ")).collect();
            format!("<span>{keys}{what}</span>\n")
        })
        .collect();
    format!(
        "<header class=\"top {verdict}\">\n<div class=\"title\"><h1>Picture tests</h1>\
         <p>{} <i>·</i> rtscript {}</p></div>\n\
         <div class=\"filters\" role=\"group\" aria-label=\"Show\">\n{filters}</div>\n\
         <input type=\"search\" placeholder=\"Search names\" aria-label=\"Search names\" spellcheck=\"false\">\n\
         <details class=\"keys\"><summary>Keys</summary><p>{keys}</p></details>\n</header>\n",
        escape(&totals.text()),
        env!("CARGO_PKG_VERSION"),
    )
}

fn filter(name: &str, number: usize, pressed: bool) -> String {
    format!(
        "<button type=\"button\" class=\"filter {name}\" data-show=\"{name}\" aria-pressed=\"{pressed}\">\
         <b>{}</b> {name}</button>\n",
        count(number as u64)
    )
}

/// The names of what passed, which need no card.
fn passed<'a>(cases: impl Iterator<Item = &'a Case>) -> String {
    let items: String = cases
        .map(|case| {
            let name = escape(&case.name);
            let took = stats::time(case.took);
            format!("<li data-name=\"{name}\"><span>{name}</span> <small>{took}</small></li>\n")
        })
        .collect();
    if items.is_empty() {
        return items;
    }
    format!(
        "<section class=\"passed-list\" data-kind=\"passed\"><h2>Passed</h2>\n<ul>\n{items}</ul></section>\n"
    )
}

#[cfg(test)]
mod tests;
