//! Why no light is to be seen.

use std::collections::BTreeMap;

use super::{World, called, placed};
use crate::{
    diag::{Code, Diagnostic},
    math::{DVec3, Ray, brief, max_abs},
    render::{
        film::Image,
        lighting,
        world::{Hit, Probe, SurfacePoint},
    },
    scene::{Light, LightKind, Object},
};

/// Points of the picture that are asked, in each direction.
const GRID: u32 = 16;

/// What keeps the light from the points that were asked, each counted once for each light.
#[derive(Default)]
struct Causes<'s> {
    /// The surface answers no light: its diffuse, specular and mirror terms are black.
    black: usize,
    /// The surface is turned away from the light.
    away: usize,
    /// The point lies where the light does not shine, by what is to be said of lights of its kind.
    beside: BTreeMap<Beside, usize>,
    /// The light is linked to other groups.
    unlinked: usize,
    /// Something stands in between, by the place of the call that made it.
    blocked: BTreeMap<(u16, u32, u16), (usize, &'s Object)>,
    /// Nothing does.
    weak: usize,
}

/// Where a light does not shine.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Beside {
    Cone,
    Picture,
    Front,
}

impl Beside {
    fn of(light: &LightKind) -> Self {
        match light {
            LightKind::Spot(_) => Self::Cone,
            LightKind::Projector(_) => Self::Picture,
            _ => Self::Front,
        }
    }

    /// What is in view lies there, and what to do.
    fn words(self, lights: &str) -> (String, &'static str) {
        match self {
            Self::Cone => (
                format!("all that is in view lies outside of the cone of {lights}"),
                "move the spot's target, or make its angle larger: it is measured from the axis to the edge",
            ),
            Self::Picture => (
                format!("all that is in view lies beside the picture of {lights}, or where that is black"),
                "move the projector's target, or make its fovy larger",
            ),
            Self::Front => (
                format!("all that is in view lies behind {lights}, which shines to its front alone"),
                "turn the light around",
            ),
        }
    }
}

/// Why the picture shows nothing; `None` where it shows what it should.
pub(super) fn why(world: &World<'_>, image: &Image) -> Option<Diagnostic> {
    let scene = world.scene;
    let s = &scene.settings;
    let frame = scene.camera.frame(s.width, s.height);
    let region = s.region();
    let points = (0..GRID * GRID).filter_map(|i| {
        let along = |i: u32, from: u32, size: u32| {
            f64::from(from) + (f64::from(i) + 0.5) / f64::from(GRID) * f64::from(size)
        };
        frame.ray(
            along(i % GRID, region.x, region.width),
            along(i / GRID, region.y, region.height),
        )
    });
    let met: Vec<(Hit, Ray)> = points
        .filter_map(|ray| Some((world.nearest(&Probe::from_space(ray), f64::INFINITY)?, ray)))
        .collect();
    let background = scene.settings.background.to_array();
    if met.is_empty() && image.pixels().first() == Some(&background) {
        return Some(
            Diagnostic::warning(
                Code::OutOfView,
                "the picture shows nothing but the background: no ray of the camera meets anything",
            )
            .note(format!(
                "the camera stands at {} and looks at {}",
                brief(scene.camera.eye),
                brief(scene.camera.at)
            ))
            .hint("camera(from, at, up, fovy) says where it stands and what it looks at"),
        );
    }
    if met.is_empty() || !image.is_black() {
        return None;
    }
    let brightest = image.pixels().iter().flatten().fold(0.0, |a: f64, b| a.max(*b));
    cause(world, &met, Some(brightest))
}

/// What keeps the light from the points that rays met; `None` where there is no light, which the scene itself is
/// warned of. `brightest` is the largest value of a pixel, where the
/// picture is there.
pub(super) fn cause(world: &World<'_>, met: &[(Hit, Ray)], brightest: Option<f64>) -> Option<Diagnostic> {
    let mut causes = Causes::default();
    for (hit, ray) in met {
        if let Some(at) = world.surface(hit, ray) {
            for (index, light) in world.scene.root().lights.iter().enumerate() {
                causes.ask(world, hit, &at, (index, light));
            }
        }
    }
    causes.told(world, brightest)
}

