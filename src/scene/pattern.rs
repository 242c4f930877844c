//! Patterns: numbers from 0 to 1 all over space, and the colors they stand for.

use super::{
    ColorMap, Interpolation, Placement, SceneError,
    placement::octaves_in_range,
    texture::{Size, TexturePoint},
};
use crate::{
    color::Color,
    math::{self, DAffine3, DVec3, PI},
    noise::{self, Octaves},
};

macro_rules! kinds {
    ($($(#[$doc:meta])* $kind:ident = $name:literal;)*) => {
        /// What a pattern looks like, as a function of a point in its own space.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum PatternKind {
            $($(#[$doc])* $kind,)*
        }

        impl PatternKind {
            /// All of them with their names in scripts.
            pub const ALL: &'static [(&'static str, Self)] = &[$(($name, Self::$kind),)*];

            /// Its name in scripts.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self {
                    $(Self::$kind => $name,)*
                }
            }
        }
    };
}

kinds! {
    /// 0 and 1 in turn in cubes of edge 1.
    Checker = "checker";
    /// Bricks of `size` in rows along x, each row moved by half a brick: 0 in the mortar between them, `mortar` wide; in a
    /// brick 1 less a share of `variation` that it has to itself.
    Brick = "brick";
    /// x without its whole part: bands across the x axis.
    Stripes = "stripes";
    /// From 0 at the point `from` to 1 at `to`.
    Linear = "linear";
    /// Distance from the y axis.
    Radial = "radial";
    /// Distance from the origin.
    Spherical = "spherical";
    /// Angle about the y axis from x towards z, a whole turn being 1.
    Angular = "angular";
    /// Rings about the y axis, 1 wide, up and down (POV-Ray's wood).
    Wood = "wood";
    /// Up and down along x, 1 wide (POV-Ray's marble); turbulence makes the veins.
    Marble = "marble";
    /// Creased noise, contrasted.
    Granite = "granite";
    /// Distance to the nearest of scattered points, 1 at most (Worley's F1).
    Worley = "worley";
    /// A number of its own for each cell around scattered points.
    Cells = "cells";
    /// How much nearer the nearest of scattered points is than the second: 0 on the borders of cells.
    Cracks = "cracks";
    /// Perlin's gradient noise about 0.5.
    Noise = "noise";
    /// Simplex noise about 0.5.
    Simplex = "simplex";
    /// Octaves of gradient noise about 0.5.
    Fbm = "fbm";
    /// Octaves of the absolute value of gradient noise.
    Turbulence = "turbulence";
    /// 1 within `width` of whole points, 0 elsewhere.
    Dots = "dots";
    /// 0, 0.5 and 1 in hexagons of edge 1 in the plane of x and z.
    Hexagon = "hexagon";
    /// 1 on lines `width` wide at whole x and whole z, 0 between them.
    Grid = "grid";
    /// Shells about the origin, each from 0 to 1.
    Onion = "onion";
    /// Waves about a few places near the origin, 1 long.
    Ripples = "ripples";
}

/// What becomes of a pattern's number before it is looked up in the colors.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wave {
    /// Kept within 0 and 1.
    Clamp,
    /// Its whole part is left out: 0 to 1 and again.
    Ramp,
    /// 0 to 1 and back.
    Triangle,
    /// As the triangle, rounded.
    Sine,
}

