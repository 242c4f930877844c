//! Solids as fields: signed distance fields, what can be done with them, and surfaces of any expression.

mod operators;

use rhai::{Array, Dynamic, Map};

pub(super) use self::operators::extend;

use super::{map, number, string, vec3};
use crate::{
    math::{Bounds3, DVec3},
    scene::SceneError,
    script::{
        call::Call,
        session::State,
        table::{DONE, Entry, Group, Kind, Param},
        value::Outcome,
    },
    shape::{Field, Isosurface, Sdf, Shape},
};

/// A sky, a light and a color before what an example is about.
macro_rules! lit {
    ($text:literal) => {
        concat!(
            "background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.8, 0.45, 0.2);\n",
            $text
        )
    };
}

const SDF: Param = Param::new("solid", Kind::Sdf, "none", "a solid, as sdfSphere(1) makes one");
const OTHER: Param = Param::new("other", Kind::Sdf, "none", "another solid");
const RADIUS: Param = number("radius", "object units", "greater than 0");
const HEIGHT: Param = number("height", "object units", "greater than 0");
const BLEND: Param = number(
    "k",
    "object units",
    "how far from where they meet the two are blended",
);
const FUNCTION: Param = Param::new(
    "f",
    Kind::Field,
    "none",
    "a function |x, y, z| of the coordinates, which is called once: what it returns is the expression",
);

