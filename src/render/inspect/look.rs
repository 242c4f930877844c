//! A coarse look through the camera, which follows every ray as a render does.

use std::collections::{BTreeMap, BTreeSet};

use super::{World, called, dark, placed, view};
use crate::{
    color::Color,
    diag::{Code, Diagnostic, Error},
    host::Host,
    math::{Bounds3, DVec2, DVec3, Ray},
    render::{
        by_rows,
        integrator::{self, Counts, Sight, Stack},
        invalid_samples,
        lighting::Lit,
        observe::{Arrived, Observer},
        shots::Shots,
        world::{Hit, Moments, Probe, SurfacePoint},
    },
    scene::{Geometry, GroupId, Light, Object, ROOT_GROUP},
};

/// Rays of the look along each side of the picture, at most.
const RAYS: u32 = 160;
/// Warnings of one kind, at most.
const MOST: usize = 10;
/// Objects of a line of which each is looked for by rays of its own, at most.
const SEARCHED: usize = 32;
/// Rays that look for an object, along each side.
const SEARCH: u32 = 24;
/// Points that are asked why no light reaches them, at most.
const ASKED: usize = 256;
/// Points that two surfaces must share before they are told of.
const SHARED: usize = 3;

/// A line of a file: number of the file, then of the line.
type Line = (u16, u32);
/// Two places of calls.
type Pair = (Line, Line);

