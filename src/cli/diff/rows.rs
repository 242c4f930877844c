//! Changes summed up: what many things of one line have in common is one row.

use std::collections::BTreeMap;

use serde_json::{Value, json};

use crate::{
    cli::{measures::count, subject::place},
    diag::SourceLoc,
    math::DVec3,
    scene::{
        Scene,
        compare::{Change, Place, Way, short},
    },
};

/// Ways of changing that are told of one line one by one; more are summed up.
const TOLD: usize = 3;

/// What is told of together: the place, what happened, the group, what it happened to, in which ways.
type Key = (Place, Sign, String, (&'static str, String), Vec<&'static str>);

#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Sign {
    Removed,
    Changed,
    Added,
}

/// All rows, in the order of their places.
pub(super) struct Rows<'a> {
    before: &'a Scene,
    after: &'a Scene,
    rows: BTreeMap<Key, Row>,
}

/// Things that are told of together.
struct Row {
    before: Option<SourceLoc>,
    after: Option<SourceLoc>,
    /// Where the first of them is.
    at: DVec3,
    count: u64,
    /// How many changed in which ways, in words; of more than [`TOLD`] different ones only some.
    ways: BTreeMap<String, (u64, Vec<Way>)>,
    /// There were more.
    is_cut: bool,
    moved: Range,
    turned: Range,
    scaled: Range,
}

/// The least and the greatest of some numbers.
#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    const EMPTY: Self = Self(f64::INFINITY, f64::NEG_INFINITY);

    fn add(&mut self, x: f64) {
        *self = Self(self.0.min(x), self.1.max(x));
    }

    fn text(self) -> String {
        let (least, greatest) = (short(self.0), short(self.1));
        if least == greatest {
            format!("{least}")
        } else {
            format!("{least} to {greatest}")
        }
    }
}

