use std::{path::PathBuf, time::Duration};

use super::*;
use crate::{
    cli::{
        measures::Measures,
        test::outcome::{Change, Fresh, Reference, SourceChange},
    },
    diag::{Diagnostic, ErrorKind},
    render::Image,
    testing::{LineShare, Region, Snapshot, from_rgb8},
};

const HOSTILE: &str = "</script></style><img src=x onerror='a()'>\"'&\u{1b}[31m\u{202e}http://example.org";

fn gray(width: u32, height: u32, byte: u8) -> Image {
    from_rgb8(width, height, &vec![byte; (width * height * 3) as usize])
}

/// Gray with a lighter rectangle at (3, 2), 4 x 5 pixels.
fn spot() -> Image {
    let mut bytes = vec![100; 16 * 12 * 3];
    for y in 2..7 {
        bytes[(y * 16 + 3) * 3..(y * 16 + 7) * 3].fill(120);
    }
    from_rgb8(16, 12, &bytes)
}

fn snapshot(image: &Image) -> Snapshot {
    Snapshot {
        width: image.width(),
        height: image.height(),
        hash: image.hash(),
        ..Snapshot::default()
    }
}

fn case(name: &str, outcome: Outcome) -> Case {
    Case {
        name: name.to_owned(),
        path: PathBuf::from(name),
        took: Duration::from_millis(120),
        outcome,
        accepted: false,
    }
}

fn change(expected: &Image, actual: &Image) -> Box<Change> {
    let region = (expected != actual).then_some(Region {
        left: 3,
        top: 2,
        width: 4,
        height: 5,
    });
    Box::new(Change {
        expected: snapshot(expected),
        actual: snapshot(actual),
        actual_image: actual.clone(),
        recipe: Default::default(),
        reference: Some(Reference {
            image: expected.clone(),
            measures: Measures {
                region,
                ..Measures::of(expected, actual)
            },
        }),
        lines: vec![LineShare {
            file: "a.rhai".to_owned(),
            line: 7,
            column: 3,
            text: "sphere(1 < 2);".to_owned(),
            now: 20,
            before: 15,
        }],
        scene: vec!["- sphere 1".to_owned(), "+ sphere 2".to_owned()],
        sources: vec![SourceChange {
            name: "a.rhai".to_owned(),
            before: "camera();\nsphere(1);\n".to_owned(),
            after: "camera();\nsphere(2);\n".to_owned(),
        }],
    })
}

fn page(cases: &[Case]) -> String {
    html(cases, &Totals::of(cases))
}

/// The card of the only case, without style sheet and script.
fn card_of(outcome: Outcome) -> String {
    let page = page(&[case("a.rhai", outcome)]);
    let start = page.find("<article").unwrap();
    page[start..page.find("</article>").unwrap()].to_owned()
}

