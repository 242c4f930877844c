//! The renderer against a second one, written straight from the rules of the CSE167 homework: no tree, no
//! transformations, no instances, a fixed offset along the new ray. Scenes like the course's hard ones (a
//! thousand spheres, a mirrored room, a curved mesh) must agree within 2/255 on 99.95 % of pixels.

#![allow(clippy::unwrap_used, clippy::indexing_slicing)]

use rtscript::{
    Builder, DVec3, NoHost, RenderOptions, Term, render,
    scene::{Attenuation, Camera, Encoding},
};

#[derive(Clone, Copy)]
enum Thing {
    Sphere(DVec3, f64),
    Triangle([DVec3; 3]),
}

#[derive(Clone, Copy)]
struct Look {
    ambient: DVec3,
    diffuse: DVec3,
    specular: DVec3,
    shininess: f64,
}

#[derive(Clone, Copy)]
enum Lamp {
    Point(DVec3, DVec3),
    Directional(DVec3, DVec3),
}

struct Rules {
    camera: Camera,
    things: Vec<(Thing, Look)>,
    lamps: Vec<Lamp>,
    attenuation: Attenuation,
}

/// Offset along the new ray, in the middle of the range the course's pictures allow.
const OFFSET: f64 = 1e-6;
const SIZE: (u32, u32) = (160, 120);

impl Rules {
    fn nearest(&self, o: DVec3, d: DVec3) -> Option<(f64, usize)> {
        let mut best: Option<(f64, usize)> = None;
        for (i, (thing, _)) in self.things.iter().enumerate() {
            let t = match *thing {
                Thing::Sphere(c, r) => {
                    let (f, a) = (o - c, d.dot(d));
                    let (b, c) = (2.0 * f.dot(d), f.dot(f) - r * r);
                    let root = b * b - 4.0 * a * c;
                    if root < 0.0 {
                        continue;
                    }
                    let (t0, t1) = ((-b - root.sqrt()) / (2.0 * a), (-b + root.sqrt()) / (2.0 * a));
                    if t0 > 0.0 { t0 } else { t1 }
                }
                Thing::Triangle([a, b, c]) => {
                    let n = (b - a).cross(c - a);
                    let t = (a - o).dot(n) / d.dot(n);
                    let p = o + d * t;
                    let inside = |u: DVec3, v: DVec3| (v - u).cross(p - u).dot(n) >= 0.0;
                    if !(inside(a, b) && inside(b, c) && inside(c, a)) {
                        continue;
                    }
                    t
                }
            };
            if t > 0.0 && best.is_none_or(|(nearest, _)| t < nearest) {
                best = Some((t, i));
            }
        }
        best
    }

    fn color(&self, o: DVec3, d: DVec3, depth: u32) -> DVec3 {
        let Some((t, i)) = self.nearest(o, d) else {
            return DVec3::ZERO;
        };
        let (thing, look) = self.things[i];
        let p = o + d * t;
        let n = match thing {
            Thing::Sphere(c, _) => (p - c).normalize(),
            Thing::Triangle([a, b, c]) => (b - a).cross(c - a).normalize(),
        };
        let n = if n.dot(d) > 0.0 { -n } else { n };
        let mut sum = look.ambient;
        for lamp in &self.lamps {
            let (l, distance, light) = match *lamp {
                Lamp::Directional(towards, light) => (towards.normalize(), f64::INFINITY, light),
                Lamp::Point(q, light) => {
                    let distance = (q - p).length();
                    (
                        (q - p) / distance,
                        distance,
                        light * self.attenuation.at(distance),
                    )
                }
            };
            let blocked = self
                .nearest(p + l * OFFSET, l)
                .is_some_and(|(t, _)| t < distance - OFFSET);
            if !blocked {
                let h = (l - d).normalize();
                let highlight = rtscript::math::pow(n.dot(h).max(0.0), look.shininess);
                sum += light * (look.diffuse * n.dot(l).max(0.0) + look.specular * highlight);
            }
        }
        if depth > 0 && look.specular != DVec3::ZERO {
            let r = (d - n * (2.0 * d.dot(n))).normalize();
            sum += look.specular * self.color(p + r * OFFSET, r, depth - 1);
        }
        sum
    }

