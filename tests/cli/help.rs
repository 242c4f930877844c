//! `rtscript help`, the completions and the manual pages.

use super::*;

fn out(args: &[&str]) -> String {
    String::from_utf8(Folder::new().ok(args).stdout).unwrap()
}

#[test]
fn help_lists_every_function_in_one_line_each() {
    let text = out(&["help"]);
    for entry in rtscript::script::entries() {
        let starts_so = |line: &str| line.starts_with(&format!("  {} ", entry.name));
        assert_eq!(text.lines().filter(|l| starts_so(l)).count(), 1, "{}", entry.name);
        assert!(text.contains(entry.group.title()), "{}", entry.name);
    }
    assert!(!text.contains('\x1b'), "no styles where there is no terminal");
    assert!(text.lines().all(|line| line.chars().count() <= 120));
}

#[test]
fn help_tells_of_every_function() {
    for entry in rtscript::script::entries() {
        let text = out(&["help", entry.name]);
        assert!(text.starts_with(entry.name), "{text}");
        assert!(text.contains("\nExample\n"), "{text}");
        for param in entry.forms.iter().copied().flatten() {
            assert!(text.contains(&format!("\n  {} ", param.name)), "{text}");
        }
    }
}

#[test]
fn a_function_comes_with_its_forms_its_example_and_what_that_prints() {
    assert_eq!(
        out(&["help", "log"]),
        "\
log(x, base = 10) -> float

Logarithm to base 10, or to the base given.

  x     number  a number
  base  number  the base of the logarithm; 10 where it is left out

Example
  print(log(1000));
  print(log(8, 2));

It prints
  3.0
  3.0

In the group Numbers: rtscript help numbers
"
    );
    assert!(out(&["help", "define"]).starts_with("define name { ... }\n"));
    assert!(out(&["help", "sphere()"]).starts_with("sphere(center, radius)\n"));
}

#[test]
fn the_example_is_shown_where_the_terminal_can() {
    let text = out(&["help", "sphere", "--pictures", "blocks"]);
    assert!(text.matches('▀').count() >= 80 * 20, "{text}");
    assert!(out(&["help", "sphere", "--pictures", "kitty"]).contains("\x1b_Ga=T"));
    assert!(!out(&["help", "sphere", "--pictures", "none"]).contains('▀'));
    assert!(!out(&["help", "dot", "--pictures", "blocks"]).contains('▀'));
}

#[test]
fn names_of_other_systems_lead_to_ours() {
    let text = out(&["help", "gluLookAt"]);
    assert!(
        text.starts_with("gluLookAt is called camera here.\n\ncamera(from"),
        "{text}"
    );
}

#[test]
fn help_knows_words_groups_and_commands() {
    assert!(out(&["help", "PI"]).starts_with("PI = 3.14159"));
    assert!(out(&["help", "width"]).starts_with(".width of image: int\n"));
    assert!(out(&["help", "vec3.x"]).starts_with(".x of vec3: number\n"));
    let shapes = out(&["help", "shapes"]);
    assert!(shapes.starts_with("Shapes\n  sphere"), "{shapes}");
    assert!(!shapes.contains("translate"));
    assert_eq!(out(&["help", "convert"]), out(&["convert", "--help"]));
}

#[test]
fn an_unknown_name_gets_the_nearest() {
    let folder = Folder::new();
    folder.fails(
        &["help", "sphre"],
        2,
        &["there is no 'sphre'; did you mean 'sphere'?"],
    );
    folder.fails(&["help", "areaLigth"], 2, &["'areaLight'"]);
    folder.fails(
        &["help", "quaternion"],
        2,
        &["there is no 'quaternion'", "rhai.rs/book"],
    );
    folder.fails(&["help", "sphere", "--json"], 2, &["--json"]);
}

#[test]
fn the_table_comes_as_json_and_as_definitions() {
    let api: serde_json::Value = serde_json::from_str(&out(&["help", "--json"])).unwrap();
    let functions = api["functions"].as_array().unwrap();
    assert_eq!(functions.len(), rtscript::script::entries().count());
    let sphere = functions.iter().find(|f| f["name"] == "sphere").unwrap();
    assert_eq!(sphere["forms"][0][1]["name"], "radius");
    assert_eq!(sphere["forms"][0][1]["unit"], "object units");
    let definitions = out(&["help", "--definitions"]);
    assert!(definitions.starts_with("module static;\n"));
    for line in [
        "fn sphere(center: vec3, radius: float) -> ();",
        "fn sphere(center_x: float, center_y: float, center_z: float, radius: float) -> ();",
        "fn log(x: float) -> float;",
        "fn log(x: float, base: float) -> float;",
        "const PI: float;",
    ] {
        assert_eq!(definitions.matches(&format!("\n{line}\n")).count(), 1, "{line}");
    }
    let lines = definitions.lines().filter(|l| l.starts_with("fn "));
    let distinct: std::collections::BTreeSet<&str> = lines.clone().collect();
    assert_eq!(lines.count(), distinct.len(), "a form is there twice");
}

#[test]
fn a_reference_that_cannot_be_written_is_an_output_error() {
    let folder = Folder::new();
    folder.write("docs", "a file");
    folder.fails(
        &["help", "--write", "docs"],
        4,
        &["cannot make 'docs/images/reference'"],
    );
}

#[test]
fn completions_know_commands_and_options() {
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = out(&["completions", shell]);
        for word in ["convert", "samples", "definitions"] {
            assert!(script.contains(word), "{shell}: {word}");
        }
    }
    Folder::new().fails(&["completions", "tcsh"], 2, &["bash", "zsh"]);
}

#[test]
fn manual_pages_are_there_for_the_program_and_its_commands() {
    let page = out(&["man"]);
    assert!(page.contains(".TH rtscript 1"), "{page}");
    assert!(page.contains("Exit codes"));
    let page = out(&["man", "test"]);
    assert!(page.contains(".TH rtscript-test 1"), "{page}");
    assert!(page.contains("\\-\\-tolerance"));
    Folder::new().fails(&["man", "tset"], 2, &["there is no command 'tset'"]);
}
