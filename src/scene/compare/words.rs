//! Values that changed, as a person reads them.

use super::{
    Way,
    items::{Contents, Item, Thing, linked},
    motion::motion,
};
use crate::{
    custom::Custom,
    math::DVec3,
    scene::{
        Encoding, Geometry, GroupId, Light, Material, Object, Projection, Scene, Term, Texture, dump,
        literal::{Number, Vector},
        source,
    },
    shape::Shape,
};

/// A number in six digits, without the noise of rounding.
///
/// ```
/// use rtscript::scene::compare::short;
/// assert_eq!(short(0.1 + 0.2), 0.3);
/// ```
#[must_use]
pub fn short(x: f64) -> f64 {
    format!("{x:.5e}").parse().unwrap_or(x) + 0.0
}

/// What is different about two things of one kind.
pub(super) fn ways((before, after): (&Contents<'_>, &Contents<'_>), a: &Item<'_>, b: &Item<'_>) -> Vec<Way> {
    let mut ways = Vec::new();
    match (a.thing, b.thing) {
        (Thing::Object(old), Thing::Object(new)) => {
            ways.extend(motion(before.placing(old), after.placing(new)));
            if a.form != b.form {
                form(&mut ways, (before.scene, old), (after.scene, new));
            }
            if a.looks != b.looks {
                looks(&mut ways, (before, old), (after, new));
            }
        }
        (Thing::Light(old), Thing::Light(new)) => {
            light(&mut ways, old, new);
            let (from, to) = (linked(before.scene, old), linked(after.scene, new));
            if from != to {
                value(&mut ways, "light linking", || from.clone(), || to.clone());
            }
        }
        _ => {}
    }
    if ways.is_empty() {
        value(&mut ways, "a last digit", String::new, String::new);
    }
    ways
}

fn value(ways: &mut Vec<Way>, what: &'static str, from: impl Fn() -> String, to: impl Fn() -> String) {
    ways.push(Way::Value {
        what,
        from: from(),
        to: to(),
    });
}

/// As [`value`], in six digits where those tell the values apart.
fn shortest(ways: &mut Vec<Way>, what: &'static str, say: impl Fn(&dyn Fn(f64) -> f64) -> [String; 2]) {
    let [mut from, mut to] = say(&short);
    if from == to {
        [from, to] = say(&|x| x);
    }
    ways.push(Way::Value { what, from, to });
}

/// As [`value`], where the numbers differ.
fn number(ways: &mut Vec<Way>, what: &'static str, from: f64, to: f64) {
    if from != to {
        shortest(ways, what, |digits| {
            [from, to].map(|x| Number(digits(x)).to_string())
        });
    }
}

/// As [`value`], where the vectors differ.
fn vector(ways: &mut Vec<Way>, what: &'static str, from: DVec3, to: DVec3) {
    if from != to {
        shortest(ways, what, |digits| [from, to].map(|v| said(v, digits)));
    }
}

fn said(v: DVec3, digits: &dyn Fn(f64) -> f64) -> String {
    Vector(DVec3::from_array(v.to_array().map(digits))).to_string()
}

fn form(ways: &mut Vec<Way>, (before, old): (&Scene, &Object), (after, new): (&Scene, &Object)) {
    match (&old.geometry, &new.geometry) {
        (Geometry::Shape(a), Geometry::Shape(b)) => shape(ways, a, b),
        (Geometry::Triangle(_), Geometry::Triangle(_)) => {
            value(ways, "corners or normals", String::new, String::new);
        }
        (Geometry::Mesh(a), Geometry::Mesh(b)) => {
            let (a, b) = (before.meshes.get(a.index()), after.meshes.get(b.index()));
            let (Some(a), Some(b)) = (a, b) else { return };
            let said = |mesh: &crate::scene::Mesh| {
                let count = mesh.triangles.len();
                let ending = if count == 1 { "" } else { "s" };
                format!("{} of {count} triangle{ending}", mesh.name)
            };
            if said(a) == said(b) {
                value(ways, "vertices or materials", String::new, String::new);
            } else {
                value(ways, "mesh", || said(a), || said(b));
            }
        }
        (Geometry::Moving(a), Geometry::Moving(b)) => {
            let said = |scene: &Scene, id: GroupId| {
                let motion = scene.groups.get(id.index()).and_then(|group| group.motion);
                motion.unwrap_or_default().to_string()
            };
            let (from, to) = (said(before, *a), said(after, *b));
            if from != to {
                value(ways, "motion", || from.clone(), || to.clone());
            }
        }
        _ => {}
    }
}

