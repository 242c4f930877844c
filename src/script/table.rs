//! One table for the language: every function a script can call is one [`Entry`].
//!
//! From it come the registration on the engine, the "did you mean" of error messages, and the reference.

use std::sync::LazyLock;

use rhai::Dynamic;

use super::{
    api,
    call::Call,
    caller::{Caller, Failure},
    session::State,
    value::Outcome,
};

pub use super::kinds::{Group, Kind};

/// A parameter.
#[derive(Clone, Copy, Debug)]
pub struct Param {
    /// Its name, as messages use it.
    pub name: &'static str,
    /// What it takes.
    pub kind: Kind,
    /// Its unit, or "none".
    pub unit: &'static str,
    /// What it is where it is left out, if it may be.
    pub default: Option<&'static str>,
    /// What it means.
    pub doc: &'static str,
    /// The keys that a map of options may have.
    pub keys: &'static [&'static str],
}

impl Param {
    pub(super) const fn new(name: &'static str, kind: Kind, unit: &'static str, doc: &'static str) -> Self {
        Self {
            name,
            kind,
            unit,
            default: None,
            doc,
            keys: &[],
        }
    }

    pub(super) const fn or(mut self, default: &'static str) -> Self {
        self.default = Some(default);
        self
    }

    pub(super) const fn keys(mut self, keys: &'static [&'static str]) -> Self {
        self.keys = keys;
        self
    }
}

/// What an entry does when it is called.
#[derive(Clone, Copy)]
pub(super) enum Run {
    /// Works on the scene.
    Scene(fn(&mut Call<'_, '_>, &mut State) -> Outcome),
    /// Depends on its arguments alone.
    Pure(fn(&mut Call<'_, '_>) -> Outcome),
    /// Works on the scene, and calls functions that the script gives it.
    Calling(fn(&mut Call<'_, '_>, &Caller<'_, '_>) -> Result<Dynamic, Failure>),
    /// A block, known to the parser.
    Syntax,
}

/// One function of the language.
///
/// ```
/// use rtscript::script::{Entry, Group, Kind, Param, entry};
/// let sphere: &Entry = entry("sphere").expect("it is there");
/// assert_eq!(sphere.group, Group::Shapes);
/// let radius: &Param = sphere.forms.iter().copied().flatten().find(|p| p.name == "r" || p.name == "radius").expect("a radius");
/// assert_eq!(radius.kind, Kind::Number);
/// ```
#[derive(Clone, Copy)]
pub struct Entry {
    /// What a script writes.
    pub name: &'static str,
    /// Where the reference lists it.
    pub group: Group,
    /// Its forms, each a list of parameters.
    pub forms: &'static [&'static [Param]],
    /// What it returns; "nothing" where that is `()`.
    pub returns: &'static str,
    /// What it does.
    pub doc: &'static str,
    /// A call, for hints.
    pub usage: &'static str,
    /// A complete script.
    pub example: &'static str,
    /// What other systems call it; only for hints.
    pub also: &'static [&'static str],
    pub(super) run: Run,
}

impl Entry {
    const fn new(group: Group, name: &'static str, run: Run) -> Self {
        Self {
            name,
            group,
            forms: &[&[]],
            returns: "nothing",
            doc: "",
            usage: "",
            example: "",
            also: &[],
            run,
        }
    }

    pub(super) const fn scene(
        group: Group,
        name: &'static str,
        run: fn(&mut Call<'_, '_>, &mut State) -> Outcome,
    ) -> Self {
        Self::new(group, name, Run::Scene(run))
    }

    pub(super) const fn pure(
        group: Group,
        name: &'static str,
        run: fn(&mut Call<'_, '_>) -> Outcome,
    ) -> Self {
        Self::new(group, name, Run::Pure(run))
    }

    pub(super) const fn calling(
        group: Group,
        name: &'static str,
        run: fn(&mut Call<'_, '_>, &Caller<'_, '_>) -> Result<Dynamic, Failure>,
    ) -> Self {
        Self::new(group, name, Run::Calling(run))
    }

