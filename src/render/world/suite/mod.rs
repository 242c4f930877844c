//! What all shapes promise, asked of scenes: of solids put together, closed meshes, instances and instances in instances.
//! The properties are those of `shape/suite`; here stand the scenes, and how a world answers.

mod scenes;

use rayon::prelude::*;

use self::scenes::{Move, SCENES, scene};
use super::{
    Probe, World,
    level::{Level, Primitive},
};
use crate::{
    math::{Bounds3, DAffine3, DVec3, Ray, max_abs},
    shape::suite::{
        Met, Rng, Subject, inner_points, leaks,
        shared::{self, Case},
    },
};

/// A scene as one thing.
struct Whole<'w> {
    name: &'w str,
    world: World<'w>,
    /// Patches are not told apart: a sphere that is stretched has another number.
    is_one: bool,
    /// Edges of triangles.
    edges: Vec<[DVec3; 2]>,
    /// Points between patches of the surface, found by [`Whole::search`].
    between: Vec<DVec3>,
}

impl<'w> Whole<'w> {
    fn new(name: &'w str, world: World<'w>) -> Self {
        let mut edges = Vec::new();
        if let Some(root) = world.root() {
            collect(&world, root, &DAffine3::IDENTITY, &mut edges);
        }
        Self {
            name,
            world,
            is_one: false,
            edges,
            between: Vec::new(),
        }
    }

    /// Points between patches: rays from one place to two points on different ones are brought together.
    fn search(&self, count: usize) -> Vec<DVec3> {
        let mut rng = Rng::new(8);
        let mut between = Vec::new();
        for _ in 0..100 * count {
            if between.len() == count {
                break;
            }
            let [one, other] = [0, 1].map(|_| Case::random(self, &mut rng));
            let (Some(a), Some(b)) = (one.found.first(), other.found.first()) else {
                continue;
            };
            let eye = one.ray.at(a.t) - one.ray.dir.normalize() * self.extent().0;
            let first = |target: DVec3| {
                let ray = Ray::new(eye, target - eye);
                let met = self.crossings(&ray).into_iter().find(|met| met.t > 0.0);
                met.map(|met| (met.patch, ray.at(met.t)))
            };
            let [mut p, mut q] = [one.ray.at(a.t), other.ray.at(b.t)];
            let patch = first(p).map(|met| met.0);
            if patch == first(q).map(|met| met.0) {
                continue;
            }
            for _ in 0..60 {
                let middle = p.midpoint(q);
                if first(middle).map(|met| met.0) == patch {
                    p = middle;
                } else {
                    q = middle;
                }
            }
            between.extend(first(p).map(|met| met.1));
        }
        between
    }
}

/// The edges of all triangles of a level and those in it.
fn collect(world: &World<'_>, level: &Level<'_>, to_world: &DAffine3, edges: &mut Vec<[DVec3; 2]>) {
    for index in 0..level.primitives() as u32 {
        match level.primitive(index) {
            Primitive::Triangle(i) => {
                let [a, b, c] = level.corners(i).map(|corner| to_world.transform_point3(corner));
                edges.extend([[a, b], [b, c], [c, a]]);
            }
            Primitive::Instance(i) => {
                let instance = &level.instances[i as usize];
                let to_world = *to_world * instance.inner_from_outer.inverse();
                collect(world, &world.levels[instance.level as usize], &to_world, edges);
            }
            Primitive::Sphere(_) | Primitive::Shape(_) => {}
        }
    }
}

impl Subject for Whole<'_> {
    fn label(&self) -> String {
        self.name.to_owned()
    }

    fn bounds(&self) -> Option<Bounds3> {
        self.world.bounds()
    }

    fn extent(&self) -> (f64, DVec3) {
        let b = self.bounds().expect("scenes of the suite have an end");
        (max_abs(b.size()) * 0.5, b.center())
    }

    fn is_solid(&self) -> bool {
        true
    }

    fn crossings(&self, ray: &Ray) -> Vec<Met> {
        let mut found = self.world.crossings_of_line(ray);
        if self.is_one {
            found.iter_mut().for_each(|met| met.patch = (0, 0));
        }
        found
    }

    fn onwards(&self, ray: &Ray, start: &Met, _: f64) -> Option<(f64, (u64, u32))> {
        let (position, length) = (ray.at(start.t), ray.dir.length());
        let onwards = Ray::new(position, ray.dir / length);
        let scale = max_abs(ray.origin).max(max_abs(position));
        let probe = Probe::from_surface(onwards, start.patch.0, scale);
        let hit = self.world.nearest(&probe, f64::INFINITY)?;
        Some((hit.t / length, (hit.number, hit.part)))
    }

    fn contains(&self, p: DVec3) -> Option<bool> {
        Some(self.world.is_inside(p))
    }

    /// Of matrices one after the other, and of numbers in the space of a group, which may be larger than in the world.
    fn rounding(&self) -> f64 {
        50.0
    }

    fn edge_distance(&self, _: DVec3) -> f64 {
        f64::INFINITY
    }

    fn edge_point(&self, rng: &mut Rng) -> DVec3 {
        if self.edges.is_empty() {
            return self.between[rng.below(self.between.len())];
        }
        let [a, b] = self.edges[rng.below(self.edges.len())];
        if rng.chance(0.3) {
            a
        } else {
            a + (b - a) * rng.unit()
        }
    }

    fn depth(&self, p: DVec3) -> f64 {
        if !self.world.is_inside(p) {
            return -1.0;
        }
        let mut rng = Rng::new(9);
        let away = (0..20).filter_map(|_| self.world.nearest_t(&Ray::new(p, rng.direction()), f64::INFINITY));
        away.map(|(t, _)| t).fold(f64::INFINITY, f64::min)
    }

    fn holds(&self, ray: &Ray) -> bool {
        self.world.nearest_t(ray, f64::INFINITY).is_some()
    }
}

