//! `edition(year)`: where it may stand and what it says where it may not.

use crate::host::{Notes, run_on, try_run};
use rtscript::scene::Edition;

fn message(source: &str) -> String {
    try_run(source).unwrap_err().to_string()
}

#[test]
fn a_scene_has_the_edition_that_it_asks_for_and_else_the_newest() {
    let scene = try_run("edition(2026); sphere(0, 0, 0, 1);").unwrap().value.scene;
    assert_eq!(scene.settings.edition, Some(Edition::E2026));
    assert!(scene.dump().starts_with("edition 2026\nsize 640 480\n"));
    let scene = try_run("sphere(0, 0, 0, 1);").unwrap().value.scene;
    assert_eq!(
        (scene.settings.edition, scene.settings.edition()),
        (None, Edition::LATEST)
    );
    assert!(scene.dump().starts_with("size 640 480\n"));
}

#[test]
fn what_is_no_call_may_come_before_it() {
    for before in [
        "// A comment.\n",
        "let n = 2 + 3;",
        "fn f() { sphere(0, 0, 0, 1); }",
        "const V = [1, 2, 3]; print(V);",
    ] {
        try_run(&format!("{before} edition(2026); sphere(0, 0, 0, 1);")).unwrap();
    }
    try_run("edition(2026); edition(2026); sphere(0, 0, 0, 1); edition(2026);").unwrap();
}

#[test]
fn an_unknown_year_is_told_what_is_known() {
    let newer = message("edition(2031);");
    assert!(
        newer.contains(":1:1: error: there is no edition 2031; known are 2026"),
        "{newer}"
    );
    assert!(newer.contains("help: a newer rtscript may know it"), "{newer}");
    let older = message("edition(1999);");
    assert!(older.contains("help: edition(2026) is the newest"), "{older}");
    assert!(message("edition(2026.5);").contains("year must be a whole number, not 2026.5"));
    assert!(message("edition(\"2026\");").contains("year must be a whole number, not a string"));
    assert!(message("edition();").contains("edition takes (year), not 0 arguments"));
}

#[test]
fn what_comes_before_it_is_named() {
    for first in [
        "sphere(0, 0, 0, 1);",
        "size(64, 48);",
        "let x = random();",
        "group { }",
        "define \"a\" { }",
    ] {
        let text = message(&format!("// A scene.\n{first}\nedition(2026);"));
        let wanted = format!(
            ":3:1: error: edition: it must come before every other call, but line 2 comes before it: {first:?}"
        );
        assert!(text.contains(&wanted), "{text}");
        assert!(
            text.contains("help: make edition(2026); the first line of the script"),
            "{text}"
        );
    }
}

#[test]
fn a_module_has_the_edition_of_its_script() {
    let host = Notes::with(&[
        (
            "same.rhai",
            "edition(2026); fn f() { edition(2026); sphere(0, 0, 0, 1); }",
        ),
        ("builds.rhai", "sphere(0, 0, 0, 1);"),
        ("later.rhai", "fn f() { edition(2026); }"),
    ]);
    run_on(&host, "edition(2026); import \"same\" as m; m::f();").unwrap();
    run_on(&host, "import \"later\" as m; edition(2026); m::f();").unwrap();
    let refused = |source: &str, wanted: &str| {
        let text = run_on(&host, source).unwrap_err().to_string();
        assert!(text.contains(wanted), "{text}");
    };
    let not_chosen = "edition: a module cannot choose it, and its script has not chosen 2026";
    refused("import \"same\" as m;", not_chosen);
    refused("import \"later\" as m; m::f();", not_chosen);
    let late = "edition: it must come before every other call, but an imported file makes one before it";
    refused("import \"builds\" as m; edition(2026);", late);
}

/// So that a call which a later version adds takes nothing from a script that is there already.
#[test]
fn a_function_of_the_script_wins_over_a_call_of_the_same_name() {
    let source = "fn sphere(at, r) { box(r, r, r); } edition(2026); sphere([0, 0, 0], 1);";
    let dump = try_run(source).unwrap().value.scene.dump();
    assert!(
        dump.contains("object 0 box") && !dump.contains("sphere"),
        "{dump}"
    );
}
