//! Shapes of curves and polynomials.

use std::sync::Arc;

use rhai::{Array, Dynamic, ImmutableString, Map};

use super::{map, number as number_param, vec3};
use crate::{
    math::{Bounds3, DVec3},
    script::{
        call::{Call, number_of, quoted},
        lists::{tuple, tuples, tuples_with},
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
    shape::{Blob, BlobPart, Capsule, Lathe, Prism, Quadric, RoundedBox, Shape, SphereSweep, Superellipsoid},
    spline::Spline,
};

const SPLINE: [&str; 1] = ["spline"];
const PROFILE: [&str; 2] = ["spline", "closed"];
const BLOB: [&str; 3] = ["threshold", "balls", "cylinders"];
const COEFFICIENTS: [&str; 10] = ["xx", "yy", "zz", "xy", "xz", "yz", "x", "y", "z", "constant"];
const QUADRIC: [&str; 12] = [
    "xx", "yy", "zz", "xy", "xz", "yz", "x", "y", "z", "constant", "min", "max",
];
const SPLINE_OPTIONS: Param = map(
    "options",
    "spline: how the curve follows the points, \"linear\" (the default), \"catmullRom\" through all of them, or \"bezier\" with two control points between each two",
)
.keys(&SPLINE);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Shapes, "capsule", capsule)
        .takes(&[
            &[],
            &[
                number_param("radius", "object units", "greater than 0"),
                number_param("height", "object units", "of the whole, at least twice the radius"),
            ],
        ])
        .doc("A cylinder around Y with a half sphere at either end; without arguments of radius 0.25 and height 1.")
        .usage("capsule(0.25, 1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nspecular(0.3, 0.3, 0.3); shininess(60);\nfor i in 0..3 {\n  group {\n    translate(i * 1.3 - 1.3, 0, 0);\n    rotate(0, 0, 1, 25);\n    diffuse(0.85, 0.2 + 0.25 * i, 0.2);\n    capsule(0.5, 2.6 - 0.5 * i);\n  }\n}")
        .also(&["pill", "stadium", "spherocylinder"]),
    Entry::scene(Group::Shapes, "roundedBox", rounded_box)
        .takes(&[
            &[],
            &[
                number_param("w", "object units", "whole edge along x, greater than 0"),
                number_param("h", "object units", "whole edge along y"),
                number_param("d", "object units", "whole edge along z"),
                number_param("radius", "object units", "of the edges, at most half of the shortest edge"),
            ],
        ])
        .doc("A box with rounded edges, centered at the origin; without arguments the unit cube with edges of radius 0.1.")
        .usage("roundedBox(1, 2, 0.5, 0.1)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.15, 0.45, 0.55);\nspecular(0.3, 0.3, 0.3); shininess(60);\nrotate(1, 1, 0, 30);\nroundedBox(2, 1.6, 2, 0.35);")
        .also(&["roundBox", "roundedCube", "bevel", "fillet", "superellipse"]),
    Entry::scene(Group::Shapes, "superellipsoid", superellipsoid)
        .takes(&[&[
            number_param("e", "none", "east-west exponent, of the sections across Y, from 0.01 to 10: 1 is round, towards 0 square, 2 a rhomb"),
            number_param("n", "none", "north-south exponent, of the sections along Y, from 0.01 to 10"),
        ]])
        .doc("What lies between box, cylinder, sphere, octahedron and star, in the unit cube: |x|^(2/e) + |z|^(2/e) to the power e/n, plus |y|^(2/n), is 1. As in POV-Ray, but around Y.")
        .usage("superellipsoid(0.25, 0.25)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.75, 0.5, 0.2);\nlet at = -1.7;\nfor e in [[0.25, 0.25], [1, 0.3], [1, 2.5]] {\n  group { translate(at, 0, 0); rotate(1, 0, 0, 25); rotate(0, 1, 0, 30); scale(1.5); superellipsoid(e[0], e[1]); }\n  at += 1.7;\n}")
        .also(&["superquadric", "squircle"]),
    Entry::scene(Group::Shapes, "quadric", quadric)
        .takes(&[
            &[Param::new(
                "coefficients",
                Kind::Array,
                "none",
                "ten numbers, of x^2, y^2, z^2, xy, xz, yz, x, y, z and 1: the surface is where the sum is 0",
            )],
            &[
                Param::new("coefficients", Kind::Array, "none", "the ten numbers"),
                vec3("min", "object units", "least corner of the box that cuts out a solid"),
                vec3("max", "object units", "greatest corner"),
            ],
            &[map(
                "options",
                "the coefficients by name, 0 where left out, and the box by its corners min and max",
            )
            .keys(&QUADRIC)],
        ])
        .doc("A surface of the second degree: ellipsoid, paraboloid, hyperboloid, cone, cylinder, two planes. With a box it is solid, all in the box where the sum is not above 0; without one it may have no end.")
        .usage("quadric(#{ xx: 1, yy: -1, zz: 1, constant: -0.1, min: [-1, -1, -1], max: [1, 1, 1] })")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nrotate(1, 0, 0, 20);\ndiffuse(0.8, 0.35, 0.2);\ngroup { translate(-1.2, 0, 0); quadric(#{ xx: 1, yy: -0.6, zz: 1, constant: -0.2, min: [-1, -1.2, -1], max: [1, 1.2, 1] }); }\ndiffuse(0.2, 0.45, 0.7);\ngroup { translate(1.2, -1, 0); quadric([1, 0, 1, 0, 0, 0, 0, -0.5, 0, 0], [-1, 0, -1], [1, 2, 1]); }")
        .also(&["quadratic", "paraboloid", "hyperboloid", "hyperbolic"]),
    Entry::scene(Group::Shapes, "prism", prism)
        .takes(&[
            &[
                Param::new("points", Kind::List, "object units", "the outline's points [x, z], or a list of outlines: one within another is a hole"),
                number_param("height", "object units", "along y, centered"),
            ],
            &[
                Param::new("points", Kind::List, "object units", "the outline's points [x, z], or a list of outlines"),
                number_param("height", "object units", "along y, centered"),
                SPLINE_OPTIONS,
            ],
        ])
        .doc("An outline in x and z, swept along Y and closed by flat ends. An outline closes by itself. A point is inside where a way to it crosses the outlines an odd number of times.")
        .usage("prism([[0, 0], [1, 0], [0, 1]], 0.5)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.85, 0.6, 0.15);\nlet gear = []; let hole = [];\nfor i in 0..48 {\n  let r = if i % 4 < 2 { 1.7 } else { 1.35 };\n  let a = radians(i * 7.5);\n  gear.push([r * cos(a), r * sin(a)]);\n}\nfor i in 0..6 { hole.push([0.6 * cos(radians(i * 60)), 0.6 * sin(radians(i * 60))]); }\nrotate(1, 0, 0, 50);\nprism([gear, hole], 0.5);")
        .also(&["extrude", "extrusion", "linear_extrude", "linearSweep"]),
    Entry::scene(Group::Shapes, "lathe", lathe)
        .takes(&[
            &[Param::new("points", Kind::List, "object units", "the profile's points [radius, y]")],
            &[
                Param::new("points", Kind::List, "object units", "the profile's points [radius, y]"),
                map(
                    "options",
                    "spline: \"linear\" (the default), \"catmullRom\" or \"bezier\"; closed: whether the profile returns to its first point, false by default",
                )
                .keys(&PROFILE),
            ],
        ])
        .doc("A profile turned around Y. It is solid where it is closed or begins and ends on the axis, else a surface.")
        .usage("lathe([[0, -1], [1, 0], [0, 1]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.3, 0.45, 0.75);\nspecular(0.4, 0.4, 0.4); shininess(80);\nrotate(1, 0, 0, 20);\nlathe([[0, -1.5], [0.8, -1.4], [1, -0.6], [0.35, 0.5], [0.6, 1.3], [0.5, 1.35], [0.2, 0.5], [0, 0.2]], #{ spline: \"catmullRom\" });")
        .also(&["revolve", "sor", "surfaceOfRevolution", "rotate_extrude", "spin"]),
    Entry::scene(Group::Shapes, "sphereSweep", sphere_sweep)
        .takes(&[
            &[Param::new("points", Kind::List, "object units", "center and radius at each point: [center, r] or [x, y, z, r]")],
            &[
                Param::new("points", Kind::List, "object units", "center and radius at each point: [center, r] or [x, y, z, r]"),
                SPLINE_OPTIONS,
            ],
        ])
        .doc("All that a sphere passes which moves along a curve while its radius changes: a tube with round ends. Straight between points unless a spline is asked for.")
        .usage("sphereSweep([[0, 0, 0, 0.5], [1, 1, 0, 0.2]])")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.25, 0.6, 0.35);\nlet points = [];\nfor i in 0..14 {\n  let a = radians(i * 50);\n  points.push([1.2 * cos(a), i * 0.22 - 1.4, 1.2 * sin(a), 0.32 - 0.02 * i]);\n}\nrotate(1, 0, 0, 15);\nsphereSweep(points, #{ spline: \"catmullRom\" });")
        .also(&["sphere_sweep", "sweep", "snake", "bezierTube"]),
    Entry::scene(Group::Shapes, "blob", blob)
        .takes(&[&[map(
            "options",
            "threshold, the density on the surface, greater than 0; balls, a list of [center, radius, strength]; cylinders, a list of [from, to, radius, strength]",
        )
        .keys(&BLOB)]])
        .doc("Balls and rods that flow into each other. At the distance d from its middle each adds strength * (1 - (d / radius)^2)^2 to the density, and nothing beyond its radius; a negative strength takes away. The surface is where the density is the threshold. At most 10,000 of them make one blob. (blob(n) with a number is the bytes of a file.)")
        .usage("blob(#{ threshold: 0.5, balls: [[[0, 0, 0], 1, 1], [[0.8, 0, 0], 1, 1]] })")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.75, 0.25, 0.45);\nspecular(0.4, 0.4, 0.4); shininess(50);\nblob(#{\n  threshold: 0.4,\n  balls: [[[-0.9, -0.3, 0], 1.3, 1], [[0.7, -0.4, 0.2], 1.2, 1], [[0, 0.2, 1.2], 0.9, -0.6]],\n  cylinders: [[[-0.3, 0, 0], [0.4, 1.3, 0], 0.7, 1]]\n});")
        .also(&["metaball", "metaballs", "blobby", "softObject"]),
];

fn capsule(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (radius, height) = if call.rest() > 0 {
        (call.number("radius")?, call.number("height")?)
    } else {
        (0.25, 1.0)
    };
    call.end()?;
    let shape = Capsule::new(radius, height)?;
    state.builder.shape(Shape::Capsule(shape))?;
    DONE
}

fn rounded_box(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (size, radius) = if call.rest() > 0 {
        let size = DVec3::new(call.number("w")?, call.number("h")?, call.number("d")?);
        (size, call.number("radius")?)
    } else {
        (DVec3::ONE, 0.1)
    };
    call.end()?;
    let shape = RoundedBox::new(size, radius)?;
    state.builder.shape(Shape::RoundedBox(shape))?;
    DONE
}

fn superellipsoid(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let (e, n) = (call.number("e")?, call.number("n")?);
    call.end()?;
    let shape = Superellipsoid::new(e, n)?;
    state.builder.shape(Shape::Superellipsoid(shape))?;
    DONE
}

fn quadric(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let (coefficients, corners) = if let Some(map) = given.read_lock::<Map>() {
        call.end()?;
        call.known_keys(&map, &QUADRIC)?;
        let mut coefficients = [0.0; 10];
        for (to, key) in coefficients.iter_mut().zip(COEFFICIENTS) {
            if let Some(d) = map.get(key) {
                *to = call.number_from(key, d)?;
            }
        }
        let corner = |key: &str| map.get(key).map(|d| call.vec3_from(key, d)).transpose();
        let corners = match (corner("min")?, corner("max")?) {
            (None, None) => None,
            (Some(min), Some(max)) => Some((min, max)),
            _ => {
                return Err(call
                    .error("min and max come together")
                    .hint("they are the corners of the box that cuts out a solid"));
            }
        };
        (coefficients, corners)
    } else {
        let coefficients = tuple(call, &|| "coefficients".to_owned(), given)?;
        let corners = if call.rest() > 0 {
            Some((call.vec3("min")?, call.vec3("max")?))
        } else {
            None
        };
        call.end()?;
        (coefficients, corners)
    };
    let clip = corners.map(|(min, max)| Bounds3::new(min, max));
    let shape = Quadric::new(coefficients, clip)?;
    state.builder.shape(Shape::Quadric(Arc::new(shape)))?;
    DONE
}

fn prism(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let height = call.number("height")?;
    let (spline, _) = spline_options(call, &SPLINE)?;
    call.end()?;
    let is_list_of_outlines = |array: &Array| {
        let first = array.first().and_then(|outline| outline.read_lock::<Array>());
        first.is_some_and(|outline| outline.first().is_some_and(|point| number_of(point).is_none()))
    };
    let outlines = match given.read_lock::<Array>() {
        Some(array) if is_list_of_outlines(&array) => {
            let each = array.iter().enumerate();
            each.map(|(i, outline)| tuples(call, &format!("points[{i}]"), outline))
                .collect::<Outcome<_>>()?
        }
        _ => vec![tuples(call, "points", given)?],
    };
    let shape = Prism::new(outlines, spline, height)?;
    state.builder.shape(Shape::Prism(Arc::new(shape)))?;
    DONE
}

fn lathe(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let (spline, closed) = spline_options(call, &PROFILE)?;
    call.end()?;
    let shape = Lathe::new(tuples(call, "points", given)?, spline, closed)?;
    state.builder.shape(Shape::Lathe(Arc::new(shape)))?;
    DONE
}

fn sphere_sweep(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let (spline, _) = spline_options(call, &SPLINE)?;
    call.end()?;
    let points = tuples_with::<4>(call, "points", given, |name, d| match d.read_lock::<Array>() {
        Some(pair) if pair.len() == 2 => {
            let [center, radius] = parts(call, name, &pair)?;
            let [x, y, z] = tuple(call, &|| format!("{}[0]", name()), center)?;
            Ok([x, y, z, call.number_from(&format!("{}[1]", name()), radius)?])
        }
        _ => tuple(call, name, d),
    })?;
    let shape = SphereSweep::new(points, spline)?;
    state.builder.shape(Shape::SphereSweep(Arc::new(shape)))?;
    DONE
}

fn blob(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    call.end()?;
    let Some(map) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map #{ }", given));
    };
    call.known_keys(&map, &BLOB)?;
    let Some(threshold) = map.get("threshold") else {
        return Err(call
            .error("threshold is missing")
            .hint("it is the density on the surface, for example 0.5"));
    };
    let threshold = call.number_from("threshold", threshold)?;
    let list = |key: &'static str| match map.get(key) {
        None => Ok(Array::new()),
        Some(d) => {
            let array = d.read_lock::<Array>().map(|array| array.clone());
            array.ok_or_else(|| call.wrong_kind(key, "an array", d))
        }
    };
    let mut blob = Vec::new();
    for (i, d) in list("balls")?.iter().enumerate() {
        let name = || format!("balls[{i}]");
        let [center, radius, strength] = parts_of(call, &name, d)?;
        blob.push(BlobPart::ball(
            call.vec3_from(&format!("{}[0]", name()), &center)?,
            call.number_from(&format!("{}[1]", name()), &radius)?,
            call.number_from(&format!("{}[2]", name()), &strength)?,
        ));
    }
    for (i, d) in list("cylinders")?.iter().enumerate() {
        let name = || format!("cylinders[{i}]");
        let [from, to, radius, strength] = parts_of(call, &name, d)?;
        blob.push(BlobPart::rod(
            call.vec3_from(&format!("{}[0]", name()), &from)?,
            call.vec3_from(&format!("{}[1]", name()), &to)?,
            call.number_from(&format!("{}[2]", name()), &radius)?,
            call.number_from(&format!("{}[3]", name()), &strength)?,
        ));
    }
    let shape = Blob::new(threshold, blob)?;
    state.builder.shape(Shape::Blob(Arc::new(shape)))?;
    DONE
}