    fn picture(&self) -> Vec<u8> {
        let frame = self.camera.frame(SIZE.0, SIZE.1);
        (0..SIZE.0 * SIZE.1)
            .flat_map(|i| {
                let ray = frame
                    .ray(f64::from(i % SIZE.0) + 0.5, f64::from(i / SIZE.0) + 0.5)
                    .unwrap();
                self.color(ray.origin, ray.dir, 5)
                    .to_array()
                    .map(|v| (v.clamp(0.0, 1.0) * 255.0) as u8)
            })
            .collect()
    }

    /// The same scene for rtscript, each thing under a matrix that it must undo.
    fn scene(&self) -> rtscript::Scene {
        let mut b = Builder::new();
        b.size(SIZE.0, SIZE.1).unwrap();
        b.encoding(Encoding::Raw);
        b.camera(self.camera);
        b.attenuation(self.attenuation).unwrap();
        for lamp in &self.lamps {
            match *lamp {
                Lamp::Point(p, c) => b.point(p, c).unwrap(),
                Lamp::Directional(d, c) => b.directional(d, c).unwrap(),
            }
        }
        for (i, (thing, look)) in self.things.iter().enumerate() {
            let m = b.material_mut();
            m.ambient = Term::color(look.ambient);
            m.diffuse = Term::color(look.diffuse);
            m.specular = Term::color(look.specular);
            m.shininess = look.shininess;
            b.push_transform().unwrap();
            match *thing {
                Thing::Sphere(c, r) => {
                    b.translate(c).unwrap();
                    b.rotate(DVec3::new(1.0, 0.3, 0.2), 10.0 * i as f64).unwrap();
                    b.scale(DVec3::new(r, r, r)).unwrap();
                    b.sphere(DVec3::ZERO, 1.0).unwrap();
                }
                Thing::Triangle(corners) => {
                    b.rotate(DVec3::Y, 90.0).unwrap();
                    let back = b.current_transform().inverse();
                    b.triangle(corners.map(|p| back.transform_point3(p)), None)
                        .unwrap();
                }
            }
            b.pop_transform().unwrap();
        }
        b.finish().value
    }

    fn check(&self, what: &str) {
        let wanted = self.picture();
        let got = render(&self.scene(), &RenderOptions::default(), &NoHost)
            .unwrap()
            .value
            .image
            .rgb8();
        let far = wanted
            .chunks(3)
            .zip(got.chunks(3))
            .filter(|(a, b)| a.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2));
        let (far, pixels) = (far.count(), wanted.len() / 3);
        let lit = wanted.iter().filter(|v| **v > 30).count();
        assert!(
            lit > wanted.len() / 4,
            "{what}: the picture is too dark to say anything ({lit})"
        );
        assert!(
            far as f64 <= 0.0005 * pixels as f64,
            "{what}: {far} of {pixels} pixels are off by more than 2/255"
        );
    }
}

/// A small generator, so that the scenes are the same everywhere.
fn random() -> impl FnMut() -> f64 {
    let mut state = 42u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    }
}

fn quad(corners: [DVec3; 4], look: Look, things: &mut Vec<(Thing, Look)>) {
    let [a, b, c, d] = corners;
    things.push((Thing::Triangle([a, b, c]), look));
    things.push((Thing::Triangle([a, c, d]), look));
}

#[test]
fn a_thousand_spheres() {
    let mut next = random();
    let mut things = Vec::new();
    for _ in 0..1000 {
        let center = DVec3::new(next() - 0.5, next() - 0.5, next() - 0.5) * 40.0;
        let look = Look {
            ambient: DVec3::splat(0.05),
            diffuse: DVec3::new(next(), next(), next()) * 0.7,
            specular: DVec3::splat(0.4),
            shininess: 20.0,
        };
        things.push((Thing::Sphere(center, 0.6 + 1.2 * next()), look));
    }
    let lamps = vec![
        Lamp::Point(DVec3::new(30.0, 40.0, 50.0), DVec3::splat(0.7)),
        Lamp::Directional(DVec3::new(-1.0, 1.0, 1.0), DVec3::splat(0.5)),
    ];
    let camera = Camera::new(DVec3::new(0.0, 0.0, 70.0), DVec3::ZERO, DVec3::Y, 35.0).unwrap();
    Rules {
        camera,
        things,
        lamps,
        attenuation: Attenuation::default(),
    }
    .check("a thousand spheres");
}