pub(super) const ENTRIES: &[Entry] = &[
    Entry::scene(Group::Fields, "isosurface", isosurface)
        .takes(&[&[
            Param::new("what", Kind::Field, "none", "a solid, or a function |x, y, z| of the coordinates, negative inside"),
            map("options", "bounds: [least corner, greatest corner], needed where nothing else tells where it ends; threshold: the value at the surface").or("#{}").keys(KEYS),
        ]])
        .doc("Makes a shape of all points where a field is below the threshold, 0. The expression is read once and compiled; rays then find its surface by interval arithmetic, which misses no wall however thin. Where the field is still below the threshold at the bounds, these close the shape. In a function the coordinates take + - * / **, sin cos (radians), sqrt, abs, min, max and noise(x, y, z).")
        .usage("isosurface(sdfSphere(0.5))")
        .example(lit!("rotate(1, 1, 0, 30);\nisosurface(|x, y, z| x ** 4 + y ** 4 + z ** 4 - 1.4 * (x * x + y * y + z * z) + 0.5,\n  #{ bounds: [[-1.4, -1.4, -1.4], [1.4, 1.4, 1.4]] });"))
        .also(&["implicit", "implicitSurface", "iso"]),
    Entry::pure(Group::Fields, "sdf", sdf)
        .takes(&[&[FUNCTION]])
        .returns("sdf")
        .doc("A solid from a function of the coordinates, negative inside. It joins others by | (union), & (intersection) and - (difference), and is seen once isosurface(solid) makes a shape of it.")
        .usage("sdf(|x, y, z| x * x + y * y + z * z - 1)")
        .example(lit!("let waves = sdf(|x, y, z| y - 0.2 * sin(3 * x) * cos(3 * z));\nisosurface(waves & sdfBox(3, 2, 3));"))
        .also(&["field", "implicitField"]),
    Entry::pure(Group::Fields, "fieldAt", field_at)
        .takes(&[&[
            SDF,
            Param::new("x", Kind::Field, "object units", "where, as a field"),
            Param::new("y", Kind::Field, "object units", "where, as a field"),
            Param::new("z", Kind::Field, "object units", "where, as a field"),
        ]])
        .returns("field")
        .doc("The field of a solid at other coordinates, for functions of sdf() and isosurface() that bend what is there.")
        .usage("fieldAt(sdfSphere(1), 0, 0, 0)")
        .example(lit!("let rod = sdfCylinder(0.3, 3);\nisosurface(|x, y, z| fieldAt(rod, x + 0.3 * sin(4 * y), y, z),\n  #{ bounds: [[-1, -1.6, -1], [1, 1.6, 1]] });")),
    Entry::pure(Group::Fields, "sdfSphere", |call| one(call, &["radius"], |[radius]| Sdf::sphere(radius)))
        .takes(&[&[RADIUS]])
        .returns("sdf")
        .doc("A ball around the origin.")
        .usage("sdfSphere(1)")
        .example(lit!("isosurface(sdfSphere(1) - sdfSphere(0.9).moved(0.6, 0.4, 0.6));")),
    Entry::pure(Group::Fields, "sdfBox", sdf_box)
        .takes(&[&[vec3("size", "object units", "lengths of its edges")]])
        .returns("sdf")
        .doc("A box around the origin. sdfBox(1, 1, 1).rounded(0.1) has rounded edges and is larger by 0.1 on all sides.")
        .usage("sdfBox(1, 2, 1)")
        .example(lit!("rotate(0, 1, 0, 30);\nisosurface(sdfBox(1.4, 1, 1).rounded(0.25));")),
    Entry::pure(Group::Fields, "sdfTorus", |call| {
        one(call, &["major", "minor"], |[major, minor]| Sdf::torus(major, minor))
    })
    .takes(&[&[
        number("major", "object units", "distance of the tube's middle from the Y axis"),
        number("minor", "object units", "radius of the tube"),
    ]])
    .returns("sdf")
    .doc("A ring around the Y axis.")
    .usage("sdfTorus(1, 0.3)")
    .example(lit!("rotate(1, 0, 0, 50);\nisosurface(sdfTorus(1, 0.35).twisted(40).displaced(0.05, 0.15));")),
    Entry::pure(Group::Fields, "sdfCylinder", |call| {
        one(call, &["radius", "height"], |[radius, height]| Sdf::cylinder(radius, height))
    })
    .takes(&[&[RADIUS, HEIGHT]])
    .returns("sdf")
    .doc("A cylinder around the Y axis, centered at the origin.")
    .usage("sdfCylinder(0.5, 1)")
    .example(lit!("let bar = sdfCylinder(0.4, 2.6);\nrotate(1, 1, 0, 30);\nisosurface(bar.smoothUnion(bar.turned([1, 0, 0], 90), 0.4));")),
    Entry::pure(Group::Fields, "sdfCone", |call| {
        one(call, &["radius", "height"], |[radius, height]| Sdf::cone(radius, height))
    })
    .takes(&[&[RADIUS, HEIGHT]])
    .returns("sdf")
    .doc("A cone around the Y axis, centered at the origin, its tip up.")
    .usage("sdfCone(0.5, 1)")
    .example(lit!("isosurface(sdfCone(0.8, 1.8).rounded(0.1).smoothUnion(sdfSphere(0.5).moved(0, 0.9, 0), 0.2));")),
    Entry::pure(Group::Fields, "sdfCapsule", sdf_capsule)
        .takes(&[&[
            vec3("a", "object units", "an end of its middle line"),
            vec3("b", "object units", "the other end"),
            RADIUS,
        ]])
        .returns("sdf")
        .doc("All points within the radius of the line from a to b.")
        .usage("sdfCapsule([0, 0, 0], [1, 0, 0], 0.2)")
        .example(lit!("let hand = sdfSphere(0.5);\nfor i in 0..5 {\n  let a = 0.6 * (i - 2);\n  hand = hand.smoothUnion(sdfCapsule([0, 0, 0], [1.3 * sin(a), 1.3 * cos(a), 0], 0.13), 0.25);\n}\nisosurface(hand);")),
    Entry::pure(Group::Fields, "sdfEllipsoid", |call| {
        let radii = call.vec3("radii")?;
        call.end()?;
        made(Sdf::ellipsoid(radii))
    })
    .takes(&[&[vec3("radii", "object units", "half its lengths along x, y and z")]])
    .returns("sdf")
    .doc("An ellipsoid around the origin.")
    .usage("sdfEllipsoid(1, 0.5, 0.7)")
    .example(lit!("isosurface(sdfEllipsoid(1.4, 0.6, 0.9).hollowed(0.1) - sdfBox(3, 3, 1).moved(0, 0, 0.8));")),
    Entry::pure(Group::Fields, "sdfPlane", |call| {
        call.end()?;
        Ok(Dynamic::from(Sdf::plane()))
    })
    .returns("sdf")
    .doc("All that lies below y = 0, without end: joined to others by & it cuts them.")
    .usage("sdfPlane()")
    .example(lit!("isosurface(sdfSphere(1) & sdfPlane().turned([1, 0, 1], 30));")),
    Entry::pure(Group::Fields, "sdfGyroid", |call| {
        one(call, &["period", "thickness"], |[period, thickness]| Sdf::gyroid(period, thickness))
    })
    .takes(&[&[
        number("period", "object units", "after which it repeats"),
        number("thickness", "object units", "of the wall"),
    ]])
    .returns("sdf")
    .doc("A wall along the gyroid, a surface without end that divides space into two halves of one form.")
    .usage("sdfGyroid(1, 0.1)")
    .example(lit!("isosurface(sdfSphere(1.3) & sdfGyroid(1, 0.15));")),
    Entry::pure(Group::Fields, "smoothUnion", |call| blended(call, Sdf::smooth_union))
        .takes(&[&[SDF, OTHER, BLEND]])
        .returns("sdf")
        .doc("Both solids, blended into one another; also a.smoothUnion(b, k). a | b blends nothing.")
        .usage("smoothUnion(sdfSphere(1), sdfBox(1, 1, 1), 0.2)")
        .example(lit!("let a = sdfSphere(0.8).moved(-0.6, 0, 0);\nlet b = sdfSphere(0.6).moved(0.7, 0.2, 0);\nisosurface(a.smoothUnion(b, 0.5));"))
        .also(&["smin", "smoothMin", "metaballs"]),
    Entry::pure(Group::Fields, "smoothIntersection", |call| blended(call, Sdf::smooth_intersection))
        .takes(&[&[SDF, OTHER, BLEND]])
        .returns("sdf")
        .doc("What both solids have in common, edges rounded; also a.smoothIntersection(b, k). a & b leaves edges sharp.")
        .usage("smoothIntersection(sdfSphere(1), sdfBox(1, 1, 1), 0.2)")
        .example(lit!("rotate(1, 1, 0, 30);\nisosurface(sdfSphere(1.2).smoothIntersection(sdfBox(1.8, 1.8, 1.8), 0.3));"))
        .also(&["smax", "smoothMax"]),
    Entry::pure(Group::Fields, "smoothDifference", |call| blended(call, Sdf::smooth_difference))
        .takes(&[&[SDF, OTHER, BLEND]])
        .returns("sdf")
        .doc("The first solid without the second, edges rounded; also a.smoothDifference(b, k). a - b leaves edges sharp.")
        .usage("smoothDifference(sdfSphere(1), sdfBox(1, 1, 1), 0.2)")
        .example(lit!("isosurface(sdfBox(2, 1.4, 2).smoothDifference(sdfSphere(0.8).moved(0, 0.7, 0.8), 0.2));"))
        .also(&["smoothSubtract", "smoothSubtraction"]),
    Entry::pure(Group::Fields, "moved", |call| {
        let (solid, by) = (solid_of(call, "solid")?, call.vec3("by")?);
        call.end()?;
        Ok(Dynamic::from(solid.moved(by)))
    })
    .takes(&[&[SDF, vec3("by", "object units", "how far along x, y and z")]])
    .returns("sdf")
    .doc("The solid in another place: solid.moved(1, 0, 0).")
    .usage("moved(sdfSphere(1), 1, 0, 0)")
    .example(lit!("isosurface(sdfSphere(0.7).moved(-0.8, 0, 0) | sdfSphere(0.7).moved(0.8, 0, 0));")),
    Entry::pure(Group::Fields, "turned", |call| {
        let (solid, axis, degrees) = (solid_of(call, "solid")?, call.vec3("axis")?, call.number("degrees")?);
        call.end()?;
        made(solid.turned(axis, degrees))
    })
    .takes(&[&[
        SDF,
        vec3("axis", "none", "of any length but 0"),
        number("degrees", "degrees", "right-handed"),
    ]])
    .returns("sdf")
    .doc("The solid turned about the origin: solid.turned([0, 1, 0], 45).")
    .usage("turned(sdfBox(1, 1, 1), [0, 1, 0], 45)")
    .example(lit!("let plank = sdfBox(2.4, 0.3, 0.6);\nisosurface(plank | plank.turned([0, 0, 1], 60) | plank.turned([0, 0, 1], 120));")),
    Entry::pure(Group::Fields, "scaled", |call| measured(call, "by", Sdf::scaled))
        .takes(&[&[SDF, number("by", "none", "the factor, greater than 0")]])
        .returns("sdf")
        .doc("The solid stretched alike in all directions: solid.scaled(2).")
        .usage("scaled(sdfBox(1, 1, 1), 2)")
        .example(lit!("let ring = sdfTorus(1, 0.2);\nrotate(1, 0, 0, 60);\nisosurface(ring | ring.scaled(0.6) | ring.scaled(0.3));")),
    Entry::pure(Group::Fields, "rounded", |call| measured(call, "by", Sdf::rounded))
        .takes(&[&[SDF, number("by", "object units", "how much larger on all sides; smaller where negative")]])
        .returns("sdf")
        .doc("The solid made larger on all sides, which rounds its edges: solid.rounded(0.1).")
        .usage("rounded(sdfBox(1, 1, 1), 0.1)")
        .example(lit!("rotate(1, 1, 0, 30);\nisosurface(sdfBox(1, 1, 1).rounded(0.4));"))
        .also(&["inflate"]),
    Entry::pure(Group::Fields, "hollowed", |call| measured(call, "thickness", Sdf::hollowed))
        .takes(&[&[SDF, number("thickness", "object units", "of the wall, greater than 0")]])
        .returns("sdf")
        .doc("A wall along the solid's surface: solid.hollowed(0.1).")
        .usage("hollowed(sdfSphere(1), 0.1)")
        .example(lit!("rotate(1, 0, 0, 40);\nisosurface(sdfSphere(1.2).hollowed(0.08) & sdfPlane());"))
        .also(&["onion", "shell"]),
    Entry::pure(Group::Fields, "twisted", |call| measured(call, "degrees", Sdf::twisted))
        .takes(&[&[SDF, number("degrees", "degrees", "for each unit of height")]])
        .returns("sdf")
        .doc("The solid turned about the Y axis the more, the higher: solid.twisted(90).")
        .usage("twisted(sdfBox(1, 2, 1), 45)")
        .example(lit!("isosurface(sdfBox(0.9, 2.6, 0.9).rounded(0.05).twisted(60));"))
        .also(&["twist"]),
    Entry::pure(Group::Fields, "bent", |call| measured(call, "degrees", Sdf::bent))
        .takes(&[&[SDF, number("degrees", "degrees", "for each unit along x")]])
        .returns("sdf")
        .doc("The solid bent about the Z axis along x: solid.bent(30).")
        .usage("bent(sdfBox(2, 1, 1), 20)")
        .example(lit!("isosurface(sdfBox(3, 0.3, 1).rounded(0.05).bent(35));"))
        .also(&["bend"]),
    Entry::pure(Group::Fields, "repeated", repeated)
        .takes(&[&[
            SDF,
            vec3("period", "object units", "from one copy to the next along x, y and z; 0 for no copies along that axis"),
            Param::new("count", Kind::Int, "none", "copies to either side").or("without end"),
        ]])
        .returns("sdf")
        .doc("Copies of the solid without further cost, each within its own cell of the period: solid.repeated([1, 0, 1], 2). Without a count there is no end to them, and & with something else must cut it.")
        .usage("repeated(sdfSphere(0.3), [1, 1, 1], 2)")
        .example(lit!("rotate(1, 0, 0, 25);\nisosurface(sdfBox(0.3, 0.5, 0.3).rounded(0.1).repeated([0.75, 0, 0.75], 2));"))
        .also(&["tile", "opRep"]),
    Entry::pure(Group::Fields, "mirrored", mirrored)
        .takes(&[&[SDF, string("axis", "\"x\", \"y\" or \"z\"")]])
        .returns("sdf")
        .doc("What lies on the positive side of the axis, on both sides: solid.mirrored(\"x\").")
        .usage("mirrored(sdfSphere(1).moved(1, 0, 0), \"x\")")
        .example(lit!("let wing = sdfEllipsoid(0.9, 0.12, 0.4).turned([0, 0, 1], 20).moved(0.9, 0.3, 0);\nisosurface(wing.mirrored(\"x\").smoothUnion(sdfEllipsoid(0.3, 0.3, 0.9), 0.2));")),
    Entry::pure(Group::Fields, "displaced", |call| {
        let solid = solid_of(call, "solid")?;
        let (amount, size) = (call.number("amount")?, call.number("size")?);
        call.end()?;
        made(solid.displaced(amount, size))
    })
    .takes(&[&[
        SDF,
        number("amount", "object units", "how far the surface is raised or lowered"),
        number("size", "object units", "of the hills, greater than 0"),
    ]])
    .returns("sdf")
    .doc("The solid with a surface of hills by noise: solid.displaced(0.1, 0.5).")
    .usage("displaced(sdfSphere(1), 0.1, 0.4)")
    .example(lit!("isosurface(sdfSphere(1.1).displaced(0.15, 0.35));"))
    .also(&["displace"]),
];