impl<'s> Causes<'s> {
    /// Counts why a light does not light a point, or does so too weakly.
    fn ask(&mut self, world: &World<'s>, hit: &Hit, at: &SurfacePoint<'_>, (index, light): (usize, &Light)) {
        if light.color == DVec3::ZERO {
            return;
        }
        let m = at.material;
        if m.diffuse.is_black() && m.specular.is_black() {
            self.black += 1;
            return;
        }
        let towards = light.kind.towards(at.position);
        if !(towards.dot(at.shading_normal) > 0.0) {
            self.away += 1;
            return;
        }
        if !lighting::shines_at(world, index, at.position) {
            *self.beside.entry(Beside::of(&light.kind)).or_default() += 1;
            return;
        }
        let path = world.places_of(hit.number);
        if !light
            .links
            .reaches(|id| path.iter().any(|(group, _)| *group == id))
        {
            self.unlinked += 1;
            return;
        }
        let distance = match light.kind.center() {
            None => f64::INFINITY,
            Some(_) => towards.length(),
        };
        let ray = Ray::new(at.position, towards / towards.length());
        let probe = Probe::from_surface(ray, hit.number, at.scale.max(max_abs(at.position)));
        let blocker = world.nearest(&probe, distance);
        match blocker.and_then(|blocker| world.objects_of(blocker.number).last().copied()) {
            Some(object) => {
                let loc = object.loc;
                let count = self.blocked.entry((loc.file, loc.line, loc.column));
                count.or_insert((0, object)).0 += 1;
            }
            None => self.weak += 1,
        }
    }

    /// The cause that counts most, in a sentence.
    fn told(&self, world: &World<'_>, brightest: Option<f64>) -> Option<Diagnostic> {
        let scene = world.scene;
        let black = |why: String| Diagnostic::warning(Code::Unlit, format!("no light is to be seen: {why}"));
        let lights = if scene.root().lights.len() == 1 {
            "the light"
        } else {
            "every light"
        };
        let blocker = self.blocked.values().max_by_key(|(count, _)| *count);
        let blocked = blocker.map_or(0, |(count, _)| *count);
        let beside = self.beside.iter().max_by_key(|(_, count)| **count);
        let aside = beside.map_or(0, |(_, count)| *count);
        let counts = [self.black, self.away, blocked, self.weak, aside, self.unlinked];
        let most = counts.into_iter().max().unwrap_or(0);
        if let Some((beside, _)) = beside.filter(|_| most == aside) {
            let (why, hint) = beside.words(lights);
            return Some(black(why).hint(hint));
        }
        Some(match blocker {
            _ if most == 0 => return None,
            Some((_, object)) if most == blocked => {
                let what = called(scene, object);
                let d = black(format!("{what} stands between {lights} and what is in view"));
                placed(scene, d, object.loc)
                    .hint("move the light or what stands in its way; a shade around a light needs a transmission(...)")
            }
            _ if most == self.weak => black(match brightest {
                Some(brightest) => format!(
                    "the light that arrives is too weak; the brightest pixel has a value of {brightest:.1e}, where white has 1"
                ),
                None => "the light that arrives is too weak".to_owned(),
            })
            .hint("make the light's color larger, or its attenuation smaller: a light of color [1, 1, 1] at distance d is divided by attenuation's c + l d + q d^2"),
            _ if most == self.unlinked => {
                black(format!("{lights} does not reach the groups that are in view"))
                    .hint("lightLinking(#{ }) before a light makes it reach everything")
            }
            _ if most == self.away => black(format!("all that is in view is turned away from {lights}"))
                .hint("put the light on the side of the camera"),
            _ => black("the materials in view answer no light: their diffuse and specular are black".to_owned())
                .hint("diffuse(0.8, 0.8, 0.8) before the shapes"),
        })
    }
}