fn assert_holds(text: &str, parts: &[&str]) {
    for part in parts {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
}

#[test]
fn a_change_can_be_looked_at_in_every_way() {
    let card = card_of(Outcome::Changed(change(&gray(16, 12, 100), &spot())));
    assert_holds(
        &card,
        &[
            "class=\"case changed\" id=\"case-0\" data-kind=\"changed\" data-name=\"a.rhai\"",
            "<figure class=\"expected\"",
            "<figure class=\"actual\"",
            "<figure class=\"difference\" data-caption=\"difference, 12.8 times as bright\"",
            "<figure class=\"heat\"",
            "role=\"slider\" tabindex=\"0\"",
            "aria-valuenow=\"50\"",
            "data-set=\"blink\"",
            "data-set=\"side\"",
            "data-left=\"3\" data-top=\"2\" data-width=\"4\" data-height=\"5\"",
            "<rect x=\"2.5\" y=\"1.5\" width=\"5\" height=\"6\"/>",
            "<dd>20 of 192 (10.4 %)</dd>",
            "<dd>20 of 255</dd>",
            "<dt>FLIP, mean</dt><dd>0.0",
            "<td class=\"place\">a.rhai:7:3</td>",
            "<rect width=\"75.00\" height=\"1\"/>",
            "sphere(1 &lt; 2);",
            "<td>−</td><td>sphere(1);</td>",
            "<td>+</td><td>sphere(2);</td>",
            "<td>−</td><td>sphere 1</td>",
            "<summary>Snapshot ",
        ],
    );
    assert_eq!(card.matches("src=\"data:image/png;base64,").count(), 4);
}

#[test]
fn pictures_of_unequal_size_have_no_heat_map() {
    let card = card_of(Outcome::Tolerated(change(&gray(16, 12, 100), &gray(12, 16, 100))));
    assert_holds(
        &card,
        &[
            "class=\"case tolerated\"",
            "data-width=\"16\" data-height=\"16\"",
            "16 × 12, now 12 × 16",
            "data-caption=\"difference\"",
        ],
    );
    assert!(!card.contains("class=\"heat\"") && !card.contains("data-set=\"heat\""));
}

#[test]
fn without_a_difference_to_see_there_is_one_picture() {
    let mut same = change(&spot(), &spot());
    same.lines.clear();
    let card = card_of(Outcome::Changed(same));
    assert_holds(
        &card,
        &["data-mode=\"still\"", "The pixels are the same.", "<dd>∞</dd>"],
    );
    assert!(!card.contains("role=\"slider\"") && !card.contains("class=\"lines\""));
    let mut alone = change(&gray(16, 12, 100), &spot());
    alone.reference = None;
    let card = card_of(Outcome::Changed(alone));
    assert_holds(
        &card,
        &[
            "data-mode=\"still\"",
            "No reference picture was kept",
            ", now <code",
        ],
    );
    assert_eq!(card.matches("src=\"data:image/png;base64,").count(), 1);
}

#[test]
fn a_new_scene_shows_its_picture_and_its_snapshot() {
    let fresh = Fresh {
        snapshot: snapshot(&spot()),
        image: spot(),
        recipe: Default::default(),
    };
    let hash = spot().hash();
    let card = card_of(Outcome::New(Box::new(fresh)));
    assert_holds(
        &card,
        &[
            "class=\"case new\"",
            "src=\"data:image/png;base64,",
            "<pre>",
            &hash,
        ],
    );
}

#[test]
fn a_failure_shows_the_place() {
    let mut error: crate::Error = Diagnostic::error(ErrorKind::Script, "unknown function 'spere'")
        .at("a.rhai", 12, 4)
        .with_source(&"\tif spere(1) < 2 {}\n".repeat(20))
        .note("called from line 20")
        .hint("did you mean sphere?")
        .into();
    error
        .warnings
        .push(Diagnostic::warning(crate::diag::Code::NoLight, "no light"));
    let card = card_of(Outcome::Failed(Box::new(error)));
    assert_holds(
        &card,
        &[
            "<p><b>error</b> unknown function &#39;spere&#39;</p>",
            "<p class=\"place\">a.rhai:12:4</p>",
            "<i>12 │</i> \tif spere(1) &lt; 2 {}\n<i>   │</i> \t  <b>^</b>",
            "<b>note</b> called from line 20",
            "<b>help</b> did you mean sphere?",
            "<b>warning</b> no light",
        ],
    );
}

#[test]
fn counts_filter_and_cases_stand_by_importance() {
    let mut cases = vec![case("p1", Outcome::Passed), case("p2", Outcome::Passed)];
    cases.push(case("t", Outcome::Tolerated(change(&gray(16, 12, 100), &spot()))));
    cases.push(case("c", Outcome::Changed(change(&gray(16, 12, 100), &spot()))));
    cases.push(case("a", Outcome::Changed(change(&gray(16, 12, 100), &spot()))));
    cases[4].accepted = true;
    let failed = Diagnostic::error(ErrorKind::Input, "no such file");
    cases.push(case("f", Outcome::Failed(Box::new(failed.into()))));
    let page = page(&cases);
    let at = |part: &str| {
        page.find(part)
            .unwrap_or_else(|| panic!("{part} is not in the page"))
    };
    let order =
        ["failed", "changed", "tolerated", "accepted"].map(|kind| at(&format!("data-kind=\"{kind}\"")));
    assert!(order.is_sorted());
    assert!(at("data-show=\"all\"") < at("data-show=\"failed\""));
    assert_holds(
        &page,
        &[
            "<b>2</b> passed",
            "<b>6</b> all",
            "<b>1</b> accepted",
            "<li data-name=\"p1\">",
        ],
    );
    assert!(!page.contains("data-show=\"new\""));
    assert_eq!(page.matches("<article").count(), 4);
    assert_eq!(page, super::html(&cases, &Totals::of(&cases)));
}

/// Everything a script or a file name can bring into the page.
fn hostile() -> Vec<Case> {
    let text = || HOSTILE.to_owned();
    let mut changed = change(&gray(16, 12, 100), &spot());
    changed.lines[0].file = text();
    changed.lines[0].text = text();
    changed.scene = vec![text(), format!("- {HOSTILE}")];
    changed.sources = vec![SourceChange {
        name: text(),
        before: text(),
        after: HOSTILE.repeat(2),
    }];
    changed.actual.warnings = vec![text()];
    changed.expected.printed = vec![text()];
    changed.expected.hash = text();
    let mut fresh = Fresh {
        snapshot: snapshot(&spot()),
        image: spot(),
        recipe: Default::default(),
    };
    fresh.snapshot.printed = vec![text()];
    fresh.snapshot.hash = text();
    let error = Diagnostic::error(ErrorKind::Script, text())
        .at(HOSTILE, 1, 5)
        .with_source(HOSTILE)
        .note(text())
        .hint(text());
    vec![
        case(HOSTILE, Outcome::Changed(changed)),
        case(HOSTILE, Outcome::New(Box::new(fresh))),
        case(HOSTILE, Outcome::Failed(Box::new(error.into()))),
        case(HOSTILE, Outcome::Passed),
    ]
}

#[test]
fn nothing_from_scripts_gets_out_of_its_element() {
    let page = page(&hostile());
    assert!(page.contains("&lt;/script&gt;&lt;/style&gt;&lt;img src=x onerror=&#39;a()&#39;&gt;&quot;"));
    assert_eq!(page.matches("</script>").count(), 1);
    assert_eq!(page.matches("</style>").count(), 1);
    assert!(!page.contains("onerror='") && !page.contains("<img src=x"));
    assert!(
        page.chars()
            .all(|c| c == '\n' || c == '\t' || !c.is_control() && c != '\u{202e}')
    );
}

#[test]
fn the_page_loads_nothing_and_runs_only_its_own() {
    let hostile = page(&hostile());
    let plain = page(&[case(
        "a.rhai",
        Outcome::Changed(change(&gray(16, 12, 100), &spot())),
    )]);
    assert!(!plain.contains("http:") && !plain.contains("https:") && !plain.contains("url("));
    let markup = plain.replace(STYLE, "").replace(SCRIPT, "");
    for word in [
        " style=",
        "<link",
        "<iframe",
        "<object",
        "@import",
        " href=",
        " onclick=",
    ] {
        assert!(!markup.contains(word), "{word}");
    }
    for page in [&hostile, &plain] {
        let nonce = page.split("nonce=\"").nth(1).unwrap().get(..32).unwrap();
        assert_holds(
            page,
            &[
                &format!(
                    "content=\"default-src 'none'; img-src data:; style-src 'nonce-{nonce}'; script-src \
                     'nonce-{nonce}'; base-uri 'none'; form-action 'none'\""
                ),
                &format!("<script nonce=\"{nonce}\">"),
                &format!("<style nonce=\"{nonce}\">"),
            ],
        );
    }
    let nonce = |page: &str| page.split("nonce=\"").nth(1).unwrap()[..32].to_owned();
    assert_ne!(nonce(&hostile), nonce(&plain));
}

#[test]
fn a_page_is_little_more_than_its_pictures() {
    let none = page(&[]).len();
    assert!(none < 40_000, "{none}");
    let passed: Vec<_> = (0..1000)
        .map(|i| case(&format!("tests/{i}.rhai"), Outcome::Passed))
        .collect();
    let per_case = (page(&passed).len() - none) / 1000;
    assert!(per_case < 120, "{per_case}");
    let changed = page(&[case("a", Outcome::Changed(change(&gray(16, 12, 100), &spot())))]).len() - none;
    assert!(changed < 10_000, "{changed}");
}

#[test]
fn every_key_of_the_list_does_something() {
    let table = SCRIPT
        .split_once("const keys = {")
        .unwrap()
        .1
        .split_once("};")
        .unwrap()
        .0;
    let known: Vec<&str> = table
        .lines()
        .filter_map(|line| Some(line.trim().split_once(": () =>")?.0.trim_matches('"')))
        .collect();
    let mut listed: Vec<&str> = KEYS.iter().flat_map(|(keys, _)| keys.split(' ')).collect();
    listed.sort_by_key(|key| known.iter().position(|k| k == key));
    assert_eq!(known, listed);
}

#[test]
fn thousands_have_commas() {
    assert_eq!(
        [0, 999, 1000, 64_000, 1_234_567].map(count),
        ["0", "999", "1,000", "64,000", "1,234,567"]
    );
}