const KEYS: &[&str] = &["bounds", "threshold"];

fn made(solid: Result<Sdf, SceneError>) -> Outcome {
    Ok(Dynamic::from(solid?))
}

/// A solid of numbers alone.
fn one<const N: usize>(
    call: &mut Call<'_, '_>,
    names: &[&str; N],
    make: impl Fn([f64; N]) -> Result<Sdf, SceneError>,
) -> Outcome {
    let mut numbers = [0.0; N];
    for (x, name) in numbers.iter_mut().zip(names) {
        *x = call.number(name)?;
    }
    call.end()?;
    made(make(numbers))
}

/// A solid from another and a number.
fn measured(
    call: &mut Call<'_, '_>,
    name: &str,
    make: impl Fn(&Sdf, f64) -> Result<Sdf, SceneError>,
) -> Outcome {
    let (solid, by) = (solid_of(call, "solid")?, call.number(name)?);
    call.end()?;
    made(make(&solid, by))
}

fn blended(call: &mut Call<'_, '_>, make: impl Fn(&Sdf, &Sdf, f64) -> Result<Sdf, SceneError>) -> Outcome {
    let (a, b, k) = (
        solid_of(call, "solid")?,
        solid_of(call, "other")?,
        call.number("k")?,
    );
    call.end()?;
    made(make(&a, &b, k))
}

