//! Numbers in scripts: the same bits everywhere, ints and floats alike, `**` as Rhai defines it.

use crate::host::{printed, run, try_run};
use rtscript::math;

/// The bits of what a script prints as a float; printing is exact, and so is reading it back.
fn bits(lines: &[String]) -> Vec<u64> {
    lines
        .iter()
        .map(|l| l.parse::<f64>().unwrap_or_else(|e| panic!("{l}: {e}")).to_bits())
        .collect()
}

/// Arguments spread over many sizes, none of them a round number.
fn arguments() -> Vec<f64> {
    (0..120)
        .map(|i| 0.137 * 1.13f64.sqrt() * f64::from(i) + 0.011)
        .collect()
}

#[test]
fn functions_come_from_the_portable_library() {
    type Unary = fn(f64) -> f64;
    let functions: [(&str, Unary); 17] = [
        ("sin", math::sin),
        ("cos", math::cos),
        ("tan", math::tan),
        ("asin", math::asin),
        ("acos", math::acos),
        ("atan", math::atan),
        ("sinh", math::sinh),
        ("cosh", math::cosh),
        ("tanh", math::tanh),
        ("asinh", math::asinh),
        ("acosh", math::acosh),
        ("atanh", math::atanh),
        ("exp", math::exp),
        ("ln", math::ln),
        ("log2", math::log2),
        ("log10", math::log10),
        ("cbrt", math::cbrt),
    ];
    for (name, f) in functions {
        let inside = |x: &f64| f(*x).is_finite();
        let arguments: Vec<f64> = arguments().into_iter().filter(inside).collect();
        assert!(arguments.len() > 5, "{name}");
        let calls: String = arguments
            .iter()
            .map(|x| format!("print({name}({x:?}));\n"))
            .collect();
        let methods: String = arguments
            .iter()
            .map(|x| format!("print(({x:?}).{name}());\n"))
            .collect();
        let wanted: Vec<u64> = arguments.iter().map(|x| f(*x).to_bits()).collect();
        assert_eq!(bits(&printed(&calls)), wanted, "{name}(x)");
        assert_eq!(bits(&printed(&methods)), wanted, "x.{name}()");
    }
}

#[test]
fn powers_come_from_the_portable_library_by_every_way() {
    let arguments = arguments();
    let wanted: Vec<u64> = arguments.iter().map(|x| math::pow(*x, 2.7).to_bits()).collect();
    for way in [
        "X ** 2.7",
        "pow(X, 2.7)",
        "Fn(\"pow\").call(X, 2.7)",
        "[X, 2.7].reduce(|a, b| if a == () { b } else { a ** b })",
        "X ** (54.0 / 20)",
        "{ let x = X; x ** 2.7 }",
        "`${X ** 2.7}`",
        "#{ a: [X ** 2.7] }.a[0]",
        "X.pow(2.7)",
    ] {
        let script: String = arguments
            .iter()
            .map(|x| format!("print({});\n", way.replace('X', &format!("{x:?}"))))
            .collect();
        assert_eq!(bits(&printed(&script)), wanted, "{way}");
    }
    let with_int: String = arguments
        .iter()
        .map(|x| format!("print({x:?} ** 3);\n"))
        .collect();
    let cubes: Vec<u64> = arguments.iter().map(|x| math::pow(*x, 3.0).to_bits()).collect();
    assert_eq!(bits(&printed(&with_int)), cubes);
}

#[test]
fn the_square_is_the_product() {
    run("for i in 1..200 { let x = i * 0.137; if x ** 2 - x * x != 0.0 { throw i; } }");
}

#[test]
fn powers_of_ints() {
    for (source, wanted) in [
        ("2 ** 10", "1024"),
        ("2 ** 3 ** 2", "512"),
        ("(2 ** 3) ** 2", "64"),
        ("2 ** 0", "1"),
        ("2 ** -1", "0.5"),
        ("-2 ** 2", "4"),
        ("(-3) ** 3", "-27"),
        ("1 ** 9999999999", "1"),
        ("(-1) ** 9999999999", "-1"),
        ("0 ** 9999999999", "0"),
        ("2 ** 0.5", "1.4142135623730951"),
        ("4 ** 0.5 ** 1", "2.0"),
        ("2.0 ** 10", "1024.0"),
        ("2 * 3 ** 2 + 1", "19"),
        ("2 ** 1 << 2", "16"),
        ("{ let a = [2, 3]; a[0] ** a[1] ** 2 }", "512"),
        ("2 ** abs(-3) ** 2", "512"),
        ("2 ** (1 + 2 ** 1) ** 2", "512"),
        ("`${2 ** 3 ** 2}` + (2 ** 3)", "5128"),
    ] {
        assert_eq!(printed(&format!("print({source});")), [wanted], "{source}");
    }
}

#[test]
fn a_chain_of_powers_has_an_end() {
    let chain = |n: usize| format!("print(1{});", " ** 1".repeat(n));
    assert_eq!(printed(&chain(20)), ["1"]);
    let e = try_run(&chain(21)).unwrap_err();
    assert_eq!(e.diagnostic.message, "at most 20 ** can stand in one chain");
    let many = format!(
        "let a = 2; print({}0); print([{}]);",
        "a ** 2 + ".repeat(50),
        "a ** 2, ".repeat(50)
    );
    assert_eq!(printed(&many)[0], "200");
    let statements = "if true { let a = 2 ** 2; }\n".repeat(50);
    run(&statements);
}

