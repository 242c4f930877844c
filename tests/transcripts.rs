//! Sessions with the command, written down: `tests/transcripts/*.md`. `TRYCMD=overwrite cargo test --test transcripts`
//! writes down what is printed now.

#[test]
#[cfg_attr(windows, ignore = "paths and messages of the system differ")]
fn sessions_go_as_written_down() {
    trycmd::TestCases::new()
        .env("NO_COLOR", "1")
        .case("tests/transcripts/*.md");
}
