//! Every function of `functions.txt`, signature by signature, with values of the types that it takes which are as unkind as
//! they come; what it is called on is made by a constructor of its own type.

use std::{fs, path::Path};

use rtscript::{
    Limits, MemoryHost,
    diag::ErrorKind,
    output::{Format, encode},
    testing::from_rgb8,
};

use crate::run;

/// Values of each type that scripts have. Those of number types that only Rhai's own packages know cannot be made.
const VALUES: &[(&str, &[&str])] = &[
    (
        "int",
        &[
            "0",
            "1",
            "-1",
            "3",
            "9223372036854775807",
            "(-9223372036854775807 - 1)",
            "64",
        ],
    ),
    (
        "float",
        &[
            "0.5",
            "-0.0",
            "1e308",
            "-1e-320",
            "(0.0 / 0.0)",
            "(1.0 / 0.0)",
            "(-1.0 / 0.0)",
        ],
    ),
    ("bool", &["true", "false"]),
    ("char", &["'c'", "'😀'"]),
    ("string", &["\"\"", "\"ä€😀\"", "huge", "\"../x\""]),
    (
        "array",
        &[
            "[]",
            "[3, 1, 2]",
            "[[], [1], \"a\", ()]",
            "[[0, 0, 0], [1, 0, 0], [0, 1, 0]]",
            "long",
            "nested",
        ],
    ),
    ("blob", &["blob()", "blob(9, 200)"]),
    (
        "map",
        &[
            "#{}",
            "#{ a: 1, b: [1] }",
            "#{ n: -1, radius: 0.0 / 0.0, levels: 99 }",
        ],
    ),
    (
        "Fn",
        &[
            "Fn(\"abs\")",
            "|x| x",
            "|x, y| x < y",
            "|x, y, z| [x, y]",
            "|x| { throw \"no\" }",
        ],
    ),
    ("range", &["0..5", "5..0", "0..9223372036854775807"]),
    ("range=", &["0..=5", "0..=9223372036854775807"]),
    (
        "vec3",
        &["vec3(1, 2, 3)", "vec3(0, 0, 0)", "vec3(1e200, -1e200, 0)"],
    ),
    ("()", &["()"]),
    ("image", &["picture"]),
    (
        "texture",
        &["checker([1, 1, 1], [0, 0, 0], 1)", "marble()", "picture * 1e300"],
    ),
    ("error", &["fault"]),
    (
        "sdf",
        &[
            "sdfSphere(1)",
            "sdfGyroid(3, 0.1)",
            "(sdfBox(1, 1, 1) | sdfTorus(1, 0.2))",
        ],
    ),
    ("field", &["field", "(field * 1e300)", "(field - field)"]),
    (
        "curve",
        &[
            "curve([[0, 0, 0], [1, 1, 0], [2, 0, 0]])",
            "curve([[0, 0, 0], [0, 0, 0]])",
        ],
    ),
    ("stream", &["randomStream(\"a\")"]),
];

/// Lines that stand before the calls.
const BEFORE: &str = "size(2, 2); let huge = \"x\"; huge.pad(9000, 'y'); let long = []; long.pad(900, 7); \
                      let nested = []; for i in 0..50 { nested = [nested]; } let field = 0; let fault = 0; \
                      sdf(|x, y, z| { field = x; x }); try { sphere(); } catch (e) { fault = e; } \
                      let picture = image(\"a.png\"); let v = 0;\n";

/// What ends a script, or changes what it may do, whatever it is called with.
const LEFT_OUT: [&str; 4] = ["exit", "render", "size", "samples"];

fn values(kind: &str, i: usize) -> Option<&'static str> {
    let all = VALUES.iter().map(|(_, values)| *values);
    if kind == "any" {
        let every: Vec<&str> = all.flatten().copied().collect();
        // A stride that has no factor in common with the count, so that neighbors differ.
        return every.get(i * 37 % every.len()).copied();
    }
    let (_, values) = VALUES.iter().find(|(name, _)| *name == kind)?;
    values.get(i % values.len()).copied()
}

