use super::{
    bins::{Binning, Bins},
    *,
};
use crate::{
    accel::{cases, lanes::Task},
    math::{Bounds3, DVec3},
};

/// Boxes of very different sizes.
fn primitives(n: usize) -> Vec<Primitive> {
    let mut next = crate::accel::random(3);
    (0..)
        .take(n)
        .map(|index| {
            let p = DVec3::new(next(), next(), next());
            let size = DVec3::new(next(), next(), next()) * next() * next() * 0.1;
            Primitive::new(index, Box32::around(&Bounds3::new(p, p + size)), next() as f32)
        })
        .collect()
}

/// Calls `leaf` with every leaf below a node and checks that boxes contain what is in them.
fn walk(bvh: &Bvh, node: usize, leaf: &mut impl FnMut(Child, &Box32)) -> Box32 {
    let mut around = Box32::EMPTY;
    let node = &bvh.nodes[node];
    for lane in 0..8 {
        let bounds = Box32 {
            min: [0, 1, 2].map(|k| node.planes[k][lane]),
            max: [3, 4, 5].map(|k| node.planes[k][lane]),
        };
        let child = node.children[lane];
        if child == Child::NOTHING {
            assert_eq!(bounds, Box32::EMPTY);
            continue;
        }
        around = around.union(&bounds);
        if child.is_leaf() {
            leaf(child, &bounds);
        } else {
            let below = walk(bvh, child.0 as usize, leaf);
            assert_eq!(bounds.union(&below), bounds);
        }
    }
    around
}

#[test]
fn every_primitive_stands_in_one_leaf_and_threads_do_not_matter() {
    for n in [1, 4, 5, 9, 4096, 4097, 200_000].map(cases) {
        let n = if cfg!(miri) { n.min(120) } else { n };
        let kinds = Kinds {
            triangles: n / 2,
            spheres: n / 3,
        };
        let with_threads = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new()
                .num_threads(threads)
                .build()
                .unwrap();
            pool.install(|| Bvh::build(primitives(n), kinds, 0.0, |_| [DVec3::ZERO; 3], || false))
        };
        let (bvh, leaves) = with_threads(1);
        let mut found: Vec<u32> = Vec::new();
        let boxes = primitives(n);
        walk(&bvh, 0, &mut |leaf, bounds| {
            let indices = match leaf.kind() {
                LeafKind::Others => bvh.others(leaf),
                LeafKind::Triangles => leaves.triangles[leaf.range()].as_flattened(),
                LeafKind::Spheres => leaves.spheres[leaf.range()].as_flattened(),
                LeafKind::Cuboids => leaves.cuboids[leaf.range()].as_flattened(),
            };
            let before = found.len();
            found.extend(indices.iter().filter(|index| **index != crate::accel::NONE));
            for &index in &found[before..] {
                assert_eq!(kinds.of(&boxes[index as usize]), leaf.kind());
                assert_eq!(boxes[index as usize].bounds().union(bounds), *bounds);
            }
        });
        found.sort_unstable();
        assert!(found.into_iter().eq(0..n as u32));
        let (other, other_leaves) = with_threads(3);
        assert_eq!(leaves.triangles, other_leaves.triangles);
        assert_eq!(leaves.spheres, other_leaves.spheres);
        assert_eq!(leaves.cuboids, other_leaves.cuboids);
        assert_eq!(bvh.others, other.others);
        let same = |(a, b): (&Node, &Node)| a.planes == b.planes && a.children == b.children;
        assert!(bvh.nodes.iter().zip(&other.nodes).all(same));
    }
}

#[test]
fn what_has_no_box_is_in_no_leaf() {
    let nothing = Primitive::new(0, Box32::EMPTY, 0.0);
    let (bvh, leaves) = Bvh::build(
        vec![nothing; 9],
        Kinds::default(),
        0.0,
        |_| [DVec3::ZERO; 3],
        || false,
    );
    assert!(bvh.nodes.is_empty() && leaves.triangles.is_empty());
}

