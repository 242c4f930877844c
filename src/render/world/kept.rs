//! Trees that outlive a world, for the next world that has the same shapes in the same places.
//!
//! A tree is known by all that it is made from: the corners of triangles, spheres, boxes, and the bounds of everything. So it
//! does not matter which scene it was built for, and a tree that is taken over is the one that would be built.

use std::{
    mem,
    sync::{Arc, Mutex, MutexGuard, PoisonError},
};

use rayon::prelude::*;

use super::{World, level::Level};
use crate::accel::{self, Bvh, Cuboids, Spheres, Triangles};

/// Bytes of trees that the last world had no use for.
const MOST_UNUSED: usize = 256 << 20;
/// Values that are hashed at once, in parallel with others.
const PIECE: usize = 1 << 14;

/// Acceleration structures kept from one render to the next: those of the last world, and up to 256 MiB of those that it
/// had no use for. Clones share what is kept.
///
/// ```
/// use rtscript::{Builder, DVec3, NoHost, RenderOptions, render, render::KeptTrees};
/// let mut b = Builder::new();
/// b.size(4, 4)?;
/// b.sphere(DVec3::ZERO, 1.0)?;
/// let scene = b.finish().value;
/// let mut options = RenderOptions::default();
/// let trees = KeptTrees::new();
/// options.trees = Some(trees.clone());
/// // The second picture finds the trees that the first one built.
/// let first = render(&scene, &options, &NoHost)?.value.image.hash();
/// assert_eq!(first, render(&scene, &options, &NoHost)?.value.image.hash());
/// assert_eq!(trees.counts(), (1, 1));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
pub struct KeptTrees(Arc<Mutex<Kept>>);

/// The same ones, not equal ones.
impl PartialEq for KeptTrees {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.0, &other.0)
    }
}

impl Eq for KeptTrees {}

#[derive(Debug, Default)]
struct Kept {
    /// The longest unused first.
    trees: Vec<(Key, Tree)>,
    built: u64,
    reused: u64,
}

/// What a level needs beside its primitives.
#[derive(Debug, Default)]
struct Tree {
    bvh: Bvh,
    triangle_blocks: Vec<Triangles>,
    sphere_blocks: Vec<Spheres>,
    cuboid_blocks: Vec<Cuboids>,
}

impl Tree {
    fn bytes(&self) -> usize {
        self.bvh.bytes()
            + size_of_val(&*self.triangle_blocks)
            + size_of_val(&*self.sphere_blocks)
            + size_of_val(&*self.cuboid_blocks)
    }

    fn swap(&mut self, level: &mut Level<'_>) {
        mem::swap(&mut self.bvh, &mut level.bvh);
        mem::swap(&mut self.triangle_blocks, &mut level.triangle_blocks);
        mem::swap(&mut self.sphere_blocks, &mut level.sphere_blocks);
        mem::swap(&mut self.cuboid_blocks, &mut level.cuboid_blocks);
    }
}

/// Everything that a tree is made from, as 256 bits of BLAKE3.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Key([u8; 32]);

impl Key {
    /// The key of the level's tree, `primitives` being those that stand in it.
    pub(super) fn of(level: &Level<'_>, primitives: &[accel::Primitive]) -> Self {
        let mut hasher = blake3::Hasher::new();
        let mut add = |values: &[u8]| _ = hasher.update(values);
        let blocks = level.triangles.len() + level.spheres.len();
        for count in [
            level.vertices.len(),
            level.triangles.len(),
            level.spheres.len(),
            primitives.len(),
        ] {
            add(&(count as u64).to_le_bytes());
        }
        add(&hash_of(&level.vertices, |p| p.to_array().map(f64::to_le_bytes)));
        add(&hash_of(&level.triangles, |corners| {
            corners.map(u32::to_le_bytes)
        }));
        add(&hash_of(&level.spheres, |sphere| {
            let [x, y, z] = sphere.center.to_array();
            [x, y, z, sphere.radius].map(f64::to_le_bytes)
        }));
        let cuboids: Vec<_> = level.cuboids().collect();
        add(&(cuboids.len() as u64).to_le_bytes());
        add(&hash_of(&cuboids, |(_, cuboid, object_from_level)| {
            let [a, b, c, d, e, f, g, h, i, j, k, l] = object_from_level.to_cols_array();
            let [x, y, z] = cuboid.half().to_array();
            [a, b, c, d, e, f, g, h, i, j, k, l, x, y, z].map(f64::to_le_bytes)
        }));
        // The boxes of the others are all that is known of them.
        let others = primitives.partition_point(|primitive| (primitive.index() as usize) < blocks);
        let others = primitives.get(others..).unwrap_or_default();
        add(&hash_of(others, |primitive| {
            primitive.bits().map(u32::to_le_bytes)
        }));
        Self(hasher.finalize().into())
    }
}

