//! What a script declares, and from where to where it is known.

use std::ops::Range;

use super::{Analysis, TokenKind};

/// What a name is declared as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SymbolKind {
    /// `fn name()`.
    Function,
    /// `let`.
    Variable,
    /// `const`.
    Constant,
    /// Of a function or a closure, or what `catch` caught.
    Parameter,
    /// `for name in`.
    Loop,
    /// `import "file" as name`.
    Module,
    /// `define "name" { }`.
    Define,
}

impl SymbolKind {
    /// Whether it is found where a variable is looked up.
    pub(crate) fn is_variable(self) -> bool {
        matches!(
            self,
            Self::Variable | Self::Constant | Self::Parameter | Self::Loop
        )
    }
}

/// A declaration.
#[derive(Clone, Debug)]
pub(crate) struct Symbol {
    pub(crate) kind: SymbolKind,
    /// The name's bytes; those of a define with its quotes.
    pub(crate) name: Range<usize>,
    /// The whole declaration; of a function from `fn` to the end of its body.
    pub(crate) whole: Range<usize>,
    /// Where it is known.
    pub(crate) scope: Range<usize>,
    /// Parameters of a function.
    pub(crate) params: Vec<String>,
    /// The file of an import.
    pub(crate) file: Option<String>,
    /// The comment before a function, comment signs left out.
    pub(crate) doc: String,
    /// The function it stands in, as its index among the symbols.
    pub(crate) function: Option<usize>,
    /// Modules do not show it.
    pub(crate) private: bool,
}

impl Symbol {
    pub(crate) fn is_known_at(&self, offset: usize) -> bool {
        self.scope.contains(&offset) || self.scope.end == offset
    }

    /// Functions, modules and definitions are known inside functions too.
    pub(crate) fn is_seen_everywhere(&self) -> bool {
        !self.kind.is_variable()
    }
}

/// Finds all declarations.
pub(super) fn symbols(text: &Analysis) -> Vec<Symbol> {
    let mut finder = Finder {
        text,
        found: Vec::new(),
    };
    for token in 0..text.tokens.len() {
        finder.look_at(token);
    }
    finder.found
}

/// A block: what is between its braces, and where it ends with its brace.
struct Block {
    inside: Range<usize>,
    end: usize,
}

struct Finder<'a> {
    text: &'a Analysis,
    found: Vec<Symbol>,
}

