//! An OBJ file, statement by statement: what it holds, once it is known to be right.
//!
//! Every statement is checked as it is read: numbers are finite, indices lie within their lists, and nothing but the
//! host opens a file.

use std::{borrow::Cow, collections::BTreeMap};

use super::{
    assets::Assets,
    text::{Source, counted, number, quoted},
    wavefront::{Statement, Unused, statements},
};
use crate::{
    color::Color,
    diag::{Diagnostic, nearest_names},
    math::{DVec2, DVec3},
    scene::SceneError,
};

/// A checked OBJ file.
#[derive(Debug, Default)]
pub(super) struct Checked<'a> {
    /// `v`, divided by its weight where it has one.
    pub(super) positions: Vec<DVec3>,
    /// `vt`, without a third number.
    pub(super) uvs: Vec<DVec2>,
    /// `vn`, of any length.
    pub(super) normals: Vec<DVec3>,
    /// Scene-linear colors of the positions, one for each; or none.
    pub(super) colors: Vec<Color>,
    /// The corners of all faces, face after face.
    pub(super) corners: Vec<Corner>,
    /// The faces in order.
    pub(super) faces: Vec<Face<'a>>,
    /// The names that `usemtl` gives, each once, and where it stands first.
    pub(super) materials: Vec<(Cow<'a, str>, &'a str)>,
    /// The files that `mtllib` names, and where.
    pub(super) libraries: Vec<(Cow<'a, str>, &'a str)>,
    /// What the mesh has not.
    pub(super) unused: Ignored<'a>,
}

/// What a file may have and a mesh has not.
#[derive(Debug, Default)]
pub(super) struct Ignored<'a> {
    /// `l` and `p`.
    pub(super) lines_and_points: Unused<'a>,
    /// Curves and surfaces of the free-form kind.
    pub(super) free_form: Unused<'a>,
    /// Vertices with a color of their own.
    pub(super) colors: Unused<'a>,
}

/// A corner of a face: indices into the lists of [`Checked`], from 0.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) position: u32,
    /// [`Corner::NONE`] where the corner has none.
    pub(super) uv: u32,
    /// [`Corner::NONE`] where the corner has none.
    pub(super) normal: u32,
}

impl Corner {
    pub(super) const NONE: u32 = u32::MAX;
}

/// Where a face stands and what it is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Face<'a> {
    /// Its keyword.
    pub(super) at: &'a str,
    /// Index into [`Checked::materials`], if a `usemtl` came before.
    pub(super) material: Option<u32>,
    /// Where its corners end in [`Checked::corners`]; they begin where the last face's end.
    pub(super) end: usize,
}

/// Statements between two questions whether to stop: a millisecond's work.
const STATEMENTS_PER_QUESTION: usize = 4096;

/// Checks a whole file.
///
/// # Errors
/// At the first statement that is wrong, and where the host asks to stop.
pub(super) fn check<'a>(source: &Source<'a>, assets: &Assets<'_>) -> Result<Checked<'a>, Diagnostic> {
    let mut guard = Guard {
        source,
        out: Checked::default(),
        lists: LISTS.map(|what| List {
            what,
            len: 0,
            ahead: Vec::new(),
        }),
        triangles: 0,
        max_triangles: assets.limits().primitives,
        material: None,
        material_ids: BTreeMap::new(),
    };
    let mut statements = statements(source);
    let mut count = 0usize;
    while let Some(statement) = statements.next() {
        count += 1;
        if count.is_multiple_of(STATEMENTS_PER_QUESTION) {
            assets.check_stop()?;
        }
        guard.statement(statement)?;
    }
    guard.check_ahead()?;
    Ok(guard.out)
}

/// What the three lists of an OBJ file hold: one and many.
const LISTS: [(&str, &str); 3] = [
    ("vertex", "vertices"),
    ("texture coordinate", "texture coordinates"),
    ("normal", "normals"),
];
const VERTICES: usize = 0;
const TEXTURE_COORDINATES: usize = 1;
const NORMALS: usize = 2;

struct List<'a> {
    what: (&'static str, &'static str),
    len: usize,
    /// Indices of what comes later in the file, each larger than the one before: the first that the whole file
    /// does not reach is among them.
    ahead: Vec<(usize, &'a str)>,
}

