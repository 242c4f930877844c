//! A static look at a script for editors: its tokens, what it declares and where that is known, its calls.
//!
//! It goes by the tokens of the text as it stands, since a text is unfinished for most of the time in which it is
//! written. No part of it runs anything, and all of it takes time in proportion to the text.

mod calls;
mod colors;
mod symbols;
mod tokens;

use std::{
    collections::{BTreeMap, BTreeSet},
    ops::Range,
    sync::Arc,
};

pub(crate) use calls::{Call, assigned};
pub(crate) use colors::{ColorPlace, Notation, colors};
pub(crate) use symbols::{Symbol, SymbolKind};
pub(crate) use tokens::{Token, TokenKind, is_word};

/// Words that are no names.
pub(crate) const KEYWORDS: [&str; 31] = [
    "as",
    "break",
    "catch",
    "const",
    "continue",
    "define",
    "difference",
    "do",
    "else",
    "export",
    "false",
    "fn",
    "for",
    "global",
    "group",
    "if",
    "import",
    "in",
    "intersection",
    "let",
    "loop",
    "moving",
    "private",
    "return",
    "switch",
    "this",
    "throw",
    "true",
    "try",
    "union",
    "while",
];

/// Words that begin a statement, so that an open bracket before one is missing its end.
const STATEMENTS: [&str; 12] = [
    "let", "const", "fn", "for", "while", "import", "export", "return", "break", "continue", "throw",
    "private",
];

/// Names of Rhai's own functions.
pub(crate) fn builtins() -> &'static BTreeSet<String> {
    &super::names::BUILTINS
}

/// Levels of brackets that a stray bracket is sought through.
const DEEPEST: usize = 80;

/// Places where a name stands that are looked at for references.
const MOST_REFERENCES: usize = 5_000;

/// Tokens that a statement without an end is followed through.
const LONGEST: usize = 1_000;

/// What a text says.
#[derive(Debug)]
pub(crate) struct Analysis {
    text: Arc<str>,
    /// Without comments.
    tokens: Vec<Token>,
    comments: Vec<Token>,
    /// For each bracket that opens, where what it holds ends, and the token that closes it.
    brackets: Vec<Bracket>,
    /// For each token, the bracket that it stands in.
    within: Vec<Option<usize>>,
    symbols: Vec<Symbol>,
    /// The symbols by name.
    by_name: BTreeMap<String, Vec<usize>>,
    /// The functions with what is theirs, parameters and body, in order.
    functions: Vec<(Range<usize>, usize)>,
}

/// A pair of brackets; the second may be missing.
#[derive(Clone, Debug)]
struct Bracket {
    /// Token that opens it.
    open: usize,
    /// Token that closes it.
    close: Option<usize>,
    /// Byte at which what it holds ends.
    end: usize,
    /// The bracket around it.
    outer: Option<usize>,
}

impl Analysis {
    /// Looks at a text.
    pub(crate) fn of(text: impl Into<Arc<str>>) -> Self {
        let text = text.into();
        let (comments, tokens) = tokens::tokens(&text)
            .into_iter()
            .partition(|t| matches!(t.kind, TokenKind::Doc | TokenKind::Comment));
        let mut analysis = Self {
            text,
            tokens,
            comments,
            brackets: Vec::new(),
            within: Vec::new(),
            symbols: Vec::new(),
            by_name: BTreeMap::new(),
            functions: Vec::new(),
        };
        analysis.match_brackets();
        analysis.symbols = symbols::symbols(&analysis);
        analysis.index();
        analysis
    }

    fn index(&mut self) {
        for (i, symbol) in self.symbols.iter().enumerate() {
            let name = self.text.get(symbol.name.clone()).map_or("", unquoted);
            self.by_name.entry(name.to_owned()).or_default().push(i);
            if symbol.kind == SymbolKind::Function {
                self.functions.push((symbol.name.end..symbol.whole.end, i));
            }
        }
        let functions: Vec<Option<usize>> = self
            .symbols
            .iter()
            .map(|s| self.function_at(s.name.start))
            .collect();
        for (symbol, function) in self.symbols.iter_mut().zip(functions) {
            symbol.function = function;
        }
    }