fn sdf_box(call: &mut Call<'_, '_>) -> Outcome {
    let size = call.vec3("size")?;
    call.end()?;
    made(Sdf::cuboid(size))
}

fn sdf_capsule(call: &mut Call<'_, '_>) -> Outcome {
    let (a, b, radius) = (call.vec3("a")?, call.vec3("b")?, call.number("radius")?);
    call.end()?;
    made(Sdf::capsule(a, b, radius))
}

fn repeated(call: &mut Call<'_, '_>) -> Outcome {
    let (solid, period) = (solid_of(call, "solid")?, call.vec3("period")?);
    let count = if call.rest() > 0 {
        Some(call.count("count", 0)?)
    } else {
        None
    };
    call.end()?;
    made(solid.repeated(period, count))
}

fn mirrored(call: &mut Call<'_, '_>) -> Outcome {
    let (solid, axis) = (solid_of(call, "solid")?, call.string("axis")?);
    call.end()?;
    match ["x", "y", "z"].iter().position(|name| *name == axis.as_str()) {
        Some(axis) => Ok(Dynamic::from(solid.mirrored(axis))),
        None => Err(call.error(format!("axis must be \"x\", \"y\" or \"z\", not \"{axis}\""))),
    }
}

fn solid_of(call: &mut Call<'_, '_>, name: &str) -> Outcome<Sdf> {
    let given = call.any()?;
    match given.read_lock::<Sdf>() {
        Some(solid) => Ok(solid.clone()),
        None => Err(call.wrong_kind(name, "a solid such as sdfSphere(1)", given)),
    }
}