fn shape(ways: &mut Vec<Way>, a: &Shape, b: &Shape) {
    match (a, b) {
        (Shape::Sphere(a), Shape::Sphere(b)) => number(ways, "radius", a.radius(), b.radius()),
        (Shape::Cuboid(a), Shape::Cuboid(b)) => vector(ways, "size", a.size(), b.size()),
        (Shape::Cylinder(a), Shape::Cylinder(b)) => {
            number(ways, "radius", a.radius(), b.radius());
            number(ways, "height", a.height(), b.height());
        }
        (Shape::Cone(a), Shape::Cone(b)) => {
            number(ways, "radius", a.radius(), b.radius());
            number(ways, "height", a.height(), b.height());
        }
        (Shape::Disk(a), Shape::Disk(b)) => number(ways, "radius", a.radius(), b.radius()),
        (Shape::Torus(a), Shape::Torus(b)) => {
            number(ways, "major radius", a.major(), b.major());
            number(ways, "minor radius", a.minor(), b.minor());
        }
        (Shape::Polygon(a), Shape::Polygon(b)) if a.points().len() != b.points().len() => {
            let count = |points: &[DVec3]| points.len().to_string();
            value(ways, "points", || count(a.points()), || count(b.points()));
        }
        (Shape::Capsule(a), Shape::Capsule(b)) => {
            number(ways, "radius", a.radius(), b.radius());
            number(ways, "height", a.height(), b.height());
        }
        (Shape::RoundedBox(a), Shape::RoundedBox(b)) => {
            vector(ways, "size", a.size(), b.size());
            number(ways, "radius", a.radius(), b.radius());
        }
        (Shape::Superellipsoid(a), Shape::Superellipsoid(b)) => {
            number(ways, "east-west exponent", a.e(), b.e());
            number(ways, "north-south exponent", a.n(), b.n());
        }
        (Shape::Quadric(_), Shape::Quadric(_)) => {
            value(ways, "coefficients or box", String::new, String::new);
        }
        (Shape::Prism(a), Shape::Prism(b)) if a.height() != b.height() => {
            number(ways, "height", a.height(), b.height());
        }
        (Shape::Blob(a), Shape::Blob(b)) if a.threshold() != b.threshold() => {
            number(ways, "threshold", a.threshold(), b.threshold());
        }
        (Shape::Blob(_), Shape::Blob(_)) => value(ways, "parts", String::new, String::new),
        (Shape::SphereSweep(_), Shape::SphereSweep(_)) => {
            value(ways, "points or spline", String::new, String::new);
        }
        (Shape::Custom(a), Shape::Custom(b)) => value(ways, "shape", || a.identity(), || b.identity()),
        _ => value(ways, "outline", String::new, String::new),
    }
}