    /// The symbols of a name, in order.
    fn named(&self, name: &str) -> impl DoubleEndedIterator<Item = (usize, &Symbol)> {
        let all = self.by_name.get(name).map_or(&[][..], Vec::as_slice);
        all.iter().filter_map(|i| Some((*i, self.symbols.get(*i)?)))
    }

    /// Functions of the script with a name.
    pub(crate) fn functions_named(&self, name: &str) -> impl Iterator<Item = &Symbol> {
        self.named(name)
            .map(|(_, s)| s)
            .filter(|s| s.kind == SymbolKind::Function)
    }

    /// The text it looked at.
    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Everything that is declared, in order.
    pub(crate) fn symbols(&self) -> &[Symbol] {
        &self.symbols
    }

    /// All tokens but comments.
    pub(crate) fn tokens(&self) -> &[Token] {
        &self.tokens
    }

    /// The comments.
    pub(crate) fn comments(&self) -> &[Token] {
        &self.comments
    }

    /// The text of a token.
    pub(crate) fn word(&self, token: usize) -> &str {
        self.tokens
            .get(token)
            .and_then(|t| self.text.get(t.span.clone()))
            .unwrap_or_default()
    }

    /// The text of the token `by` places after (before where negative) a token.
    pub(crate) fn word_near(&self, token: usize, by: isize) -> &str {
        token.checked_add_signed(by).map_or("", |i| self.word(i))
    }

    /// What a string token holds, escapes left as they are; `None` for other tokens.
    pub(crate) fn string(&self, token: usize) -> Option<&str> {
        let inside = self.string_span(token)?;
        self.text.get(inside)
    }

    /// The bytes between the quotes of a string token.
    pub(crate) fn string_span(&self, token: usize) -> Option<Range<usize>> {
        let t = self.tokens.get(token).filter(|t| t.kind == TokenKind::Text)?;
        let word = self.word(token);
        let quote = word.chars().next().filter(|c| matches!(c, '"' | '`'))?;
        let closed = !t.open && word.len() > 1 && word.ends_with(quote);
        Some(t.span.start + 1..t.span.end - usize::from(closed))
    }

    /// The word, number or string that `offset` touches; a word is preferred to what begins after it.
    pub(crate) fn token_at(&self, offset: usize) -> Option<usize> {
        let after = self.tokens.partition_point(|t| t.span.start <= offset);
        let touches = |i: &usize| self.tokens.get(*i).is_some_and(|t| offset <= t.span.end);
        let last = after.checked_sub(1).filter(touches)?;
        let is_name = |i: &usize| self.tokens.get(*i).is_some_and(|t| t.kind != TokenKind::Symbol);
        if is_name(&last) {
            return Some(last);
        }
        let before = last.checked_sub(1).filter(touches).filter(is_name);
        Some(before.unwrap_or(last))
    }

    /// Whether `offset` is inside a comment.
    pub(crate) fn in_comment(&self, offset: usize) -> bool {
        let after = self.comments.partition_point(|t| t.span.start < offset);
        let last = after.checked_sub(1).and_then(|i| self.comments.get(i));
        last.is_some_and(|t| {
            let is_line = self.text.get(t.span.clone()).is_some_and(|c| c.starts_with("//"));
            offset < t.span.end || (is_line || t.open) && offset == t.span.end
        })
    }

    /// Index of the first token that begins at or after `offset`.
    pub(crate) fn tokens_before(&self, offset: usize) -> usize {
        self.tokens.partition_point(|t| t.span.start < offset)
    }

    /// What is known of where `offset` is: symbols that can be named there, the innermost last.
    pub(crate) fn visible(&self, offset: usize) -> impl Iterator<Item = &Symbol> {
        let function = self.function_at(offset);
        self.symbols
            .iter()
            .filter(move |s| s.is_known_at(offset) && (s.function == function || s.is_seen_everywhere()))
    }

    /// The function whose body or parameters `offset` stands in, as its index among the symbols.
    fn function_at(&self, offset: usize) -> Option<usize> {
        // Functions do not nest.
        let begun = self.functions.partition_point(|(own, _)| own.start <= offset);
        let (own, function) = self.functions.get(begun.checked_sub(1)?)?;
        (offset < own.end).then_some(*function)
    }

