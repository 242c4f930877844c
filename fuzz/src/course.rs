//! Scenes of the course's format.

use rtscript::{MemoryHost, RunOptions, Script, import::script_from_course, source};

use crate::oracle::{check, check_error, check_source, limits};

const NAME: &str = "a.test";

pub fn run(data: &[u8]) {
    let (limits, host) = (limits(), MemoryHost::new());
    let text = match source::text(NAME, data.to_vec(), &limits) {
        Ok(text) => text,
        Err(error) => return check_error(&error, &[]),
    };
    let texts = [(NAME, &*text)];
    let options = RunOptions::default();
    let loaded = source::load(NAME, &text, &host, &limits, &options);
    let converted = script_from_course(NAME, &text);
    match loaded {
        Err(error) => {
            check_error(&error, &texts);
            if let Err(diagnostic) = converted {
                check(&diagnostic, &texts);
            }
        }
        Ok(report) => {
            report.warnings.iter().for_each(|warning| check(warning, &texts));
            check_source(&report.value, &host, true);
            let script = converted.unwrap_or_else(|e| panic!("a scene that loads is not converted: {e}"));
            let again = Script::compile("a.rhai", &script, &rtscript::Limits::default())
                .and_then(|script| script.run(&host, &options))
                .unwrap_or_else(|e| panic!("the script does not run: {e}\n{script}"));
            assert_eq!(
                again.value.scene.hash(),
                report.value.scene.hash(),
                "another scene\n{script}"
            );
        }
    }
}
