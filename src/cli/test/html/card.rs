//! One case that needs a look.

use std::fmt::Write as _;

use super::{
    Kind, diff,
    escape::escape,
    picture::{covering, difference, heat, img, outline},
};
use crate::{
    cli::{
        measures::count,
        stats,
        test::outcome::{Case, Change, Fresh, Outcome, Reference, SourceChange},
    },
    diag::{Diagnostic, Error},
    render::Image,
    testing::{LineShare, Snapshot},
};

/// Lines of the script shown in the table of those that made the changed pixels.
const LINES: usize = 40;
/// Characters of such a line.
const LINE: usize = 160;

/// The card of a case; `index` makes its place in the page unique.
pub(super) fn card(index: usize, case: &Case, kind: Kind) -> String {
    let (name, word) = (escape(&case.name), kind.name());
    let body = match &case.outcome {
        Outcome::Passed => String::new(),
        Outcome::Tolerated(change) | Outcome::Changed(change) => changed(change),
        Outcome::New(fresh) => new(fresh),
        Outcome::Failed(error) => failed(error),
    };
    format!(
        "<article class=\"case {word}\" id=\"case-{index}\" data-kind=\"{word}\" data-name=\"{name}\" tabindex=\"-1\">\n\
         <header><h2>{name}</h2> <span class=\"badge\">{word}</span> <small>{}</small></header>\n{body}</article>\n",
        stats::time(case.took)
    )
}

fn changed(change: &Change) -> String {
    let mut body = match &change.reference {
        Some(reference) if reference.measures.comparison.differing > 0 => {
            viewer(reference, &change.actual_image)
        }
        Some(_) => still(
            &change.actual_image,
            "The pixels are the same. Something else that the snapshot holds is not.",
        ),
        None => still(
            &change.actual_image,
            "No reference picture was kept, so this is the picture of now alone.",
        ),
    };
    body += &numbers(change);
    body += &lines(&change.lines);
    body += &change.sources.iter().map(source).collect::<String>();
    body += &scene(&change.scene);
    let (before, after) = (change.expected.to_string(), change.actual.to_string());
    if before != after {
        body += &section(
            "Snapshot",
            &summary_sizes(&before, &after),
            false,
            &diff::table(&before, &after),
        );
    }
    body
}

fn new(fresh: &Fresh) -> String {
    let mut body = still(&fresh.image, "There is no snapshot yet.");
    body += &facts(&snapshot_facts(&fresh.snapshot));
    let text = format!("<pre>{}</pre>\n", escape(&fresh.snapshot.to_string()));
    body += &section("Snapshot", "", false, &text);
    body
}

fn failed(error: &Error) -> String {
    let mut body = "<div class=\"diagnostics\">\n".to_owned();
    body += &diagnostic(&error.diagnostic, "error");
    for warning in &error.warnings {
        body += &diagnostic(warning, "warning");
    }
    body + "</div>\n"
}

fn diagnostic(diagnostic: &Diagnostic, word: &str) -> String {
    let mut text = format!(
        "<div class=\"diagnostic {word}\"><p><b>{word}</b> {}</p>\n",
        escape(&diagnostic.message)
    );
    if let Some(file) = &diagnostic.file {
        text += &format!(
            "<p class=\"place\">{}</p>\n",
            place(file, diagnostic.line, diagnostic.column)
        );
    }
    if let (Some(line), 1..) = (&diagnostic.source_line, diagnostic.line) {
        let indent: String = line
            .chars()
            .take((diagnostic.column as usize).saturating_sub(1))
            .map(|c| if c == '\t' { '\t' } else { ' ' })
            .collect();
        let caret = if diagnostic.column > 0 { "^" } else { "" };
        // The margin is as wide as the number, so that the caret stands below its character.
        let (number, source) = (diagnostic.line.to_string(), escape(line));
        let margin = " ".repeat(number.len());
        text += &format!("<pre><i>{number} │</i> {source}\n<i>{margin} │</i> {indent}<b>{caret}</b></pre>\n");
    }
    for (word, texts) in [("note", &diagnostic.notes), ("help", &diagnostic.hints)] {
        for said in texts {
            text += &format!("<p class=\"{word}\"><b>{word}</b> {}</p>\n", escape(said));
        }
    }
    text + "</div>\n"
}

/// `file:line:column`, as far as known.
fn place(file: &str, line: u32, column: u32) -> String {
    let mut place = escape(file);
    for number in [line, column].into_iter().take_while(|n| *n > 0) {
        // Writing into a String does not fail.
        let _ = write!(place, ":{number}");
    }
    place
}

/// One picture to look at, and what to know about it.
fn still(image: &Image, note: &str) -> String {
    let panel = panel("actual", "now", img(image, "the picture now"), "");
    stage(&panel, (image.width(), image.height()), "still", "", note)
}