impl<'a> Rows<'a> {
    pub(super) fn new(before: &'a Scene, after: &'a Scene) -> Self {
        Self {
            before,
            after,
            rows: BTreeMap::new(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    pub(super) fn add(&mut self, change: Change<'_>) {
        let sign = match (change.before, change.after) {
            (Some(_), Some(_)) => Sign::Changed,
            (_, None) => Sign::Removed,
            (None, _) => Sign::Added,
        };
        let kinds = change.ways.iter().map(kind).collect();
        let what = (change.name, change.of.to_owned());
        let key = (change.place, sign, change.group.to_owned(), what, kinds);
        let row = self.rows.entry(key).or_insert_with(|| Row {
            before: change.before,
            after: change.after,
            at: change.at,
            count: 0,
            ways: BTreeMap::new(),
            is_cut: false,
            moved: Range::EMPTY,
            turned: Range::EMPTY,
            scaled: Range::EMPTY,
        });
        row.count += 1;
        for way in &change.ways {
            match way {
                Way::Moved(by) => row.moved.add(by.length()),
                Way::Turned(_, degrees) => row.turned.add(*degrees),
                Way::Scaled(by) => by.to_array().into_iter().for_each(|x| row.scaled.add(x)),
                _ => {}
            }
        }
        let text = words(&change.ways);
        if let Some((count, _)) = row.ways.get_mut(&text) {
            *count += 1;
        } else if row.ways.len() < TOLD {
            row.ways.insert(text, (1, change.ways));
        } else {
            row.is_cut = true;
        }
    }

    /// A line for each row.
    pub(super) fn text(&self) -> String {
        let mut text = String::new();
        for ((_, sign, group, (name, of), _), row) in &self.rows {
            let context = if group.is_empty() {
                String::new()
            } else {
                format!(" in {group:?}")
            };
            let places = self.places(row);
            let mut line = |count: u64, sign: &str, what: &str| {
                let things = things(name, of, count);
                text += &format!("{sign} {things}{context}{what}{places}\n");
            };
            let at = match row.count {
                1 if *name != "define" && *name != "directional" => format!(" at {}", vector(row.at)),
                _ => String::new(),
            };
            match sign {
                Sign::Removed => line(row.count, "-", &at),
                Sign::Added => line(row.count, "+", &at),
                Sign::Changed if row.is_cut => line(row.count, "~", &format!(" {}", row.summary())),
                Sign::Changed => {
                    for (ways, (count, _)) in &row.ways {
                        line(*count, "~", &format!(" {ways}"));
                    }
                }
            }
        }
        text
    }

    /// `  a.rhai:12 -> b.rhai:14`.
    fn places(&self, row: &Row) -> String {
        let known = |scene: &Scene, loc: Option<SourceLoc>| {
            let loc = loc.filter(|loc| loc.line > 0)?;
            Some(place(scene, SourceLoc { column: 0, ..loc }))
        };
        match (known(self.before, row.before), known(self.after, row.after)) {
            (Some(before), Some(after)) => format!("  {before} -> {after}"),
            (Some(one), None) | (None, Some(one)) => format!("  {one}"),
            (None, None) => String::new(),
        }
    }

    /// `3 added, 1 removed, 12 changed`.
    pub(super) fn totals(&self, settings: usize) -> String {
        let sum = |wanted: Sign| -> u64 {
            let rows = self.rows.iter().filter(|((_, sign, ..), _)| *sign == wanted);
            rows.map(|(_, row)| row.count).sum()
        };
        let counts = [
            (sum(Sign::Added), "added"),
            (sum(Sign::Removed), "removed"),
            (sum(Sign::Changed), "changed"),
            (
                settings as u64,
                if settings == 1 { "setting" } else { "settings" },
            ),
        ];
        let counts = counts.iter().filter(|(n, _)| *n > 0);
        let counts: Vec<String> = counts.map(|(n, what)| format!("{} {what}", count(*n))).collect();
        counts.join(", ")
    }

    /// An object for each row.
    pub(super) fn json(&self) -> Vec<Value> {
        let site = |scene: &Scene, loc: Option<SourceLoc>| {
            loc.map(|loc| {
                let file = scene.files.get(usize::from(loc.file));
                json!({ "file": file, "line": loc.line, "column": loc.column })
            })
        };
        let rows = self
            .rows
            .iter()
            .map(|((_, sign, group, (name, of), kinds), row)| {
                let ways = row.ways.iter().map(|(text, (count, ways))| {
                json!({ "count": count, "text": text, "ways": ways.iter().map(way_json).collect::<Vec<_>>() })
            });
                json!({
                    "change": match sign {
                        Sign::Removed => "removed",
                        Sign::Changed => "changed",
                        Sign::Added => "added",
                    },
                    "group": (!group.is_empty()).then_some(group),
                    "name": name,
                    "of": (!of.is_empty()).then_some(of),
                    "count": row.count,
                    "at": row.at.to_array(),
                    "before": site(self.before, row.before),
                    "after": site(self.after, row.after),
                    "kinds": kinds,
                    "ways": if row.ways.keys().all(String::is_empty) { Vec::new() } else { ways.collect() },
                    "complete": !row.is_cut,
                })
            });
        rows.collect()
    }
}

impl Row {
    /// `moved by 0.2 to 1.4, diffuse changed`.
    fn summary(&self) -> String {
        let Some((_, ways)) = self.ways.values().next() else {
            return String::new();
        };
        let parts = ways.iter().map(|way| match way {
            Way::Moved(_) => format!("moved by {}", self.moved.text()),
            Way::Turned(..) => format!("turned by {} degrees", self.turned.text()),
            Way::Scaled(_) => format!("scaled by {}", self.scaled.text()),
            Way::Placed => "placed by another matrix".to_owned(),
            Way::Value { what, .. } => format!("{what} changed"),
        });
        parts.collect::<Vec<_>>().join(", ")
    }
}

fn kind(way: &Way) -> &'static str {
    match way {
        Way::Moved(_) => "moved",
        Way::Turned(..) => "turned",
        Way::Scaled(_) => "scaled",
        Way::Placed => "placed",
        Way::Value { what, .. } => what,
    }
}

fn words(ways: &[Way]) -> String {
    let parts = ways.iter().map(|way| match way {
        Way::Moved(by) => format!("moved by {}", vector(*by)),
        Way::Turned(axis, degrees) => {
            let degrees = short(*degrees);
            let unit = if degrees == 1.0 { "degree" } else { "degrees" };
            format!("turned by {degrees} {unit} about {}", vector(*axis))
        }
        Way::Scaled(by) => {
            let [x, y, z] = by.to_array().map(short);
            if x == y && y == z {
                format!("scaled by {x}")
            } else {
                format!("scaled by {}", vector(*by))
            }
        }
        Way::Placed => "placed by another matrix".to_owned(),
        Way::Value { what, from, to } if from.is_empty() && to.is_empty() => format!("{what} changed"),
        Way::Value { what, from, to } => format!("{what} {from} -> {to}"),
    });
    parts.collect::<Vec<_>>().join(", ")
}

fn way_json(way: &Way) -> Value {
    match way {
        Way::Moved(by) => json!({ "kind": "moved", "by": by.to_array() }),
        Way::Turned(axis, degrees) => {
            json!({ "kind": "turned", "axis": axis.to_array(), "degrees": degrees })
        }
        Way::Scaled(by) => json!({ "kind": "scaled", "by": by.to_array() }),
        Way::Placed => json!({ "kind": "placed" }),
        Way::Value { what, from, to } => json!({ "kind": "value", "what": what, "from": from, "to": to }),
    }
}

fn vector(v: DVec3) -> String {
    let [x, y, z] = v.to_array().map(short);
    format!("({x}, {y}, {z})")
}

/// `sphere`, `1,204 spheres`, `3 instances of "car"`.
fn things(name: &str, of: &str, n: u64) -> String {
    let of = match (name, of) {
        (_, "") => String::new(),
        ("define", of) => format!(" {of:?}"),
        (_, of) => format!(" of {of:?}"),
    };
    let one = match name {
        "directional" => "directional light",
        "areaLight" => "area light",
        "tri" => "triangle",
        name => name,
    };
    if n == 1 {
        return format!("{one}{of}");
    }
    let many = match one {
        "box" => "boxes".to_owned(),
        "mesh" => "meshes".to_owned(),
        "torus" => "tori".to_owned(),
        one => format!("{one}s"),
    };
    format!("{} {many}{of}", count(n))
}
