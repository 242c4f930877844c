//! Every function that a script can call, Rhai's and ours, signature by signature: `tests/abuse/functions.txt`. One that
//! comes in with a new version of Rhai makes the counts differ.
//!
//! Rhai names its functions to nobody, but answers whether a module has the function of a hash, and counts them. So the
//! list is right where each of its lines is found and it lacks no more than is known here.
//! `RTSCRIPT_ACCEPT=1 cargo test --lib visible_tests` writes it anew from the names in the old one and in
//! `RTSCRIPT_NAMES`, a file with a name a line.

use std::{any::TypeId, collections::BTreeSet, fs, path::Path, sync::Arc};

use rhai::{Array, Blob, Dynamic, FnPtr, FuncRegistration, ImmutableString, Map, Module, RhaiFunc};

use super::{
    api::{CurveValue, StreamValue},
    engine, power,
    value::{ImageValue, ScriptError, TextureValue},
};
use crate::math::DVec3;

/// Types of parameters by name, those that come in threes first.
fn types() -> Vec<(&'static str, TypeId)> {
    vec![
        ("any", TypeId::of::<Dynamic>()),
        ("int", TypeId::of::<i64>()),
        ("float", TypeId::of::<f64>()),
        ("bool", TypeId::of::<bool>()),
        ("char", TypeId::of::<char>()),
        ("string", TypeId::of::<ImmutableString>()),
        ("array", TypeId::of::<Array>()),
        ("blob", TypeId::of::<Blob>()),
        ("map", TypeId::of::<Map>()),
        ("Fn", TypeId::of::<FnPtr>()),
        ("range", TypeId::of::<std::ops::Range<i64>>()),
        ("range=", TypeId::of::<std::ops::RangeInclusive<i64>>()),
        ("vec3", TypeId::of::<DVec3>()),
        ("()", TypeId::of::<()>()),
        ("image", TypeId::of::<ImageValue>()),
        ("texture", TypeId::of::<TextureValue>()),
        ("error", TypeId::of::<ScriptError>()),
        ("i8", TypeId::of::<i8>()),
        ("u8", TypeId::of::<u8>()),
        ("i16", TypeId::of::<i16>()),
        ("u16", TypeId::of::<u16>()),
        ("i32", TypeId::of::<i32>()),
        ("u32", TypeId::of::<u32>()),
        ("u64", TypeId::of::<u64>()),
        ("i128", TypeId::of::<i128>()),
        ("u128", TypeId::of::<u128>()),
        ("f32", TypeId::of::<f32>()),
        ("sdf", TypeId::of::<crate::shape::Sdf>()),
        ("field", TypeId::of::<crate::shape::Field>()),
        ("curve", TypeId::of::<CurveValue>()),
        ("stream", TypeId::of::<StreamValue>()),
    ]
}

/// Types that are tried three and four at a time.
const IN_THREES: usize = 14;
const IN_FOURS: usize = 12;

/// Functions of each package that are not listed, because they have a name or a type of a parameter that is not tried: of
/// Rhai's package of iterators, ranges with steps over number types that scripts do not have.
const UNNAMED: [usize; 10] = [0, 0, 0, 0, 0, 0, 19, 0, 0, 0];

/// Functions and properties of ours that stand in no table: `api/numbers.rs`.
const NUMBERS: [&str; 18] = [
    "PI",
    "E",
    "to_float",
    "to_radians",
    "to_degrees",
    "ceiling",
    "fraction",
    "is_nan",
    "is_finite",
    "is_infinite",
    "get$floor",
    "get$ceiling",
    "get$round",
    "get$int",
    "get$fraction",
    "get$is_nan",
    "get$is_finite",
    "get$is_infinite",
];

/// The hash by which a module knows the function.
fn hash(name: &str, types: &[TypeId]) -> u64 {
    let nothing = RhaiFunc::Method {
        func: Arc::new(|_, _| Ok(Dynamic::UNIT)),
        has_context: false,
        is_pure: true,
        is_volatile: false,
    };
    FuncRegistration::new(name)
        .set_into_module_raw(&mut Module::new(), types, nothing)
        .hash
}

fn modules() -> Vec<Module> {
    let modules = engine::modules().iter().map(|module| {
        let mut module = Module::clone(module);
        module.register_lazy_functions();
        module
    });
    modules.collect()
}