/// A field: one itself, or a number.
fn field_of(d: &Dynamic) -> Option<Field> {
    if let Some(field) = d.read_lock::<Field>() {
        return Some(field.clone());
    }
    if let Some(solid) = d.read_lock::<Sdf>() {
        return Some(solid.field().clone());
    }
    crate::script::call::number_of(d).map(Field::constant)
}

fn field_at(call: &mut Call<'_, '_>) -> Outcome {
    let solid = solid_of(call, "solid")?;
    let mut next = |name| {
        let given = call.any()?;
        field_of(given).ok_or_else(|| call.wrong_kind(name, "a number or a field", given))
    };
    let point = [next("x")?, next("y")?, next("z")?];
    call.end()?;
    Ok(Dynamic::from(solid.field().moved_to(&point)))
}

/// What is given to `sdf` where it is no function.
fn sdf(call: &mut Call<'_, '_>) -> Outcome {
    let given = call.any()?;
    call.end()?;
    if let Some(solid) = given.read_lock::<Sdf>() {
        return Ok(Dynamic::from(solid.clone()));
    }
    match field_of(given) {
        Some(field) => Ok(Dynamic::from(Sdf::from_field(field, None))),
        None => Err(call.wrong_kind("f", "a function |x, y, z| of the coordinates", given)),
    }
}

