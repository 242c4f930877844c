//! Shapes.

use std::sync::Arc;

use rhai::Array;

use super::{number as number_param, vec3};
use crate::{
    math::DVec3,
    scene::SceneError,
    script::{
        call::Call,
        lists::{number, tuple, tuples_with},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
    shape::{Cone, Cuboid, Cylinder, Disk, Plane, Polygon, Shape, Sphere, Torus},
};

const RADIUS: Param = number_param("radius", "object units", "greater than 0");
const HEIGHT: Param = number_param("height", "object units", "greater than 0");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Shapes, "sphere", sphere)
        .takes(&[&[
            vec3("center", "object units", "its middle"),
            number_param("radius", "object units", "greater than 0"),
        ]])
        .doc("A sphere. Under scale(x, y, z) it is an ellipsoid.")
        .usage("sphere(0, 0, 0, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nsphere(0, 0, 0, 1.3);")
        .also(&["ball", "ellipsoid", "orb"]),
    Entry::scene(Group::Shapes, "spheres", spheres)
        .takes(&[&[Param::new(
            "list",
            Kind::List,
            "object units",
            "center and radius of each: [x, y, z, r] or [center, r]; or their numbers in one flat list or blob",
        )]])
        .doc("Many spheres at once, each as sphere(x, y, z, r) would make it. A blob holds floats as write_le writes them, 8 bytes each.")
        .usage("spheres([[0, 0, 0, 1], [2, 0, 0, 0.5]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.25, 0.15);\nlet list = [];\nfor i in 0..60 {\n  let a = radians(i * 137.5);\n  let r = 0.24 * sqrt(i);\n  list.push([r * cos(a), r * sin(a), 0, 0.2]);\n}\nspheres(list);")
        .also(&["balls", "particles"]),
    Entry::scene(Group::Shapes, "tri", tri)
        .takes(&[
            &[
                vec3("a", "object units", "first corner"),
                vec3("b", "object units", "second corner"),
                vec3("c", "object units", "third corner"),
            ],
            &[
                vec3("a", "object units", "first corner"),
                vec3("b", "object units", "second corner"),
                vec3("c", "object units", "third corner"),
                vec3("na", "none", "normal at a, of any length but 0"),
                vec3("nb", "none", "normal at b"),
                vec3("nc", "none", "normal at c"),
            ],
        ])
        .doc("A triangle; counter-clockwise is the front. With normals at its corners it is shaded smoothly.")
        .usage("tri([0, 0, 0], [1, 0, 0], [0, 1, 0])")
        .example("background(\"#cfe3f5\");\nlight([1, 2, 5], [1, 1, 1]);\ndiffuse(0.2, 0.45, 0.8);\ntri([-2, -1, 0], [0, -1, 0], [-1, 1, 0]);\n// with normals that differ, it looks bent\ntri([0.2, -1, 0], [2.2, -1, 0], [1.2, 1, 0],\n    [-1, 0, 0.4], [1, 0, 0.4], [0, 1, 0.4]);")
        .also(&["triangle", "face"]),
    Entry::scene(Group::Shapes, "box", cuboid)
        .takes(&[
            &[],
            &[
                number_param("w", "object units", "edge along x, greater than 0"),
                number_param("h", "object units", "edge along y"),
                number_param("d", "object units", "edge along z"),
            ],
        ])
        .doc("A box centered at the origin; without arguments the unit cube, which scale(w, h, d) gives its size.")
        .usage("box(1, 2, 0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.55, 0.15);\nrotate(1, 1, 0, 30);\nbox(1.5, 2, 1.5);")
        .also(&["cube", "cuboid", "block"]),
    Entry::scene(Group::Shapes, "cylinder", cylinder)
        .takes(&[&[], &[RADIUS, HEIGHT]])
        .doc("A closed cylinder around Y, centered at the origin; without arguments of radius 0.5 and height 1.")
        .usage("cylinder(0.5, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.2, 0.5, 0.7);\nrotate(1, 0, 0, 30);\ncylinder(0.9, 2.2);")
        .also(&["tube", "pillar"]),
    Entry::scene(Group::Shapes, "cone", cone)
        .takes(&[&[], &[RADIUS, HEIGHT]])
        .doc("A closed cone around Y, its apex up, from y = -height / 2 to height / 2; without arguments of radius 0.5 and height 1.")
        .usage("cone(0.5, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.2, 0.6, 0.3);\nrotate(1, 0, 0, 20);\ncone(1.1, 2.6);"),
    Entry::scene(Group::Shapes, "disk", disk)
        .takes(&[&[], &[RADIUS]])
        .doc("A flat disk in y = 0, its front up; without arguments of radius 0.5.")
        .usage("disk(0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.75, 0.25, 0.45);\nrotate(1, 0, 0, 40);\ndisk(1.6);")
        .also(&["circle"]),
    Entry::scene(Group::Shapes, "torus", torus)
        .takes(&[
            &[],
            &[
                number_param("major", "object units", "from the middle to the middle of the tube"),
                number_param("minor", "object units", "radius of the tube, less than major"),
            ],
        ])
        .doc("A ring around Y; without arguments major 0.375 and minor 0.125, which fits the unit cube.")
        .usage("torus(0.375, 0.125)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.5, 0.15);\nrotate(1, 0, 0, 50);\ntorus(1.2, 0.45);")
        .also(&["ring", "donut", "doughnut"]),
    Entry::scene(Group::Shapes, "plane", plane)
        .doc("The endless plane y = 0, its front up.")
        .usage("plane()")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(checker(\"#fff\", \"#3a7\", 1));\ntranslate(0, -1, 0);\nplane();")
        .also(&["ground"]),
    Entry::scene(Group::Shapes, "polygon", polygon)
        .takes(&[&[Param::new(
            "points",
            Kind::Array,
            "object units",
            "at least 3 points in one plane, in order around the outline; concave is fine",
        )]])
        .doc("A flat polygon; counter-clockwise is the front.")
        .usage("polygon([[0, 0, 0], [1, 0, 0], [0, 1, 0]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.9, 0.65, 0.1);\nlet points = [];\nfor i in 0..10 {\n  let r = if i % 2 == 0 { 1.8 } else { 0.75 };\n  let a = radians(90 + i * 36);\n  points.push([r * cos(a), r * sin(a), 0]);\n}\npolygon(points);"),
];

