//! Text as solids: outlines of a font, extruded.

mod cff;
mod font;
mod outline;
mod solid;

use std::collections::BTreeMap;

use ttf_parser::GlyphId;

pub use font::Font;
use font::Typeface;
use outline::regions;
use solid::Prism;

use super::Allowance;
use crate::{
    math::{DVec2, DVec3},
    scene::{Attribute, Mesh, SceneError},
};

/// Where lines of text are, seen along x.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Align {
    /// They begin at x = 0.
    #[default]
    Left,
    /// Their middles are at x = 0.
    Center,
    /// They end at x = 0.
    Right,
}

/// Where text is, seen along y.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum VerticalAlign {
    /// The first line stands on y = 0.
    #[default]
    Baseline,
    /// Its top is at y = 0.
    Top,
    /// Its middle is at y = 0.
    Middle,
    /// Its bottom is at y = 0.
    Bottom,
}

/// Lines of text, from left to right, one glyph for each character.
///
/// ```
/// use rtscript::{Limits, tessellate::{Align, Allowance, Text, TextSize, VerticalAlign}};
/// let mut word = Text::new("Hi");
/// word.align = Align::Center;
/// word.vertical_align = VerticalAlign::Middle;
/// let limits = Limits::default();
/// let size: TextSize = word.measure(&Allowance::of(&limits))?;
/// assert!(size.lines == 1 && size.width > 0.0);
/// assert!(word.mesh(&Allowance::of(&limits))?.is_some());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Text {
    /// The characters; `\n` begins a line.
    pub text: String,
    /// The font. Default: [`Font::built_in`].
    pub font: Font,
    /// The em, the height that the font is designed on, in object units, greater than 0; capitals are about 0.7 of it.
    /// Default: 1.
    pub size: f64,
    /// From the back at z = -depth / 2 to the front, in object units; 0 makes faces without walls and back.
    /// Default: 0.2.
    pub depth: f64,
    /// Default: left.
    pub align: Align,
    /// Default: the baseline.
    pub vertical_align: VerticalAlign,
    /// Whether pairs such as AV are moved together as the font says. Default: true.
    pub kerning: bool,
    /// From one line to the next, times what the font says. Default: 1.
    pub line_spacing: f64,
    /// Added after each character, in object units. Default: 0.
    pub letter_spacing: f64,
    /// How far edges may be off the curves of the letters, in object units, greater than 0. Default: a thousandth of the
    /// size.
    pub tolerance: Option<f64>,
}

/// How large text is, in object units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TextSize {
    /// Of the longest line, by the advances of its characters.
    pub width: f64,
    /// From the top of the first line to the bottom of the last.
    pub height: f64,
    /// From the first baseline up to the top.
    pub ascent: f64,
    /// From the last baseline down to the bottom.
    pub descent: f64,
    /// Lines.
    pub lines: usize,
}

/// Where each glyph is put.
struct Layout {
    glyphs: Vec<(GlyphId, DVec2)>,
    size: TextSize,
    /// The lower left corner of the block of lines.
    low: DVec2,
    /// Characters that the font does not have, each once.
    missing: Vec<char>,
}

impl Text {
    /// Text in the built-in font.
    #[must_use]
    pub fn new(text: &str) -> Self {
        Self {
            text: text.to_owned(),
            font: Font::built_in(),
            size: 1.0,
            depth: 0.2,
            align: Align::Left,
            vertical_align: VerticalAlign::Baseline,
            kerning: true,
            line_spacing: 1.0,
            letter_spacing: 0.0,
            tolerance: None,
        }
    }

    fn check(&self) -> Result<(), SceneError> {
        let size = [("size", self.size), ("tolerance", self.tolerance.unwrap_or(1.0))];
        for (name, x) in size {
            if !(x > 0.0 && x <= 1e9) {
                return Err(SceneError::new(format!(
                    "{name} must be greater than 0 and at most 1e9, not {x}"
                )));
            }
        }
        if !(self.depth >= 0.0 && self.depth <= 1e9) {
            let depth = self.depth;
            return Err(SceneError::new(format!(
                "depth must be 0 or greater and at most 1e9, not {depth}"
            )));
        }
        for (name, x) in [
            ("lineSpacing", self.line_spacing),
            ("letterSpacing", self.letter_spacing),
        ] {
            if !(x.abs() <= 1e9) {
                return Err(SceneError::new(format!(
                    "{name} must be a number within 1e9, not {x}"
                )));
            }
        }
        Ok(())
    }