/// How many functions a module has.
fn count(module: &Module) -> usize {
    let text = format!("{module:?}");
    let functions = text.split_once("functions: [").unwrap().1;
    let functions = functions.split_once(']').unwrap().0;
    functions.matches('"').count() / 2
}

/// `name(type, type)`.
fn parsed(line: &str) -> (&str, Vec<TypeId>) {
    let types = types();
    let (name, rest) = line.rsplit_once(" : ").unwrap();
    let of = |name: &str| types.iter().find(|(known, _)| *known == name).unwrap().1;
    (name, rest.split(' ').filter(|t| !t.is_empty()).map(of).collect())
}

/// Every list of `n` types.
fn lists(n: usize) -> Vec<Vec<(&'static str, TypeId)>> {
    let all = types();
    let few = match n {
        0..3 => &all[..],
        3 => &all[..IN_THREES],
        _ => &all[..IN_FOURS],
    };
    // Beyond four, Rhai has none, and ours take anything, numbers behind the sixteenth.
    if n > 4 {
        let numbers = n.saturating_sub(16);
        return (0..1usize << numbers)
            .map(|bits| {
                (0..n)
                    .map(|i| {
                        if i < 16 {
                            all[0]
                        } else {
                            all[1 + (bits >> (i - 16) & 1)]
                        }
                    })
                    .collect()
            })
            .collect();
    }
    let mut lists = vec![Vec::new()];
    for _ in 0..n {
        lists = lists
            .iter()
            .flat_map(|list| few.iter().map(move |t| [list.as_slice(), &[*t]].concat()))
            .collect();
    }
    lists
}

fn found(modules: &[Module], names: &BTreeSet<String>) -> BTreeSet<String> {
    let mut most: Vec<_> = (0..=22).map(lists).collect();
    // Of points, each coordinate a field.
    let field = ("field", TypeId::of::<crate::shape::Field>());
    most.push(vec![vec![field; 3]]);
    let mut lines = BTreeSet::new();
    for name in names {
        for list in most.iter().flatten() {
            // Indexers of Rhai's own types may not even be tried.
            if name.starts_with("index$") && list.first().is_none_or(|(t, _)| *t != "vec3") {
                continue;
            }
            let ids: Vec<TypeId> = list.iter().map(|(_, id)| *id).collect();
            let hash = hash(name, &ids);
            if modules.iter().any(|module| module.contains_fn(hash)) {
                let types: Vec<&str> = list.iter().map(|(t, _)| *t).collect();
                lines.insert(format!("{name} : {}", types.join(" ")));
            }
        }
    }
    lines
}

#[test]
fn every_function_that_scripts_see_is_listed() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/abuse/functions.txt");
    let modules = modules();
    let mut text = fs::read_to_string(&path).unwrap_or_default();
    if std::env::var_os("RTSCRIPT_ACCEPT").is_some() {
        let more = std::env::var_os("RTSCRIPT_NAMES").map(|file| fs::read_to_string(file).unwrap());
        let more = more.unwrap_or_default();
        let own = super::entries().map(|entry| entry.name.to_owned());
        let known = text.lines().map(|line| parsed(line).0.to_owned());
        let names = own
            .chain(known)
            .chain(NUMBERS.map(str::to_owned))
            .chain(power::OPERATORS.map(str::to_owned))
            .chain(["get$length".to_owned()])
            .chain(more.lines().map(str::to_owned))
            .filter(|name| !name.is_empty())
            .collect();
        text = found(&modules, &names)
            .into_iter()
            .map(|line| line + "\n")
            .collect();
        fs::write(&path, &text).unwrap();
    }
    let mut listed = vec![0; modules.len()];
    for line in text.lines() {
        let (name, types) = parsed(line);
        let hash = hash(name, &types);
        let mut known = false;
        for (module, listed) in modules.iter().zip(&mut listed) {
            if module.contains_fn(hash) {
                *listed += 1;
                known = true;
            }
        }
        assert!(known, "there is no function {line}");
    }
    let unnamed: Vec<usize> = modules
        .iter()
        .map(count)
        .zip(&listed)
        .map(|(all, listed)| all - listed)
        .collect();
    assert_eq!(unnamed, UNNAMED, "functions by package that are not listed");
    for absent in [
        "sleep",
        "timestamp",
        "elapsed",
        "eval",
        "curry",
        "import",
        "load",
        "read",
        "write",
        "open",
    ] {
        assert!(!text.lines().any(|line| parsed(line).0 == absent), "{absent}");
    }
}