fn looks(
    ways: &mut Vec<Way>,
    (before, old): (&Contents<'_>, &Object),
    (after, new): (&Contents<'_>, &Object),
) {
    let material = |contents: &Contents<'_>, object: &Object| {
        let found = contents.scene.materials.get(object.material.index());
        found.cloned().unwrap_or_default()
    };
    let (a, b) = (material(before, old), material(after, new));
    type Of = fn(&Material) -> Option<Term>;
    let terms: [(&'static str, Of); 6] = [
        ("ambient", |m| Some(m.ambient)),
        ("emission", |m| Some(m.emission)),
        ("diffuse", |m| Some(m.diffuse)),
        ("specular", |m| Some(m.specular)),
        ("reflection", |m| m.reflection),
        ("transmission", |m| Some(m.transmission)),
    ];
    for (what, of) in terms {
        let (a, b) = (of(&a), of(&b));
        let content = |contents: &Contents<'_>, t: &Option<Term>| t.as_ref().map(|t| contents.term(t));
        if content(before, &a) != content(after, &b) {
            let said = |contents: &Contents<'_>, t: &Option<Term>, digits: &dyn Fn(f64) -> f64| {
                t.as_ref()
                    .map_or("as specular".to_owned(), |t| term(contents.scene, t, digits))
            };
            shortest(ways, what, |digits| {
                [said(before, &a, digits), said(after, &b, digits)]
            });
        }
    }
    number(ways, "shininess", a.shininess, b.shininess);
    number(ways, "ior", a.ior, b.ior);
    if a.reflectance != b.reflectance {
        let said = |m: &Material| {
            m.reflectance
                .as_ref()
                .map_or("built in".to_owned(), Custom::identity)
        };
        value(ways, "reflectance", || said(&a), || said(&b));
    }
    finish(ways, (before, &a), (after, &b));
}

/// What differs beyond the shading equation, key by key.
fn finish(
    ways: &mut Vec<Way>,
    (before, a): (&Contents<'_>, &Material),
    (after, b): (&Contents<'_>, &Material),
) {
    let options = |contents: &Contents<'_>, m: &Material| {
        let said = |id| term(contents.scene, &Term::texture(id), &|x| x);
        m.finish
            .as_ref()
            .map_or_else(Vec::new, |finish| finish.options(&said))
    };
    let (a, b) = (options(before, a), options(after, b));
    let of = |options: &[(&'static str, String)], key: &str| {
        let found = options.iter().find(|(name, _)| *name == key);
        found.map_or("none".to_owned(), |(_, text)| text.clone())
    };
    let mut keys: Vec<&'static str> = a.iter().chain(&b).map(|(key, _)| *key).collect();
    keys.sort_unstable();
    keys.dedup();
    for key in keys {
        let (old, new) = (of(&a, key), of(&b, key));
        if old != new {
            value(ways, key, || old.clone(), || new.clone());
        }
    }
}

fn term(scene: &Scene, term: &Term, digits: &dyn Fn(f64) -> f64) -> String {
    let texture = term.texture.and_then(|id| scene.textures.get(id.index()));
    let texture = match texture.map(|texture| &**texture) {
        None => return said(term.color, digits),
        Some(Texture::Image(image)) => format!("{} {} x {}", image.name, image.width, image.height),
        Some(Texture::Checker { even, odd, size }) => {
            let (even, odd) = (said(*even, digits), said(*odd, digits));
            format!("checker({even}, {odd}, {})", Number(digits(*size)))
        }
        Some(Texture::Custom(texture)) => texture.identity(),
        Some(texture) => texture.call(&|part| match &**part {
            Texture::Image(image) => Some(format!("{} {} x {}", image.name, image.width, image.height)),
            _ => None,
        }),
    };
    if term.color == crate::color::Color::ONE {
        texture
    } else {
        format!("{texture} * {}", said(term.color, digits))
    }
}

fn light(ways: &mut Vec<Way>, old: &Light, new: &Light) {
    let moved = |ways: &mut Vec<Way>, from: DVec3, to: DVec3| {
        if from != to {
            ways.push(Way::Moved(to - from));
        }
    };
    let vectors = old.kind.vectors().into_iter().zip(new.kind.vectors());
    for (i, (from, to)) in vectors.enumerate() {
        if i == 0 && from.is_point {
            moved(ways, from.value, to.value);
        } else {
            vector(ways, from.name, from.value, to.value);
        }
    }
    for ((what, from), (_, to)) in old.kind.numbers().into_iter().zip(new.kind.numbers()) {
        number(ways, what, from, to);
    }
    vector(ways, "color", old.color, new.color);
    if let (Some(a), Some(b)) = (old.kind.attenuation(), new.kind.attenuation()) {
        let terms = |a: &crate::scene::Attenuation| DVec3::new(a.constant, a.linear, a.quadratic);
        vector(ways, "attenuation", terms(a), terms(b));
    }
}

fn or_none(said: Option<String>) -> String {
    said.unwrap_or_else(|| "none".to_owned())
}

/// Settings and camera that differ: what, the value it had, the value it has.
///
/// ```
/// use rtscript::{Builder, scene::compare::settings};
/// let mut b = Builder::new();
/// b.samples(4)?;
/// let changed = settings(&Builder::new().finish().value, &b.finish().value);
/// assert_eq!(changed, [("samples", "1".to_owned(), "4".to_owned())]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
pub fn settings(before: &Scene, after: &Scene) -> Vec<(&'static str, String, String)> {
    let said = |scene: &Scene| {
        let (s, c) = (&scene.settings, &scene.camera);
        let encoding = match s.encoding {
            Encoding::Srgb => "srgb",
            Encoding::Raw => "raw",
        };
        let surroundings = s.surroundings.texts();
        let thing = |i: usize| {
            let text = surroundings.get(i).cloned().flatten();
            text.unwrap_or_else(|| "none".to_owned())
        };
        [
            ("edition", s.edition().to_string()),
            ("size", format!("{} x {}", s.width, s.height)),
            ("samples", s.samples.to_string()),
            ("maxDepth", s.max_depth.to_string()),
            ("minWeight", Number(s.min_weight).to_string()),
            ("seed", s.seed.cast_signed().to_string()),
            ("background", Vector(s.background).to_string()),
            ("encoding", encoding.to_owned()),
            ("environment", thing(0)),
            ("ambient occlusion", thing(1)),
            ("fog", thing(2)),
            ("haze", thing(3)),
            ("camera from", Vector(c.eye).to_string()),
            ("camera at", Vector(c.at).to_string()),
            ("camera up", Vector(c.up).to_string()),
            (
                "camera fovy",
                c.fovy()
                    .map_or("none".to_owned(), |fovy| Number(fovy).to_string()),
            ),
            (
                "camera projection",
                match c.projection {
                    Projection::Perspective { .. } => "perspective".to_owned(),
                    other => dump::projection(&other),
                },
            ),
            ("lens", or_none(c.lens.as_ref().map(source::lens))),
            ("stereo", or_none(c.stereo.as_ref().map(source::stereo))),
            ("motion", or_none(c.motion.as_ref().map(source::motion))),
            ("shutter", source::shutter(&c.shutter)),
            ("sampler", s.sampling.name().to_owned()),
            ("filter", source::filter(&s.filter)),
            ("adaptive", or_none(s.adaptive.as_ref().map(source::adaptive))),
            ("crop", or_none(s.crop.as_ref().map(source::crop))),
        ]
    };
    let pairs = said(before).into_iter().zip(said(after));
    pairs
        .filter(|((_, a), (_, b))| a != b)
        .map(|((what, a), (_, b))| (what, a, b))
        .collect()
}
