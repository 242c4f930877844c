//! Sessions with the command, written down: `tests/transcripts/*.md`. `TRYCMD=overwrite cargo test --test transcripts`
//! writes down what is printed now.

#![allow(clippy::unwrap_used)]

use std::{fs, path::Path, process::Command};

use rtscript::diag::Code;

#[test]
#[cfg_attr(windows, ignore = "paths and messages of the system differ")]
fn sessions_go_as_written_down() {
    trycmd::TestCases::new()
        .env("NO_COLOR", "1")
        .case("tests/transcripts/*.md");
}

/// Classes that no command line brings about by itself: a signal (`tests/cli/system.rs`), and a fault of the program.
const WITHOUT: [&str; 2] = ["cancelled", "internal"];

#[test]
fn every_class_of_messages_is_written_down() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/transcripts");
    let sessions: String = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .map(|path| fs::read_to_string(path).unwrap())
        .collect();
    for code in Code::ALL {
        let shown = format!("{}[{}]", code.severity().name(), code.name());
        let is_there = sessions.contains(&shown);
        assert_eq!(is_there, !WITHOUT.contains(&code.name()), "{shown}");
    }
    let errors = sessions.matches("\nerror").count();
    assert!(errors >= 80, "{errors}");
}

#[test]
fn every_command_has_its_session() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/transcripts/commands.md");
    let sessions = fs::read_to_string(path).unwrap();
    let help = Command::new(env!("CARGO_BIN_EXE_rtscript"))
        .arg("--help")
        .output()
        .unwrap();
    let help = String::from_utf8(help.stdout).unwrap();
    let commands = help.lines().skip_while(|line| *line != "Commands:").skip(1);
    let names: Vec<&str> = commands
        .take_while(|line| !line.is_empty())
        .filter_map(|line| line.strip_prefix("  ")?.split(' ').next())
        .filter(|name| !name.is_empty())
        .collect();
    assert!(names.len() >= 15, "{names:?}");
    for name in names {
        assert!(sessions.contains(&format!("$ rtscript {name}")), "{name}");
    }
}