/// A statement that calls a function, on a line of its own; `None` where a value of such a type cannot be made.
fn call(name: &str, kinds: &[&str], round: usize) -> Option<String> {
    let arguments: Option<Vec<&str>> = kinds
        .iter()
        .enumerate()
        .map(|(i, kind)| values(kind, round * 5 + i * (round + 1) + name.len()))
        .collect();
    let arguments = arguments?;
    let first = arguments.first().copied().unwrap_or_default();
    let operator = if name.starts_with("**") { "**" } else { name };
    let is_word = operator.starts_with(|c: char| c.is_alphabetic());
    let expression = match (name.split_once('$'), &arguments[..]) {
        (Some(("index", "get$")), [of, at]) => format!("v = {of}; v[{at}]"),
        (Some(("index", "set$")), [of, at, to]) => format!("v = {of}; v[{at}] = {to}"),
        (Some(("get", property)), [of]) => format!("v = {of}; v.{property}"),
        (Some(("set", property)), [of, to]) => format!("v = {of}; v.{property} = {to}"),
        (Some(_), _) => return None,
        (None, [a]) if !is_word => format!("{operator}{a}"),
        (None, [a, b]) if operator.ends_with('=') && !["==", "!=", "<=", ">="].contains(&operator) => {
            format!("v = {a}; v {operator} {b}")
        }
        (None, [a, b]) if !is_word => format!("{a} {operator} {b}"),
        (None, [_, rest @ ..]) if round % 2 == 1 => format!("v = {first}; v.{name}({})", rest.join(", ")),
        _ => format!("{name}({})", arguments.join(", ")),
    };
    Some(format!("try {{ {expression}; }} catch {{ }}\n"))
}

#[test]
fn every_function_is_tried_and_none_is_a_fault_of_the_program() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abuse/functions.txt");
    let text = fs::read_to_string(path).unwrap();
    let mut calls = Vec::new();
    let (mut tried, mut unmade) = (0, Vec::new());
    for line in text.lines() {
        let (name, kinds) = line.rsplit_once(" : ").unwrap();
        if LEFT_OUT.contains(&name) {
            continue;
        }
        let kinds: Vec<&str> = kinds.split(' ').filter(|kind| !kind.is_empty()).collect();
        let made: Vec<String> = (0..3).filter_map(|round| call(name, &kinds, round)).collect();
        if made.is_empty() {
            unmade.push(line);
        } else {
            tried += 1;
        }
        calls.extend(made);
    }
    // Only numbers that scripts do not have.
    const FOREIGN: [&str; 11] = [
        "i8", "u8", "i16", "u16", "i32", "u32", "u64", "i128", "u128", "f32", "usize",
    ];
    for line in &unmade {
        assert!(
            line.split(' ').any(|word| FOREIGN.contains(&word)),
            "no value for {line}"
        );
    }
    assert!(tried > 1000, "{tried} signatures");

    let mut limits = Limits::untrusted();
    limits.closures = true;
    limits.operations = 20_000;
    limits.primitives = 500;
    limits.string_bytes = 10_000;
    limits.array_len = 1_000;
    limits.variables = 2_000;
    limits.print_bytes = 1 << 20;
    limits.script_time *= 100;
    let picture = encode(&from_rgb8(2, 1, &[255, 0, 0, 0, 0, 255]), Format::Png).unwrap();
    let host = MemoryHost::new().with("a.png", picture);
    let mut from = 0;
    let mut ended = 0;
    while from < calls.len() {
        let some = &calls[from..calls.len().min(from + 100)];
        let script = format!("{BEFORE}{}", some.concat());
        let Err(error) = run(&script, &limits, &host) else {
            from += some.len();
            continue;
        };
        assert!(
            matches!(error.kind(), ErrorKind::Limit | ErrorKind::Script),
            "{error}"
        );
        // A limit cannot be caught: the calls behind it are tried by a script of their own.
        let line = error.diagnostic.line as usize;
        assert!(line >= 2 && line < some.len() + 2, "{error}\n{script}");
        from += line - 1;
        ended += 1;
    }
    assert!(
        ended < calls.len() / 4,
        "{ended} of {} calls met a limit",
        calls.len()
    );
}