impl Wave {
    /// All of them with their names in scripts.
    pub const ALL: [(&'static str, Self); 4] = [
        ("clamp", Self::Clamp),
        ("ramp", Self::Ramp),
        ("triangle", Self::Triangle),
        ("sine", Self::Sine),
    ];

    fn of(self, x: f64) -> f64 {
        match self {
            Self::Clamp => x.clamp(0.0, 1.0),
            Self::Ramp => x - x.floor(),
            Self::Triangle => triangle(x * 0.5),
            Self::Sine => 0.5 - 0.5 * math::cos(PI * x),
        }
    }
}

/// A pattern with all that may be said of it; [`Texture::pattern`](super::Texture::pattern) makes a texture of it.
///
/// ```
/// use std::sync::Arc;
/// use rtscript::{Builder, DVec3, Term, scene::{Pattern, PatternKind, Texture, Wave}};
/// let mut rings = Pattern::new(PatternKind::Onion);
/// rings.frequency = 4.0;
/// rings.wave = Wave::Triangle;
/// assert!((0.0..=1.0).contains(&rings.value(DVec3::new(0.1, 0.2, 0.3))));
/// let mut b = Builder::new();
/// let id = b.texture(&Arc::new(Texture::pattern(rings)?));
/// b.material_mut().diffuse = Term::texture(id);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// What it looks like.
    pub kind: PatternKind,
    /// The colors of 0 to 1.
    pub colors: ColorMap,
    /// What becomes of its number times `frequency` plus `phase`.
    pub wave: Wave,
    /// How often the colors come within 0 to 1. Default 1.
    pub frequency: f64,
    /// How far the colors are moved. Default 0.
    pub phase: f64,
    /// Where it lies in the shape's space.
    pub placement: Placement,
    /// How the octaves of `fbm`, `turbulence` and `granite` follow each other.
    pub detail: Octaves,
    /// How far the points of `worley`, `cells` and `cracks` are scattered: 0 a lattice, 1 at random. Default 1.
    pub jitter: f64,
    /// Of dots: their radius. Of a grid: the width of its lines.
    pub width: f64,
    /// Of a brick, mortar included: along x, y and z.
    pub size: DVec3,
    /// Width of the mortar between bricks.
    pub mortar: f64,
    /// How differently bricks are colored, 0 to 1. Default 0.
    pub variation: f64,
    /// Where a linear gradient is 0. Default 0, -1, 0.
    pub from: DVec3,
    /// Where a linear gradient is 1. Default 0, 1, 0.
    pub to: DVec3,
}

impl Pattern {
    /// A pattern of a kind with that kind's usual colors.
    #[must_use]
    pub fn new(kind: PatternKind) -> Self {
        use PatternKind as K;
        let gray: &[(f64, u32)] = &[(0.0, 0x00_0000), (1.0, 0xff_ffff)];
        let linear = |entries: &[(f64, u32)]| ColorMap::known(entries, Interpolation::Linear);
        let colors = match kind {
            K::Brick => linear(&[(0.0, 0xb9_b4a8), (0.01, 0x6e_2a1c), (1.0, 0x9c_4630)]),
            K::Stripes => ColorMap::known(&[(0.0, 0xff_ffff), (0.5, 0x2a_4d7c)], Interpolation::None),
            K::Wood => linear(&[(0.0, 0xc8_9a62), (0.6, 0xb0_7d47), (1.0, 0x6f_4523)]),
            K::Marble => linear(&[
                (0.0, 0xf4_f2ee),
                (0.5, 0xdc_d8d2),
                (0.85, 0x8d_8a88),
                (1.0, 0x3c_3a3c),
            ]),
            K::Granite => linear(&[
                (0.0, 0x2b_2a2c),
                (0.25, 0x8a_7f7a),
                (0.55, 0xc9_bdb4),
                (1.0, 0xee_e8e2),
            ]),
            K::Cracks => linear(&[(0.0, 0x1c_1714), (0.08, 0x8c_7a66), (1.0, 0xb8_a78e)]),
            K::Fbm => linear(&[
                (0.0, 0x3f_78c4),
                (0.45, 0x6d_9bd6),
                (0.7, 0xff_ffff),
                (1.0, 0xff_ffff),
            ]),
            K::Hexagon => linear(&[(0.0, 0xe8_e0d0), (0.5, 0x9c_6b4a), (1.0, 0x54_3a2c)]),
            _ => linear(gray),
        };
        let placement = Placement {
            turbulence: match kind {
                K::Marble => 0.7,
                K::Wood => 0.08,
                _ => 0.0,
            },
            scale: DVec3::splat(match kind {
                K::Wood => 0.2,
                K::Marble | K::Stripes | K::Hexagon => 0.5,
                K::Granite | K::Worley | K::Cells | K::Cracks | K::Dots | K::Grid => 0.4,
                _ => 1.0,
            }),
            ..Placement::default()
        };
        Self {
            kind,
            colors,
            wave: match kind {
                K::Stripes | K::Angular | K::Onion => Wave::Ramp,
                _ => Wave::Clamp,
            },
            frequency: 1.0,
            phase: 0.0,
            placement,
            detail: Octaves::new(6),
            jitter: 1.0,
            width: match kind {
                K::Grid => 0.1,
                _ => 0.3,
            },
            size: DVec3::new(0.5, 0.25, 0.25),
            mortar: 0.03,
            variation: 0.0,
            from: DVec3::NEG_Y,
            to: DVec3::Y,
        }
    }