/// Both pictures, to be compared in several ways.
fn viewer(reference: &Reference, actual: &Image) -> String {
    let size = covering(&reference.image, actual);
    let region = reference
        .measures
        .region
        .as_ref()
        .map(|region| outline(region, size))
        .unwrap_or_default();
    let (plain, factor) = difference(&reference.image, actual);
    let heat = heat(&reference.image, actual);
    let mut panels = panel(
        "expected",
        "expected",
        img(&reference.image, "the expected picture"),
        &region,
    );
    panels += &panel("actual", "now", img(actual, "the picture now"), &region);
    let brightened = if factor > 1.0 {
        format!("difference, {} times as bright", short(factor))
    } else {
        "difference".to_owned()
    };
    panels += &panel(
        "difference",
        &brightened,
        img(&plain, "the difference of both"),
        &region,
    );
    let mut modes = mode("slider", "Slider", "s", true);
    modes += &mode("side", "Side by side", "x", false);
    modes += &mode("blink", "Blink", "b", false);
    modes += &mode("difference", "Difference", "d", false);
    if let Some(heat) = &heat {
        panels += &panel(
            "heat",
            "FLIP error",
            img(heat, "FLIP's error as a heat map"),
            &region,
        );
        modes += &mode("heat", "Heat", "h", false);
    }
    panels += "<div class=\"handle\" role=\"slider\" tabindex=\"0\" aria-label=\"expected left, now right\" \
               aria-orientation=\"horizontal\" aria-valuemin=\"0\" aria-valuemax=\"100\" aria-valuenow=\"50\" \
               aria-valuetext=\"50 % expected\"></div>\n";
    let zoom = match &reference.measures.region {
        Some(r) => format!(
            "<button type=\"button\" data-zoom=\"region\" data-left=\"{}\" data-top=\"{}\" data-width=\"{}\" \
             data-height=\"{}\" title=\"z\">Zoom to the change</button>\n\
             <button type=\"button\" data-outline aria-pressed=\"true\" title=\"o\">Outline</button>\n",
            r.left, r.top, r.width, r.height
        ),
        None => String::new(),
    };
    let modes = format!("<div class=\"modes\" role=\"group\" aria-label=\"View\">\n{modes}</div>\n");
    stage(&panels, size, "slider", &format!("{modes}{zoom}"), "")
}

/// A frame of pictures with its tools. Sizes are in pixels of the pictures.
fn stage(panels: &str, (width, height): (u32, u32), mode: &str, tools: &str, note: &str) -> String {
    let note = match note {
        "" => String::new(),
        note => format!("<p class=\"note\">{note}</p>\n"),
    };
    format!(
        "<div class=\"viewer\" data-mode=\"{mode}\" data-width=\"{width}\" data-height=\"{height}\">\n\
         <div class=\"tools\">\n{tools}<div class=\"zoom\" role=\"group\" aria-label=\"Zoom\">\
         <button type=\"button\" data-zoom=\"out\" aria-label=\"smaller\" title=\"-\">−</button>\
         <output>1×</output>\
         <button type=\"button\" data-zoom=\"in\" aria-label=\"larger\" title=\"+\">+</button>\
         <button type=\"button\" data-zoom=\"fit\" title=\"0\">Fit</button></div>\n</div>\n\
         <div class=\"frame\" tabindex=\"0\" aria-label=\"pictures\"><div class=\"stage\">\n{panels}</div></div>\n\
         <p class=\"caption\" aria-live=\"off\"></p>\n{note}</div>\n"
    )
}

fn mode(name: &str, label: &str, key: &str, pressed: bool) -> String {
    format!(
        "<button type=\"button\" data-set=\"{name}\" aria-pressed=\"{pressed}\" title=\"{key}\">{label}</button>\n"
    )
}

fn panel(class: &str, caption: &str, picture: Option<String>, region: &str) -> String {
    let picture = picture.unwrap_or_else(|| "<p class=\"none\">no picture</p>".to_owned());
    format!(
        "<figure class=\"{class}\" data-caption=\"{caption}\"><div>{picture}{region}</div>\
         <figcaption>{caption}</figcaption></figure>\n"
    )
}

/// What was measured.
fn numbers(change: &Change) -> String {
    let mut all = Vec::new();
    if let Some(reference) = &change.reference {
        let c = &reference.measures.comparison;
        let share = 100.0 * c.differing as f64 / c.pixels.max(1) as f64;
        all.push((
            "pixels",
            format!(
                "{} of {} ({} %)",
                count(c.differing),
                count(c.pixels),
                short(share)
            ),
        ));
        all.push(("largest", format!("{} of 255", c.max)));
        let psnr = if c.psnr.is_finite() {
            format!("{:.1} dB", c.psnr)
        } else {
            "∞".to_owned()
        };
        all.push(("PSNR", psnr));
        if let Some(flip) = reference.measures.flip {
            all.push(("FLIP, mean", format!("{flip:.5}")));
        }
        if let Some(r) = &reference.measures.region {
            all.push(("region", r.to_string()));
        }
    }
    let (before, after) = (&change.expected, &change.actual);
    if (before.width, before.height) != (after.width, after.height) {
        all.push((
            "size",
            format!(
                "{} × {}, now {} × {}",
                before.width, before.height, after.width, after.height
            ),
        ));
    }
    all.push(if before.hash == after.hash {
        ("hash", code(&after.hash))
    } else {
        (
            "hash",
            format!("{}, now {}", code(&before.hash), code(&after.hash)),
        )
    });
    facts(&all)
}

