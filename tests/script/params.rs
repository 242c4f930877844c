//! `param(name, default, options)`.

use rtscript::{RunOptions, Script, parameters::ParameterKind};

use crate::host::{Notes, try_run};

fn printed(source: &str, given: &[(&str, &str)]) -> Result<Vec<String>, String> {
    let host = Notes::default();
    let mut options = RunOptions::default();
    for (name, value) in given {
        options.parameters.insert((*name).to_owned(), (*value).to_owned());
    }
    let script =
        Script::compile("a.rhai", source, &rtscript::Limits::default()).map_err(|e| e.to_string())?;
    script.run(&host, &options).map_err(|e| e.to_string())?;
    Ok(host.printed())
}

#[test]
fn the_value_has_the_type_of_the_default() {
    let source = "
        print(type_of(param(\"a\", 1))); print(type_of(param(\"b\", 1.0)));
        print(type_of(param(\"c\", true))); print(type_of(param(\"d\", \"x\")));
    ";
    let types = ["i64", "f64", "bool", "string"];
    assert_eq!(printed(source, &[]).unwrap(), types);
    assert_eq!(
        printed(source, &[("a", "-3"), ("b", "2"), ("c", "false"), ("d", "7")]).unwrap(),
        types
    );
    assert_eq!(
        printed("print(param(\"b\", 0.5) * 2);", &[("b", "1e-1")]).unwrap(),
        ["0.2"]
    );
}

#[test]
fn a_run_tells_what_was_declared() {
    let host = Notes::default();
    let source = "param(\"r\", 0.5, #{ min: 0, max: 2, doc: \"of it\" });\nfn f() { param(\"n\", 3, #{ choices: [1, 3] }) }\nf(); f();";
    let script = Script::compile("a.rhai", source, &rtscript::Limits::default()).unwrap();
    let mut options = RunOptions::default();
    options.parameters.insert("n".to_owned(), "1".to_owned());
    let run = script.run(&host, &options).unwrap().value;
    let [r, n] = &run.parameters[..] else {
        panic!("{:?}", run.parameters)
    };
    assert_eq!(
        (r.kind, r.min, r.max, &*r.doc, r.loc.line),
        (ParameterKind::Number, Some(0.0), Some(2.0), "of it", 1)
    );
    assert_eq!(
        (n.kind, &*n.default, &*n.value, n.loc.line),
        (ParameterKind::Int, "3", "1", 2)
    );
    assert_eq!(n.choices, ["1", "3"]);
}

#[test]
fn declarations_that_make_no_sense_are_errors() {
    for (source, message) in [
        ("param(\"a b\", 1)", "is no name for a parameter"),
        ("param(\"\", 1)", "is no name for a parameter"),
        ("param(\"seed\", 1)", "\"seed\" is taken"),
        (
            "param(\"a\", [1])",
            "default must be a number, true, false or a string, not an array",
        ),
        (
            "param(\"a\", 5, #{ max: 2 })",
            "the default 5 is not a whole number up to 2",
        ),
        (
            "param(\"a\", \"x\", #{ max: 2 })",
            "max is for numbers, and the default is a string",
        ),
        (
            "param(\"a\", 1, #{ choices: 3 })",
            "choices must be an array, not a number",
        ),
        (
            "param(\"a\", 1, #{ choices: [2, 3] })",
            "the default 1 is not one of 2, 3",
        ),
        ("param(\"a\", 1, #{ maximum: 3 })", "unknown key \"maximum\""),
        ("param(\"a\", 1, #{ doc: 3 })", "doc must be a string"),
        (
            "param(\"a\", 1);\nparam(\"a\", 2)",
            "\"a\" was declared in line 1 with another default or other options",
        ),
        ("param(\"a\")", "param takes"),
        ("param(1, 2)", "name must be a string"),
    ] {
        let error = try_run(source).unwrap_err().to_string();
        assert!(error.contains(message), "{source}: {error}");
    }
}

#[test]
fn a_value_for_nothing_is_an_error_unless_the_script_fails_first() {
    let error = printed("param(\"radius\", 1);", &[("raduis", "2")]).unwrap_err();
    assert!(
        error.contains("the script has no parameter \"raduis\""),
        "{error}"
    );
    let error = printed("throw \"x\";", &[("a", "2")]).unwrap_err();
    assert!(error.contains('x') && !error.contains("parameter"), "{error}");
}