    /// Refuses what is no pattern.
    fn check(&self) -> Result<(), SceneError> {
        self.placement.check()?;
        octaves_in_range(self.detail.count)?;
        let numbers = [
            ("frequency", self.frequency, -1e6, 1e6),
            ("phase", self.phase, -1e6, 1e6),
            ("lacunarity", self.detail.lacunarity, 1.0, 8.0),
            ("gain", self.detail.gain, 0.0, 1.0),
            ("jitter", self.jitter, 0.0, 1.0),
            ("width", self.width, 0.0, 1.0),
            ("mortar", self.mortar, 0.0, 1e6),
            ("variation", self.variation, 0.0, 1.0),
        ];
        for (name, x, least, most) in numbers {
            if !(least..=most).contains(&x) {
                return Err(SceneError::new(format!(
                    "{name} must lie between {least} and {most}, not {x}"
                )));
            }
        }
        if !(self.size.min_element() >= 1e-6 && self.size.max_element() <= 1e6) {
            return Err(SceneError::new(format!(
                "size must be 3 numbers between 1e-6 and 1e6, not {}",
                self.size
            )));
        }
        let way = self.to - self.from;
        if !(way.is_finite() && way.length_squared() > 1e-18) {
            return Err(SceneError::new(format!(
                "from and to must be two points, not {} and {}",
                self.from, self.to
            )));
        }
        Ok(())
    }

    /// The number at a point in its own space, mostly from 0 to 1.
    #[must_use]
    pub fn value(&self, p: DVec3) -> f64 {
        use PatternKind as K;
        match self.kind {
            K::Checker => {
                let sum = cell(p.x) + cell(p.y) + cell(p.z);
                sum.rem_euclid(2.0)
            }
            K::Brick => self.brick(p),
            K::Stripes => p.x + INWARDS,
            K::Linear => {
                let way = self.to - self.from;
                (p - self.from).dot(way) / way.length_squared()
            }
            K::Radial => (p.x * p.x + p.z * p.z).sqrt(),
            K::Spherical | K::Onion => p.length(),
            K::Angular => {
                let turn = math::atan2(p.z, p.x) / (2.0 * PI);
                turn - turn.floor()
            }
            K::Wood => triangle((p.x * p.x + p.z * p.z).sqrt()),
            K::Marble => triangle(p.x),
            // The mean of creased noise is about a quarter.
            K::Granite => (noise::turbulence(p, self.detail) * 2.0).min(1.0),
            K::Worley => noise::worley(p, self.jitter).nearest.min(1.0),
            K::Cells => noise::worley(p, self.jitter).cell,
            K::Cracks => {
                let found = noise::worley(p, self.jitter);
                (found.second - found.nearest).min(1.0)
            }
            K::Noise => 0.5 + 0.5 * noise::perlin(p),
            K::Simplex => 0.5 + 0.5 * noise::simplex(p),
            K::Fbm => 0.5 + 0.5 * noise::fbm(p, self.detail),
            K::Turbulence => noise::turbulence(p, self.detail),
            K::Dots => {
                let near = p - (p + DVec3::splat(0.5)).floor();
                truth(near.length_squared() < self.width * self.width)
            }
            K::Hexagon => hexagon(p),
            K::Grid => {
                let from_line = |x: f64| (x - (x + 0.5).floor()).abs();
                truth(from_line(p.x).min(from_line(p.z)) < self.width * 0.5)
            }
            K::Ripples => {
                let wave = |n: i64| {
                    let [x, y, z] = [0, 1, 2].map(|axis| 2.0 * noise::unit(noise::hash(n, axis, 0)) - 1.0);
                    math::sin((p - DVec3::new(x, y, z)).length() * (2.0 * PI))
                };
                0.5 + 0.125 * (wave(0) + wave(1) + wave(2) + wave(3))
            }
        }
    }

