//! What is asked of a font file: which glyph a character has, its outline, how wide it is, how close two may stand.

use std::{collections::BTreeMap, fmt, sync::Arc};

use ttf_parser::{
    Face, FaceParsingError, GlyphId, Tag,
    gpos::{PairAdjustment, PositioningSubtable},
    head::IndexToLocationFormat,
    opentype_layout::LayoutTable,
};

use super::{
    cff::Charstrings,
    outline::{Contour, Pen},
};
use crate::scene::SceneError;

/// A font, of TrueType outlines or of the cubic ones of a table 'CFF '.
///
/// ```
/// use rtscript::tessellate::{Font, Text};
/// let mut word = Text::new("Hi");
/// word.font = Font::built_in();
/// assert!(Font::read(b"no font").is_err());
/// ```
#[derive(Clone, PartialEq)]
pub struct Font {
    bytes: Arc<[u8]>,
}

impl fmt::Debug for Font {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Font")
            .field("bytes", &self.bytes.len())
            .finish_non_exhaustive()
    }
}

impl Default for Font {
    fn default() -> Self {
        Self::built_in()
    }
}

/// Bytes of outlines, or steps of drawing, that a glyph may be put together of: more is a file that means harm.
const MOST_OUTLINE_BYTES: u64 = 1 << 20;

impl Font {
    /// DejaVu Sans with Latin, Greek, punctuation and some signs; `src/tessellate/fonts/README.md` says which.
    #[must_use]
    pub fn built_in() -> Self {
        Self {
            bytes: Arc::from(&include_bytes!("../fonts/latin.ttf")[..]),
        }
    }

    /// The font in a file, the first one of a collection.
    ///
    /// # Errors
    /// Where the bytes are no font, or a font with other outlines.
    pub fn read(bytes: &[u8]) -> Result<Self, SceneError> {
        let face = Face::parse(bytes, 0).map_err(|error| {
            SceneError::new(match error {
                FaceParsingError::UnknownMagic => "it is no font that can be read".to_owned(),
                error => format!("the font is damaged: {error}"),
            })
            .hint("fonts are TrueType files, which end in .ttf, .otf or .ttc")
        })?;
        if face.tables().glyf.is_none() && charstrings(&face).is_none() {
            return Err(SceneError::new(
                "the font has no outlines that can be read (a table 'glyf' or 'CFF ')",
            )
            .hint("convert a variable font to one of its instances, and bitmaps to outlines"));
        }
        Ok(Self {
            bytes: Arc::from(bytes),
        })
    }

    pub(super) fn face(&self) -> Result<Typeface<'_>, SceneError> {
        let face = Face::parse(&self.bytes, 0)
            .map_err(|error| SceneError::new(format!("the font cannot be read: {error}")))?;
        Ok(Typeface {
            kerning: kerning_lookups(&face),
            costs: BTreeMap::new(),
            charstrings: charstrings(&face),
            face,
        })
    }
}

/// A font that is being read.
pub(super) struct Typeface<'a> {
    face: Face<'a>,
    /// Numbers of the lookups of the feature 'kern' in the table GPOS.
    kerning: Vec<u16>,
    /// See [`Typeface::cost`].
    costs: BTreeMap<u16, u64>,
    /// Where the outlines are those of a table 'CFF '.
    charstrings: Option<Charstrings<'a>>,
}

