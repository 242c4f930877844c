//! The builder that Rust programs use: calls in any order with any values.

use std::sync::Arc;

use rtscript::{
    Builder, DVec3, Scene, Term,
    math::{DAffine3, DMat3, DVec2},
    scene::{
        Attenuation, Attribute, Camera, Encoding, ImageTexture, Material, Mesh, SceneError, Texels, Texture,
    },
    shape::{Cone, Cuboid, Cylinder, Disk, Plane, Polygon, Shape, Torus},
};

use crate::{
    bytes::Bytes,
    oracle::{check, limits},
};

/// Deepest nesting of groups.
const DEPTH: u32 = 4;

pub fn run(data: &[u8]) {
    let scene = build(&mut Bytes::new(data));
    assert!(!scene.dump().is_empty());
    assert!(!scene.hash().is_empty());
    let _ = scene.holds();
}

/// The scene that these bytes stand for.
pub fn build(bytes: &mut Bytes<'_>) -> Scene {
    let mut builder = Builder::with_limits(limits());
    while !bytes.is_empty() {
        call(bytes, &mut builder, 0);
    }
    builder
        .take_warnings()
        .iter()
        .for_each(|warning| check(warning, &[]));
    let report = builder.finish();
    report.warnings.iter().for_each(|warning| check(warning, &[]));
    report.value
}

fn call(bytes: &mut Bytes<'_>, b: &mut Builder, depth: u32) {
    if let Err(error) = attempt(bytes, b, depth) {
        check(&error.into(), &[]);
    }
}

fn attempt(bytes: &mut Bytes<'_>, b: &mut Builder, depth: u32) -> Result<(), SceneError> {
    match bytes.below(40) {
        0 => b.push_transform(),
        1 => b.pop_transform(),
        2 | 3 => b.translate(bytes.vector()),
        4 => b.rotate(bytes.vector(), bytes.number() * 45.0),
        5 => b.scale(bytes.vector()),
        6 => b.scale(DVec3::splat(bytes.positive())),
        7 => b.mult_matrix(&matrix(bytes)),
        8 => b.load_matrix(&matrix(bytes)),
        9 => {
            b.load_identity();
            Ok(())
        }
        10 => b.multiply(affine(bytes)),
        11..=14 => {
            let center = bytes.vector();
            b.sphere(center, bytes.positive())
        }
        15 => b.shape(Shape::Cuboid(Cuboid::new(bytes.vector().abs())?)),
        16 => b.shape(Shape::Cylinder(Cylinder::new(
            bytes.positive(),
            bytes.positive(),
        )?)),
        17 => b.shape(Shape::Cone(Cone::new(bytes.positive(), bytes.positive())?)),
        18 => b.shape(Shape::Disk(Disk::new(bytes.positive())?)),
        19 => b.shape(Shape::Torus(Torus::new(bytes.positive(), bytes.positive())?)),
        20 => b.shape(Shape::Plane(Plane)),
        21 => {
            let count = bytes.below(9);
            let flat = !bytes.byte().is_multiple_of(4);
            let point = |_| bytes.vector() * DVec3::new(1.0, if flat { 0.0 } else { 1.0 }, 1.0);
            let points: Vec<DVec3> = (0..count).map(point).collect();
            b.shape(Shape::Polygon(Arc::new(Polygon::new(points)?)))
        }
        22..=24 => {
            let corners = [bytes.vector(), bytes.vector(), bytes.vector()];
            let normals =
                (bytes.byte().is_multiple_of(4)).then(|| [bytes.vector(), bytes.vector(), bytes.vector()]);
            b.triangle(corners, normals)
        }
        25 => {
            let mesh = Arc::new(mesh(bytes)?);
            b.mesh(&mesh)?;
            // A second place makes it a level of its own.
            b.translate(DVec3::X)?;
            b.mesh(&mesh)
        }
        26..=28 => {
            let material = material(bytes, b);
            b.set_material(material);
            Ok(())
        }
        29 | 30 => {
            let position = bytes.vector();
            b.point(position, bytes.color())
        }
        31 => {
            let direction = bytes.vector();
            b.directional(direction, bytes.color())
        }
        32 => {
            let (corner, edge1, edge2) = (bytes.vector(), bytes.vector(), bytes.vector());
            b.area_light(corner, edge1, edge2, bytes.color(), u32::from(bytes.byte() % 5))
        }
        33 => b.attenuation(Attenuation {
            constant: bytes.positive(),
            linear: bytes.positive(),
            quadratic: bytes.positive(),
        }),
        34 if depth < DEPTH => {
            let mark = b.begin_group()?;
            for _ in 0..bytes.below(4) {
                call(bytes, b, depth + 1);
            }
            b.end_group(mark);
            Ok(())
        }
        35 if depth < DEPTH => {
            let mark = b.begin_define(name(bytes))?;
            for _ in 0..bytes.below(5) {
                call(bytes, b, depth + 1);
            }
            b.end_define(mark, !bytes.byte().is_multiple_of(8));
            Ok(())
        }
        36 => b.instance(name(bytes)),
        37 => {
            let matrices = [matrix(bytes), matrix(bytes)];
            b.instances(name(bytes), &matrices)
        }
        38 => {
            b.camera(Camera::new(
                bytes.vector(),
                bytes.vector(),
                bytes.vector(),
                bytes.number() * 16.0,
            )?);
            Ok(())
        }
        _ => settings(bytes, b),
    }
}