/// What the rays of a look met.
#[derive(Default)]
struct Met<'s> {
    lines: BTreeSet<Line>,
    shared: BTreeMap<Pair, (usize, [&'s Object; 2])>,
    /// What the rays of the camera met.
    first: Vec<(Hit, Ray)>,
    /// Samples that were no finite numbers.
    invalid: u64,
    /// Light from a light was seen.
    is_lit: bool,
}

/// Warnings of a look at what the camera sees.
///
/// # Errors
/// `Cancelled` where the host asks to stop.
pub(super) fn look(world: &World<'_>, host: &dyn Host) -> Result<Vec<Diagnostic>, Error> {
    let s = &world.scene.settings;
    if world.scene.root().objects.is_empty() {
        return Ok(Vec::new());
    }
    let shots = Shots::into_world(world, s);
    let (width, height) = (s.region().width, s.region().height);
    let step = width.div_ceil(RAYS).max(height.div_ceil(RAYS)).max(1);
    let size = (width.div_ceil(step), height.div_ceil(step));
    let met = by_rows(size, host, |x, y, interrupt| {
        let pixel = (
            (x * step + step / 2).min(width - 1),
            (y * step + step / 2).min(height - 1),
        );
        let shot = shots.shot(pixel, 0);
        let Some(probe) = shot.probe else {
            return Met::default();
        };
        let mut moments = Moments::new(world);
        let world = moments.at(&shot);
        let mut eye = Eye {
            world,
            met: Met::default(),
        };
        let first = world.nearest(&probe, f64::INFINITY);
        if let Some(hit) = &first {
            eye.share(hit, &probe.ray);
            eye.met.first.push((*hit, probe.ray));
        }
        let mut counts = Counts::default();
        integrator::radiance(
            world,
            Sight::met(&probe, first),
            shot.sampler,
            interrupt,
            &mut Stack::default(),
            &mut counts,
            &mut eye,
        );
        eye.met.invalid = counts.invalid;
        eye.met
    })?;
    let mut all = Met::default();
    for met in met {
        all.lines.extend(met.lines);
        all.first.extend(met.first);
        all.is_lit |= met.is_lit;
        all.invalid += met.invalid;
        for (pair, (count, objects)) in met.shared {
            all.shared.entry(pair).or_insert((0, objects)).0 += count;
        }
    }
    let mut warnings = Vec::new();
    let glows = |light: &Light| light.color != Color::ZERO;
    if !all.is_lit && !all.first.is_empty() && world.scene.root().lights.iter().any(glows) {
        let sparse: Vec<_> = all
            .first
            .iter()
            .step_by(1 + all.first.len() / ASKED)
            .copied()
            .collect();
        warnings.extend(dark::cause(world, &sparse, None));
    }
    warnings.extend(invalid_samples(all.invalid));
    warnings.extend(coincident(world, &all));
    warnings.extend(unseen(world, &all.lines));
    Ok(warnings)
}

/// Notes what rays meet.
struct Eye<'w, 's> {
    world: &'w World<'s>,
    met: Met<'s>,
}

impl Eye<'_, '_> {
    /// Notes another surface in the place of a hit, where both are opaque and look different.
    fn share(&mut self, hit: &Hit, ray: &Ray) {
        let Some(at) = self.world.surface(hit, ray) else {
            return;
        };
        let Some((other, behind)) = self.world.touching(hit, ray, &at) else {
            return;
        };
        let Some(beside) = self.world.surface(&other, &behind) else {
            return;
        };
        let look_alike = at.material == beside.material;
        let are_opaque = at.material.is_opaque() && beside.material.is_opaque();
        let lie_flat = at.geometric_normal.dot(beside.geometric_normal).abs() > 0.999;
        if look_alike || !are_opaque || !lie_flat {
            return;
        }
        let objects = [hit.number, other.number].map(|n| self.world.objects_of(n).last().copied());
        let [Some(a), Some(b)] = objects else { return };
        if line(a) != line(b) {
            let mut pair = [a, b];
            pair.sort_by_key(|object| line(object));
            let key = (line(pair[0]), line(pair[1]));
            self.met.shared.entry(key).or_insert((0, pair)).0 += 1;
        }
    }
}

impl Observer for Eye<'_, '_> {
    fn arrived(&mut self, _: &Lit<'_>, light: &Arrived<'_>) {
        self.met.is_lit |= light.added != Color::ZERO;
    }

    fn surface(&mut self, hit: &Hit, _: &Ray, _: &SurfacePoint<'_>) {
        let objects = self.world.objects_of(hit.number);
        self.met.lines.extend(objects.into_iter().map(line));
    }
}

fn line(object: &Object) -> Line {
    (object.loc.file, object.loc.line)
}

fn coincident(world: &World<'_>, met: &Met<'_>) -> Vec<Diagnostic> {
    let scene = world.scene;
    let shared = met.shared.values().filter(|(count, _)| *count >= SHARED);
    let told = shared.map(|(_, [a, b])| {
        let (first, second) = (called(scene, a), called(scene, b));
        let message = format!("{second} has a face in the very place of a face of {first}");
        let d = Diagnostic::warning(Code::CoincidentFaces, message)
            .note("rounding decides at each point which of the two is seen")
            .hint("move one of them by a little, or let it reach into the other");
        placed(scene, d, b.loc)
    });
    told.take(MOST).collect()
}

/// Warnings about lines all of whose shapes no ray met.
fn unseen(world: &World<'_>, met: &BTreeSet<Line>) -> Vec<Diagnostic> {
    let scene = world.scene;
    let mut lines: BTreeMap<Line, Vec<(GroupId, u32)>> = BTreeMap::new();
    for (group, number) in scene.groups.iter().zip(0..) {
        for (object, index) in group.objects.iter().zip(0..) {
            if object.loc.line > 0 && !met.contains(&line(object)) {
                lines
                    .entry(line(object))
                    .or_default()
                    .push((GroupId(number), index));
            }
        }
    }
    let warnings = lines.values().filter_map(|places| {
        let objects: Vec<&Object> = places
            .iter()
            .filter_map(|(group, index)| scene.groups.get(group.index())?.objects.get(*index as usize))
            .collect();
        let first = *objects.first()?;
        let why = if places.iter().all(|(group, _)| *group == ROOT_GROUP) {
            why_unseen(world, &objects)?
        } else if places.iter().all(|(group, _)| !is_placed(world, *group)) {
            "no instance(...) places the group that it is in".to_owned()
        } else {
            return None;
        };
        let what = called(scene, first);
        let others = match objects.len() - 1 {
            0 => String::new(),
            n => format!(" and {n} more"),
        };
        let d = Diagnostic::warning(Code::UnseenShape, format!("no ray meets {what}{others}")).note(why);
        Some(placed(scene, d, first.loc))
    });
    warnings.take(MOST).collect()
}

/// Whether anything that is seen leads to a group.
fn is_placed(world: &World<'_>, group: GroupId) -> bool {
    let scene = world.scene;
    let mut reached = vec![false; scene.groups.len()];
    // A group comes before those that place it, but for the root, which is the first.
    let order = std::iter::once(0).chain((1..scene.groups.len()).rev());
    for i in order {
        if i != ROOT_GROUP.index() && reached.get(i) != Some(&true) {
            continue;
        }
        for object in scene.groups.get(i).into_iter().flat_map(|group| &group.objects) {
            if let Some(inner) = object.geometry.group()
                && let Some(inner) = reached.get_mut(inner.index())
            {
                *inner = true;
            }
        }
    }
    group == ROOT_GROUP || reached.get(group.index()).copied().unwrap_or(false)
}

/// Why no ray met any of these objects of the root; `None` where one does after all, or nothing certain can be said.
fn why_unseen(world: &World<'_>, objects: &[&Object]) -> Option<String> {
    let scene = world.scene;
    if objects.len() > SEARCHED {
        return None;
    }
    let bounds: Option<Vec<Bounds3>> = objects.iter().map(|object| bounds(world, object)).collect();
    let bounds = bounds?;
    let mut sides = bounds.iter().map(|bounds| view::side(scene, bounds));
    if let Some(Some(side)) = sides.next()
        && sides.all(|other| other == Some(side))
    {
        return Some(format!("it lies {side}"));
    }
    let mut hiders: BTreeMap<Line, (usize, &Object)> = BTreeMap::new();
    for (object, bounds) in objects.iter().zip(&bounds) {
        for ray in rays_towards(world, bounds) {
            let Some(hit) = world.nearest(&Probe::from_space(ray), f64::INFINITY) else {
                continue;
            };
            let seen = *world.objects_of(hit.number).first()?;
            if std::ptr::eq(seen, *object) {
                return None;
            }
            hiders.entry(line(seen)).or_insert((0, seen)).0 += 1;
        }
    }
    let hider = hiders.values().max_by_key(|(count, _)| *count);
    Some(match hider {
        Some((_, hider)) => format!("{} hides it", called(scene, hider)),
        None => "it is smaller than the distance between two rays, or outside of the view".to_owned(),
    })
}

/// A box around an object of the root; `None` where it has no end or is an instance.
fn bounds(world: &World<'_>, object: &Object) -> Option<Bounds3> {
    let scene = world.scene;
    let around = match &object.geometry {
        Geometry::Shape(shape) => shape.bounds()?,
        Geometry::Triangle(id) => Bounds3::around(scene.triangles.get(id.index())?.positions),
        Geometry::Mesh(id) => scene.meshes.get(id.index())?.bounds(),
        Geometry::Instance(_) | Geometry::Csg(..) | Geometry::Moving(_) => return None,
    };
    Some(around.transformed(&scene.world_from_object(object)))
}

/// Rays of the camera through the part of the picture that a box may be seen in.
fn rays_towards(world: &World<'_>, bounds: &Bounds3) -> Vec<Ray> {
    let s = &world.scene.settings;
    let frame = world.scene.camera.frame(s.width, s.height);
    let region = s.region();
    let low = DVec2::new(f64::from(region.x), f64::from(region.y));
    let high = low + DVec2::new(f64::from(region.width), f64::from(region.height));
    let mut from = DVec2::INFINITY;
    let mut to = DVec2::NEG_INFINITY;
    let corners: [DVec3; 8] = bounds.corners();
    for (i, a) in corners.iter().enumerate() {
        for b in corners.iter().skip(i) {
            for end in frame.project(*a, *b).into_iter().flatten() {
                from = from.min(DVec2::from_array(end));
                to = to.max(DVec2::from_array(end));
            }
        }
    }
    if frame.project(corners[0], corners[7]).is_none() && frame.extent().is_none() {
        (from, to) = (low, high);
    }
    let (from, to) = (from.clamp(low, high), to.clamp(low, high));
    let ([x0, y0], [x1, y1]) = (from.to_array(), to.to_array());
    let place = |i: u32, from: f64, to: f64| from + (to - from) * (f64::from(i) + 0.5) / f64::from(SEARCH);
    (0..SEARCH * SEARCH)
        .filter_map(|i| frame.ray(place(i % SEARCH, x0, x1), place(i / SEARCH, y0, y1)))
        .collect()
}