struct Guard<'s, 'a> {
    source: &'s Source<'a>,
    out: Checked<'a>,
    lists: [List<'a>; 3],
    triangles: usize,
    max_triangles: usize,
    material: Option<u32>,
    material_ids: BTreeMap<Cow<'a, str>, u32>,
}

impl<'a> Guard<'_, 'a> {
    fn statement(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        // Bytes make one decision tree; strings would be compared one after the other.
        match s.keyword.as_bytes() {
            b"v" => self.vertex(s),
            b"vt" => self.numbers(s, TEXTURE_COORDINATES, (1, 3), "u v [w]"),
            b"vn" => self.numbers(s, NORMALS, (3, 3), "x y z"),
            b"f" | b"fo" => self.face(s),
            b"l" | b"p" => {
                self.out.unused.lines_and_points.add(s.keyword);
                Ok(())
            }
            b"usemtl" => self.use_material(s),
            b"mtllib" => self.library(s),
            b"o" | b"g" | b"s" | b"mg" | b"bevel" | b"c_interp" | b"d_interp" | b"lod" | b"shadow_obj"
            | b"trace_obj" | b"ctech" | b"stech" | b"usemap" | b"maplib" | b"call" | b"csh" => Ok(()),
            b"vp" | b"cstype" | b"deg" | b"bmat" | b"step" | b"parm" | b"trim" | b"hole" | b"scrv"
            | b"sp" | b"end" | b"con" | b"cdc" | b"res" => Ok(()),
            b"curv" | b"curv2" | b"surf" | b"bsp" | b"bzp" | b"cdp" => {
                self.out.unused.free_form.add(s.keyword);
                Ok(())
            }
            _ => Err(self.unknown(s.keyword)),
        }
    }

    fn unknown(&self, keyword: &str) -> Diagnostic {
        let error = self
            .source
            .error(keyword, format!("unknown OBJ keyword {}", quoted(keyword)));
        let known = ["v", "vt", "vn", "f", "l", "p", "o", "g", "s", "usemtl", "mtllib"];
        match nearest_names(keyword, known).first() {
            Some(near) if keyword.len() > 2 || near.eq_ignore_ascii_case(keyword) => error.hint(format!("did you mean '{near}'?")),
            _ => error.hint("is this a Wavefront OBJ file? its lines begin with v, vt, vn, f, o, g, s, usemtl, mtllib or #"),
        }
    }

    fn vertex(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        // A fourth number is a weight to divide by, six are position and color, seven a color with alpha.
        let keep = match s.args.len() {
            3 | 4 => s.args.len(),
            6 | 7 => {
                self.out.unused.colors.add(s.keyword);
                3
            }
            _ => return Err(self.wrong_count(s, "3 numbers (x y z), 4 (x y z w) or 6 (x y z r g b)")),
        };
        let mut values = [0.0; 4];
        for (i, word) in s.args.iter().enumerate() {
            let value = self.number(word)?;
            if let Some(slot) = values.get_mut(i) {
                *slot = value;
            }
        }
        let [x, y, z, w] = values;
        if keep == 4 && !((x / w).abs().max((y / w).abs()).max((z / w).abs()) <= 1e15) {
            let at = s.args.get(3).copied().unwrap_or(s.keyword);
            return Err(self.source.error(
                at,
                format!(
                    "the vertex divided by its weight {} is not within 1e15 of the origin",
                    quoted(at)
                ),
            ));
        }
        let position = DVec3::new(x, y, z);
        self.out
            .positions
            .push(if keep == 4 { position / w } else { position });
        self.count(VERTICES);
        Ok(())
    }

    fn numbers(
        &mut self,
        s: Statement<'_, 'a>,
        list: usize,
        (least, most): (usize, usize),
        usage: &str,
    ) -> Result<(), Diagnostic> {
        if !(least..=most).contains(&s.args.len()) {
            let wanted = if least == most {
                format!("{most} numbers ({usage})")
            } else {
                format!("{least} to {most} numbers ({usage})")
            };
            return Err(self.wrong_count(s, &wanted));
        }
        let mut values = [0.0; 3];
        for (slot, word) in values.iter_mut().zip(s.args) {
            *slot = self.number(word)?;
        }
        let [x, y, z] = values;
        if list == TEXTURE_COORDINATES {
            self.out.uvs.push(DVec2::new(x, y));
        } else {
            self.out.normals.push(DVec3::new(x, y, z));
        }
        self.count(list);
        Ok(())
    }

    fn face(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        if s.args.len() < 3 {
            return Err(self.wrong_count(s, "3 or more corners (v, v/vt, v//vn or v/vt/vn)"));
        }
        self.triangles = self.triangles.saturating_add(s.args.len() - 2);
        if self.triangles > self.max_triangles {
            let error = SceneError::limit("too many triangles", "primitives", self.max_triangles);
            return Err(self.source.place(error.into(), s.keyword));
        }
        for corner in s.args {
            let mut indices = [None; 3];
            for (i, part) in corner.split('/').enumerate() {
                let Some(slot) = indices.get_mut(i) else {
                    return Err(self.bad_corner(corner));
                };
                if !part.is_empty() {
                    *slot = Some(self.index(i, part)?);
                }
            }
            let [Some(v), vt, vn] = indices else {
                return Err(self.bad_corner(corner));
            };
            // What no list reaches is refused when the lists are complete.
            let from_zero = |index: usize| u32::try_from(index - 1).unwrap_or(Corner::NONE);
            self.out.corners.push(Corner {
                position: from_zero(v),
                uv: vt.map_or(Corner::NONE, from_zero),
                normal: vn.map_or(Corner::NONE, from_zero),
            });
        }
        self.out.faces.push(Face {
            at: s.keyword,
            material: self.material,
            end: self.out.corners.len(),
        });
        Ok(())
    }

