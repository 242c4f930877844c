//! Calls of the language as text.

use std::fmt::{self, Display};

use crate::{
    color::Color,
    math::{Bounds3, DAffine3},
    scene::{
        Geometry, Object, Scene, Term,
        literal::{Components, Number, Text, Vector},
    },
    shape::{BlobPart, Isosurface, Shape},
    spline::Spline,
};

/// A term of a material.
pub(super) struct Said(pub(super) Term);

impl Display for Said {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Term { color, texture } = self.0;
        match texture {
            None => write!(f, "{}", Vector(color)),
            Some(id) if color == Color::ONE => write!(f, "texture_{}", id.0),
            Some(id) => write!(f, "texture_{} * vec3({})", id.0, Components(color)),
        }
    }
}

/// `loadMatrix([...]);`
pub(super) struct Load<'a>(pub(super) &'a DAffine3);

impl Display for Load<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (linear, t) = (self.0.matrix3, self.0.translation);
        f.write_str("loadMatrix([")?;
        for (i, t) in t.to_array().into_iter().enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{}, {}", Components(linear.row(i)), Number(t))?;
        }
        f.write_str("]);")
    }
}

/// The call that makes an object, but for meshes.
pub(super) struct Call<'a> {
    pub(super) scene: &'a Scene,
    pub(super) object: &'a Object,
    pub(super) names: &'a [String],
}

impl Display for Call<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.object.geometry {
            Geometry::Shape(shape) => write!(f, "{};", ShapeCall(shape)),
            Geometry::Triangle(id) => {
                let Some(triangle) = self.scene.triangles.get(id.index()) else {
                    return Ok(());
                };
                let [a, b, c] = triangle.positions.map(Vector);
                write!(f, "tri({a}, {b}, {c}")?;
                for n in triangle.normals.into_iter().flatten() {
                    write!(f, ", {}", Vector(n))?;
                }
                f.write_str(");")
            }
            Geometry::Instance(id) => {
                let name = self.names.get(id.index()).map_or("", String::as_str);
                write!(f, "instance({});", Text(name))
            }
            Geometry::Mesh(_) | Geometry::Csg(..) | Geometry::Moving(_) => Ok(()),
        }
    }
}

/// The call that makes a shape.
struct ShapeCall<'a>(&'a Shape);

impl Display for ShapeCall<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.0 {
            Shape::Sphere(s) => write!(f, "sphere({}, {})", Components(s.center()), Number(s.radius())),
            Shape::Cuboid(s) => write!(f, "box({})", Components(s.size())),
            Shape::Cylinder(s) => write!(f, "cylinder({}, {})", Number(s.radius()), Number(s.height())),
            Shape::Cone(s) => write!(f, "cone({}, {})", Number(s.radius()), Number(s.height())),
            Shape::Disk(s) => write!(f, "disk({})", Number(s.radius())),
            Shape::Torus(s) => write!(f, "torus({}, {})", Number(s.major()), Number(s.minor())),
            Shape::Plane(_) => f.write_str("plane()"),
            Shape::Polygon(s) => {
                f.write_str("polygon([")?;
                for (i, p) in s.points().iter().enumerate() {
                    let separator = if i == 0 { "" } else { ", " };
                    write!(f, "{separator}{}", Vector(*p))?;
                }
                f.write_str("])")
            }
            Shape::Isosurface(s) => write!(f, "{}", IsosurfaceCall(s)),
            Shape::Capsule(s) => write!(f, "capsule({}, {})", Number(s.radius()), Number(s.height())),
            Shape::RoundedBox(s) => {
                write!(f, "roundedBox({}, {})", Components(s.size()), Number(s.radius()))
            }
            Shape::Superellipsoid(s) => {
                write!(f, "superellipsoid({}, {})", Number(s.e()), Number(s.n()))
            }
            Shape::Quadric(s) => {
                write!(f, "quadric({}", Numbers(&s.coefficients()))?;
                if let Some(clip) = s.clip() {
                    write!(f, ", {}, {}", Vector(clip.min), Vector(clip.max))?;
                }
                f.write_str(")")
            }
            Shape::Prism(s) => {
                f.write_str("prism([")?;
                for (i, outline) in s.outlines().iter().enumerate() {
                    let separator = if i == 0 { "" } else { ", " };
                    write!(f, "{separator}{}", Tuples(outline))?;
                }
                write!(f, "], {}{})", Number(s.height()), Following(s.spline(), false))
            }
            Shape::Lathe(s) => {
                let options = Following(s.spline(), s.is_closed());
                write!(f, "lathe({}{options})", Tuples(s.points()))
            }
            Shape::SphereSweep(s) => {
                let options = Following(s.spline(), false);
                write!(f, "sphereSweep({}{options})", Tuples(s.points()))
            }
            Shape::Blob(s) => write!(
                f,
                "blob(#{{ threshold: {}, balls: [{}], cylinders: [{}] }})",
                Number(s.threshold()),
                Parts(s.parts(), false),
                Parts(s.parts(), true)
            ),
            // What only the program can make: read back, it is an unknown function, not another picture.
            Shape::Custom(s) => write!(f, "customShape({})", Text(&s.identity())),
        }
    }
}

/// The call that makes an isosurface, its program step by step.
struct IsosurfaceCall<'a>(&'a Isosurface);

impl Display for IsosurfaceCall<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Bounds3 { min, max } = self.0.within();
        let text = self.0.field().program();
        write!(
            f,
            "isosurface({}, #{{ bounds: [{}, {}] }})",
            Text(&text),
            Vector(min),
            Vector(max)
        )
    }
}

/// `[1, 2, 3]`.
struct Numbers<'a>(&'a [f64]);

impl Display for Numbers<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (i, x) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{}", Number(*x))?;
        }
        f.write_str("]")
    }
}

/// `[[1, 2], [3, 4]]`.
struct Tuples<'a, const N: usize>(&'a [[f64; N]]);

impl<const N: usize> Display for Tuples<'_, N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("[")?;
        for (i, numbers) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}{}", Numbers(numbers))?;
        }
        f.write_str("]")
    }
}

/// `, #{ spline: "catmullRom", closed: true }`, or nothing for straight and open.
struct Following(Spline, bool);

impl Display for Following {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let name = Text(self.0.name());
        match self {
            Self(Spline::Linear, false) => Ok(()),
            Self(_, false) => write!(f, ", #{{ spline: {name} }}"),
            Self(_, true) => write!(f, ", #{{ spline: {name}, closed: true }}"),
        }
    }
}

/// The balls of a blob, or its cylinders.
struct Parts<'a>(&'a [BlobPart], bool);

impl Display for Parts<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(parts, cylinders) = *self;
        let parts = parts.iter().filter(|part| part.is_ball() != cylinders);
        for (i, part) in parts.enumerate() {
            let separator = if i == 0 { "" } else { ", " };
            write!(f, "{separator}[{}", Vector(part.from))?;
            if cylinders {
                write!(f, ", {}", Vector(part.to))?;
            }
            write!(f, ", {}, {}]", Number(part.radius), Number(part.strength))?;
        }
        Ok(())
    }
}