/// Calls `check` with every scene of the list.
fn for_each(check: impl Fn(&mut Whole<'_>, &mut Rng) + Sync) {
    SCENES.par_iter().for_each(|(name, text)| {
        let scene = scene(text, Move::None);
        let mut whole = Whole::new(name, World::compile(&scene).unwrap());
        check(&mut whole, &mut Rng::new(1));
    });
}

/// Random lines through each scene until `check` has checked so much.
fn for_lines(wanted: usize, check: impl Fn(&Case<'_>, &mut Rng) -> usize + Sync) {
    for_each(|whole, rng| {
        let whole = &*whole;
        let mut checked = 0;
        for _ in 0..40 * wanted {
            checked += check(&Case::random(whole, rng), rng);
            if checked >= wanted {
                return;
            }
        }
        panic!("{checked} of {}", whole.name);
    });
}

#[test]
fn crossings_are_ordered_and_closed_and_in_the_bounds() {
    for_lines(300, |case, _| {
        shared::are_within_bounds(case);
        shared::are_ordered_and_closed(case)
    });
}

#[test]
fn normals_point_outwards_as_finite_differences_say() {
    for_lines(200, |case, _| {
        shared::normals_agree_with_finite_differences(case);
        shared::normals_point_outwards(case)
    });
}

#[test]
fn a_ray_that_starts_on_the_surface_meets_the_rest() {
    for_lines(100, |case, _| shared::starts_are_left_out(case));
}

#[test]
fn a_point_is_inside_where_an_odd_number_of_crossings_lies_before_it() {
    for_lines(50, |case, rng| shared::sides_change_at_crossings(case, 4, rng)[0]);
}

/// What a picture asks for is the first of all crossings.
#[test]
fn the_nearest_hit_is_the_first_crossing() {
    for_each(|whole, rng| {
        let whole = &*whole;
        let (size, center) = whole.extent();
        let mut met = 0;
        for _ in 0..6000 {
            let ray = Ray::new(center + rng.in_cube() * 1.5 * size, rng.direction());
            let case = Case::new(whole, ray);
            let first = case.found.iter().find(|met| met.t > 0.0);
            let nearest = whole.world.nearest_t(&ray, f64::INFINITY);
            let same = match (first, nearest) {
                (Some(met), Some((t, number))) => (met.t - t).abs() < 1e-9 * size && met.patch.0 == number,
                (met, nearest) => met.is_none() && nearest.is_none(),
            };
            assert!(same, "{nearest:?}: {case}");
            met += usize::from(first.is_some());
            if met == 100 {
                return;
            }
        }
        panic!("{met} of {}", whole.name);
    });
}

#[test]
fn a_moved_ray_meets_the_moved_scene_where_the_ray_meets_the_scene() {
    SCENES.par_iter().for_each(|(name, text)| {
        let scenes = [Move::None, Move::Similar, Move::Uneven].map(|how| scene(text, how));
        let [mut plain, similar, mut uneven] = scenes
            .each_ref()
            .map(|s| Whole::new(name, World::compile(s).unwrap()));
        let mut rng = Rng::new(2);
        uneven.is_one = true;
        for (moved, how) in [(&similar, Move::Similar), (&uneven, Move::Uneven)] {
            plain.is_one = moved.is_one;
            let inverse = how.matrix().inverse();
            let mut checked = 0;
            for _ in 0..2000 {
                let ray = shared::random_ray(moved, &mut rng);
                checked += shared::moves_with_its_ray(moved, &plain, |ray| ray.transformed(&inverse), ray);
                if checked > 100 {
                    break;
                }
            }
            assert!(checked > 100, "{checked} of {name}");
        }
    });
}

fn nothing_leaks(lines: usize, between: usize) {
    let batch = lines.min(10_000);
    for_each(|whole, rng| {
        if whole.edges.is_empty() {
            whole.between = whole.search(between);
            assert_eq!(whole.between.len(), between, "{}", whole.name);
        }
        let whole = &*whole;
        let inner = inner_points(whole, rng);
        let found = (0..lines / batch)
            .into_par_iter()
            .find_map_any(|number| leaks(whole, &inner, batch, &mut Rng::new(number as u64)));
        assert_eq!(found, None, "{}", whole.name);
    });
}

#[test]
fn no_line_leaks_through_an_edge() {
    nothing_leaks(200, 20);
}

#[test]
#[ignore = "a million lines through each scene take minutes in a release build"]
fn no_line_of_a_million_leaks_through_an_edge() {
    nothing_leaks(1_000_000, 2000);
}