/// Leaves whose blocks are nearly empty share them, unless that would cost rays much.
#[test]
#[cfg_attr(
    miri,
    ignore = "says something of tens of thousands of triangles only; other tests build"
)]
fn blocks_are_full_where_that_costs_little() {
    let n = cases(40_000);
    let kinds = Kinds {
        triangles: n,
        spheres: 0,
    };
    let items = primitives(n);
    let memory = memory::charge(&items);
    let (bvh, leaves) = Bvh::build(items, kinds, 0.0, |_| [DVec3::ZERO; 3], || false);
    let full = leaves.triangles.len() as f64 * BLOCK as f64 / n as f64;
    assert!(full < 1.1, "{full}");
    for node in &bvh.nodes {
        let blocks: Vec<(Box32, usize)> = (0..8)
            .filter(|lane| node.children[*lane] != Child::NOTHING && node.children[*lane].is_leaf())
            .map(|lane| {
                let bounds = Box32 {
                    min: [0, 1, 2].map(|k| node.planes[k][lane]),
                    max: [3, 4, 5].map(|k| node.planes[k][lane]),
                };
                let indices = leaves.triangles[node.children[lane].first()];
                let empty = indices.iter().filter(|index| **index == crate::accel::NONE);
                (bounds, BLOCK - empty.count())
            })
            .collect();
        for (i, (a, items)) in blocks.iter().enumerate() {
            for (b, more) in &blocks[..i] {
                let growth = a.union(b).half_area() - a.half_area() - b.half_area();
                assert!(items + more > BLOCK || growth >= 0.999 * memory);
            }
        }
    }
}

/// The best plane between eight bins.
struct BestOfEight<'a>(&'a [Primitive], Kinds, Binning<8>, f32);

impl Task for BestOfEight<'_> {
    type Output = Option<(usize, usize, f32, [Box32; 2])>;

    #[inline(always)]
    fn run<L: Lanes>(self, lanes: L) -> Self::Output {
        let Self(items, kinds, binning, memory) = self;
        let bins = Bins::of(lanes, items, kinds, &binning);
        let (best, bounds) = bins.best(lanes, binning.scale.to_array(), memory)?;
        Some((best.axis, best.bin, best.cost, bounds.map(Aabb::to_box)))
    }
}

#[test]
fn no_plane_between_bins_costs_less_than_the_one_that_is_found() {
    for n in 2..40 {
        let mut items = primitives(n);
        if n % 5 == 0 {
            // All in one plane, so that this axis divides nothing.
            for item in &mut items {
                (item.0[1], item.0[5]) = (0.5, 0.5);
            }
        }
        // Both kinds of loads.
        let kinds = Kinds {
            triangles: n / 2,
            spheres: 0,
        };
        let centers = Summary::of(&items).centers;
        let binning = Binning::<8>::new(&centers);
        let (scale, min) = (binning.scale.to_array(), binning.min.to_array());
        let memory = [0.0, 0.01][n / 2 % 2];
        let mut least: Option<(usize, usize, f32, [Box32; 2])> = None;
        for axis in 0..3 {
            for bin in 1..8 {
                let is_left = |item: &&Primitive| {
                    (item.min(axis) + item.max(axis) - min[axis]) * scale[axis] < bin as f32
                };
                let (left, right): (Vec<&Primitive>, Vec<&Primitive>) = items.iter().partition(is_left);
                if left.is_empty() || right.is_empty() {
                    continue;
                }
                let sides = [left, right].map(|side| {
                    let bounds = Summary::of(&side.iter().map(|item| **item).collect::<Vec<_>>()).bounds;
                    let alone = side
                        .iter()
                        .filter(|item| item.index() as usize >= kinds.triangles);
                    let alone = alone.count() as f32;
                    let blocks = ((side.len() as f32 - alone) / 4.0).ceil();
                    let cost = (bounds.half_area() + memory) * (blocks + 2.0 * alone);
                    (cost, bounds.to_box())
                });
                let cost = sides[0].0 + sides[1].0;
                if least.is_none_or(|least| cost < least.2) {
                    least = Some((axis, bin, cost, sides.map(|side| side.1)));
                }
            }
        }
        assert!(least.is_some());
        for simd in Simd::all() {
            let found = simd.run(BestOfEight(&items, kinds, binning, memory));
            assert_eq!(found, least, "{n} items, {simd:?}");
        }
    }
}