fn isosurface(call: &mut Call<'_, '_>, state: &mut State) -> Outcome {
    let given = call.any()?;
    let options = (call.rest() > 0).then(|| call.any()).transpose()?;
    call.end()?;
    let mut solid = if let Some(solid) = given.read_lock::<Sdf>() {
        solid.clone()
    } else if let Some(text) = given.read_lock::<rhai::ImmutableString>() {
        Sdf::from_field(Field::from_program(&text)?, None)
    } else {
        match field_of(given) {
            Some(field) => Sdf::from_field(field, None),
            None => return Err(call.wrong_kind("what", "a solid or a function |x, y, z|", given)),
        }
    };
    let mut bounds = None;
    if let Some(options) = options {
        let Some(map) = options.read_lock::<Map>() else {
            return Err(call.wrong_kind("options", "a map such as #{ threshold: 0.1 }", options));
        };
        call.known_keys(&map, KEYS)?;
        if let Some(threshold) = map.get("threshold") {
            solid = solid.rounded(call.number_from("threshold", threshold)?)?;
        }
        bounds = map
            .get("bounds")
            .map(|given| bounds_of(call, given))
            .transpose()?;
    }
    let surface = match bounds {
        Some(bounds) => Isosurface::new(solid.field().clone(), bounds)?,
        None => solid.isosurface()?,
    };
    state.builder.shape(Shape::Isosurface(surface.into()))?;
    DONE
}

fn bounds_of(call: &Call<'_, '_>, given: &Dynamic) -> Outcome<Bounds3> {
    let corners = given.read_lock::<Array>();
    let Some([min, max]) = corners.as_deref().map(Vec::as_slice) else {
        return Err(call.wrong_kind("bounds", "a list of two corners", given));
    };
    let corner = |i: usize, d: &Dynamic| -> Outcome<DVec3> { call.vec3_from(&format!("bounds[{i}]"), d) };
    Ok(Bounds3::new(corner(0, min)?, corner(1, max)?))
}