/// A number generator for test expressions.
struct Dice(u64);

impl Dice {
    fn throw(&mut self, n: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % n
    }

    fn expression(&mut self, depth: u32) -> String {
        if depth == 0 {
            return (self.throw(3) + 1).to_string();
        }
        let mut sub = || self.expression(depth - 1);
        let (a, b) = (sub(), sub());
        match self.throw(13) {
            0..=5 => format!("{a} ** {b}"),
            6 => format!("{a} + {b}"),
            7 => format!("{a} * {b}"),
            8 => format!("{a} - {b}"),
            9 => format!("({a})"),
            10 => format!("[{a}, {b}][1]"),
            11 => format!("{{ let x = {a}; x }} ** 2"),
            _ => format!("{a} << 1"),
        }
    }
}

#[test]
fn powers_bind_as_in_rhai() {
    let rhai = rhai::Engine::new();
    let mut dice = Dice(5);
    let mut compared = 0;
    for _ in 0..600 {
        let source = dice.expression(4);
        // Where Rhai has no int (a negative exponent, an overflow), there is nothing to compare.
        let Ok(wanted) = rhai.eval_expression::<i64>(&source) else {
            continue;
        };
        assert_eq!(
            printed(&format!("print({source});")),
            [wanted.to_string()],
            "{source}"
        );
        compared += 1;
    }
    assert!(compared > 150, "{compared}");
}

#[test]
fn ints_are_as_good_as_floats() {
    for (source, wanted) in [
        ("sqrt(16)", "4.0"),
        ("16.sqrt()", "4.0"),
        ("sin(0)", "0.0"),
        ("atan(1, 1)", "0.7853981633974483"),
        ("atan2(1, 1)", "0.7853981633974483"),
        ("hypot(3, 4)", "5.0"),
        ("log(1000)", "3.0"),
        ("log(8, 2)", "3.0"),
        ("ln(1)", "0.0"),
        ("exp(0)", "1.0"),
        ("abs(-3)", "3"),
        ("abs(-3.5)", "3.5"),
        ("min(1, 2)", "1"),
        ("min(1, 2.5)", "1.0"),
        ("max(1, 2)", "2"),
        ("max(1.5, 1)", "1.5"),
        ("floor(2.7)", "2.0"),
        ("floor(2)", "2"),
        ("ceil(2.2)", "3.0"),
        ("round(2.5)", "3.0"),
        ("round(7)", "7"),
        ("clamp(5, 0, 3)", "3"),
        ("clamp(5.0, 0, 3)", "3.0"),
        ("clamp(1, 0.0, 3)", "1.0"),
        ("sign(-2)", "-1"),
        ("sign(0.0)", "0"),
        ("sign(-2.5)", "-1"),
        ("lerp(0, 10, 0.5)", "5.0"),
        ("mix(2, 4, 1)", "4.0"),
        ("smooth(0.5)", "0.5"),
        ("smooth(-3)", "0.0"),
        ("radians(180)", "3.141592653589793"),
        ("degrees(PI)", "180.0"),
        ("PI == PI() && E == E() && TAU == 2 * PI", "true"),
        ("to_int(2.9) + to_float(1)", "3.0"),
        ("2.7.to_int()", "2"),
        ("parse_int(\"ff\", 16) + parse_int(\" 1 \")", "256"),
        ("parse_float(\"2.5\")", "2.5"),
        ("2.7.floor + 2.2.ceiling + 2.5.round", "8.0"),
        ("(0.0 / 0.0).is_nan", "true"),
        ("10 / 4", "2"),
        ("10 / 4.0", "2.5"),
        ("max(9007199254740993, 9007199254740992)", "9007199254740993"),
    ] {
        assert_eq!(printed(&format!("print({source});")), [wanted], "{source}");
    }
}

#[test]
fn constants_are_known_inside_functions_and_may_be_hidden() {
    assert_eq!(printed("fn f() { PI } print(f());"), ["3.141592653589793"]);
    assert_eq!(printed("let E = 5; print(E);"), ["5"]);
    assert_eq!(
        printed("const R = 2; fn f() { global::R * TAU } print(f());"),
        ["12.566370614359172"]
    );
}

#[test]
fn nothing_tells_the_time_or_waits() {
    for call in ["sleep(1)", "timestamp()", "sleep(1.0)", "rand()"] {
        let e = try_run(&format!("{call};")).unwrap_err();
        assert!(
            e.diagnostic.message.starts_with("unknown function"),
            "{call}: {e}"
        );
    }
}

#[test]
fn closures_have_no_names_that_change() {
    let source = "let f = |x| x; print(f); print(f.name); print(`${[f]}`); print(\"\" + f); print(#{ f: f }); debug(f); let g = |x| x + 1; print(g);";
    let lines = printed(source);
    assert!(lines.iter().all(|l| !l.contains('$')), "{lines:?}");
    assert_eq!(lines[0], "Fn(closure)");
}
