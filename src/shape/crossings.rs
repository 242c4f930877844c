//! Where a line crosses a surface.

/// A point where a line crosses a surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// Ray parameter.
    pub t: f64,
    /// Which part of the surface: a face of a box, the side or a cap of a cylinder; 0 where there is one
    /// part.
    pub part: u32,
}

/// Crossings of one line with one shape, in ascending order of `t`.
///
/// ```
/// use rtscript::shape::{Crossing, CrossingSink, Crossings};
/// let mut crossings = Crossings::default();
/// crossings.push(2.0, 0);
/// crossings.push(4.0, 1);
/// let first: Option<Crossing> = crossings.first_within(3.0, 10.0);
/// assert_eq!(first.map(|c| (c.t, c.part)), Some((4.0, 1)));
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Crossings {
    items: [Crossing; Self::CAPACITY],
    len: usize,
    is_cut: bool,
    /// One beyond this is the last that is asked for.
    enough: f64,
}

impl Default for Crossings {
    fn default() -> Self {
        Self {
            items: [Crossing { t: 0.0, part: 0 }; Self::CAPACITY],
            len: 0,
            is_cut: false,
            enough: f64::INFINITY,
        }
    }
}

/// What a shape hands its crossings to, in any order.
///
/// ```
/// use rtscript::shape::{Crossing, CrossingSink};
///
/// /// Whether anything is crossed between `from` and `to`: the first crossing there is enough.
/// struct Blocked {
///     from: f64,
///     to: f64,
///     is_blocked: bool,
/// }
///
/// impl CrossingSink for Blocked {
///     fn push(&mut self, t: f64, _part: u32) {
///         self.is_blocked |= t > self.from && t < self.to;
///     }
///
///     fn span(&self) -> (f64, f64) {
///         (self.from, self.to)
///     }
///
///     fn is_served(&self) -> bool {
///         self.is_blocked
///     }
/// }
///
/// let mut way = Blocked { from: 0.0, to: 5.0, is_blocked: false };
/// way.push(7.0, 0);
/// assert!(!way.is_served());
/// way.push(4.0, 0);
/// assert!(way.is_served());
/// // A list takes all of them, wherever they are.
/// assert_eq!(Vec::<Crossing>::new().span(), (f64::NEG_INFINITY, f64::INFINITY));
/// ```
pub trait CrossingSink {
    /// Takes a crossing at the ray parameter `t` on part `part` of the surface; NaN is dropped.
    fn push(&mut self, t: f64, part: u32);

    /// The least and the greatest t between which crossings are of use. A shape to which each of them is work may leave
    /// the others out.
    fn span(&self) -> (f64, f64) {
        (f64::NEG_INFINITY, f64::INFINITY)
    }

    /// Whether crossings beyond those that it was given are of no use.
    fn is_served(&self) -> bool {
        false
    }
}

/// Keeps all of them, in the order in which they came.
impl CrossingSink for Vec<Crossing> {
    fn push(&mut self, t: f64, part: u32) {
        if !t.is_nan() {
            Vec::push(self, Crossing { t, part });
        }
    }
}

impl CrossingSink for Crossings {
    /// Adds a crossing in its place; NaN is dropped. Of more than [`Self::CAPACITY`] those stay that matter to a ray from
    /// t = 0 on: the nearest to its origin, which may be its own start, and the first after it.
    #[inline]
    #[allow(
        clippy::indexing_slicing,
        reason = "there is room for one more than `len`, as was just asked"
    )]
    fn push(&mut self, t: f64, part: u32) {
        if t.is_nan() || self.len == Self::CAPACITY && !self.make_room(t) {
            return;
        }
        let mut i = self.len;
        while i > 0 && self.items[i - 1].t > t {
            self.items[i] = self.items[i - 1];
            i -= 1;
        }
        self.items[i] = Crossing { t, part };
        self.len += 1;
    }

    #[inline]
    fn is_served(&self) -> bool {
        self.as_slice().last().is_some_and(|last| last.t > self.enough)
    }
}

impl Crossings {
    /// As many as a line can have with one shape of ours (a torus has up to 4).
    pub const CAPACITY: usize = 4;

    /// No crossings yet; of those beyond `t` only the first is asked for, which spares a shape to look for the others.
    pub(crate) fn until_beyond(t: f64) -> Self {
        Self {
            enough: t,
            ..Self::default()
        }
    }

    /// Where there is no room for a crossing at `t`, drops the one that matters least; false where that is the new one.
    #[cold]
    #[inline(never)]
    #[allow(clippy::indexing_slicing, reason = "all places are taken")]
    fn make_room(&mut self, t: f64) -> bool {
        self.is_cut = true;
        let behind = self.items.iter().filter(|c| c.t <= 0.0).count() + usize::from(t <= 0.0);
        let another = if behind > 1 {
            // The farthest behind the origin.
            self.items[0].t < t
        } else {
            t < self.items[Self::CAPACITY - 1].t
        };
        if another {
            if behind > 1 {
                self.items.copy_within(1.., 0);
            }
            self.len -= 1;
        }
        another
    }

    /// Whether crossings were dropped because there were more than [`Self::CAPACITY`].
    #[must_use]
    pub fn is_cut(&self) -> bool {
        self.is_cut
    }

    /// The crossings in order.
    #[must_use]
    #[allow(
        clippy::indexing_slicing,
        reason = "`len` is at most the capacity, which `push` sees to"
    )]
    pub fn as_slice(&self) -> &[Crossing] {
        &self.items[..self.len]
    }

    /// Drops the crossing that is the ray's own start on this surface: the one nearest to t = 0, if it is
    /// within `t_self`.
    ///
    /// ```
    /// use rtscript::shape::{CrossingSink, Crossings};
    /// // A ray that starts on a sphere: rounding puts its start a little off 0.
    /// let mut crossings = Crossings::default();
    /// crossings.push(1e-13, 0);
    /// crossings.push(2.0, 0);
    /// crossings.drop_start(1e-9);
    /// assert_eq!(crossings.first_within(0.0, 9.0).map(|c| c.t), Some(2.0));
    /// // Two crossings of a line are far fewer than are kept.
    /// assert!(!crossings.is_cut());
    /// ```
    pub fn drop_start(&mut self, t_self: f64) {
        let distances = self.as_slice().iter().map(|crossing| crossing.t.abs());
        let nearest = distances.enumerate().min_by(|(_, a), (_, b)| a.total_cmp(b));
        if let Some((i, _)) = nearest.filter(|(_, distance)| *distance <= t_self) {
            self.items.copy_within(i + 1..self.len, i);
            self.len -= 1;
        }
    }

    /// The first crossing with `t_min < t < t_max`.
    #[must_use]
    pub fn first_within(&self, t_min: f64, t_max: f64) -> Option<Crossing> {
        self.as_slice()
            .iter()
            .copied()
            .find(|c| c.t > t_min && c.t < t_max)
    }
}