/// The entries of an array of `N`.
fn parts<'a, const N: usize>(
    call: &Call<'_, '_>,
    name: &dyn Fn() -> String,
    array: &'a Array,
) -> Outcome<&'a [Dynamic; N]> {
    let all = array.as_slice().try_into();
    all.map_err(|_| {
        call.error(format!(
            "{} must be an array of {N}, not of {}",
            name(),
            array.len()
        ))
    })
}

fn parts_of<const N: usize>(
    call: &Call<'_, '_>,
    name: &dyn Fn() -> String,
    d: &Dynamic,
) -> Outcome<[Dynamic; N]> {
    let Some(array) = d.read_lock::<Array>() else {
        return Err(call.wrong_kind(&name(), &format!("an array of {N}"), d));
    };
    parts(call, name, &array).cloned()
}

/// The map of options that may come last: which spline, and whether it is closed.
fn spline_options(call: &mut Call<'_, '_>, known: &[&str]) -> Outcome<(Spline, bool)> {
    let (mut spline, mut closed) = (Spline::Linear, false);
    if call.rest() == 0 {
        return Ok((spline, closed));
    }
    let given = call.any()?;
    let Some(map) = given.read_lock::<Map>() else {
        return Err(call.wrong_kind("options", "a map #{ }", given));
    };
    call.known_keys(&map, known)?;
    if let Some(d) = map.get("spline") {
        let name = d.clone().try_cast::<ImmutableString>();
        let name = name.ok_or_else(|| call.wrong_kind("spline", "a string", d))?;
        spline = Spline::of_name(&name).ok_or_else(|| {
            let names = Spline::NAMES.map(|(name, _)| quoted(name));
            call.error(format!(
                "spline must be one of {}, not {}",
                names.join(", "),
                quoted(&name)
            ))
        })?;
    }
    if let Some(d) = map.get("closed") {
        closed = d
            .as_bool()
            .map_err(|_| call.wrong_kind("closed", "true or false", d))?;
    }
    Ok((spline, closed))
}
