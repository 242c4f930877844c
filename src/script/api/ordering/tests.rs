//! What these functions do is what Rhai's do, held against Rhai's own.

use proptest::prelude::*;
use rhai::{Dynamic, Engine};

use super::*;
use crate::{
    limits::Limits,
    script::{engine, language::Language},
};

/// An engine with functions of Rhai's alone.
pub(in crate::script::api) fn rhais() -> Engine {
    let mut rhais = Engine::new_raw();
    for module in engine::rhais_packages() {
        rhais.register_global_module(module);
    }
    rhais
}

pub(in crate::script::api) fn ours() -> Engine {
    engine::compiler(&Limits::default(), &Language::new()).unwrap()
}

/// The value of a script, or its error with the place.
pub(in crate::script::api) fn told(engine: &Engine, script: &str) -> String {
    match engine.eval::<Dynamic>(script) {
        Ok(value) => format!("{value:?}"),
        Err(error) => format!("{:?} {error:?}", error.position()),
    }
}

fn literal(value: &Value) -> String {
    match value {
        Value::Int(x) => x.to_string(),
        Value::Float(x) => format!("{x:?}"),
        Value::Text(x) => format!("{x:?}"),
        Value::Char(x) => format!("'{x}'"),
        Value::Bool(x) => x.to_string(),
        Value::Unit => "()".to_owned(),
        Value::Pair(x, y) => format!("[{x}, {y}]"),
    }
}

#[derive(Clone, Debug)]
enum Value {
    Int(i64),
    Float(f64),
    Text(String),
    Char(char),
    Bool(bool),
    Unit,
    Pair(i64, i64),
}

/// Values of one kind, or of any.
fn lists() -> impl Strategy<Value = Vec<Value>> {
    let int = || {
        prop_oneof![
            -3i64..3,
            any::<i64>().prop_filter("a literal", |x| *x != i64::MIN)
        ]
        .prop_map(Value::Int)
    };
    let float = || prop_oneof![-2.0..2.0, Just(0.0), Just(-0.0), Just(1.0)].prop_map(Value::Float);
    let text = || "[ab]{1,4}".prop_map(Value::Text);
    let char = || prop::char::range('a', 'e').prop_map(Value::Char);
    let bool = || any::<bool>().prop_map(Value::Bool);
    let pair = || (0i64..4, 0i64..100).prop_map(|(x, y)| Value::Pair(x, y));
    let any = prop_oneof![int(), float(), text(), char(), bool(), Just(Value::Unit), pair()];
    prop_oneof![
        prop::collection::vec(int(), 0..60),
        prop::collection::vec(float(), 0..60),
        prop::collection::vec(text(), 0..60),
        prop::collection::vec(char(), 0..60),
        prop::collection::vec(bool(), 0..60),
        prop::collection::vec(Just(Value::Unit), 0..5),
        prop::collection::vec(pair(), 0..60),
        prop::collection::vec(any, 0..6),
    ]
}

/// Calls, in whose comparisons there is no contradiction.
const CALLS: [&str; 23] = [
    "a.sort(); a",
    "a.sort_desc(); a",
    "a.order()",
    "a.order_desc()",
    "a.sort(|x, y| if x < y { -1 } else if x > y { 1 } else { 0 }); a",
    "a.sort(|x, y| y[0] - x[0]); a",
    "a.sort_by(|x, y| x[0] - y[0]); a",
    "a.order(|x, y| x[0] < y[0])",
    "a.order_by(|x, y| x < y)",
    "a.order_by(Fn(\"by_first\"))",
    "a.sort(\"by_first\"); a",
    "a.sort(\"no such name\"); a",
    "a.sort(\"nobody\"); a",
    "a.sort(|x, y| \"neither\"); a",
    "a.sort(|x, y| throw \"no\"); a",
    "a.sort(|x| x); a",
    "a.dedup(); a",
    "a.dedup(|x, y| x[0] == y[0]); a",
    "a.dedup(\"by_first\"); a",
    "a.dedup(\"no such name\"); a",
    "a.dedup(|x, y| throw \"no\"); a",
    "const C = [2, 1]; C.sort(); C",
    "const C = [2, 1]; C.order()",
];

