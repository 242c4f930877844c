//! Mistakes of more than one line, and what surrounds a message: places, calls, excerpts. The messages are in `tests/bad`.

use crate::host::try_run;
use rtscript::diag::ErrorKind::Limit;

/// The error of a script of several lines.
fn error(source: &str) -> String {
    match try_run(source) {
        Ok(_) => panic!("it runs:\n{source}"),
        Err(e) => e.to_string(),
    }
}

#[test]
fn the_place_is_that_of_the_call() {
    let source = "// a comment\nlet x = 1;\n  if x == 1 {\n\tsphere(0, 0,\n      0, -1);\n}\n";
    let e = try_run(source).unwrap_err();
    assert_eq!((e.diagnostic.line, e.diagnostic.column), (4, 2));
    assert_eq!(e.diagnostic.source_line.as_deref(), Some("\tsphere(0, 0,"));
}

#[test]
fn columns_count_characters() {
    let e = try_run("print(\"äöü\"); sphere(1);").unwrap_err();
    assert_eq!(e.diagnostic.column, 15);
}

#[test]
fn calls_that_led_there_are_listed() {
    let source = "fn wheel(r) {\n  sphere(0, 0, 0, r);\n}\nfn car(r) {\n  wheel(r);\n}\nfor r in [1, 0] {\n  car(r);\n}\n";
    assert_eq!(
        error(source),
        "scene.rhai:2:3: error: the sphere's radius must be greater than 0 and at most 1e15, not 0\n  \
         note: called from car() at scene.rhai:5:3\n  \
         note: called at scene.rhai:8:3"
    );
}

#[test]
fn long_chains_of_calls_are_cut() {
    let source = "fn down(n) {\n  if n == 0 { sphere(1); }\n  down(n - 1);\n}\ndown(40);";
    let e = try_run(source).unwrap_err();
    assert_eq!(
        e.diagnostic.message,
        "sphere takes (center, radius), not 1 argument"
    );
    assert_eq!(e.diagnostic.notes.len(), 11);
    assert_eq!(e.diagnostic.notes[8], "... and 31 calls more ...");
    assert_eq!(e.diagnostic.notes[10], "called at scene.rhai:5:1");
}

#[test]
fn a_limit_inside_a_function_keeps_its_place() {
    let source = "fn deep() {\n  size(100000, 1);\n}\ndeep();";
    let e = try_run(source).unwrap_err();
    assert_eq!((e.diagnostic.line, e.diagnostic.column, e.kind()), (2, 3, Limit));
}

#[test]
fn a_long_thrown_text_is_cut() {
    let e = try_run("let s = \"x\"; s.pad(100000, 'x'); throw s;").unwrap_err();
    assert!(e.diagnostic.message.len() <= 4096);
    assert!(e.diagnostic.message.ends_with("..."));
}

#[test]
fn what_was_caught_can_be_told() {
    let source = "try { sphere(0, 0, 0, -1); } catch (e) { throw \"caught: \" + e; }";
    assert_eq!(
        try_run(source).unwrap_err().diagnostic.message,
        "caught: the sphere's radius must be greater than 0 and at most 1e15, not -1"
    );
    let source = "try { sphere(1); } catch (e) { throw e.message; }";
    assert_eq!(
        try_run(source).unwrap_err().diagnostic.message,
        "sphere takes (center, radius), not 1 argument"
    );
    let rethrown = "try {\n  sphere(0, 0, 0, -1);\n} catch (e) {\n  throw e;\n}";
    assert!(
        error(rethrown).starts_with("scene.rhai:2:3: error: the sphere's radius"),
        "{}",
        error(rethrown)
    );
}

#[test]
fn lines_beyond_the_last_that_is_counted() {
    let source = format!("{}sphere(1);", "\n".repeat(70_000));
    let e = try_run(&source).unwrap_err();
    assert_eq!(e.diagnostic.line, 65_535);
    assert_eq!(e.diagnostic.source_line, None);
    assert_eq!(
        e.diagnostic.notes,
        ["the place is at or past line 65535; lines are not counted any further"]
    );
}