fn snapshot_facts(snapshot: &Snapshot) -> Vec<(&'static str, String)> {
    vec![
        ("size", format!("{} × {}", snapshot.width, snapshot.height)),
        ("hash", code(&snapshot.hash)),
    ]
}

/// A hash, of which the start is enough to tell two apart; the whole shows when pointed at.
fn code(hash: &str) -> String {
    let start: String = hash.chars().take(12).collect();
    format!("<code title=\"{}\">{}</code>", escape(hash), escape(&start))
}

/// Names and values; the values are HTML.
fn facts(all: &[(&str, String)]) -> String {
    let items: String = all
        .iter()
        .map(|(name, value)| format!("<div><dt>{name}</dt><dd>{value}</dd></div>\n"))
        .collect();
    format!("<dl class=\"facts\">\n{items}</dl>\n")
}

/// Up to three digits that count.
fn short(number: f64) -> String {
    match number {
        100.0.. => format!("{number:.0}"),
        10.0.. => format!("{number:.1}"),
        1.0.. => format!("{number:.2}"),
        _ => format!("{number:.3}"),
    }
}

/// The lines that made the changed pixels.
fn lines(lines: &[LineShare]) -> String {
    if lines.is_empty() {
        return String::new();
    }
    let most = lines
        .iter()
        .map(|line| line.now.max(line.before))
        .max()
        .unwrap_or(0)
        .max(1);
    let row = |line: &LineShare| {
        format!(
            "<tr><td class=\"place\">{}</td><td class=\"bars\">{}{}</td><td class=\"number\">{}</td>\
             <td class=\"number\">{}</td><td class=\"code\">{}</td></tr>\n",
            place(&line.file, line.line, line.column),
            bar("now", line.now, most),
            bar("before", line.before, most),
            count(line.now),
            count(line.before),
            escape(&line.text.trim().chars().take(LINE).collect::<String>()),
        )
    };
    let rows: String = lines.iter().take(LINES).map(row).collect();
    let more = match lines.len().saturating_sub(LINES) {
        0 => String::new(),
        left => format!("<p>{} more lines made fewer pixels.</p>\n", count(left as u64)),
    };
    let table = format!(
        "<div class=\"scroll\"><table class=\"lines\"><thead><tr><th>line</th><th>changed pixels</th>\
         <th class=\"number\">now</th><th class=\"number\">before</th><th></th></tr></thead><tbody>\n{rows}</tbody>\
         </table></div>\n{more}"
    );
    section("Lines that made the changed pixels", "", true, &table)
}

/// A bar as long as the share of `most`.
fn bar(class: &str, pixels: u64, most: u64) -> String {
    // What is there can be seen.
    let least = if pixels > 0 { 1.0 } else { 0.0 };
    let length = (100.0 * pixels as f64 / most as f64).max(least);
    format!(
        "<svg class=\"{class}\" viewBox=\"0 0 100 1\" preserveAspectRatio=\"none\" aria-hidden=\"true\">\
         <rect width=\"{length:.2}\" height=\"1\"/></svg>"
    )
}

/// A script then and now.
fn source(change: &SourceChange) -> String {
    let title = format!("Script <code>{}</code>", escape(&change.name));
    let sizes = summary_sizes(&change.before, &change.after);
    section(&title, &sizes, true, &diff::table(&change.before, &change.after))
}

/// Lines of the scene's dump that came and went, a sign before each.
fn scene(lines: &[String]) -> String {
    let row = |line: &String| {
        let (class, sign, line) = match line.strip_prefix("- ") {
            Some(line) => ("del", "−", line),
            None => ("ins", "+", line.strip_prefix("+ ").unwrap_or(line)),
        };
        format!(
            "<tr class=\"{class}\"><td>{sign}</td><td>{}</td></tr>\n",
            escape(&diff::shortened(line))
        )
    };
    if lines.is_empty() {
        return String::new();
    }
    let rows: String = lines.iter().map(row).collect();
    let table =
        format!("<div class=\"scroll\"><table class=\"diff scene\"><tbody>\n{rows}</tbody></table></div>\n");
    section("Scene", "", false, &table)
}

/// How many lines came and went, as HTML.
fn summary_sizes(before: &str, after: &str) -> String {
    match diff::sizes(before, after) {
        Some((added, removed)) => format!(
            "<span class=\"added\">+{}</span> <span class=\"removed\">−{}</span>",
            count(added as u64),
            count(removed as u64)
        ),
        None => String::new(),
    }
}

/// A part of a card that can be folded; title, hint and content are HTML.
fn section(title: &str, hint: &str, open: bool, content: &str) -> String {
    let open = if open { " open" } else { "" };
    format!("<details{open}><summary>{title} {hint}</summary>\n{content}</details>\n")
}