    pub(super) const fn syntax(group: Group, name: &'static str) -> Self {
        Self::new(group, name, Run::Syntax)
    }

    pub(super) const fn takes(mut self, forms: &'static [&'static [Param]]) -> Self {
        self.forms = forms;
        self
    }

    pub(super) const fn returns(mut self, what: &'static str) -> Self {
        self.returns = what;
        self
    }

    pub(super) const fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    pub(super) const fn usage(mut self, usage: &'static str) -> Self {
        self.usage = usage;
        self
    }

    pub(super) const fn example(mut self, example: &'static str) -> Self {
        self.example = example;
        self
    }

    pub(super) const fn also(mut self, names: &'static [&'static str]) -> Self {
        self.also = names;
        self
    }

    /// `(center, radius)`, or several such lists joined by "or".
    #[must_use]
    pub fn signature(&self) -> String {
        let forms: Vec<String> = self
            .forms
            .iter()
            .map(|params| {
                let names: Vec<&str> = params.iter().map(|p| p.name).collect();
                format!("({})", names.join(", "))
            })
            .collect();
        forms.join(" or ")
    }

    /// How many arguments it may be given, in ascending order: a vector counts for one or for three.
    ///
    /// ```
    /// use rtscript::script::entry;
    /// // translate([x, y, z]) and translate(x, y, z).
    /// assert_eq!(entry("translate").map(|e| e.arities()), Some(vec![1, 3]));
    /// ```
    #[must_use]
    pub fn arities(&self) -> Vec<usize> {
        arities(self.arity_set()).collect()
    }

    /// The same as a set: bit n where n arguments are accepted.
    pub(super) fn arity_set(&self) -> u64 {
        let mut all = 0u64;
        for params in self.forms {
            let mut reached = 1u64;
            for param in *params {
                if param.default.is_some() {
                    all |= reached;
                }
                reached = if param.kind.spreads() {
                    reached << 1 | reached << 3
                } else {
                    reached << 1
                };
            }
            all |= reached;
        }
        all
    }
}

/// The numbers in a set of numbers of arguments, in ascending order.
pub(super) fn arities(set: u64) -> impl Iterator<Item = usize> {
    let rest = |set: &u64| Some(set & (set - 1)).filter(|rest| *rest != 0);
    std::iter::successors(Some(set).filter(|set| *set != 0), rest).map(|set| set.trailing_zeros() as usize)
}

impl std::fmt::Debug for Entry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}{}", self.name, self.signature())
    }
}

/// Every function of the language, in the order of the reference.
///
/// ```
/// use rtscript::script::entries;
/// assert!(entries().count() > 100);
/// assert!(entries().all(|entry| !entry.doc.is_empty()));
/// ```
pub fn entries() -> impl Iterator<Item = &'static Entry> {
    api::ALL.iter().flat_map(|list| list.iter())
}

/// The entry called `name`.
///
/// ```
/// use rtscript::script::entry;
/// assert!(entry("sphere").is_some_and(|e| e.signature().contains("center")));
/// assert!(entry("spere").is_none());
/// ```
#[must_use]
pub fn entry(name: &str) -> Option<&'static Entry> {
    static BY_NAME: LazyLock<std::collections::BTreeMap<&'static str, &'static Entry>> =
        LazyLock::new(|| entries().map(|e| (e.name, e)).collect());
    BY_NAME.get(name).copied()
}