fn sphere(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let center = call.vec3("center")?;
    let radius = call.number("radius")?;
    call.end()?;
    state.builder.sphere(center, radius)?;
    DONE
}

fn spheres(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let numbers = tuples_with::<4>(call, "list", given, |name, d| match d.read_lock::<Array>() {
        Some(pair) if pair.len() == 2 => center_and_radius(call, name, &pair),
        _ => tuple(call, name, d),
    })?;
    // All are checked before the first is made: a script that catches the error has none of them.
    let checked: Result<Vec<Shape>, SceneError> = numbers
        .iter()
        .enumerate()
        .map(|(i, &[x, y, z, r])| {
            let sphere = Sphere::new(DVec3::new(x, y, z), r);
            sphere
                .map(Shape::Sphere)
                .map_err(|e| e.of(format_args!("sphere {i}")))
        })
        .collect();
    for shape in checked? {
        state.builder.shape(shape)?;
    }
    DONE
}

fn center_and_radius(call: &Call<'_, '_>, name: &dyn Fn() -> String, pair: &Array) -> Outcome<[f64; 4]> {
    let [center, radius] = pair.as_slice() else {
        return Err(call.error(format!("{} must be a center and a radius", name())));
    };
    let [x, y, z] = tuple(call, &|| format!("{}[0]", name()), center)?;
    Ok([x, y, z, number(call, || format!("{}[1]", name()), radius)?])
}

fn tri(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let positions = [call.vec3("a")?, call.vec3("b")?, call.vec3("c")?];
    let normals = if call.rest() > 0 {
        Some([call.vec3("na")?, call.vec3("nb")?, call.vec3("nc")?])
    } else {
        None
    };
    call.end()?;
    state.builder.triangle(positions, normals)?;
    DONE
}

fn cuboid(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let size = if call.rest() > 0 {
        DVec3::new(call.number("w")?, call.number("h")?, call.number("d")?)
    } else {
        DVec3::ONE
    };
    call.end()?;
    state.builder.shape(Shape::Cuboid(Cuboid::new(size)?))?;
    DONE
}

/// Radius and height, or those that fit the unit cube.
fn radius_and_height(call: &mut Call<'_, '_>) -> Outcome<(f64, f64)> {
    let both = if call.rest() > 0 {
        (call.number("radius")?, call.number("height")?)
    } else {
        (0.5, 1.0)
    };
    call.end()?;
    Ok(both)
}

fn cylinder(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (radius, height) = radius_and_height(call)?;
    state
        .builder
        .shape(Shape::Cylinder(Cylinder::new(radius, height)?))?;
    DONE
}

fn cone(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (radius, height) = radius_and_height(call)?;
    state.builder.shape(Shape::Cone(Cone::new(radius, height)?))?;
    DONE
}

fn disk(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let radius = if call.rest() > 0 {
        call.number("radius")?
    } else {
        0.5
    };
    call.end()?;
    state.builder.shape(Shape::Disk(Disk::new(radius)?))?;
    DONE
}

fn torus(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (major, minor) = if call.rest() > 0 {
        (call.number("major")?, call.number("minor")?)
    } else {
        (0.375, 0.125)
    };
    call.end()?;
    state.builder.shape(Shape::Torus(Torus::new(major, minor)?))?;
    DONE
}

fn plane(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    call.end()?;
    state.builder.shape(Shape::Plane(Plane))?;
    DONE
}

fn polygon(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let Some(array) = given.read_lock::<Array>() else {
        return Err(call.wrong_kind("points", "an array of points", given));
    };
    let points: Outcome<Vec<DVec3>> = array
        .iter()
        .enumerate()
        .map(|(i, p)| call.vec3_from(&format!("points[{i}]"), p))
        .collect();
    state
        .builder
        .shape(Shape::Polygon(Arc::new(Polygon::new(points?)?)))?;
    DONE
}
