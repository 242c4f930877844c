//! Functions of the language that call functions of the script.

use std::time::Duration;

use rtscript::{Limits, NoHost, RunOptions, Script, diag::ErrorKind, script::Run};

fn run_within(source: &str, limits: &Limits) -> Result<Run, rtscript::Error> {
    let script = Script::compile("a.rhai", source, limits)?;
    script.run(&NoHost, &RunOptions::default()).map(|run| run.value)
}

fn run(source: &str) -> Result<Run, rtscript::Error> {
    run_within(source, &Limits::default())
}

#[test]
fn what_is_called_may_work_on_the_scene_and_call_such_functions_again() {
    let made = run("
        let count = 0;
        fn low(x, z) { 0.1 * x }
        heightField(|x, z| {
            count += 1;
            if count == 1 { sphere(0, 0, 0, 1); heightField(Fn(\"low\"), #{ columns: 2, rows: 2 }); }
            random(0, 1)
        }, #{ columns: 3, rows: 2 });
        if count != 6 { throw count; }
    ")
    .unwrap();
    assert_eq!(made.scene.root().objects.len(), 3);
    // The field belongs to its own line, whatever stood in others meanwhile.
    let lines: Vec<u32> = made
        .scene
        .root()
        .objects
        .iter()
        .map(|object| object.loc.line)
        .collect();
    assert_eq!(lines, [6, 6, 4]);
}

#[test]
fn an_error_in_what_is_called_can_be_caught_and_leaves_nothing() {
    let made = run("
        try { heightField(|x, z| if x > 0 { throw \"enough\" } else { 0 }); }
        catch (e) { if e != \"enough\" { throw e; } }
        try { surface(|u, v| [u, v, 1.0 / 0.0]); } catch { }
        sphere(0, 0, 0, 1);
    ");
    assert_eq!(made.unwrap().scene.root().objects.len(), 1);
}

#[test]
fn its_steps_and_its_time_are_the_scripts() {
    let mut limits = Limits::default();
    limits.operations = 20_000;
    let source = "heightField(|x, z| x + z, #{ columns: 1000, rows: 1000 });";
    let error = run_within(source, &limits).unwrap_err();
    assert_eq!(error.kind(), ErrorKind::Limit);
    assert!(error.to_string().contains("'operations'"), "{error}");
    limits = Limits::default();
    limits.script_time = Duration::from_millis(30);
    let endless = "surface(|u, v| [u, v, sin(1e9 * u * v)], #{ tolerance: 1e-9 });";
    let error = run_within(endless, &limits).unwrap_err();
    assert!(error.to_string().contains("'script_time'"), "{error}");
    limits = Limits::default();
    limits.script_time = Duration::from_millis(30);
    let large = "let points = []; for i in 0..16 { points.push([i % 4, sin(7.0 * i), i / 4]); }\n\
        bezierPatch(points, #{ tolerance: 1e-9 });";
    let error = run_within(large, &limits).unwrap_err();
    assert!(error.to_string().contains("'script_time'"), "{error}");
}
