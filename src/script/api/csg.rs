//! Blocks that put solids together.

use crate::script::table::{Entry, Group, Kind, Param};

const BLOCK: Param = Param::new(
    "block",
    Kind::Block,
    "none",
    "statements that make the solids, in the scope they stand in",
);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::syntax(Group::Shapes, "union")
        .takes(&[&[BLOCK]])
        .doc("Makes one solid of all that its block makes: what is inside of any of them. Nothing is left of the faces within, so glass put together this way is one body. Saves matrix and material as group { } does. All in it must be closed: solids, closed meshes, instances of groups of such things, other blocks of this kind; plane() is all that lies below it.")
        .usage("union { sphere(0, 0, 0, 0.5); box(1, 0.4, 0.4); }")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.1, 0.1, 0.12);\ntransmission(0.85, 0.9, 0.95);\nreflection(0.1, 0.1, 0.1);\nior(1.3);\nunion {          // one body of glass, without walls inside\n  sphere(-0.7, 0, 0, 0.9);\n  sphere(0.7, 0, 0, 0.9);\n  cylinder(0.3, 3);\n}\ntranslate(0, -1.6, 0);\ntransmission(0, 0, 0);\nreflection(0, 0, 0);\ndiffuse(checker([0.8, 0.8, 0.8], [0.3, 0.35, 0.5], 0.7));\nplane();")
        .also(&["merge", "fuse", "combine"]),
    Entry::syntax(Group::Shapes, "intersection")
        .takes(&[&[BLOCK]])
        .doc("Makes one solid of what is inside of all that its block makes. Each face keeps the material of the shape that it belongs to. See union for what may be in it.")
        .usage("intersection { sphere(0, 0, 0, 0.6); box(1, 1, 1); }")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nrotate(1, 1, 0, 30);\nintersection {\n  diffuse(0.85, 0.85, 0.9);\n  box(2, 2, 2);\n  diffuse(0.8, 0.25, 0.15);\n  sphere(0, 0, 0, 1.3);\n}")
        .also(&["intersect", "common"]),
    Entry::syntax(Group::Shapes, "difference")
        .takes(&[&[BLOCK]])
        .doc("Makes one solid of the first thing that its block makes, with all others cut out of it. A cut has the material of what cut it. See union for what may be in it.")
        .usage("difference { box(1, 1, 1); sphere(0, 0, 0, 0.6); }")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nrotate(1, 1, 0, 30);\ndifference {\n  diffuse(0.15, 0.35, 0.8);\n  box(2, 2, 2);\n  diffuse(0.9, 0.7, 0.3);   // the cut is of the cutter's material\n  sphere(0, 0, 0, 1.25);\n  for i in 0..3 {\n    rotate(1, 1, 1, 120);\n    cylinder(0.5, 3);\n  }\n}")
        .also(&["subtract", "subtraction", "cut", "carve", "boolean", "csg"]),
];