    fn brick(&self, p: DVec3) -> f64 {
        // Moved by a quarter and a half, so that no border lies in the faces of shapes about the origin.
        let q = p / self.size + DVec3::new(0.25, 0.5, 0.25);
        let row = q.y.floor();
        let half = if row.rem_euclid(2.0) == 0.0 { 0.0 } else { 0.5 };
        let q = q + DVec3::new(half, 0.0, half);
        let brick = q.floor();
        let inside = q - brick;
        let margin = DVec3::splat(self.mortar * 0.5) / self.size;
        let in_mortar = (inside - margin).min_element() < 0.0 || (inside + margin).max_element() > 1.0;
        if in_mortar {
            return 0.0;
        }
        if self.variation == 0.0 {
            return 1.0;
        }
        let [i, j, k] = brick.to_array().map(|c| c as i64);
        1.0 - self.variation * noise::unit(noise::hash(i, j, k))
    }
}

/// Half a millionth of a cell, so that a face in the plane of a border takes one color instead of rounding noise.
const INWARDS: f64 = 5e-7;

fn cell(x: f64) -> f64 {
    (x + INWARDS).floor()
}

fn truth(is: bool) -> f64 {
    f64::from(u8::from(is))
}

/// 0 at whole numbers, 1 halfway between them, straight lines in between.
fn triangle(x: f64) -> f64 {
    1.0 - (2.0 * (x - x.floor()) - 1.0).abs()
}

/// Which of three colors the hexagon has that holds `p`: hexagons of edge 1 with corners on the x axis, found by rounding cube
/// coordinates (Patel, "Hexagonal grids", 2013).
fn hexagon(p: DVec3) -> f64 {
    let (q, r) = (p.x * (2.0 / 3.0), p.z / 3.0_f64.sqrt() - p.x / 3.0);
    let cube = DVec3::new(q, r, -q - r);
    let mut whole = (cube + DVec3::splat(0.5)).floor();
    let off = (whole - cube).abs();
    if off.x > off.y && off.x > off.z {
        whole.x = -whole.y - whole.z;
    } else if off.y > off.z {
        whole.y = -whole.x - whole.z;
    }
    0.5 * (whole.x - whole.y).rem_euclid(3.0)
}

/// A pattern that was checked, ready to be looked up.
///
/// ```
/// use rtscript::scene::{Pattern, PatternKind, PatternTexture, Texture};
/// let Texture::Pattern(texture) = Texture::pattern(Pattern::new(PatternKind::Wood))? else { panic!("a pattern") };
/// let texture: &PatternTexture = &texture;
/// assert_eq!(texture.pattern().kind, PatternKind::Wood);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PatternTexture {
    pattern: Pattern,
    texture_from_object: DAffine3,
    size: Size,
}

impl PatternTexture {
    pub(super) fn new(pattern: Pattern) -> Result<Self, SceneError> {
        pattern.check()?;
        let size = Size::of(pattern.colors.entries().iter().map(|(_, paint)| paint))?;
        let texture_from_object = pattern.placement.texture_from_object();
        Ok(Self {
            pattern,
            texture_from_object,
            size,
        })
    }

    /// What it was made from.
    #[must_use]
    pub fn pattern(&self) -> &Pattern {
        &self.pattern
    }

    pub(super) fn size(&self) -> Size {
        self.size
    }

    pub(super) fn at(&self, point: &TexturePoint) -> Color {
        let pattern = &self.pattern;
        let p = self.texture_from_object.transform_point3(point.position);
        let value = pattern.value(pattern.placement.stir(p));
        let t = pattern.wave.of(value * pattern.frequency + pattern.phase);
        pattern.colors.at(t, point)
    }
}

#[cfg(test)]
#[path = "pattern_tests.rs"]
mod tests;
