//! Limits, and scripts that mean harm.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use rtscript::{Limits, RunOptions, Script, diag::ErrorKind::Limit, script::Language};

use crate::host::{Notes, try_run};

/// The message of a script under limits of its own.
fn limited(source: &str, set: impl FnOnce(&mut Limits)) -> String {
    let mut limits = Limits::default();
    set(&mut limits);
    let e = Script::compile("scene.rhai", source, &limits)
        .and_then(|s| s.run(&Notes::default(), &RunOptions::default()))
        .unwrap_err();
    assert_eq!(e.kind(), Limit, "{e}");
    e.to_string().lines().next().unwrap().to_owned()
}

#[test]
fn limits_cannot_be_caught() {
    let e = try_run("try { size(100000, 1); } catch { size(1, 1); }").unwrap_err();
    assert_eq!(e.kind(), Limit);
}

#[test]
fn deep_nesting_is_refused() {
    for (open, close) in [("(", ")"), ("[", "]"), ("{", "}"), ("group {", "}"), ("!", "")] {
        let source = format!("{}1{};", open.repeat(10_000), close.repeat(10_000));
        let e = try_run(&source).unwrap_err();
        assert_eq!(e.kind(), Limit, "{open}: {e}");
    }
}

#[test]
fn the_script_itself_has_a_limit() {
    let mut limits = Limits::default();
    limits.source_bytes = 10;
    let e = Script::compile("big.rhai", "sphere(0, 0, 0, 1);", &limits).unwrap_err();
    assert_eq!(
        e.to_string(),
        "big.rhai: error: the script of 19 bytes is too large: the limit 'source_bytes' is 10"
    );
}

#[test]
fn every_limit_has_its_name() {
    let place = "scene.rhai:1:";
    for (source, set, message) in [
        (
            "loop { }",
            (|l| l.operations = 1000) as fn(&mut Limits),
            "6: error: the script takes too many steps: the limit 'operations' is 1000",
        ),
        (
            "let a = []; loop { a.push(1); }",
            |l| l.array_len = 50,
            "22: error: the array is too long: the limit 'array_len' is 50",
        ),
        (
            "let m = #{}; for i in 0..100 { m[`${i}`] = i; } material(m + m);",
            |l| l.map_len = 50,
            "60: error: the map is too large: the limit 'map_len' is 50",
        ),
        (
            "let s = \"abc\"; s.replace(\"a\", s); s.replace(\"b\", s);",
            |l| l.string_bytes = 8,
            "37: error: the string is too long: the limit 'string_bytes' is 8",
        ),
        (
            "let a = 1; let b = 2; let c = 3;",
            |l| l.variables = 2,
            "23: error: too many variables: the limit 'variables' is 2",
        ),
        (
            "fn f() { } fn g() { }",
            |l| l.functions = 1,
            "12: error: too many functions are defined: the limit 'functions' is 1",
        ),
        (
            "loop { pushTransform(); }",
            |l| l.transform_depth = 5,
            "8: error: too many pushTransform and group levels: the limit 'transform_depth' is 5",
        ),
        (
            "loop { sphere(0, 0, 0, 1); }",
            |l| l.primitives = 5,
            "8: error: too many shapes: the limit 'primitives' is 5",
        ),
        (
            "loop { light([0, 0, 0], [1, 1, 1]); }",
            |l| l.lights = 5,
            "8: error: too many lights: the limit 'lights' is 5",
        ),
    ] {
        assert_eq!(limited(source, set), format!("{place}{message}"), "{source}");
    }
}

#[test]
fn time_is_limited() {
    let message = limited("loop { let x = 1; }", |l| {
        l.script_time = std::time::Duration::from_millis(30)
    });
    assert!(
        message.ends_with("error: the script runs too long: the limit 'script_time' is 30ms"),
        "{message}"
    );
}

#[test]
fn printing_has_a_budget() {
    let host = Notes::default();
    let mut limits = Limits::default();
    limits.print_bytes = 40;
    let script = Script::compile("scene.rhai", "loop { print(\"123456789\"); }", &limits).unwrap();
    let e = script.run(&host, &RunOptions::default()).unwrap_err();
    assert_eq!(
        e.diagnostic.message,
        "the script prints too much: the limit 'print_bytes' is 40"
    );
    assert_eq!(host.printed().len(), 4);
}

#[test]
fn reading_a_script_has_a_time_limit() {
    // Names are looked up one by one: reading many of them takes time that grows with the square.
    let source: String = (0..60_000).map(|i| format!("let a{i}=1;")).collect();
    let mut limits = Limits::default();
    limits.compile_time = std::time::Duration::from_millis(50);
    limits.variables = 100_000;
    let e = Script::compile("scene.rhai", &source, &limits).unwrap_err();
    assert_eq!(e.kind(), Limit);
    assert_eq!(
        e.diagnostic.message,
        "reading the script takes too long: the limit 'compile_time' is 50ms"
    );
}

