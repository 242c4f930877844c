//! Shapes, textures and answers to light of a program's own: a gyroid carved out of a ball, in three steps of light, on
//! a mirroring floor of rings, beside a ball of glass.
//!
//! `cargo run --release --example custom -- picture.png`

#![allow(clippy::print_stdout, reason = "a program may print")]

use std::{error::Error, path::Path, sync::Arc};

use rtscript::{
    Builder, DVec3, NoHost, RenderOptions, Term,
    math::{Bounds3, DVec2, Ray, cos, sin},
    output, render,
    scene::{Camera, CustomReflectance, CustomTexture, Material, ShadingPoint, Texture},
    shape::{CrossingSink, CustomShape, Disk, Shape, Surface},
};

/// The part of a ball of radius 1 where |sin x cos y + sin y cos z + sin z cos x| <= `thickness`, coordinates times
/// `frequency` (Schoen, "Infinite periodic minimal surfaces without self-intersections", NASA TN D-5541, 1970).
#[derive(Debug)]
struct Gyroid {
    frequency: f64,
    thickness: f64,
}

impl Gyroid {
    /// Below 0 inside, with its gradient.
    fn wall(&self, p: DVec3) -> (f64, DVec3) {
        let q = p * self.frequency;
        let [sx, sy, sz] = q.to_array().map(sin);
        let [cx, cy, cz] = q.to_array().map(cos);
        let value = sx * cy + sy * cz + sz * cx;
        let gradient = DVec3::new(cx * cy - sz * sx, cy * cz - sx * sy, cz * cx - sy * sz) * self.frequency;
        (value.abs() - self.thickness, gradient * value.signum())
    }

    /// Below 0 inside: of the walls and of the ball, whichever ends first.
    fn value(&self, p: DVec3) -> f64 {
        self.wall(p).0.max(p.length() - 1.0)
    }
}

impl CustomShape for Gyroid {
    fn name(&self) -> &'static str {
        "gyroid"
    }

    fn bounds(&self) -> Option<Bounds3> {
        Some(Bounds3::new(DVec3::NEG_ONE, DVec3::ONE))
    }

    fn is_solid(&self) -> bool {
        true
    }

    // Steps along the line's part in the ball, each root made exact by bisection. The part of the surface is told by
    // number: 0 a wall, 1 the ball.
    fn crossings(&self, ray: &Ray, out: &mut dyn CrossingSink) {
        let length = ray.dir.length();
        let nearest = -ray.origin.dot(ray.dir) / (length * length);
        let closest = ray.at(nearest).length();
        if !(closest < 1.0) {
            return;
        }
        let half = (1.0 - closest * closest).sqrt() / length * (1.0 + 1e-9);
        let steps = (24.0 * self.frequency * half * length).ceil().clamp(8.0, 4096.0);
        let at = |i: f64| nearest + half * (2.0 * i / steps - 1.0);
        let is_inside = |t: f64| self.value(ray.at(t)) < 0.0;
        let mut i = 0.0;
        while i < steps {
            let (mut low, mut high) = (at(i), at(i + 1.0));
            let entering = !is_inside(low);
            if entering == is_inside(high) {
                for _ in 0..48 {
                    let middle = 0.5 * (low + high);
                    if is_inside(middle) == entering {
                        high = middle;
                    } else {
                        low = middle;
                    }
                }
                let p = ray.at(high);
                out.push(high, u32::from(p.length() - 1.0 > self.wall(p).0));
            }
            i += 1.0;
        }
    }

    fn surface(&self, p: DVec3, part: u32) -> Surface {
        Surface {
            normal: if part == 1 { p } else { self.wall(p).1 },
            uv: DVec2::ZERO,
        }
    }
}

/// Rings around the origin of the object.
#[derive(Debug)]
struct Rings {
    width: f64,
}

impl CustomTexture for Rings {
    fn color(&self, _uv: DVec2, p: DVec3) -> DVec3 {
        let ring = (DVec2::new(p.x, p.z).length() / self.width).floor();
        if ring.rem_euclid(2.0) == 0.0 {
            DVec3::new(0.95, 0.85, 0.6)
        } else {
            DVec3::new(0.15, 0.3, 0.4)
        }
    }
}

/// Light in steps, as in a drawing.
#[derive(Debug)]
struct Toon {
    steps: f64,
}

impl CustomReflectance for Toon {
    fn response(&self, at: &ShadingPoint, to_light: DVec3) -> DVec3 {
        let cosine = at.normal.dot(to_light).max(0.0);
        at.diffuse * ((cosine * self.steps).ceil() / self.steps)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut b = Builder::new();
    b.size(320, 240)?;
    b.samples(4)?;
    b.background(DVec3::new(0.35, 0.45, 0.6))?;
    b.camera(Camera::new(
        DVec3::new(0.0, 1.9, 6.0),
        DVec3::new(0.0, 0.1, 0.0),
        DVec3::Y,
        36.0,
    )?);
    b.directional(DVec3::new(-1.0, 2.0, 1.5), DVec3::splat(0.8))?;

    let rings = b.texture(&Arc::new(Texture::custom(Rings { width: 0.4 })));
    b.material_mut().diffuse = Term::texture(rings);
    b.material_mut().reflection = Some(Term::color(DVec3::splat(0.25)));
    b.push_transform()?;
    b.translate(DVec3::new(0.0, -1.0, 0.0))?;
    b.shape(Shape::Disk(Disk::new(3.2)?))?;
    b.pop_transform()?;

    let mut drawn = b.material().clone().with_reflectance(Toon { steps: 3.0 });
    drawn.diffuse = Term::color(DVec3::new(0.9, 0.35, 0.25));
    drawn.reflection = Some(Term::BLACK);
    b.set_material(drawn);
    b.push_transform()?;
    b.translate(DVec3::new(-0.9, 0.0, 0.0))?;
    b.rotate(DVec3::Y, 25.0)?;
    b.shape(Shape::custom(Gyroid {
        frequency: 7.0,
        thickness: 0.45,
    }))?;
    b.pop_transform()?;

    let glass = Material {
        ambient: Term::BLACK,
        specular: Term::color(DVec3::splat(0.3)),
        shininess: 200.0,
        reflection: Some(Term::color(DVec3::splat(0.08))),
        transmission: Term::color(DVec3::new(0.9, 0.95, 0.95)),
        ..Material::default()
    };
    b.set_material(glass);
    b.sphere(DVec3::new(1.1, -0.1, 0.9), 0.9)?;

    let scene = b.finish().value;
    let rendered = render(&scene, &RenderOptions::default(), &NoHost)?;
    let picture = std::env::args().nth(1);
    output::save(
        Path::new(picture.as_deref().unwrap_or("custom.png")),
        &rendered.value.image,
    )?;
    println!("{}", rendered.value.image.hash());
    Ok(())
}