#[test]
fn a_mirrored_room() {
    let mut things = Vec::new();
    let look = |r: f64, g: f64, b: f64, mirror: f64| Look {
        ambient: DVec3::splat(0.02),
        diffuse: DVec3::new(r, g, b),
        specular: DVec3::splat(mirror),
        shininess: 50.0,
    };
    let p = |x: f64, y: f64, z: f64| DVec3::new(x, y, z) * 3.0;
    let walls = [
        [p(-1., -1., -1.), p(1., -1., -1.), p(1., -1., 1.), p(-1., -1., 1.)],
        [p(-1., 1., -1.), p(-1., 1., 1.), p(1., 1., 1.), p(1., 1., -1.)],
        [p(-1., -1., -1.), p(-1., 1., -1.), p(1., 1., -1.), p(1., -1., -1.)],
        [p(-1., -1., -1.), p(-1., -1., 1.), p(-1., 1., 1.), p(-1., 1., -1.)],
        [p(1., -1., -1.), p(1., 1., -1.), p(1., 1., 1.), p(1., -1., 1.)],
        [p(-1., -1., 1.), p(1., -1., 1.), p(1., 1., 1.), p(-1., 1., 1.)],
    ];
    for (i, wall) in walls.into_iter().enumerate() {
        let hue = i as f64 / 6.0;
        quad(
            wall,
            look(0.3 + 0.5 * hue, 0.6, 0.8 - 0.5 * hue, 0.35),
            &mut things,
        );
    }
    things.push((
        Thing::Sphere(DVec3::new(-1.0, -2.0, 0.0), 1.0),
        look(0.2, 0.2, 0.2, 0.8),
    ));
    things.push((
        Thing::Sphere(DVec3::new(1.2, -2.3, 0.8), 0.7),
        look(0.8, 0.3, 0.2, 0.3),
    ));
    things.push((
        Thing::Sphere(DVec3::new(0.4, 0.3, -1.0), 0.8),
        look(0.1, 0.5, 0.3, 0.5),
    ));
    let camera = Camera::new(
        DVec3::new(0.3, 0.2, 2.7),
        DVec3::new(0.0, -0.4, 0.0),
        DVec3::Y,
        70.0,
    )
    .unwrap();
    let lamps = vec![Lamp::Point(DVec3::new(0.5, 2.6, 1.0), DVec3::ONE)];
    let attenuation = Attenuation {
        constant: 1.0,
        linear: 0.1,
        quadratic: 0.05,
    };
    Rules {
        camera,
        things,
        lamps,
        attenuation,
    }
    .check("a mirrored room");
}

#[test]
fn a_curved_mesh() {
    let at = |u: usize, v: usize| {
        let (a, b) = (u as f64 * 360.0 / 48.0, v as f64 * 360.0 / 24.0);
        let ((sa, ca), (sb, cb)) = (
            rtscript::math::sin_cos_degrees(a),
            rtscript::math::sin_cos_degrees(b + 20.0 * (u % 3) as f64),
        );
        DVec3::new((2.0 + 0.8 * cb) * ca, 0.8 * sb + 0.3 * ca, (2.0 + 0.8 * cb) * sa)
    };
    let look = Look {
        ambient: DVec3::new(0.1, 0.1, 0.05),
        diffuse: DVec3::new(0.3, 0.5, 0.6),
        specular: DVec3::splat(0.3),
        shininess: 30.0,
    };
    let mut things = Vec::new();
    for u in 0..48 {
        for v in 0..24 {
            quad(
                [at(u, v), at(u, v + 1), at(u + 1, v + 1), at(u + 1, v)],
                look,
                &mut things,
            );
        }
    }
    quad(
        [[-9., -1.5, 9.], [9., -1.5, 9.], [9., -1.5, -9.], [-9., -1.5, -9.]].map(DVec3::from),
        look,
        &mut things,
    );
    let lamps = vec![
        Lamp::Point(DVec3::new(3.0, 6.0, 4.0), DVec3::splat(0.8)),
        Lamp::Directional(DVec3::new(-1.0, 2.0, 0.5), DVec3::splat(0.4)),
    ];
    let camera = Camera::new(DVec3::new(0.0, 4.0, 6.0), DVec3::ZERO, DVec3::Y, 45.0).unwrap();
    Rules {
        camera,
        things,
        lamps,
        attenuation: Attenuation::default(),
    }
    .check("a curved mesh");
}
