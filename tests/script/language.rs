//! Functions of the program's own.

use std::sync::{
    Arc,
    atomic::{AtomicU64, Ordering},
};

use rtscript::{
    DVec3, Error, Limits, MemoryHost, NoHost, Report, RunOptions, Script,
    diag::Code,
    scene::SceneError,
    script::{
        Language, Run, build,
        rhai::{EvalAltResult, NativeCallContext},
    },
};

fn language() -> Language {
    let mut language = Language::new();
    language.engine_mut(|engine| {
        engine.register_fn("column", |ctx: NativeCallContext, n: i64| {
            build(&ctx, |b| {
                if n > 9 {
                    return Err(SceneError::new(format!("a column has at most 9 balls, not {n}")));
                }
                (0..n).try_for_each(|i| b.sphere(DVec3::Y * i as f64, 0.5))
            })
        });
        engine.register_fn("answer", |x: f64| x * 2.0);
    });
    language
}

fn run(script: &str) -> Result<Report<Run>, Error> {
    let script = Script::compile_in(&language(), "a.rhai", script, &Limits::default())?;
    let mut options = RunOptions::default();
    options.lint = true;
    let host = MemoryHost::new().with("m.rhai", "fn two() { column(2); }");
    script.run(&host, &options)
}

fn error(script: &str) -> (String, u32, u32) {
    let error = run(script).unwrap_err();
    (
        error.diagnostic.message.clone(),
        error.diagnostic.line,
        error.diagnostic.column,
    )
}

#[test]
fn they_build_where_the_script_is_and_stand_where_it_calls() {
    let report = run("translate(5, 0, 0);\n  column(3);\nimport \"m\" as m; m::two();").unwrap();
    assert!(
        report.warnings.iter().all(|w| w.code != Code::UnknownFunction),
        "{:?}",
        report.warnings
    );
    let scene = report.value.scene;
    let objects = &scene.root().objects;
    assert_eq!(objects.len(), 5);
    assert_eq!(
        (objects[0].loc.line, objects[0].loc.column, objects[0].loc.file),
        (2, 3, 0)
    );
    assert_eq!((objects[4].loc.line, objects[4].loc.file), (1, 1));
    assert_eq!(scene.world_from_object(&objects[0]).translation.x, 5.0);
}

#[test]
fn their_errors_have_the_place_of_the_call() {
    assert_eq!(
        error("let n = 12;\n  column(n);"),
        ("a column has at most 9 balls, not 12".to_owned(), 2, 3)
    );
    assert_eq!(
        error("column(\"three\");"),
        ("column cannot be called with a string".to_owned(), 1, 1)
    );
    let (message, ..) = error("colum(3);");
    assert_eq!(message, "unknown function colum");
}

#[test]
fn a_script_that_is_read_without_them_does_not_know_them() {
    let script = Script::compile("a.rhai", "column(3);", &Limits::default()).unwrap();
    let error = script.run(&NoHost, &RunOptions::default()).unwrap_err();
    assert_eq!(error.diagnostic.code, Code::UnknownFunction);
}

#[test]
fn they_cannot_build_from_within_what_they_build() {
    let mut language = Language::new();
    language.engine_mut(|engine| {
        engine.register_fn(
            "inner",
            |ctx: NativeCallContext| -> Result<(), Box<EvalAltResult>> {
                build(&ctx, |_| match build(&ctx, |b| b.sphere(DVec3::ZERO, 1.0)) {
                    Ok(()) => Ok(()),
                    Err(_) => Err(SceneError::new("not twice")),
                })
            },
        );
    });
    let script = Script::compile_in(&language, "a.rhai", "inner();", &Limits::default()).unwrap();
    let error = script.run(&NoHost, &RunOptions::default()).unwrap_err();
    assert_eq!(error.diagnostic.message, "not twice");
}

#[test]
fn what_they_share_is_shared_by_runs_at_once() {
    let calls = Arc::new(AtomicU64::new(0));
    let mut language = Language::new();
    let counted = Arc::clone(&calls);
    language.engine_mut(move |engine| {
        let counted = Arc::clone(&counted);
        engine.register_fn("count", move || {
            counted.fetch_add(1, Ordering::Relaxed);
        });
    });
    let script = Script::compile_in(
        &language,
        "a.rhai",
        "for i in 0..100 { count(); sphere(i, 0, 0, 1); }",
        &Limits::untrusted(),
    )
    .unwrap();
    std::thread::scope(|scope| {
        for _ in 0..4 {
            scope.spawn(|| {
                let run = script.run(&NoHost, &RunOptions::default()).unwrap().value;
                assert_eq!(run.scene.root().objects.len(), 100);
            });
        }
    });
    assert_eq!(calls.load(Ordering::Relaxed), 400);
}