/// Calls that do not compare values of several types: how Rhai orders those depends on the build.
const MIXED: [usize; 8] = [0, 1, 2, 3, 11, 16, 17, 18];

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn arrays_come_out_as_of_rhais_own_functions(list in lists()) {
        let literals: Vec<String> = list.iter().map(literal).collect();
        let literals = literals.join(", ");
        let (ours, rhais) = (ours(), rhais());
        let kinds: std::collections::BTreeSet<_> = list.iter().map(std::mem::discriminant).map(|d| format!("{d:?}")).collect();
        for (i, call) in CALLS.iter().enumerate() {
            if kinds.len() > 1 && !MIXED.contains(&i) {
                continue;
            }
            let script = format!("fn by_first(x, y) {{ x[0] - y[0] }}\nlet a = [{literals}];\n{call}");
            prop_assert_eq!(told(&ours, &script), told(&rhais, &script), "{}", script);
        }
    }

}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(8))]

    #[test]
    fn long_arrays_do_too(seed in any::<u64>(), length in 4000usize..12_000, few in 1i64..50_000, runs in 0i64..5) {
        let script = format!(
            "let a = []; let x = {};
            for i in 0..{length} {{
                x = (x * 75 + 74) % 65537;
                a.push(if {runs} > 2 {{ x % {few} }} else {{ (i * {runs}) % {few} + (x / 65000) }});
            }}
            let b = a; let c = a; let d = a; let e = [];
            for i in 0..{length} {{ e.push(a[i] * 1000000 + i); }}
            b.sort(); c.sort_desc(); d.dedup();
            e.sort(|x, y| x / 1000000 - y / 1000000);
            [b, c, d, e, a.order(|x, y| x > y)]",
            seed % 65537
        );
        let (mut ours, mut rhais) = (ours(), rhais());
        for engine in [&mut ours, &mut rhais] {
            engine.set_max_array_size(0).set_max_expr_depths(0, 0);
        }
        let (ours, rhais) = (told(&ours, &script), told(&rhais, &script));
        prop_assert!(ours == rhais, "{}\n{:.200}\n{:.200}", script, ours, rhais);
        prop_assert!(ours.starts_with('['), "{}", ours);
    }
}

#[test]
fn what_is_no_number_stays_behind() {
    let list: Vec<String> = (0..5000)
        .map(|i| {
            if i % 3 == 0 {
                "0.0 / 0.0".to_owned()
            } else {
                format!("{}.0", i * 7 % 1000)
            }
        })
        .collect();
    let script = |call: &str| {
        let script = format!(
            "let a = [{}]; {call}; let n = a.index_of(|x| x.is_nan); [n, a.extract(n).all(|x| x.is_nan), a[0], a[n - 1]]",
            list.join(", ")
        );
        told(&ours(), &script)
    };
    let n = 5000 - 5000_usize.div_ceil(3);
    assert_eq!(script("a.sort()"), format!("[{n}, true, 0.0, 999.0]"));
    assert_eq!(script("a.sort_desc()"), format!("[{n}, true, 999.0, 0.0]"));
}

#[test]
fn comparisons_that_contradict_one_another_end_too() {
    let mut turn = 0;
    let items: Array = (0..3000).map(Dynamic::from_int).collect();
    let sorted = sorted_by(items, |_, _| {
        turn += 1;
        Ok(turn % 7 < 3)
    });
    let mut sorted: Vec<i64> = sorted.unwrap().iter().map(|x| x.as_int().unwrap()).collect();
    sorted.sort_unstable();
    assert!(sorted.into_iter().eq(0..3000));
}

#[test]
fn pieces_of_long_texts_are_short() {
    let long = Dynamic::from("a".repeat(1 << 20));
    assert_eq!(piece(&[long.clone(), long.clone()], of_a_text).0, 1);
    let short = vec![Dynamic::from_int(1); 10_000];
    assert_eq!(piece(&short, of_a_text), (PIECE, PIECE + 1));
}