    fn layout(&self, face: &Typeface<'_>, allowance: &Allowance<'_>) -> Result<Layout, SceneError> {
        self.check()?;
        let scale = self.size / face.units_per_em();
        let down = face.line_height() * scale * self.line_spacing;
        let mut layout = Layout {
            glyphs: Vec::new(),
            size: TextSize {
                width: 0.0,
                height: 0.0,
                ascent: face.ascent_and_descent().0 * scale,
                descent: -face.ascent_and_descent().1 * scale,
                lines: 0,
            },
            low: DVec2::ZERO,
            missing: Vec::new(),
        };
        let mut left = 0.0f64;
        for line in self.text.split('\n') {
            allowance.check_stop()?;
            let y = -down * layout.size.lines as f64;
            let start = layout.glyphs.len();
            let (mut x, mut before) = (0.0, None);
            for (i, c) in line.chars().filter(|c| *c != '\r').enumerate() {
                if i % 256 == 255 {
                    allowance.check_stop()?;
                }
                let glyph = face.glyph(c).unwrap_or_else(|| {
                    if !c.is_whitespace() && !layout.missing.contains(&c) && layout.missing.len() < 100 {
                        layout.missing.push(c);
                    }
                    GlyphId(0)
                });
                if let Some(before) = before.filter(|_| self.kerning) {
                    x += face.kerning(before, glyph) * scale;
                }
                let missing_space = glyph == GlyphId(0) && c.is_whitespace();
                if !missing_space {
                    layout.glyphs.push((glyph, DVec2::new(x, y)));
                }
                x += face.advance(glyph) * scale + self.letter_spacing;
                before = Some(glyph);
            }
            if before.is_some() {
                x -= self.letter_spacing;
            }
            let shift = match self.align {
                Align::Left => 0.0,
                Align::Center => -x / 2.0,
                Align::Right => -x,
            };
            for (_, place) in layout.glyphs.get_mut(start..).unwrap_or_default() {
                place.x += shift;
            }
            left = left.min(shift);
            layout.size.width = layout.size.width.max(x);
            layout.size.lines += 1;
        }
        let between = down * (layout.size.lines.max(1) - 1) as f64;
        let size = &mut layout.size;
        size.height = size.ascent + between + size.descent;
        let up = match self.vertical_align {
            VerticalAlign::Baseline => 0.0,
            VerticalAlign::Top => -size.ascent,
            VerticalAlign::Middle => size.height / 2.0 - size.ascent,
            VerticalAlign::Bottom => between + size.descent,
        };
        for (_, place) in &mut layout.glyphs {
            place.y += up;
        }
        layout.low = DVec2::new(left, up - between - size.descent);
        Ok(layout)
    }

    /// How large it is.
    ///
    /// # Errors
    /// Where the font cannot be read or a number makes no sense.
    pub fn measure(&self, allowance: &Allowance<'_>) -> Result<TextSize, SceneError> {
        Ok(self.layout(&self.font.face()?, allowance)?.size)
    }

    /// The characters that the font does not have; a box stands in their place.
    ///
    /// # Errors
    /// As [`Text::measure`].
    ///
    /// ```
    /// use rtscript::{Limits, tessellate::{Allowance, Text}};
    /// let limits = Limits::default();
    /// let missing = Text::new("Hi 你").missing(&Allowance::of(&limits))?;
    /// assert_eq!(missing, ['你']);
    /// # Ok::<(), rtscript::scene::SceneError>(())
    /// ```
    pub fn missing(&self, allowance: &Allowance<'_>) -> Result<Vec<char>, SceneError> {
        Ok(self.layout(&self.font.face()?, allowance)?.missing)
    }

