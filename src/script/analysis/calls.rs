//! Calls as they are written, finished or not, and which parameter an argument is for.

use std::ops::Range;

use super::{Analysis, TokenKind};
use crate::script::{Kind, Param};

/// A call.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Call {
    /// Token of the function's name.
    pub(crate) name: usize,
    /// Token of the module's name, in `module::function()`.
    pub(crate) module: Option<usize>,
    /// Tokens of each argument. What follows the last comma counts, even where nothing follows it.
    pub(crate) args: Vec<Range<usize>>,
    /// Bytes of the commas between them.
    commas: Vec<usize>,
}

impl Call {
    /// Which argument `offset` stands in, from 0.
    pub(crate) fn active(&self, offset: usize) -> usize {
        self.commas.iter().filter(|c| **c < offset).count()
    }
}

/// What can be told of an argument by how it is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Shape {
    Number,
    Text,
    Array,
    Map,
    Other,
}

impl Analysis {
    /// The innermost call whose arguments `offset` stands in. A block ends the search: what is in it is a statement.
    pub(crate) fn call_at(&self, offset: usize) -> Option<Call> {
        let mut holder = self.bracket_at(offset);
        while let Some(bracket) = holder.and_then(|b| self.brackets.get(b)) {
            match self.word(bracket.open) {
                "(" => {
                    if let Some(call) = bracket.open.checked_sub(1).and_then(|name| self.call_of(name)) {
                        return Some(call);
                    }
                }
                "{" | "${" => return None,
                _ => {}
            }
            holder = bracket.outer;
        }
        None
    }

    /// The call of the function whose name a token is.
    pub(crate) fn call_of(&self, name: usize) -> Option<Call> {
        let token = self.tokens.get(name)?;
        let word = self.word(name);
        let is_name = token.kind == TokenKind::Word && !super::KEYWORDS.contains(&word);
        if !is_name || self.word(name + 1) != "(" || self.word_near(name, -1) == "fn" {
            return None;
        }
        let bracket = self.brackets.get(self.bracket_of(name + 1)?)?;
        let last = bracket.close.unwrap_or_else(|| self.tokens_before(bracket.end));
        let (args, commas) = self.list(name + 2..last);
        Some(Call {
            name,
            module: (self.word_near(name, -1) == "::").then(|| name.saturating_sub(2)),
            args,
            commas,
        })
    }

    /// What commas divide the tokens of a range into, and the places of the commas.
    pub(super) fn list(&self, range: Range<usize>) -> (Vec<Range<usize>>, Vec<usize>) {
        let (mut parts, mut commas) = (Vec::new(), Vec::new());
        let (mut start, mut i) = (range.start, range.start);
        while i < range.end {
            if self.word(i) == "," && self.tokens.get(i).is_some_and(|t| t.kind == TokenKind::Symbol) {
                parts.push(start..i);
                commas.extend(self.tokens.get(i).map(|t| t.span.start));
                start = i + 1;
            }
            i = self.past(i).min(range.end).max(i + 1);
        }
        if start < range.end || !parts.is_empty() {
            parts.push(start..range.end);
        }
        (parts, commas)
    }

    /// The token after this one, or after all that it opens.
    pub(super) fn past(&self, token: usize) -> usize {
        let bracket = self.bracket_of(token).and_then(|b| self.brackets.get(b));
        match bracket {
            Some(b) => b
                .close
                .map_or_else(|| self.tokens_before(b.end).max(token + 1), |close| close + 1),
            None => token + 1,
        }
    }

    /// The bytes from the first to the last token of a range.
    pub(crate) fn span_of(&self, tokens: &Range<usize>) -> Option<Range<usize>> {
        let first = self.tokens.get(tokens.start)?;
        let last = self.tokens.get(tokens.end.checked_sub(1)?)?;
        (tokens.start < tokens.end).then_some(first.span.start..last.span.end)
    }

    fn shape(&self, arg: &Range<usize>) -> Shape {
        let first = self.tokens.get(arg.start).filter(|_| !arg.is_empty());
        let whole = self.past(arg.start) == arg.end;
        match first.map(|t| t.kind) {
            Some(TokenKind::Number) if arg.len() == 1 => Shape::Number,
            Some(TokenKind::Text) if arg.len() == 1 => Shape::Text,
            Some(TokenKind::Symbol) => match self.word(arg.start) {
                "[" if whole => Shape::Array,
                "#{" if whole => Shape::Map,
                "-" if arg.len() == 2
                    && self
                        .tokens
                        .get(arg.start + 1)
                        .is_some_and(|t| t.kind == TokenKind::Number) =>
                {
                    Shape::Number
                }
                _ => Shape::Other,
            },
            _ => Shape::Other,
        }
    }
}

/// For each argument the index of the parameter that it is for, where the arguments fit the form: a vector may be
/// one argument or three. `complete` asks that no parameter is left over.
pub(crate) fn assigned(
    text: &Analysis,
    form: &[Param],
    args: &[Range<usize>],
    complete: bool,
) -> Option<Vec<usize>> {
    let shapes: Vec<Shape> = args.iter().map(|arg| text.shape(arg)).collect();
    let mut chosen = Vec::new();
    assign(form, &shapes, complete, 0, &mut chosen).then_some(chosen)
}

fn assign(form: &[Param], shapes: &[Shape], complete: bool, at: usize, chosen: &mut Vec<usize>) -> bool {
    let given = chosen.len();
    let Some(param) = form.get(at) else {
        return given == shapes.len();
    };
    let Some(shape) = shapes.get(given) else {
        return !complete || param.default.is_some();
    };
    if fits(param.kind, *shape) {
        chosen.push(at);
        if assign(form, shapes, complete, at + 1, chosen) {
            return true;
        }
        chosen.truncate(given);
    }
    let rest = shapes.get(given..).unwrap_or_default();
    let three = rest.get(..rest.len().min(3)).unwrap_or_default();
    let may_be_numbers = three.iter().all(|s| matches!(s, Shape::Number | Shape::Other));
    if param.kind.spreads() && may_be_numbers && (three.len() == 3 || !complete) {
        chosen.extend(three.iter().map(|_| at));
        if assign(form, shapes, complete, at + 1, chosen) {
            return true;
        }
        chosen.truncate(given);
    }
    false
}

fn fits(kind: Kind, shape: Shape) -> bool {
    match shape {
        Shape::Other => true,
        Shape::Number => matches!(
            kind,
            Kind::Number | Kind::Int | Kind::NumberOrVec3 | Kind::NumberOrTexture | Kind::Any
        ),
        Shape::Text => matches!(kind, Kind::String | Kind::Color | Kind::Term | Kind::Any),
        Shape::Array => !matches!(
            kind,
            Kind::Number | Kind::Int | Kind::NumberOrTexture | Kind::String | Kind::Map | Kind::Image
        ),
        Shape::Map => matches!(kind, Kind::Map | Kind::Any),
    }
}
