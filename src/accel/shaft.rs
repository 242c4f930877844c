//! What lies between a point and an area: leaves that touch the pyramid between them (Haines and Wallace, "Shaft
//! culling for efficient ray-traced radiosity", 1991). Where none does, no ray from the point to the area meets
//! anything.

use super::{
    boxes::{Child, round_down, round_up},
    build::Bvh,
};
use crate::math::{Bounds3, DVec3, max_abs};

/// The convex hull of a point and a parallelogram, a little too large: its faces through the point, and a box.
///
/// With M the largest coordinate of its corners, boxes are first cut to the shaft's own, so that no number below
/// exceeds M by more than a rounding. A plane's normal has |nx| + |ny| + |nz| = 1; then three products, two sums
/// and the rounding of the normal change n.p by less than 2^-21 M in f32. Twice that and more is allowed for.
#[derive(Clone, Copy, Debug)]
pub struct Shaft {
    min: [f32; 3],
    max: [f32; 3],
    /// n and d: n.p >= d inside. All of space is inside where a face is too narrow to tell its sides apart.
    faces: [(DVec3, f64); 4],
    normals: [[f32; 3]; 4],
    offsets: [f32; 4],
}

impl Shaft {
    /// Nodes that can wait.
    const STACK: usize = 64;

    /// The hull of `apex` and a parallelogram whose corners stand in order around it.
    #[must_use]
    pub fn new(apex: DVec3, corners: [DVec3; 4]) -> Self {
        let bounds = Bounds3::around(corners.into_iter().chain([apex]));
        let slack = 1e-6 * max_abs(bounds.min).max(max_abs(bounds.max));
        let center = (corners[0] + corners[2]) * 0.5 - apex;
        let faces = [0, 1, 2, 3].map(|k: usize| {
            let n = (corners[k] - apex).cross(corners[(k + 1) % 4] - apex);
            let n = n / (n.x.abs() + n.y.abs() + n.z.abs());
            let inside = n.dot(center);
            if inside.abs() > slack {
                let n = if inside < 0.0 { -n } else { n };
                (n, n.dot(apex) - slack)
            } else {
                (DVec3::ZERO, -1.0)
            }
        });
        Self {
            min: bounds.min.to_array().map(|x| round_down(x - slack)),
            max: bounds.max.to_array().map(|x| round_up(x + slack)),
            faces,
            normals: faces.map(|(n, _)| n.to_array().map(|x| x as f32)),
            offsets: faces.map(|(_, d)| round_down(d)),
        }
    }

    /// Whether a sphere may touch the shaft.
    #[must_use]
    pub fn touches_sphere(&self, center: DVec3, radius: f64) -> bool {
        self.faces.iter().all(|(n, d)| n.dot(center) >= d - radius)
    }

    /// Whether a triangle may touch the shaft.
    #[must_use]
    pub fn touches_triangle(&self, corners: [DVec3; 3]) -> bool {
        self.faces
            .iter()
            .all(|(n, d)| corners.iter().any(|p| n.dot(*p) >= *d))
    }

    /// Whether a box may touch the shaft: the points within all three half edges of a center.
    #[must_use]
    pub fn touches_cuboid(&self, center: DVec3, half_edges: [DVec3; 3]) -> bool {
        let reach = half_edges.iter().fold(DVec3::ZERO, |sum, edge| sum + edge.abs());
        // Far more than the rounding of the numbers given.
        let slack = 1e-9 * (max_abs(center) + max_abs(reach));
        let reach = reach + slack;
        let overlaps = (0..3).all(|k| {
            center[k] + reach[k] >= f64::from(self.min[k]) && center[k] - reach[k] <= f64::from(self.max[k])
        });
        overlaps
            && self.faces.iter().all(|(n, d)| {
                let reach: f64 = half_edges.iter().map(|edge| n.dot(*edge).abs()).sum();
                n.dot(center) >= d - reach - slack
            })
    }

    /// One bit for each child of a node whose box may touch the shaft.
    #[inline]
    fn touched(&self, planes: &[[f32; 8]; 6]) -> u32 {
        let (mut low, mut high) = ([[0.0f32; 8]; 3], [[0.0f32; 8]; 3]);
        let mut inside = [true; 8];
        for k in 0..3 {
            for lane in 0..8 {
                low[k][lane] = planes[k][lane].max(self.min[k]);
                high[k][lane] = planes[k + 3][lane].min(self.max[k]);
                inside[lane] &= low[k][lane] <= high[k][lane];
            }
        }
        for (n, d) in self.normals.iter().zip(self.offsets) {
            // The corner of each box that is farthest inside.
            let mut height = [0.0f32; 8];
            for k in 0..3 {
                let corner = if n[k] < 0.0 { &low[k] } else { &high[k] };
                for lane in 0..8 {
                    height[lane] += n[k] * corner[lane];
                }
            }
            for lane in 0..8 {
                inside[lane] &= height[lane] >= d;
            }
        }
        (0..8).fold(0, |mask, lane| mask | u32::from(inside[lane]) << lane)
    }
}

impl Bvh {
    /// Calls `visit` with each leaf whose box may touch the shaft, until it returns false. False where it did, or
    /// where the shaft touches more than `nodes_max` nodes.
    pub fn touching(&self, shaft: &Shaft, nodes_max: usize, mut visit: impl FnMut(Child) -> bool) -> bool {
        let mut stack = [Child::NOTHING; Shaft::STACK];
        let mut top = 0;
        let mut current = Child::node(0);
        for _ in 0..nodes_max {
            let Some(node) = self.nodes.get(current.0 as usize) else {
                return true;
            };
            let mut mask = shaft.touched(&node.planes);
            while mask != 0 {
                let child = node.children[mask.trailing_zeros() as usize & 7];
                mask &= mask - 1;
                if child.is_leaf() {
                    if !visit(child) {
                        return false;
                    }
                } else if let Some(place) = stack.get_mut(top) {
                    *place = child;
                    top += 1;
                } else {
                    return false;
                }
            }
            if top == 0 {
                return true;
            }
            top -= 1;
            current = stack[top];
        }
        false
    }
}