impl Typeface<'_> {
    pub(super) fn units_per_em(&self) -> f64 {
        f64::from(self.face.units_per_em())
    }

    /// From the baseline to the top of a line and, negative, to its bottom.
    pub(super) fn ascent_and_descent(&self) -> (f64, f64) {
        (f64::from(self.face.ascender()), f64::from(self.face.descender()))
    }

    /// From one baseline to the next.
    pub(super) fn line_height(&self) -> f64 {
        f64::from(self.face.height()) + f64::from(self.face.line_gap())
    }

    /// The glyph of a character, where the font has it.
    pub(super) fn glyph(&self, c: char) -> Option<GlyphId> {
        self.face.glyph_index(c).filter(|glyph| glyph.0 != 0)
    }

    pub(super) fn advance(&self, glyph: GlyphId) -> f64 {
        f64::from(self.face.glyph_hor_advance(glyph).unwrap_or(0))
    }

    /// What is added to the advance of `left` where `right` follows: by the table GPOS, or `kern` where that says nothing.
    pub(super) fn kerning(&self, left: GlyphId, right: GlyphId) -> f64 {
        if let Some(gpos) = self.face.tables().gpos.filter(|_| !self.kerning.is_empty()) {
            let pairs = self
                .kerning
                .iter()
                .filter_map(|lookup| pair(&gpos, *lookup, left, right));
            return pairs.map(f64::from).sum();
        }
        let Some(kern) = self.face.tables().kern else {
            return 0.0;
        };
        let tables = kern
            .subtables
            .into_iter()
            .filter(|table| table.horizontal && !table.variable && !table.has_cross_stream);
        let kernings = tables.filter_map(|table| table.glyphs_kerning(left, right));
        kernings.map(f64::from).sum()
    }

    /// The outline of a glyph in units of the font, flattened to `tolerance`.
    ///
    /// # Errors
    /// Where the glyph is put together of more than any glyph needs.
    pub(super) fn outline(&mut self, glyph: GlyphId, tolerance: f64) -> Result<Vec<Contour>, SceneError> {
        let is_small = match &self.charstrings {
            Some(charstrings) => charstrings.cost(glyph.0, MOST_OUTLINE_BYTES).is_some(),
            None => self.cost(glyph.0, 0) <= MOST_OUTLINE_BYTES,
        };
        if !is_small {
            return Err(too_complex(glyph));
        }
        let mut pen = Pen::new(tolerance);
        self.face.outline_glyph(glyph, &mut pen);
        pen.finish().ok_or_else(|| too_complex(glyph))
    }

    /// Bytes of outlines that are read for a glyph: parts that name parts that name parts multiply.
    fn cost(&mut self, glyph: u16, depth: u32) -> u64 {
        if let Some(known) = self.costs.get(&glyph) {
            return *known;
        }
        if depth > 32 {
            return u64::MAX;
        }
        let Some(data) = self.data(glyph) else {
            return 0;
        };
        let mut cost = data.len() as u64;
        if data.first().is_some_and(|byte| *byte >= 0x80) {
            for part in parts(data) {
                cost = cost.saturating_add(self.cost(part, depth + 1));
            }
        }
        self.costs.insert(glyph, cost);
        cost
    }

    /// The bytes of a glyph's outline in the table 'glyf'.
    fn data(&self, glyph: u16) -> Option<&[u8]> {
        let table = |name| self.face.raw_face().table(Tag::from_bytes(name));
        let (places, outlines) = (table(b"loca")?, table(b"glyf")?);
        let place = |i: usize| -> Option<usize> {
            Some(match self.face.tables().head.index_to_location_format {
                IndexToLocationFormat::Short => {
                    2 * usize::from(u16::from_be_bytes(*places.get(2 * i..)?.first_chunk()?))
                }
                IndexToLocationFormat::Long => {
                    u32::from_be_bytes(*places.get(4 * i..)?.first_chunk()?) as usize
                }
            })
        };
        let glyph = usize::from(glyph);
        outlines.get(place(glyph)?..place(glyph + 1)?)
    }
}

/// The outlines of a font that has none of the TrueType kind.
fn charstrings<'a>(face: &Face<'a>) -> Option<Charstrings<'a>> {
    if face.tables().glyf.is_some() {
        return None;
    }
    face.tables().cff?;
    Charstrings::read(face.raw_face().table(Tag::from_bytes(b"CFF "))?)
}

fn too_complex(glyph: GlyphId) -> SceneError {
    SceneError::new(format!(
        "glyph {} of the font has too complex an outline",
        glyph.0
    ))
}

/// The glyphs that a composite glyph is made of (OpenType, table 'glyf').
fn parts(data: &[u8]) -> Vec<u16> {
    const HEADER: usize = 10;
    const MORE: u16 = 0x20;
    let mut parts = Vec::new();
    let mut rest = data.get(HEADER..).unwrap_or(&[]);
    while let Some((head, after)) = rest.split_first_chunk::<4>() {
        let [f0, f1, g0, g1] = *head;
        let flags = u16::from_be_bytes([f0, f1]);
        parts.push(u16::from_be_bytes([g0, g1]));
        let offset = if flags & 1 == 0 { 2 } else { 4 };
        let matrix = match flags & 0xc8 {
            0 => 0,
            0x08 => 2,
            0x40 => 4,
            _ => 8,
        };
        rest = after.get(offset + matrix..).unwrap_or(&[]);
        if flags & MORE == 0 {
            break;
        }
    }
    parts
}

fn kerning_lookups(face: &Face<'_>) -> Vec<u16> {
    let Some(gpos) = face.tables().gpos else {
        return Vec::new();
    };
    let mut lookups: Vec<u16> = gpos
        .features
        .into_iter()
        .filter(|feature| feature.tag == Tag::from_bytes(b"kern"))
        .flat_map(|feature| feature.lookup_indices.into_iter())
        .collect();
    lookups.sort_unstable();
    lookups.dedup();
    lookups
}

