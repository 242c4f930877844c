//! Script source: any text, mostly what the fuzzer makes of the test scenes.

use rtscript::{RunOptions, Script, render::inspect, source};

use crate::oracle::{check, check_error, check_source, host, limits};

const NAME: &str = "a.rhai";

pub fn run(data: &[u8]) {
    let limits = limits();
    match source::text(NAME, data.to_vec(), &limits) {
        Ok(text) => run_text(&text, true),
        Err(error) => check_error(&error, &[]),
    }
}

/// Runs a script, and where it builds a scene, holds that to what is promised. `dry` leaves out what it renders.
pub fn run_text(text: &str, dry: bool) {
    let (limits, host) = (
        limits(),
        host().with("lib.rhai", "fn ball(r) { sphere(0, 0, 0, r); }"),
    );
    let texts = [(NAME, text)];
    let mut options = RunOptions::default();
    (options.dry, options.lint) = (dry, true);
    (options.size, options.samples) = (Some((8, 6)), Some(1));
    options.render.threads = 1;
    let ran = Script::compile(NAME, text, &limits).and_then(|script| script.run(&host, &options));
    let report = match ran {
        Ok(report) => report,
        Err(error) => return check_error(&error, &texts),
    };
    report.warnings.iter().for_each(|warning| check(warning, &texts));
    let run = &report.value;
    for warning in inspect(&run.scene, &host).into_iter().flatten() {
        check(&warning, &texts);
    }
    // What is rendered into a texture is not written out to the last bit of a picture made dry.
    let pictures = text.contains("render");
    if !pictures {
        check_source(run, &host, !text.contains("catch"));
    }
}