fn settings(bytes: &mut Bytes<'_>, b: &mut Builder) -> Result<(), SceneError> {
    match bytes.below(7) {
        0 => b.size(u32::from(bytes.byte()), u32::from(bytes.byte())),
        1 => b.samples(u32::from(bytes.byte() % 8)),
        2 => match bytes.byte() {
            depth @ 0..128 => b.max_depth(u32::from(depth % 8)),
            _ => b.min_weight(bytes.number()),
        },
        3 => b.background(bytes.color()),
        4 => {
            b.encoding(bytes.one_of(&[Encoding::Raw, Encoding::Srgb]));
            Ok(())
        }
        5 => {
            b.seed(bytes.bits());
            Ok(())
        }
        _ => {
            let warnings = b.take_warnings();
            warnings.iter().for_each(|warning| check(warning, &[]));
            let _ = b.snapshot();
            Ok(())
        }
    }
}

fn name(bytes: &mut Bytes<'_>) -> &'static str {
    bytes.one_of(&["a", "b", "c", ""])
}

/// Mostly one with the last row 0 0 0 1, which is all that is allowed.
fn matrix(bytes: &mut Bytes<'_>) -> [f64; 16] {
    let mut rows = std::array::from_fn(|i| if i % 5 == 0 { 1.0 } else { 0.0 });
    for value in rows.iter_mut().take(12) {
        if bytes.byte().is_multiple_of(3) {
            *value = bytes.number();
        }
    }
    if bytes.byte() > 250 {
        rows[15] = bytes.number();
    }
    rows
}

fn affine(bytes: &mut Bytes<'_>) -> DAffine3 {
    DAffine3::from_mat3_translation(
        DMat3::from_cols(bytes.vector(), bytes.vector(), bytes.vector()),
        bytes.vector(),
    )
}

fn mesh(bytes: &mut Bytes<'_>) -> Result<Mesh, SceneError> {
    let positions: Vec<DVec3> = (0..bytes.below(12)).map(|_| bytes.vector()).collect();
    let count = positions.len();
    let triangles: Vec<[u32; 3]> = (0..bytes.below(24))
        .map(|_| [0; 3].map(|_: u32| bytes.below(count + usize::from(count == 0)) as u32))
        .collect();
    let mut mesh = Mesh::new("mesh", positions, triangles)?;
    let indices = || mesh.triangles.clone();
    let (smooth, placed) = (bytes.byte().is_multiple_of(3), bytes.byte().is_multiple_of(3));
    if smooth {
        let values = (0..count).map(|_| bytes.vector()).collect();
        mesh.normals = Some(Attribute {
            values,
            indices: indices(),
        });
    }
    if placed {
        let values = (0..count)
            .map(|_| DVec2::new(bytes.number(), bytes.number()))
            .collect();
        mesh.uvs = Some(Attribute {
            values,
            indices: mesh.triangles.clone(),
        });
    }
    Ok(mesh)
}

fn material(bytes: &mut Bytes<'_>, b: &mut Builder) -> Material {
    let mut material = Material {
        diffuse: Term::color(bytes.color()),
        ..b.material().clone()
    };
    match bytes.below(8) {
        0 => material.ambient = Term::color(bytes.color()),
        1 => material.emission = Term::color(bytes.color()),
        2 => {
            material.specular = Term::color(bytes.color());
            material.shininess = bytes.positive() * 16.0;
        }
        3 => material.reflection = Some(Term::color(bytes.color())),
        4 | 5 => {
            material.transmission = Term::color(bytes.color());
            material.ior = bytes.positive() + 0.5;
        }
        6 => {
            let texture = texture(bytes);
            material.diffuse = Term::texture(b.texture(&Arc::new(texture)));
        }
        _ => {}
    }
    material
}

fn texture(bytes: &mut Bytes<'_>) -> Texture {
    let (width, height) = (1 + bytes.below(3) as u32, 1 + bytes.below(3) as u32);
    let texels = (0..width * height).map(|_| [bytes.byte(), bytes.byte(), bytes.byte()]);
    Texture::Image(ImageTexture {
        name: "picture".to_owned(),
        width,
        height,
        texels: Texels::Srgb8(texels.collect()),
    })
}
