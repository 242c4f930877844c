//! Chains of calls at random: every function of the language, with values at the edges of what there is.

use rtscript::{Limits, diag::ErrorKind, script::entries};

use crate::{Quiet, run};

/// What Rhai's packages bring, as methods of whatever stands first, and operators in the place of a dot.
const BORROWED: &[&str] = &[
    "abs",
    "sign",
    "is_zero",
    "is_odd",
    "is_even",
    "is_nan",
    "is_finite",
    "is_infinite",
    "floor",
    "ceiling",
    "round",
    "int",
    "fraction",
    "to_int",
    "to_float",
    "to_string",
    "to_debug",
    "to_hex",
    "to_octal",
    "to_binary",
    "get_bit",
    "set_bit",
    "get_bits",
    "set_bits",
    "bits",
    "len",
    "is_empty",
    "push",
    "append",
    "insert",
    "concat",
    "pad",
    "pop",
    "shift",
    "remove",
    "clear",
    "truncate",
    "chop",
    "reverse",
    "splice",
    "extract",
    "split",
    "map",
    "filter",
    "contains",
    "index_of",
    "dedup",
    "some",
    "all",
    "reduce",
    "reduce_rev",
    "zip",
    "sort",
    "sort_desc",
    "order",
    "order_desc",
    "drain",
    "retain",
    "find",
    "find_map",
    "for_each",
    "to_blob",
    "as_string",
    "parse_le_int",
    "parse_be_int",
    "write_le",
    "write_be",
    "write_utf8",
    "get",
    "set",
    "keys",
    "values",
    "mixin",
    "fill_with",
    "sub_string",
    "crop",
    "trim",
    "to_upper",
    "to_lower",
    "make_upper",
    "make_lower",
    "starts_with",
    "ends_with",
    "chars",
    "bytes",
    "to_chars",
    "replace",
    "split_rev",
    "split_at",
    "parse_int",
    "parse_float",
    "range",
    "start",
    "end",
    "exclusive",
    "is_inclusive",
    "call",
    "name",
    "is_anonymous",
    "print",
    "debug",
    "max",
    "min",
    "remove",
    "+",
    "-",
    "*",
    "/",
    "%",
    "**",
    "<<",
    ">>",
    "&",
    "|",
    "^",
    "==",
    "!=",
    "<",
    "<=",
    ">",
    ">=",
    "in",
    "+=",
    "-=",
    "*=",
    "/=",
    "%=",
    "<<=",
    ">>=",
    "**=",
];

const VALUES: &[&str] = &[
    "0",
    "1",
    "-1",
    "9223372036854775807",
    "(-9223372036854775807 - 1)",
    "63",
    "64",
    "0.5",
    "-0.0",
    "1e308",
    "-1e308",
    "1e-320",
    "(0.0 / 0.0)",
    "(1.0 / 0.0)",
    "(-1.0 / 0.0)",
    "true",
    "()",
    "\"\"",
    "\"a\"",
    "\"ä€😀\"",
    "huge",
    "'c'",
    "'😀'",
    "[]",
    "[1]",
    "[[], [1], \"a\"]",
    "[3, 1, 2]",
    "[1, \"a\", ()]",
    "long",
    "#{}",
    "#{ a: 1, b: [1] }",
    "blob()",
    "blob(9, 200)",
    "0..5",
    "5..0",
    "0..=9223372036854775807",
    "range(0, 10, 3)",
    "vec3(1, 2, 3)",
    "vec3(0, 0, 0)",
    "vec3(1e200, -1e200, 0)",
    "checker([1, 1, 1], [0, 0, 0], 1)",
    "nested",
    "|x| x",
    "|x, y| x < y",
    "|x| [x, x]",
    "Fn(\"abs\")",
    "PI",
];

struct Dice(u64);

impl Dice {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % n
    }

    fn of<'a>(&mut self, list: &[&'a str]) -> &'a str {
        list[self.below(list.len())]
    }
}

/// A statement that calls something on a value or on what came out of the call before.
fn step(dice: &mut Dice, names: &[&str]) -> String {
    let value = |dice: &mut Dice| match dice.below(4) {
        0 => "v",
        1 => "w",
        _ => dice.of(VALUES),
    };
    let name = dice.of(names);
    let first = value(dice);
    let call = if name.starts_with(|c: char| c.is_alphabetic()) && name != "in" {
        let arguments: Vec<&str> = (0..dice.below(4)).map(|_| value(dice)).collect();
        let arguments = arguments.join(", ");
        match dice.below(3) {
            0 => format!(
                "{name}({first}{}{arguments})",
                if arguments.is_empty() { "" } else { ", " }
            ),
            1 => format!("w = {first}; w.{name}({arguments})"),
            _ => format!("v.{name}({arguments})"),
        }
    } else if name.ends_with('=') && !["==", "!=", "<=", ">="].contains(&name) {
        format!("v {name} {first}; v")
    } else {
        format!("{first} {name} {}", value(dice))
    };
    format!(
        "try {{ v = {{ {call} }}; }} catch {{ v = {}; }}\n",
        dice.of(VALUES)
    )
}

/// Whatever is called with whatever, nothing is a fault of the program's own. A panic would be: it comes back as an error
/// of that kind.
#[test]
fn no_chain_of_calls_is_a_fault_of_the_program() {
    let own = entries()
        .map(|entry| entry.name)
        .filter(|name| !["group", "define", "render", "size", "exit"].contains(name));
    let names: Vec<&str> = own.chain(BORROWED.iter().copied()).collect();
    let mut dice = Dice(7);
    let mut limits = Limits::untrusted();
    limits.closures = true;
    limits.operations = 100_000;
    let mut ended = [0; 2];
    for round in 0..400 {
        let mut script =
            "size(2, 2); let huge = \"x\"; huge.pad(60000, 'y'); let long = []; long.pad(5000, 7);\n\
                          let nested = []; for i in 0..200 { nested = [nested]; }\nlet v = 1; let w = 2;\n"
                .to_owned();
        (0..60).for_each(|_| script += &step(&mut dice, &names));
        match run(&script, &limits, &Quiet) {
            Ok(_) => ended[0] += 1,
            Err(error) => {
                assert!(
                    matches!(error.kind(), ErrorKind::Limit | ErrorKind::Script),
                    "round {round}: {error}\n{script}"
                );
                ended[1] += 1;
            }
        }
    }
    assert!(ended[0] > 50, "{ended:?}: most scripts must come to their end");
}
