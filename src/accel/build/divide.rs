//! From all primitives to parts that are small enough for a subtree each.

use super::{Aabb, Context, Items, Primitive, SAH_DEPTH, Summary, binning::Split, spatial::Plane};

/// Most items in a subtree: its binary tree then fits a second-level cache.
const SUBTREE: usize = 4096;
/// Splits that cut are tried where the parts' boxes overlap by more than this share of the area of the box around
/// everything,
const OVERLAP_OF_ROOT: f32 = 1e-4;
/// and this share of the area of the box around them.
const OVERLAP: f32 = 0.2;
/// They are taken where they cost less than this share of what a split that cuts nothing costs.
const GAIN: f32 = 0.985;

/// Items that become one subtree.
pub(super) struct Subtree<'a> {
    pub(super) items: Items<'a>,
    pub(super) summary: Summary,
    /// Divisions above it.
    pub(super) depth: usize,
}

/// What a division made.
pub(super) enum Part<'a> {
    Subtree(Subtree<'a>),
    Pair(Box<[Part<'a>; 2]>, Aabb),
}

/// Divides items until each part is small enough.
pub(super) fn divide<'a>(
    items: Items<'a>,
    context: &Context<'_>,
    summary: Summary,
    depth: usize,
) -> Part<'a> {
    if items.count <= SUBTREE || (context.stop)() {
        return Part::Subtree(Subtree {
            items,
            summary,
            depth,
        });
    }
    let [left, right] = halves(items, context, &summary, depth);
    let (left, right) = rayon::join(
        || divide(left.0, context, left.1, depth + 1),
        || divide(right.0, context, right.1, depth + 1),
    );
    Part::Pair(Box::new([left, right]), summary.bounds)
}

/// Divides two or more items in two.
pub(super) fn halves<'a>(
    mut items: Items<'a>,
    context: &Context<'_>,
    summary: &Summary,
    depth: usize,
) -> [(Items<'a>, Summary); 2] {
    let split = if depth < SAH_DEPTH {
        Split::best(items.live(), context, &summary.centers)
    } else {
        None
    };
    if let Some(plane) = cut(&mut items, context, summary, depth, split.as_ref()) {
        let (middle, _) = Split::across(&plane).divide(items.live(), context);
        if middle > 0 && middle < items.count {
            return at(items, middle, context);
        }
    } else if let Some(split) = split {
        let (middle, summaries) = split.divide(items.live(), context);
        let [left, right] = items.split_at(middle);
        return [(left, summaries[0]), (right, summaries[1])];
    }
    // All centers are the same, or the tree is too deep.
    let middle = items.count / 2;
    at(items, middle, context)
}

/// The items before and from `middle`.
fn at<'a>(items: Items<'a>, middle: usize, context: &Context<'_>) -> [(Items<'a>, Summary); 2] {
    let of = |items: &[Primitive]| match (context.stop)() {
        true => Summary::empty(),
        false => Summary::of(items),
    };
    items.split_at(middle).map(|mut part| {
        let summary = of(part.live());
        (part, summary)
    })
}

/// Cuts triangles by the plane that is returned, where that is worth more than the split.
fn cut(
    items: &mut Items<'_>,
    context: &Context<'_>,
    summary: &Summary,
    depth: usize,
    split: Option<&Split>,
) -> Option<Plane> {
    let room = items.all.len() - items.count;
    if room == 0 || depth >= SAH_DEPTH {
        return None;
    }
    let area = summary.bounds.half_area();
    let least = if let Some(split) = split {
        let overlap = split.bounds[0].overlap(&split.bounds[1]);
        if overlap.is_empty()
            || !(overlap.half_area() > (OVERLAP * area).max(OVERLAP_OF_ROOT * context.root_area))
        {
            return None;
        }
        split.cost * GAIN
    } else if area > OVERLAP_OF_ROOT * context.root_area {
        f32::INFINITY
    } else {
        return None;
    };
    let plane = Plane::best(items.live(), &summary.bounds, room, context)?;
    (plane.cost < least).then(|| {
        let count = items.count;
        items.count = plane.cut(items.all, count, context);
        plane
    })
}