/// What a lookup says of a pair: the first of its subtables that covers the first glyph and has the second.
fn pair(gpos: &LayoutTable<'_>, lookup: u16, left: GlyphId, right: GlyphId) -> Option<i16> {
    let subtables = gpos.lookups.get(lookup)?.subtables;
    subtables
        .into_iter::<PositioningSubtable<'_>>()
        .find_map(|subtable| {
            let PositioningSubtable::Pair(pair) = subtable else {
                return None;
            };
            let covered = pair.coverage().get(left)?;
            let first = match pair {
                PairAdjustment::Format1 { sets, .. } => sets.get(covered)?.get(right)?.0,
                PairAdjustment::Format2 { classes, matrix, .. } => {
                    matrix.get((classes.0.get(left), classes.1.get(right)))?.0
                }
            };
            Some(first.x_advance)
        })
}

#[cfg(test)]
mod tests {
    use super::{super::outline::area, *};

    #[test]
    fn the_built_in_font_kerns() {
        let font = Font::built_in();
        let face = font.face().unwrap();
        let pair = |a, b| face.kerning(face.glyph(a).unwrap(), face.glyph(b).unwrap());
        assert_eq!(face.units_per_em(), 2048.0);
        assert_eq!(pair('A', 'V'), -131.0);
        assert_eq!(pair('H', 'H'), 0.0);
        assert_eq!(face.glyph('\u{4e2d}'), None);
    }

    #[test]
    fn no_bytes_hurt() {
        let whole = include_bytes!("../fonts/latin.ttf");
        assert!(Font::read(b"").is_err() && Font::read(b"no font at all, but long enough").is_err());
        let mut rng = crate::tessellate::suite::Rng::new(5);
        for _ in 0..200 {
            let mut bytes = whole.to_vec();
            for _ in 0..20 {
                // Most of what is to be read stands at the beginning.
                let n = if rng.below(2) == 0 { 2000 } else { bytes.len() };
                let at = rng.below(n);
                bytes[at] = rng.below(256) as u8;
            }
            bytes.truncate(1 + rng.below(whole.len()));
            let Ok(font) = Font::read(&bytes) else { continue };
            let Ok(mut face) = font.face() else { continue };
            for c in "AVe\u{e4}".chars() {
                if let Some(glyph) = face.glyph(c) {
                    let _ = (
                        face.outline(glyph, 1.0),
                        face.kerning(glyph, glyph),
                        face.advance(glyph),
                    );
                }
            }
        }
    }

    #[test]
    fn cubic_outlines_are_those_of_the_file() {
        let bytes = include_bytes!("../fonts/rounds.otf");
        let font = Font::read(bytes).unwrap();
        let mut face = font.face().unwrap();
        let mut contours = |c: char| {
            let glyph = face.glyph(c).unwrap();
            face.outline(glyph, 0.01).unwrap()
        };
        // An L of straight lines by a subroutine: 400 by 150 and 150 by 550.
        let [letter] = &contours('L')[..] else { panic!() };
        assert_eq!(area(letter).abs(), 400.0 * 150.0 + 150.0 * 550.0);
        // A ring between circles of radius 350 and 200, which four cubic curves meet within 3 in 10,000.
        let ring = contours('O');
        let [outer, inner] = &ring[..] else { panic!() };
        assert!(area(outer) * area(inner) < 0.0);
        let sum = area(outer).abs() - area(inner).abs();
        let circles = std::f64::consts::PI * (350.0 * 350.0 - 200.0 * 200.0);
        assert!((sum / circles - 1.0).abs() < 1e-3, "{sum} {circles}");
        let mut rng = crate::tessellate::suite::Rng::new(7);
        for _ in 0..2000 {
            let mut bytes = bytes.to_vec();
            for _ in 0..1 + rng.below(4) {
                let at = rng.below(bytes.len());
                bytes[at] = rng.below(256) as u8;
            }
            let Ok(font) = Font::read(&bytes) else { continue };
            let Ok(mut face) = font.face() else { continue };
            for glyph in "OLD".chars().filter_map(|c| face.glyph(c)).collect::<Vec<_>>() {
                let _ = face.outline(glyph, 1.0);
            }
        }
    }

    #[test]
    fn parts_that_multiply_are_counted() {
        let font = Font::built_in();
        let mut face = font.face().unwrap();
        let glyph = face.glyph('\u{e4}').unwrap();
        let parts = parts(face.data(glyph.0).unwrap());
        assert_eq!(parts.len(), 2);
        let sum: u64 = parts
            .iter()
            .map(|part| face.data(*part).unwrap().len() as u64)
            .sum();
        assert_eq!(
            face.cost(glyph.0, 0),
            face.data(glyph.0).unwrap().len() as u64 + sum
        );
        face.costs.insert(parts[0], MOST_OUTLINE_BYTES);
        face.costs.remove(&glyph.0);
        assert!(face.outline(glyph, 1.0).is_err());
    }
}