    /// Its triangles: each letter closed, walls smooth along curves and sharp at corners; uvs go from 0 to 1 over the block
    /// of lines, on front, back and walls alike. `None` where nothing of it is to be seen.
    ///
    /// # Errors
    /// As [`Text::measure`]; where a glyph is too complex, or the triangles are too many.
    pub fn mesh(&self, allowance: &Allowance<'_>) -> Result<Option<Mesh>, SceneError> {
        let mut face = self.font.face()?;
        let layout = self.layout(&face, allowance)?;
        let scale = self.size / face.units_per_em();
        let tolerance = self.tolerance.unwrap_or(self.size / 1000.0) / scale;
        let mut prisms: BTreeMap<GlyphId, Prism> = BTreeMap::new();
        let mut block = Block {
            depth: self.depth,
            low: layout.low,
            size: DVec2::new(layout.size.width, layout.size.height).max(DVec2::splat(1e-300)),
            ..Block::default()
        };
        for (glyph, place) in &layout.glyphs {
            allowance.check_stop()?;
            if !prisms.contains_key(glyph) {
                let mut prism = Prism::default();
                for region in regions(face.outline(*glyph, tolerance)?) {
                    prism.add(&region);
                }
                prisms.insert(*glyph, prism);
            }
            if let Some(prism) = prisms.get(glyph) {
                let count = 2 * (prism.triangles.len() + prism.walls.len());
                allowance.triangles(block.triangles.len().saturating_add(count))?;
                block.add(prism, scale, *place);
            }
        }
        if block.triangles.is_empty() {
            return Ok(None);
        }
        let uv_indices = block.triangles.clone();
        let mut mesh = Mesh::new("text", block.positions, block.triangles)?;
        mesh.normals = Some(Attribute {
            values: block.normals,
            indices: block.normal_indices,
        });
        mesh.uvs = Some(Attribute {
            values: block.uvs,
            indices: uv_indices,
        });
        Ok(Some(mesh))
    }
}

/// The mesh in the making.
#[derive(Default)]
struct Block {
    depth: f64,
    low: DVec2,
    size: DVec2,
    positions: Vec<DVec3>,
    uvs: Vec<DVec2>,
    normals: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    normal_indices: Vec<[u32; 3]>,
}

impl Block {
    fn add(&mut self, prism: &Prism, scale: f64, place: DVec2) {
        let points: Vec<DVec2> = prism.points.iter().map(|p| *p * scale + place).collect();
        let first = self.positions.len() as u32;
        let count = points.len() as u32;
        let flat = self.depth == 0.0;
        for z in [0.5, -0.5].into_iter().take(if flat { 1 } else { 2 }) {
            self.positions
                .extend(points.iter().map(|p| p.extend(z * self.depth)));
            self.uvs
                .extend(points.iter().map(|p| (*p - self.low) / self.size));
        }
        let front = self.normal(DVec3::Z);
        for t in &prism.triangles {
            self.triangles.push(t.map(|i| first + i));
            self.normal_indices.push([front; 3]);
        }
        if flat {
            return;
        }
        let back = self.normal(DVec3::NEG_Z);
        for [a, b, c] in &prism.triangles {
            self.triangles.push([*a, *c, *b].map(|i| first + count + i));
            self.normal_indices.push([back; 3]);
        }
        let mut last: Option<(DVec2, u32)> = None;
        for [(a, leaving), (b, arriving)] in &prism.walls {
            let n = match last {
                Some((normal, n)) if normal == *leaving => n,
                _ => self.normal(leaving.extend(0.0)),
            };
            let m = if leaving == arriving {
                n
            } else {
                self.normal(arriving.extend(0.0))
            };
            last = Some((*arriving, m));
            let [a, b] = [first + a, first + b];
            let [c, d] = [a + count, b + count];
            self.triangles.extend([[a, c, d], [a, d, b]]);
            self.normal_indices.extend([[n, n, m], [n, m, m]]);
        }
    }

    fn normal(&mut self, normal: DVec3) -> u32 {
        self.normals.push(normal);
        self.normals.len() as u32 - 1
    }
}

#[cfg(test)]
mod tests {
    use super::{super::suite, *};
    use crate::Limits;