    /// The symbol that a token stands for, where it is declared or used.
    pub(crate) fn resolve(&self, token: usize) -> Option<usize> {
        let span = self.tokens.get(token)?.span.clone();
        let name = self.word(token);
        if let Some((own, _)) = self.named(unquoted(name)).find(|(_, s)| s.name == span) {
            return Some(own);
        }
        let kind = self.tokens.get(token)?.kind;
        if kind == TokenKind::Text {
            return self.resolve_text(token);
        }
        if kind != TokenKind::Word || KEYWORDS.contains(&name) || self.is_key(token) {
            return None;
        }
        let first = |kind: SymbolKind| self.named(name).find(|(_, s)| s.kind == kind).map(|(i, _)| i);
        match (self.word_near(token, -1), self.word_near(token, 1)) {
            ("::", _) if self.word_near(token, -2) == "global" => {
                let global = self
                    .named(name)
                    .find(|(_, s)| s.kind == SymbolKind::Constant && s.function.is_none());
                return global.map(|(i, _)| i);
            }
            ("::", _) => return None,
            (_, "::") => return first(SymbolKind::Module),
            _ => {}
        }
        if let Some(call) = self.call_of(token) {
            let is_method = matches!(self.word_near(token, -1), "." | "?.");
            let fits = |s: &Symbol| s.kind == SymbolKind::Function && s.params.len() == call.args.len();
            let function = self.named(name).find(|(_, s)| fits(s)).map(|(i, _)| i);
            if is_method || function.is_some() {
                return function.or_else(|| first(SymbolKind::Function));
            }
        } else if matches!(self.word_near(token, -1), "." | "?.") {
            return None;
        }
        let function = self.function_at(span.start);
        let known =
            |s: &Symbol| s.kind.is_variable() && s.scope.contains(&span.start) && s.function == function;
        let variable = self.named(name).rfind(|(_, s)| known(s)).map(|(i, _)| i);
        variable.or_else(|| first(SymbolKind::Function))
    }

    /// The definition that `instance("name")` names, or the function of `Fn("name")`.
    fn resolve_text(&self, token: usize) -> Option<usize> {
        let name = self.string(token)?;
        let wanted = match (self.word_near(token, -2), self.word_near(token, -1)) {
            ("instance" | "instances", "(") => SymbolKind::Define,
            ("Fn", "(") => SymbolKind::Function,
            _ => return None,
        };
        self.named(name).find(|(_, s)| s.kind == wanted).map(|(i, _)| i)
    }

    /// Every token that stands for a symbol, its declaration included.
    pub(crate) fn references(&self, symbol: usize) -> Vec<Range<usize>> {
        let Some(wanted) = self.symbols.get(symbol) else {
            return Vec::new();
        };
        let name = self.text.get(wanted.name.clone()).map(unquoted);
        let candidates = self.tokens.iter().enumerate().filter(|(i, t)| match t.kind {
            TokenKind::Word => Some(self.word(*i)) == name,
            TokenKind::Text => self.string(*i).is_some() && self.string(*i) == name,
            _ => false,
        });
        let same = candidates
            .take(MOST_REFERENCES)
            .filter(|(i, _)| self.resolve(*i) == Some(symbol));
        same.filter_map(|(i, t)| match t.kind {
            TokenKind::Text => self.string_span(i),
            _ => Some(t.span.clone()),
        })
        .collect()
    }

    /// Whether a word is the key of a map.
    fn is_key(&self, token: usize) -> bool {
        let holder = self.within.get(token).copied().flatten();
        let opens = holder
            .and_then(|b| self.brackets.get(b))
            .map(|b| self.word(b.open));
        opens == Some("#{")
            && self.word_near(token, 1) == ":"
            && matches!(self.word_near(token, -1), "#{" | ",")
    }

    /// The map that `offset` stands in directly: the bracket's token and the keys that it has.
    pub(crate) fn map_at(&self, offset: usize) -> Option<(usize, Vec<&str>)> {
        let bracket = self.bracket_at(offset)?;
        let open = self.brackets.get(bracket)?.open;
        let keys =
            (0..self.tokens.len()).filter(|i| self.within.get(*i) == Some(&Some(bracket)) && self.is_key(*i));
        (self.word(open) == "#{").then(|| (open, keys.map(|i| self.word(i)).collect()))
    }

    /// Blocks and brackets, as bytes from the first bracket to the last.
    pub(crate) fn blocks(&self) -> impl Iterator<Item = Range<usize>> {
        self.brackets.iter().filter_map(|b| {
            let (open, close) = (self.tokens.get(b.open)?, self.tokens.get(b.close?)?);
            Some(open.span.start..close.span.end)
        })
    }