/// The hash of a list, of which each value is turned into bytes.
fn hash_of<T: Sync, const N: usize, const M: usize>(
    values: &[T],
    bytes: impl Fn(&T) -> [[u8; N]; M] + Sync,
) -> [u8; 32] {
    let hash = |values: &[T]| {
        let mut hasher = blake3::Hasher::new();
        let mut buffer = Vec::with_capacity(values.len() * N * M);
        for value in values {
            buffer.extend_from_slice(bytes(value).as_flattened());
        }
        hasher.update(&buffer);
        <[u8; 32]>::from(hasher.finalize())
    };
    let pieces: Vec<[u8; 32]> = values.par_chunks(PIECE).map(hash).collect();
    blake3::hash(pieces.as_flattened()).into()
}

impl KeptTrees {
    /// Nothing, so far.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Trees that were built, and trees that were taken over instead, since the beginning.
    #[must_use]
    pub fn counts(&self) -> (u64, u64) {
        let kept = self.kept();
        (kept.built, kept.reused)
    }

    /// Puts the tree for a key into the level; false where there is none.
    pub(super) fn lend(&self, key: &Key, level: &mut Level<'_>) -> bool {
        let mut kept = self.kept();
        let found = kept.trees.iter().rposition(|(known, _)| known == key);
        let Some(index) = found else {
            kept.built += 1;
            return false;
        };
        kept.reused += 1;
        let (_, mut tree) = kept.trees.remove(index);
        tree.swap(level);
        true
    }

    /// Takes the trees of a world that is not needed any more.
    pub(crate) fn take_back(&self, mut world: World<'_>) {
        let mut kept = self.kept();
        let mut unused: usize = kept.trees.iter().map(|(_, tree)| tree.bytes()).sum();
        kept.trees.retain(|(_, tree)| {
            let stays = unused <= MOST_UNUSED;
            if !stays {
                unused -= tree.bytes();
            }
            stays
        });
        // Nobody else holds the levels of a world that is given back.
        let levels = Arc::get_mut(&mut world.levels).unwrap_or_default();
        for (key, level) in world.keys.into_iter().zip(levels) {
            let mut tree = Tree::default();
            tree.swap(level);
            kept.trees.push((key, tree));
        }
    }

    fn kept(&self) -> MutexGuard<'_, Kept> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        Builder, DVec3, Image, NoHost, RenderOptions, Scene,
        render::render,
        scene::{Mesh, Term},
    };

    /// A mesh placed twice, spheres, a plane and a light.
    fn scene(color: f64, ball: f64, corner: f64) -> Scene {
        let mut b = Builder::new();
        b.size(40, 30).unwrap();
        b.directional(DVec3::new(1.0, 2.0, 3.0), DVec3::ONE).unwrap();
        b.material_mut().diffuse = Term::color(DVec3::new(color, 0.5, 0.2));
        b.sphere(DVec3::new(ball, 0.0, 0.0), 0.5).unwrap();
        let positions = vec![DVec3::ZERO, DVec3::X, DVec3::new(0.0, corner, 0.2), DVec3::Z];
        let mesh = Arc::new(Mesh::new("m", positions, vec![[0, 1, 2], [0, 2, 3]]).unwrap());
        b.mesh(&mesh).unwrap();
        b.translate(DVec3::new(-1.0, 0.3, 0.0)).unwrap();
        b.mesh(&mesh).unwrap();
        b.finish().value
    }

    fn image(scene: &Scene, trees: Option<&KeptTrees>) -> Image {
        let options = RenderOptions {
            trees: trees.cloned(),
            ..RenderOptions::default()
        };
        render(scene, &options, &NoHost).unwrap().value.image
    }

    #[test]
    fn what_did_not_move_keeps_its_tree_and_every_bit_of_the_picture() {
        let trees = KeptTrees::new();
        let mut pictures = Vec::new();
        for (changed, counts) in [
            (scene(0.5, 0.0, 1.0), (2, 0)),
            // Another color: everything stands where it stood.
            (scene(0.9, 0.0, 1.0), (2, 2)),
            // Another ball: the tree of the mesh is the same.
            (scene(0.9, 0.4, 1.0), (3, 3)),
            // Another mesh.
            (scene(0.9, 0.4, 1.1), (5, 3)),
            // And back to one whose trees were not used in between.
            (scene(0.5, 0.0, 1.0), (5, 5)),
        ] {
            let kept = image(&changed, Some(&trees));
            assert_eq!(trees.counts(), counts);
            assert_eq!(kept, image(&changed, None));
            pictures.push(kept);
        }
        assert_eq!(pictures[0], pictures[4]);
        assert!(pictures.windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn unused_trees_go_when_they_are_too_many() {
        let trees = KeptTrees::new();
        image(&scene(0.5, 0.0, 1.0), Some(&trees));
        let big = Tree {
            triangle_blocks: vec![Triangles::EMPTY; MOST_UNUSED / size_of::<Triangles>() + 1],
            ..Tree::default()
        };
        trees.kept().trees.insert(0, (Key([0; 32]), big));
        image(&scene(0.5, 0.0, 1.0), Some(&trees));
        let kept = trees.kept();
        assert_eq!((kept.trees.len(), kept.reused), (2, 2));
        assert!(kept.trees.iter().all(|(key, _)| *key != Key([0; 32])));
    }
}