impl Finder<'_> {
    fn look_at(&mut self, token: usize) {
        let text = self.text;
        match text.word(token) {
            "fn" => self.function(token),
            "let" => self.variable(token, SymbolKind::Variable),
            "const" => self.variable(token, SymbolKind::Constant),
            "for" => self.loop_variables(token),
            "catch" => self.caught(token),
            "import" => self.module(token),
            "define" => self.define(token),
            "|" | "||" if self.begins_closure(token) => self.closure(token),
            _ => {}
        }
    }

    fn span(&self, token: usize) -> Range<usize> {
        let end = self.text.text.len();
        self.text.tokens.get(token).map_or(end..end, |t| t.span.clone())
    }

    fn is_name(&self, token: usize) -> bool {
        let word = self
            .text
            .tokens
            .get(token)
            .is_some_and(|t| t.kind == TokenKind::Word);
        word && !super::KEYWORDS.contains(&self.text.word(token))
    }

    fn add(
        &mut self,
        kind: SymbolKind,
        name: usize,
        whole: Range<usize>,
        scope: Range<usize>,
    ) -> Option<&mut Symbol> {
        let name = self.span(name);
        self.found.push(Symbol {
            kind,
            name,
            whole,
            scope,
            params: Vec::new(),
            file: None,
            doc: String::new(),
            function: None,
            private: false,
        });
        self.found.last_mut()
    }

    /// Where the braces around a token end.
    fn block_end(&self, token: usize) -> usize {
        let mut holder = self.text.within.get(token).copied().flatten();
        while let Some(bracket) = holder.and_then(|b| self.text.brackets.get(b)) {
            if matches!(self.text.word(bracket.open), "{" | "${") {
                return bracket.end;
            }
            holder = bracket.outer;
        }
        self.text.text.len()
    }

    /// The end of a statement or an expression that begins at a token: the first of `ends` at its own level, or the end
    /// of what it stands in.
    fn expression_end(&self, token: usize, ends: &[&str]) -> usize {
        let holder = self.text.within.get(token).copied().flatten();
        let last = holder
            .and_then(|b| self.text.brackets.get(b))
            .map_or(self.text.text.len(), |b| b.end);
        let mut i = token;
        for _ in 0..super::LONGEST {
            let Some(t) = self.text.tokens.get(i).filter(|t| t.span.start < last) else {
                break;
            };
            if ends.contains(&self.text.word(i))
                || i > token && super::STATEMENTS.contains(&self.text.word(i))
            {
                return t.span.start;
            }
            i = self.text.past(i);
        }
        last
    }

    /// The block that the next brace from `token` on opens, up to a `;`.
    fn block_after(&self, mut token: usize) -> Option<Block> {
        for _ in 0..super::LONGEST {
            match self.text.word(token) {
                "{" => {
                    let bracket = self.text.brackets.get(self.text.bracket_of(token)?)?;
                    return Some(Block {
                        inside: self.span(token).end..bracket.end,
                        end: bracket.close.map_or(bracket.end, |close| self.span(close).end),
                    });
                }
                ";" | "}" | "" => return None,
                _ => token = self.text.past(token),
            }
        }
        None
    }

    /// Names between two tokens.
    fn names(&self, range: Range<usize>) -> Vec<usize> {
        range.filter(|i| self.is_name(*i)).collect()
    }

    fn function(&mut self, token: usize) {
        // `fn int.name()` is a function for one type.
        let name = match self.text.word(token + 2) {
            "." => token + 3,
            _ => token + 1,
        };
        if !self.is_name(name) {
            return;
        }
        let params = match self.text.bracket_of(name + 1) {
            Some(b) if self.text.word(name + 1) == "(" => {
                let bracket = self.text.brackets.get(b);
                let end = bracket.map_or(name, |b| b.close.unwrap_or(self.text.tokens_before(b.end)));
                self.names(name + 2..end)
            }
            _ => Vec::new(),
        };
        let after = params.last().map_or(name + 1, |p| p + 1);
        let body = self.block_after(if params.is_empty() {
            self.text.past(name + 1)
        } else {
            after + 1
        });
        let private = token > 0 && self.text.word(token - 1) == "private";
        let begin = self.span(token - usize::from(private)).start;
        let end = body.as_ref().map_or(self.span(after).end, |b| b.end);
        let words: Vec<String> = params.iter().map(|p| self.text.word(*p).to_owned()).collect();
        let doc = self.doc_before(begin);
        let everywhere = 0..self.text.text.len();
        if let Some(symbol) = self.add(SymbolKind::Function, name, begin..end, everywhere) {
            (symbol.params, symbol.private, symbol.doc) = (words, private, doc);
        }
        let from = self.span(name).end;
        for param in params {
            self.add(SymbolKind::Parameter, param, self.span(param), from..end);
        }
    }

    /// The `///` comments that end right before `offset`.
    fn doc_before(&self, offset: usize) -> String {
        let text = self.text;
        let mut lines = Vec::new();
        let mut from = offset;
        let before = text.comments.partition_point(|c| c.span.end <= offset);
        for comment in text.comments.get(..before).unwrap_or_default().iter().rev() {
            let between = text.text.get(comment.span.end..from).unwrap_or_default();
            if comment.kind != TokenKind::Doc || !between.trim().is_empty() {
                break;
            }
            let written = text.text.get(comment.span.clone()).unwrap_or_default();
            lines.push(without_signs(written));
            from = comment.span.start;
        }
        lines.reverse();
        lines.join("\n")
    }

    fn variable(&mut self, token: usize, kind: SymbolKind) {
        if !self.is_name(token + 1) {
            return;
        }
        let end = self.expression_end(token, &[";"]);
        // Not known in its own value. Without one, or without an end, from the name on.
        let ended = self.text.word(self.text.tokens_before(end)) == ";";
        let from = if ended { end + 1 } else { self.span(token + 1).end };
        let scope = from..self.block_end(token);
        self.add(kind, token + 1, self.span(token).start..end, scope);
    }

    fn loop_variables(&mut self, token: usize) {
        let ends = |i: &usize| matches!(self.text.word(*i), "in" | "{" | ";") || *i > token + 8;
        let Some(end) = (token + 1..self.text.tokens.len()).find(ends) else {
            return;
        };
        let names = self.names(token + 1..end);
        let Some(body) = self.block_after(end) else {
            return;
        };
        for name in names {
            self.add(
                SymbolKind::Loop,
                name,
                self.span(token).start..body.inside.start,
                body.inside.clone(),
            );
        }
    }

    fn caught(&mut self, token: usize) {
        if self.text.word(token + 1) == "("
            && self.is_name(token + 2)
            && let Some(body) = self.block_after(token + 4)
        {
            self.add(
                SymbolKind::Parameter,
                token + 2,
                self.span(token).start..body.inside.start,
                body.inside,
            );
        }
    }

    fn module(&mut self, token: usize) {
        let Some(file) = self.text.string(token + 1).map(str::to_owned) else {
            return;
        };
        if self.text.word(token + 2) == "as" && self.is_name(token + 3) {
            let whole = self.span(token).start..self.span(token + 3).end;
            let scope = whole.end..self.block_end(token);
            if let Some(symbol) = self.add(SymbolKind::Module, token + 3, whole, scope) {
                symbol.file = Some(file);
            }
        }
    }

    fn define(&mut self, token: usize) {
        if self.text.string(token + 1).is_none() {
            return;
        }
        let end = self
            .block_after(token + 2)
            .map_or(self.span(token + 1).end, |b| b.end);
        let whole = self.span(token).start..end;
        self.add(SymbolKind::Define, token + 1, whole, 0..self.text.text.len());
    }

    /// Whether a bar stands where an expression begins, so that it is no operator.
    fn begins_closure(&self, token: usize) -> bool {
        token == 0
            || matches!(
                self.text.word(token - 1),
                "(" | "," | "=" | "{" | "#{" | "${" | "}" | "[" | ":" | ";" | "return" | "=>" | "?["
            )
    }

    fn closure(&mut self, token: usize) {
        if self.text.word(token) == "||" {
            return;
        }
        let ends = |i: &usize| matches!(self.text.word(*i), "|" | ";" | "{" | "}") || *i > token + 64;
        let Some(bar) = (token + 1..self.text.tokens.len()).find(ends) else {
            return;
        };
        if self.text.word(bar) != "|" {
            return;
        }
        let body = match self.text.word(bar + 1) {
            "{" => self.block_after(bar + 1),
            _ => None,
        };
        let end = body.map_or_else(|| self.expression_end(bar + 1, &[",", ";"]), |b| b.inside.end);
        for name in self.names(token + 1..bar) {
            self.add(
                SymbolKind::Parameter,
                name,
                self.span(name),
                self.span(bar).end..end,
            );
        }
    }
}

/// The text of a comment that documents.
fn without_signs(comment: &str) -> String {
    if let Some(line) = comment.strip_prefix("///") {
        return line.strip_prefix(' ').unwrap_or(line).trim_end().to_owned();
    }
    let inside = comment.strip_prefix("/**").unwrap_or(comment);
    let inside = inside.strip_suffix("*/").unwrap_or(inside);
    let lines = inside.lines().map(|line| {
        let line = line.trim();
        line.strip_prefix('*').unwrap_or(line).trim()
    });
    lines.collect::<Vec<_>>().join("\n").trim().to_owned()
}
