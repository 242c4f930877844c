//! Colors that are written out where the language takes a color.

use std::ops::Range;

use super::{Analysis, TokenKind, assigned};
use crate::{
    color::{Color, from_hex},
    script::{Kind, Param, entry},
};

/// How a color is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Notation {
    /// `"#rrggbb"`, sRGB.
    Code,
    /// `[r, g, b]`, linear.
    Array,
    /// `vec3(r, g, b)`, linear.
    Vector,
    /// Three arguments, linear.
    Numbers,
}

/// A color in a script.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ColorPlace {
    /// Its bytes, quotes and brackets included.
    pub(crate) span: Range<usize>,
    /// Its value in scene-linear RGB.
    pub(crate) color: Color,
    /// How it is written.
    pub(crate) notation: Notation,
}

/// All colors that are arguments of the language's own functions, or stand in a map of options under the name of a
/// function that takes a color.
pub(crate) fn colors(text: &Analysis) -> Vec<ColorPlace> {
    let mut found = Vec::new();
    for name in 0..text.tokens.len() {
        let method = matches!(text.word_near(name, -1), "." | "?." | "::");
        let Some(entry) = entry(text.word(name)).filter(|_| !method) else {
            continue;
        };
        let Some(call) = text.call_of(name) else { continue };
        let own = text
            .functions_named(entry.name)
            .any(|s| s.params.len() == call.args.len());
        let forms = entry.forms.iter().filter(|_| !own);
        let fitting = forms.filter_map(|form| Some((form, assigned(text, form, &call.args, true)?)));
        let Some((form, params)) = fitting.into_iter().next() else {
            continue;
        };
        for (i, param) in form.iter().enumerate() {
            let args: Vec<&Range<usize>> = call
                .args
                .iter()
                .zip(&params)
                .filter(|(_, p)| **p == i)
                .map(|(arg, _)| arg)
                .collect();
            match (param.kind, args.as_slice()) {
                (Kind::Color | Kind::Term, [one]) => found.extend(text.color(one)),
                (Kind::Color | Kind::Term, [_, _, _]) => found.extend(text.three(&args)),
                (Kind::Map, [map]) => text.options(param, map, &mut found),
                _ => {}
            }
        }
    }
    found
}

/// Whether a key of options takes a color: it is the name of a function that does.
fn takes_color(key: &str) -> bool {
    let first = entry(key)
        .and_then(|e| e.forms.first())
        .and_then(|form| form.first());
    first.is_some_and(|p| matches!(p.kind, Kind::Color | Kind::Term))
}

impl Analysis {
    fn options(&self, param: &Param, map: &Range<usize>, found: &mut Vec<ColorPlace>) {
        if self.word(map.start) != "#{" {
            return;
        }
        let (values, _) = self.list(map.start + 1..map.end.saturating_sub(1));
        for value in values {
            let key = self.word(value.start);
            if param.keys.contains(&key) && takes_color(key) && self.word(value.start + 1) == ":" {
                found.extend(self.color(&(value.start + 2..value.end)));
            }
        }
    }

    /// One argument that is a color.
    fn color(&self, arg: &Range<usize>) -> Option<ColorPlace> {
        let span = self.span_of(arg)?;
        let (color, notation) = match self.word(arg.start) {
            "[" => (
                self.components(arg.start + 1..arg.end.saturating_sub(1))?,
                Notation::Array,
            ),
            "vec3" if self.word(arg.start + 1) == "(" => (
                self.components(arg.start + 2..arg.end.saturating_sub(1))?,
                Notation::Vector,
            ),
            _ if arg.len() == 1 => (from_hex(self.string(arg.start)?)?, Notation::Code),
            _ => return None,
        };
        Some(ColorPlace {
            span,
            color,
            notation,
        })
    }

    fn components(&self, range: Range<usize>) -> Option<Color> {
        let (parts, _) = self.list(range);
        self.three(&parts.iter().collect::<Vec<_>>())
            .map(|place| place.color)
    }

    /// Three numbers.
    fn three(&self, args: &[&Range<usize>]) -> Option<ColorPlace> {
        let [r, g, b] = args else { return None };
        let number = |arg: &Range<usize>| {
            let is_number = self
                .tokens
                .get(arg.start)
                .is_some_and(|t| t.kind == TokenKind::Number);
            let digits = self.word(arg.start).replace('_', "");
            digits
                .parse::<f64>()
                .ok()
                .filter(|x| is_number && arg.len() == 1 && x.is_finite())
        };
        Some(ColorPlace {
            color: Color::new(number(r)?, number(g)?, number(b)?),
            span: self.span_of(&(r.start..b.end))?,
            notation: Notation::Numbers,
        })
    }
}