/// The result of a function that returns nothing.
pub(super) const DONE: Outcome = Ok(Dynamic::UNIT);

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;
    use crate::{
        host::{Host, HostError},
        limits::Limits,
        render::Image,
        script::{CONSTANTS, EXAMPLE_FILES, PROPERTIES, RunOptions, Script},
    };

    /// Takes pictures and has the files that the examples name.
    struct Gallery;

    impl Host for Gallery {
        fn read(&self, path: &str, _: u64) -> Result<Vec<u8>, HostError> {
            let file = EXAMPLE_FILES.iter().find(|(name, _)| *name == path);
            file.map(|(_, bytes)| bytes.to_vec()).ok_or_else(|| {
                let what = format!("no such file: {path}");
                HostError::new(crate::diag::ErrorKind::Input, what)
            })
        }

        fn write_image(&self, _: &str, _: &Image) -> Result<(), HostError> {
            Ok(())
        }
    }

    fn runs(source: &str) {
        // Small: what is tested is that the script is right, not how it looks.
        let options = RunOptions {
            size: Some((16, 12)),
            ..RunOptions::default()
        };
        let script = Script::compile("example.rhai", source, &Limits::default());
        let run = script.and_then(|s| s.run(&Gallery, &options));
        if let Err(e) = run {
            panic!("{e}\n{source}");
        }
    }

    #[test]
    fn names_are_unique() {
        let mut seen = BTreeSet::new();
        for entry in entries() {
            assert!(seen.insert(entry.name), "{} is there twice", entry.name);
        }
        for entry in entries() {
            for also in entry.also {
                assert!(
                    !seen.contains(also),
                    "{also} is a name of its own and of {}",
                    entry.name
                );
            }
        }
    }

    #[test]
    fn every_group_and_every_kind_is_listed() {
        for entry in entries() {
            assert!(Group::ALL.contains(&entry.group), "{}", entry.name);
            for param in entry.forms.iter().copied().flatten() {
                assert!(Kind::ALL.contains(&param.kind), "{}: {}", entry.name, param.name);
            }
        }
    }

    #[test]
    fn everything_is_documented() {
        for entry in entries() {
            let name = entry.name;
            assert!(entry.doc.ends_with(['.', ')', '!']), "{name}: {:?}", entry.doc);
            assert!(entry.usage.contains(name), "{name}: usage {:?}", entry.usage);
            assert!(entry.example.contains(name), "{name}: example");
            for param in entry.forms.iter().copied().flatten() {
                assert!(
                    !param.unit.is_empty() && !param.doc.is_empty(),
                    "{name}: {}",
                    param.name
                );
            }
        }
    }

    #[test]
    fn every_example_runs() {
        for entry in entries() {
            runs(entry.example);
        }
    }

    #[test]
    fn every_usage_runs() {
        for entry in entries() {
            let before = match entry.name {
                "popTransform" => "pushTransform(); ",
                "instance" | "instances" | "raycast" | "bounds" | "inside" => {
                    "define \"car\" { sphere(0, 0, 0, 1); } "
                }
                "pixel" => "let picture = render(); ",
                "position" | "tangent" | "points" => "let curve = polyline([[0, 0, 0], [1, 0, 0]]); ",
                _ => "",
            };
            runs(&format!("{before}{};", entry.usage));
        }
    }

    #[test]
    fn every_property_and_constant_is_there() {
        let value = |of: &str| match of {
            "vec3" => "vec3(1, 2, 3)",
            "image" => "render()",
            _ => "e",
        };
        for p in PROPERTIES {
            let set = if p.can_be_set {
                format!("v.{0} = v.{0};", p.name)
            } else {
                String::new()
            };
            runs(&format!(
                "try {{ sphere(1); }} catch (e) {{ let v = {}; v.{}; {set} }}",
                value(p.of),
                p.name
            ));
        }
        for c in CONSTANTS {
            runs(&format!("if {} != {:?} {{ throw 1; }}", c.name, c.value));
        }
    }

    #[test]
    fn a_vector_counts_for_one_argument_or_three() {
        let arities = |name| entry(name).unwrap().arities();
        assert_eq!(arities("sphere"), [2, 4]);
        assert_eq!(arities("scale"), [1, 3]);
        assert_eq!(arities("camera"), [4, 6, 8, 10]);
        assert_eq!(arities("tri"), [3, 5, 6, 7, 8, 9, 10, 12, 14, 16, 18]);
        assert_eq!(arities("log"), [1, 2]);
    }
}