#[test]
fn attacks_end_in_an_error_of_their_own() {
    let many = "let a = [1]; let s = `${\"x\"}`; ";
    for attack in [
        "loop { a.push(a); }",
        "loop { a.push([a, a]); }",
        "loop { a += a; }",
        "loop { a.append(a); }",
        "loop { a.append([a, a]); }",
        "loop { a.insert(0, a); }",
        "a.pad(9000000000000000000, 0);",
        "a.pad(100000000, [1, 2, 3]);",
        "s.pad(9000000000000000000, 'x');",
        "loop { s += s; }",
        "loop { s = s + s; }",
        "s = \"a\"; s.pad(500000, 'a'); s.replace(\"a\", s);",
        "loop { s = `${s}${s}`; }",
        "let m = #{}; loop { m[s] = m; s += \"x\"; }",
        "fn f(x) { f([x, x]) } f(1);",
        "let f = |x| x; f = || f.call(); f.call();",
        "a.map(|x| loop { });",
        "while true { }",
        "do { } while true;",
        "for i in 0..9223372036854775807 { }",
        "loop { group { } }",
        "fn g() { group { g(); } } g();",
        "fn g(n) { define `d${n}` { g(n + 1); } } g(0);",
        "let b = [2, 1]; b.sort(|x, y| loop { });",
        "loop { try { loop { } } catch { } }",
        "for i in 0..100 { a.map(|x| { for j in 0..100000 { } }); }",
        "let f = 0; loop { let g = f; f = || g; }",
        "loop { material(material()); }",
        "let n = 0; loop { define `d${n}` { sphere(0, 0, 0, 1); } n += 1; instance(`d${n - 1}`); }",
    ] {
        let source = format!("{many}{attack}");
        let mut limits = Limits::untrusted();
        limits.script_time = std::time::Duration::from_millis(300);
        limits.closures = true;
        let script = Script::compile("scene.rhai", &source, &limits);
        let run = script.and_then(|s| s.run(&Notes::default(), &RunOptions::default()));
        let Err(e) = run else {
            panic!("{attack} runs");
        };
        // A data race is what Rhai calls a closure that is changed while it is called.
        assert!(
            e.kind() == Limit || e.to_string().contains("data race"),
            "{attack}: {e}"
        );
    }
}

/// Every function with arguments of every kind: whatever they are, the answer is a result or an error, and
/// never a fault of the program's own.
#[test]
fn no_arguments_are_a_fault_of_the_program() {
    let values = [
        "0",
        "1",
        "-1",
        "2.5",
        "1e308",
        "9223372036854775807",
        "-9223372036854775807 - 1",
        "0.0 / 0.0",
        "1.0 / 0.0",
        "\"\"",
        "\"#fff\"",
        "\"x.png\"",
        "'c'",
        "()",
        "true",
        "[]",
        "[1, 2, 3]",
        "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]",
        "[1e200, 0, -1e200]",
        "#{}",
        "#{ positions: [0, 0, 0, 1, 0, 0, 0, 1, 0] }",
        "#{ diffuse: [1, 0, 0] }",
        "vec3(1, 2, 3)",
        "vec3(0, 0, 0)",
        "|x| x",
        "0..5",
        "checker([1, 1, 1], [0, 0, 0], 1)",
    ];
    let mut dice = 11u64;
    let mut pick = |n: usize| {
        dice = dice
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (dice >> 33) as usize % n
    };
    let mut options = RunOptions::default();
    options.size = Some((2, 2));
    let mut faults = Vec::new();
    for entry in rtscript::script::entries() {
        // A block is no call.
        if entry
            .forms
            .iter()
            .flat_map(|form| form.iter())
            .any(|p| p.kind == rtscript::script::Kind::Block)
        {
            continue;
        }
        for arity in 0..6 {
            let calls: String = (0..12)
                .map(|_| {
                    let arguments: Vec<&str> = (0..arity).map(|_| values[pick(values.len())]).collect();
                    format!(
                        "try {{ {}({}); }} catch {{ }}\n",
                        entry.name,
                        arguments.join(", ")
                    )
                })
                .collect();
            let mut limits = Limits::untrusted();
            limits.closures = true;
            let script = Script::compile("scene.rhai", &calls, &limits).unwrap();
            if let Err(e) = script.run(&Notes::default(), &options)
                && !matches!(e.kind(), Limit)
            {
                faults.push(format!("{e}\n{calls}"));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_text_that_grows_too_long_is_not_written_to_its_end() {
    #[derive(Clone)]
    struct Loud(Arc<AtomicU64>);
    let asked = Arc::new(AtomicU64::new(0));
    let mut language = Language::new();
    let loud = Loud(Arc::clone(&asked));
    language.engine_mut(move |engine| {
        let loud = loud.clone();
        engine.register_type_with_name::<Loud>("loud");
        engine.register_fn("loud", move || loud.clone());
        engine.register_fn("to_debug", |loud: &mut Loud| {
            loud.0.fetch_add(1, Ordering::Relaxed);
            "!".repeat(30_000)
        });
    });
    let made = "let l = loud(); let a = []; for i in 0..1000 { a.push(l); } let m = #{}; for i in 0..900 { m[`k${i}`] = l; }";
    for text in [
        "a.to_string()",
        "`${a}`",
        "\"\" + a",
        "print(a)",
        "m.to_debug()",
        "`${m}`",
        "`${[[a]]}`",
    ] {
        asked.store(0, Ordering::Relaxed);
        let source = format!("{made}\nlet t = {text};");
        let script = Script::compile_in(&language, "a.rhai", &source, &Limits::untrusted()).unwrap();
        let error = script.run(&rtscript::NoHost, &RunOptions::default()).unwrap_err();
        assert!(error.to_string().starts_with("a.rhai:2:"), "{text}: {error}");
        assert!(
            error.to_string().contains("the limit 'string_bytes' is 65536"),
            "{text}: {error}"
        );
        assert!(asked.load(Ordering::Relaxed) < 10, "{text}: {asked:?}");
    }
}