    fn bad_corner(&self, corner: &str) -> Diagnostic {
        self.source.error(
            corner,
            format!(
                "expected a corner like 1, 1/2, 1//3 or 1/2/3, found {}",
                quoted(corner)
            ),
        )
    }

    /// The index `part` of a list, counted from 1; it may lie ahead.
    fn index(&mut self, list: usize, part: &'a str) -> Result<usize, Diagnostic> {
        let Some(List { what, len, ahead }) = self.lists.get_mut(list) else {
            return Err(self.bad_corner(part));
        };
        let (one, many) = *what;
        let expected = || {
            self.source.error(
                part,
                format!(
                    "expected the number of a {one}, counted from 1 or back from -1, found {}",
                    quoted(part)
                ),
            )
        };
        let value: i64 = part.parse().map_err(|_| expected())?;
        if value < 0 {
            let back = usize::try_from(value.unsigned_abs()).unwrap_or(usize::MAX);
            return match len.checked_sub(back) {
                Some(before) => Ok(before + 1),
                None => Err(self.source.error(
                    part,
                    format!(
                        "there is no {one} {value}: {} before this line",
                        come(*len, (one, many))
                    ),
                )),
            };
        }
        let index = usize::try_from(value).unwrap_or(usize::MAX);
        if index == 0 {
            return Err(expected());
        }
        if index > *len && ahead.last().is_none_or(|(furthest, _)| index > *furthest) {
            ahead.push((index, part));
        }
        Ok(index)
    }

    /// Refuses the first index that the whole file does not reach.
    fn check_ahead(&self) -> Result<(), Diagnostic> {
        let unreached = self.lists.iter().filter_map(|list| {
            let (index, at) = list.ahead.iter().find(|(index, _)| *index > list.len)?;
            Some((*at, *index, list))
        });
        let first = unreached.min_by_key(|(at, ..)| at.as_ptr() as usize);
        let Some((at, index, List { what, len, .. })) = first else {
            return Ok(());
        };
        let (one, many) = *what;
        Err(self.source.error(
            at,
            format!(
                "there is no {one} {index}: the file has {}",
                counted(*len, one, many)
            ),
        ))
    }

    fn use_material(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        let name = s.name_from(0);
        if name.is_empty() {
            return Err(self.nameless(s, "a material"));
        }
        let materials = &mut self.out.materials;
        let id = *self.material_ids.entry(name).or_insert_with_key(|name| {
            materials.push((name.clone(), s.keyword));
            u32::try_from(materials.len() - 1).unwrap_or(u32::MAX)
        });
        self.material = Some(id);
        Ok(())
    }

    fn library(&mut self, s: Statement<'_, 'a>) -> Result<(), Diagnostic> {
        if s.args.is_empty() {
            return Err(self.nameless(s, "a file"));
        }
        // Several names are several files only if each looks like one: "old car.mtl" is a name with a space.
        let is_file = |word: &&str| word.len() > 4 && word.to_ascii_lowercase().ends_with(".mtl");
        if s.args.iter().all(is_file) {
            let files = s.args.iter().map(|word| (Cow::Borrowed(*word), *word));
            self.out.libraries.extend(files);
        } else {
            let at = s.args.first().copied().unwrap_or(s.keyword);
            self.out.libraries.push((s.name_from(0), at));
        }
        Ok(())
    }

    fn number(&self, word: &str) -> Result<f64, Diagnostic> {
        number(word).map_err(|message| self.source.no_number(word, message))
    }

    fn wrong_count(&self, s: Statement<'_, 'a>, wanted: &str) -> Diagnostic {
        let given = s.args.len();
        self.source
            .error(s.keyword, format!("{} takes {wanted}, not {given}", s.keyword))
    }

    fn nameless(&self, s: Statement<'_, 'a>, what: &str) -> Diagnostic {
        self.source.error(
            s.keyword,
            format!("{} takes the name of {what}; it has none", s.keyword),
        )
    }

    fn count(&mut self, list: usize) {
        if let Some(list) = self.lists.get_mut(list) {
            list.len += 1;
        }
    }
}

fn come(n: usize, (one, many): (&str, &str)) -> String {
    format!(
        "{} {}",
        counted(n, one, many),
        if n == 1 { "comes" } else { "come" }
    )
}