    fn allowance() -> Allowance<'static> {
        Allowance::of(&Limits::default())
    }

    #[test]
    fn every_letter_is_a_closed_solid_as_large_as_its_outline() {
        let font = Font::built_in();
        let mut letters = 0;
        for c in (' '..='\u{17f}')
            .chain('\u{391}'..='\u{3c9}')
            .chain("\u{20ac}\u{2211}\u{221e}\u{2026}".chars())
        {
            let mut face = font.face().unwrap();
            let Some(glyph) = face.glyph(c) else { continue };
            for tolerance in [0.0004, 0.02] {
                let text = Text {
                    tolerance: Some(tolerance),
                    ..Text::new(&c.to_string())
                };
                let Some(mesh) = text.mesh(&allowance()).unwrap() else {
                    continue;
                };
                suite::check_closed(&mesh);
                // Triangles that turned over or overlapped would make the fronts larger than what the outlines enclose.
                let outlines = regions(face.outline(glyph, tolerance * 2048.0).unwrap());
                let enclosed: f64 = outlines
                    .iter()
                    .flat_map(|region| std::iter::once(&region.outer).chain(&region.holes))
                    .map(|contour| outline::area(contour))
                    .sum();
                let mut fronts = 0.0;
                for face in 0..mesh.triangles.len() {
                    let [a, b, c] = mesh.corners(face);
                    let n = (b - a).cross(c - a);
                    if a.z > 0.0 && b.z > 0.0 && c.z > 0.0 {
                        assert!(n.z >= -1e-12, "{c}");
                        fronts += n.z / 2.0;
                    }
                }
                let expected = enclosed / (2048.0 * 2048.0);
                assert!((fronts - expected).abs() < 1e-9, "{c}: {fronts} for {expected}");
                let volume = suite::volume(&mesh);
                assert!((volume - expected * 0.2).abs() < 1e-9, "{c}: {volume}");
                letters += 1;
            }
        }
        assert!(letters > 600, "{letters}");
    }

    #[test]
    fn walls_are_smooth_along_curves_and_sharp_at_corners() {
        let mesh = |text: &str| Text::new(text).mesh(&allowance()).unwrap().unwrap();
        for text in ["I", "O", "B", "&"] {
            suite::check_normals(&mesh(text), 0.9);
        }
        // Walls of an I have four directions, those of an O one at each point of its two outlines.
        let upright = |mesh: &Mesh| {
            let normals = mesh.normals.as_ref().unwrap();
            let mut all: Vec<_> = normals.values.iter().filter(|n| n.z == 0.0).collect();
            all.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
            all.dedup();
            all.len()
        };
        assert_eq!(upright(&mesh("I")), 4);
        assert!(upright(&mesh("O")) > 40);
    }

    #[test]
    fn lines_are_aligned_and_pairs_kerned() {
        let size = |text: &Text| text.measure(&allowance()).unwrap();
        let mut text = Text::new("AV");
        let kerned = size(&text).width;
        text.kerning = false;
        assert!((size(&text).width - kerned - 131.0 / 2048.0).abs() < 1e-12);
        text.text = "HH\nH".to_owned();
        let two = size(&text);
        assert_eq!(two.lines, 2);
        assert!((two.width - 2.0 * size(&Text::new("H")).width).abs() < 1e-12);
        assert!((two.height - two.ascent - two.descent - (2384.0 / 2048.0)).abs() < 1e-12);
        for (align, middle) in [(Align::Left, 1.0), (Align::Center, 0.0), (Align::Right, -1.0)] {
            text.align = align;
            let bounds = text.mesh(&allowance()).unwrap().unwrap().bounds();
            let off = bounds.center().x - middle * two.width / 2.0;
            assert!(off.abs() < 1e-9, "{align:?} {off}");
        }
        for (align, low, high) in [
            (VerticalAlign::Top, -two.height, 0.0),
            (VerticalAlign::Middle, -two.height / 2.0, two.height / 2.0),
            (VerticalAlign::Bottom, 0.0, two.height),
        ] {
            text.vertical_align = align;
            let bounds = text.mesh(&allowance()).unwrap().unwrap().bounds();
            let within = bounds.min.y >= low && bounds.max.y <= high;
            assert!(
                within && bounds.size().y > 0.7 * two.height,
                "{align:?} {bounds:?}"
            );
        }
    }

    #[test]
    fn nothing_to_be_seen_is_no_mesh_and_nonsense_an_error() {
        assert_eq!(Text::new(" \n").mesh(&allowance()).unwrap(), None);
        let mut text = Text::new("a\u{4e2d}\u{4e2d}");
        assert_eq!(text.missing(&allowance()).unwrap(), ['\u{4e2d}']);
        text.depth = 0.0;
        let flat = text.mesh(&allowance()).unwrap().unwrap();
        assert_eq!(flat.bounds().size().z, 0.0);
        text.size = 0.0;
        let error = text.mesh(&allowance()).unwrap_err();
        assert_eq!(
            error.message,
            "size must be greater than 0 and at most 1e9, not 0"
        );
        let few = Limits {
            primitives: 50,
            ..Limits::default()
        };
        let text = Text::new("ABC");
        assert!(
            text.mesh(&Allowance::of(&few))
                .unwrap_err()
                .message
                .contains("'primitives'")
        );
    }
}
