//! `import`: files of functions, read through the host.

use crate::host::{Notes, run_on};
use rtscript::{Limits, RunOptions, Script, diag::ErrorKind};

#[test]
fn functions_and_constants_are_imported() {
    let host = Notes::with(&[(
        "lib/parts.rhai",
        "export const RADIUS = 0.5;
         fn ball(x) { sphere(x, 0, 0, size_of(1)); }
         fn size_of(n) { n * 0.25 + sin(0) }
         private fn hidden() { }",
    )]);
    let source = "import \"lib/parts\" as parts;\nparts::ball(1);\nsphere(0, 0, 0, parts::RADIUS);";
    let scene = run_on(&host, source).unwrap().value.scene;
    assert_eq!(scene.root().objects.len(), 2);
    assert_eq!(scene.files, ["scene.rhai", "lib/parts.rhai"]);
    assert_eq!(
        scene.root().objects[0].loc.file,
        1,
        "the ball is made in the other file"
    );
    assert_eq!(
        (scene.root().objects[0].loc.line, scene.root().objects[1].loc.line),
        (2, 3)
    );
}

#[test]
fn a_module_runs_once_and_may_build() {
    let host = Notes::with(&[
        ("floor.rhai", "print(\"floor\"); plane();"),
        ("a.rhai", "import \"floor\" as f; fn nothing() { }"),
    ]);
    let scene = run_on(
        &host,
        "import \"floor\" as f; import \"a\" as a; import \"floor.rhai\" as g;",
    )
    .unwrap()
    .value
    .scene;
    assert_eq!(host.printed(), ["floor"]);
    assert_eq!(scene.root().objects.len(), 1);
}

#[test]
fn imports_are_relative_to_the_file_that_names_them() {
    let host = Notes::with(&[
        (
            "a/one.rhai",
            "import \"b/two\" as two; import \"../three\" as three; fn f() { two::g() + three::h() }",
        ),
        ("a/b/two.rhai", "fn g() { 1 }"),
        ("a/../three.rhai", "fn h() { 2 }"),
    ]);
    run_on(&host, "import \"a/one\" as one; print(one::f());").unwrap();
    assert_eq!(host.printed(), ["3"]);
}

#[test]
fn a_module_does_not_see_the_variables_of_its_importer() {
    let host = Notes::with(&[("m.rhai", "print(x);")]);
    let e = run_on(&host, "let x = 1; import \"m\" as m;").unwrap_err();
    assert!(
        e.to_string().starts_with("m.rhai:1:7: error: unknown variable x"),
        "{e}"
    );
}

#[test]
fn circles_and_depth_are_refused() {
    let host = Notes::with(&[("a.rhai", "import \"b\" as b;"), ("b.rhai", "import \"a\" as a;")]);
    let e = run_on(&host, "import \"a\" as a;").unwrap_err();
    assert_eq!(
        e.to_string(),
        "b.rhai:1:8: error: files import one another in a circle: a.rhai -> b.rhai -> a.rhai\n  \
         note: imported at a.rhai:1:8\n  \
         note: imported at scene.rhai:1:8"
    );
    let host = Notes::with(&[("scene.rhai", "import \"scene\" as s;")]);
    let e = run_on(&host, "import \"scene\" as s;").unwrap_err();
    assert!(e.to_string().contains("scene.rhai -> scene.rhai"), "{e}");
    let files: Vec<(String, String)> = (0..9)
        .map(|i| (format!("m{i}.rhai"), format!("import \"m{}\" as m;", i + 1)))
        .collect();
    let files: Vec<(&str, &str)> = files.iter().map(|(a, b)| (&**a, &**b)).collect();
    let e = run_on(&Notes::with(&files), "import \"m0\" as m;").unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Limit);
    assert!(
        e.to_string()
            .contains("imports are nested too deep: the limit is 8"),
        "{e}"
    );
}

#[test]
fn errors_in_modules_name_their_file() {
    let host = Notes::with(&[
        ("bad.rhai", "let x = ;"),
        ("late.rhai", "fn f() {\n  sphere(0, 0, 0, -1);\n}"),
        ("text.rhai", "\u{0}"),
    ]);
    let e = run_on(&host, "import \"bad\" as b;").unwrap_err();
    assert_eq!(e.diagnostic.file.as_deref(), Some("bad.rhai"));
    assert_eq!(e.diagnostic.source_line.as_deref(), Some("let x = ;"));
    assert_eq!(e.diagnostic.notes, ["imported at scene.rhai:1:8"]);
    let e = run_on(&host, "import \"late\" as l;\nl::f();").unwrap_err();
    assert_eq!(e.diagnostic.file.as_deref(), Some("late.rhai"));
    assert_eq!(
        (e.diagnostic.line, e.diagnostic.notes.as_slice()),
        (2, &["called at scene.rhai:2:4".to_owned()][..])
    );
    let e = run_on(&host, "import \"late\" as l;\nl::g(1);").unwrap_err();
    assert_eq!(
        e.diagnostic.message,
        "the module l has no function g for 1 argument"
    );
}

#[test]
fn bytes_that_are_no_text_are_refused() {
    let mut host = Notes::default();
    host.insert("m.rhai", vec![b'a', 0xff, b'b']);
    let e = run_on(&host, "import \"m\" as m;").unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Input);
    assert_eq!(e.diagnostic.message, "'m.rhai' is not UTF-8: byte 1 is wrong");
}

#[test]
fn modules_count_as_files_and_share_the_steps() {
    let host = Notes::with(&[("m.rhai", "let n = 0; for i in 0..1000 { n += i; }")]);
    let mut limits = Limits::default();
    limits.operations = 500;
    let script = Script::compile("scene.rhai", "import \"m\" as m;", &limits).unwrap();
    let e = script.run(&host, &RunOptions::default()).unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Limit);
    limits = Limits::default();
    limits.files = 0;
    let script = Script::compile("scene.rhai", "import \"m\" as m;", &limits).unwrap();
    let e = script.run(&host, &RunOptions::default()).unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Limit);
}