    /// Whether nothing stands outside functions but declarations: a module for others to import.
    pub(crate) fn is_library(&self) -> bool {
        let mut begins = true;
        let mut declares = false;
        let mut functions = false;
        for i in (0..self.tokens.len()).filter(|i| self.within.get(*i) == Some(&None)) {
            let word = self.word(i);
            if begins {
                declares = matches!(word, "fn" | "private" | "const" | "let" | "import" | "export");
                functions |= matches!(word, "fn" | "private" | "export");
                if !declares && word != ";" {
                    return false;
                }
            }
            begins = word == ";" || word == "}";
        }
        functions || declares
    }

    /// The innermost bracket that is open at `offset`.
    fn bracket_at(&self, offset: usize) -> Option<usize> {
        let before = self.tokens_before(offset);
        let last = before.checked_sub(1)?;
        // A bracket that opens just before holds the place; otherwise the token before and the place stand in the same
        // one, or that which ends before the place.
        let own = self.brackets.partition_point(|b| b.open < last);
        let opened = self.brackets.get(own).filter(|b| b.open == last).map(|_| own);
        let mut holder = opened.or(self.within.get(last).copied().flatten());
        while let Some(b) = holder.and_then(|b| self.brackets.get(b)) {
            if offset <= b.end {
                return holder;
            }
            holder = b.outer;
        }
        None
    }

    fn match_brackets(&mut self) {
        let mut stack: Vec<usize> = Vec::new();
        let mut brackets: Vec<Bracket> = Vec::new();
        let mut within = Vec::with_capacity(self.tokens.len());
        for i in 0..self.tokens.len() {
            let word = self.word(i);
            let start = self.tokens.get(i).map_or(0, |t| t.span.start);
            let opens_brace = |b: &usize| {
                let open = brackets.get(*b).map(|b: &Bracket| self.word(b.open));
                open.is_some_and(|w| w.ends_with('{'))
            };
            let closes = |b: &usize| {
                let open = brackets.get(*b).map(|b: &Bracket| self.word(b.open));
                open.is_some_and(|w| match word {
                    ")" => w == "(",
                    "]" => w.ends_with('['),
                    _ => w.ends_with('{'),
                })
            };
            // What keeps its bracket: everything before the first that must have ended here.
            let keep = match word {
                ";" => stack.iter().rposition(opens_brace).map_or(0, |n| n + 1),
                w if STATEMENTS.contains(&w) && self.word_near(i, 1) != ":" => {
                    stack.iter().rposition(opens_brace).map_or(0, |n| n + 1)
                }
                // Not sought without end: no script nests deeper, and a text of stray brackets must not take for ever.
                ")" | "]" | "}" => {
                    let near = stack.iter().rev().take(DEEPEST).position(closes);
                    near.map_or(stack.len(), |n| stack.len() - 1 - n)
                }
                _ => stack.len(),
            };
            let closed = match word {
                ")" | "]" | "}" => stack.get(keep).copied(),
                _ => None,
            };
            for b in stack.drain(keep..) {
                if let Some(bracket) = brackets.get_mut(b) {
                    bracket.end = start;
                    bracket.close = (Some(b) == closed).then_some(i);
                }
            }
            within.push(stack.last().copied());
            if self.tokens.get(i).is_some_and(|t| t.kind == TokenKind::Symbol)
                && matches!(word, "(" | "[" | "?[" | "{" | "#{" | "${")
            {
                brackets.push(Bracket {
                    open: i,
                    close: None,
                    end: self.text.len(),
                    outer: stack.last().copied(),
                });
                stack.push(brackets.len() - 1);
            }
        }
        self.brackets = brackets;
        self.within = within;
    }

    /// The bracket that a token opens.
    fn bracket_of(&self, open: usize) -> Option<usize> {
        let at = self.brackets.partition_point(|b| b.open < open);
        self.brackets.get(at).filter(|b| b.open == open).map(|_| at)
    }
}

/// A string without its quotes.
pub(crate) fn unquoted(text: &str) -> &str {
    text.strip_prefix('"')
        .map_or(text, |inside| inside.strip_suffix('"').unwrap_or(inside))
}

#[cfg(test)]
mod tests;
