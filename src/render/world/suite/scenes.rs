//! The scenes, as a script makes them.

use crate::{
    DVec3, Limits, NoHost, RunOptions, Scene, Script,
    math::{self, DAffine3},
};

/// What is done to a whole scene.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    None,
    /// Moved, turned, mirrored and made larger.
    Similar,
    /// Stretched as well.
    Uneven,
}

impl Move {
    fn scale(self) -> DVec3 {
        match self {
            Self::None => DVec3::ONE,
            Self::Similar => DVec3::new(1.5, 1.5, -1.5),
            Self::Uneven => DVec3::new(1.5, 0.7, -2.2),
        }
    }

    pub(super) fn matrix(self) -> DAffine3 {
        if self == Self::None {
            return DAffine3::IDENTITY;
        }
        let turn = math::rotation(DVec3::new(1.0, 2.0, 3.0).normalize(), 40.0);
        DAffine3::from_translation(DVec3::new(0.3, -1.2, 2.0))
            * DAffine3::from_mat3(turn)
            * DAffine3::from_scale(self.scale())
    }
}

/// A scene of the list, moved.
pub(super) fn scene(text: &str, how: Move) -> Scene {
    let DVec3 { x, y, z } = how.scale();
    let before = match how {
        Move::None => String::new(),
        _ => format!("translate(0.3, -1.2, 2.0); rotate(1, 2, 3, 40); scale({x:?}, {y:?}, {z:?});\n"),
    };
    let script = Script::compile("suite.rhai", &(before + text), &Limits::default()).unwrap();
    script.run(&NoHost, &RunOptions::default()).unwrap().value.scene
}

/// Things with an inside, by name.
pub(super) const SCENES: &[(&str, &str)] = &[
    (
        "union",
        "union { box(1, 2, 1); translate(0.4, 0.3, 0.2); cylinder(0.6, 1.5); rotate(0, 0, 1, 70); capsule(0.2, 3); }",
    ),
    (
        "intersection",
        "intersection { sphere(0, 0, 0, 1); rotate(1, 1, 0, 20); box(1.5, 1.4, 1.3); scale(1.7, 1.7, 1.7); superellipsoid(0.5, 0.7); }",
    ),
    (
        "difference",
        "difference { box(2, 1, 2); sphere(0.2, 0.6, 0.3, 0.5); rotate(1, 0, 0, 90); cylinder(0.3, 3); torus(0.9, 0.1); }",
    ),
    (
        "difference of a union and an intersection",
        "difference {
           union { sphere(-0.4, 0, 0, 0.8); sphere(0.4, 0, 0, 0.8); }
           intersection { box(3, 0.4, 3); rotate(1, 0, 0, 90); cylinder(0.5, 3); }
           group { translate(0, 0.5, 0); roundedBox(0.5, 1, 3, 0.1); }
         }",
    ),
    (
        "difference of curved solids",
        "difference {
           lathe([[0, -1], [0.6, -1], [0.8, -0.3], [0.2, 0.5], [0.5, 1], [0, 0.9]], #{ spline: \"catmullRom\" });
           sphereSweep([[-1, -0.6, 0.1, 0.2], [0, 0, 0.2, 0.3], [1, 0.4, -0.1, 0.1]]);
           translate(0, -0.9, 0); prism([[0.3, 0], [0, 0.3], [-0.3, 0.1], [0, -0.3]], 0.5);
         }",
    ),
    (
        "difference with a mesh and an isosurface",
        "difference {
           box(2, 1, 1);
           group { translate(-0.5, -0.1, 0.4); text(\"Ae\", #{ size: 0.6, depth: 0.4 }); }
           group { translate(0.5, 0.5, 0); isosurface(sdfSphere(0.4)); }
         }",
    ),
    (
        "instances of a solid",
        "define \"part\" { difference { box(1, 1, 1); cylinder(0.3, 2); } }
         instance(\"part\"); translate(2, 0.1, 0.3); rotate(1, 2, 0, 35); scale(1, 1.4, 0.8); instance(\"part\");",
    ),
    (
        "instances of instances",
        "define \"ball\" { sphere(0, 0, 0, 0.4); group { translate(0.9, 0, 0); box(0.3, 0.8, 0.5); } }
         define \"pair\" { instance(\"ball\"); group { translate(0, 1, 0); rotate(0, 0, 1, 30); instance(\"ball\"); } }
         define \"four\" { instance(\"pair\"); group { translate(2.5, 0, 0); rotate(0, 1, 1, 50); scale(0.7, 0.9, 0.7); instance(\"pair\"); } }
         instance(\"four\"); translate(0, 0, 3); instance(\"four\");",
    ),
    (
        "a solid of instances",
        "define \"peg\" { group { rotate(1, 0, 0, 90); cylinder(0.2, 3); } cylinder(0.2, 3); }
         difference { box(2, 2, 2); instance(\"peg\"); group { translate(0.6, 0.1, 0.2); rotate(1, 1, 1, 40); instance(\"peg\"); } }",
    ),
    (
        "height field",
        "heightField(|x, z| 0.3 + 0.2 * sin(7 * x) * cos(5 * z), #{ solid: true, columns: 12, rows: 12 });",
    ),
    ("text", "text(\"R&%\", #{ size: 0.8, depth: 0.3 });"),
    (
        "subdivided cube",
        "subdivide(#{
           positions: [[-1, -1, -1], [1, -1, -1], [-1, 1, -1], [1, 1, -1], [-1, -1, 1], [1, -1, 1], [-1, 1, 1], [1, 1, 1]],
           faces: [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]] }, 2);",
    ),
    (
        "surface tube",
        "surface(|u, v| [(1.2 + 0.4 * cos(v)) * cos(u), 0.4 * sin(v), (1.2 + 0.4 * cos(v)) * sin(u)],
           #{ u: [0, TAU], v: [0, TAU], tolerance: 0.02 });",
    ),
    (
        "surface with poles",
        "surface(|u, v| [sin(v) * cos(u), 1.3 * cos(v), sin(v) * sin(u)], #{ u: [0, TAU], v: [0, PI], tolerance: 0.02 });",
    ),
    (
        "curve tube",
        "curve([[0, 0, 0], [1, 0.5, 0], [1.5, -0.5, 1], [0, -0.5, 2]], [0.2, 0.1, 0.25, 0.15], #{ sides: 7 });",
    ),
    (
        "closed curve tube",
        "curve([[1, 0, 0], [0, 0.3, 1], [-1, 0, 0], [0, -0.3, -1]], 0.2, #{ closed: true, sides: 6 });",
    ),
    (
        "straight curve tube",
        "curve([[0, 0, 0], [1, 0.5, 0], [1.5, -0.5, 1]], 0.1, #{ kind: \"linear\", sides: 5 });",
    ),
    (
        "closed patches",
        "let above = []; let below = [];
         for i in 0..16 {
           let x = i % 4; let z = i / 4;
           let inner = x > 0 && x < 3 && z > 0 && z < 3;
           above.push([x / 3.0, if inner { 0.6 } else { 0.0 }, z / 3.0]);
           below.push([z / 3.0, if inner { -0.4 } else { 0.0 }, x / 3.0]);
         }
         bezierPatch([above, below], #{ tolerance: 0.01 });",
    ),
    (
        "meshes in a group",
        "define \"letters\" { text(\"io\", #{ size: 0.8, depth: 0.3 }); }
         instance(\"letters\"); group { translate(0, 1, 0.2); rotate(1, 1, 0, 25); instance(\"letters\"); }
         translate(0, -1, 0); box(1, 0.5, 1);",
    ),
];
