//! The tokens of a script as it stands, finished or not, each with where it begins and ends.
//!
//! Rhai's own lexer tells where a token begins, not where it ends, passes over comments, needs the parser's help inside
//! `${ }`, and counts lines in 16 bits. This one goes over any text to its end; a test holds it to Rhai's on every
//! script of the repository.

use std::ops::Range;

/// What a token is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TokenKind {
    /// A name or a keyword.
    Word,
    /// A number.
    Number,
    /// A string, or a piece of one in backticks between two `${ }`; a character.
    Text,
    /// A comment that documents what follows: `///` or `/** */`.
    Doc,
    /// Any other comment.
    Comment,
    /// An operator or a bracket.
    Symbol,
}

/// A token.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Token {
    pub(crate) kind: TokenKind,
    /// Its bytes, quotes and comment signs included.
    pub(crate) span: Range<usize>,
    /// A string or a comment whose end is missing.
    pub(crate) open: bool,
}

/// Operators of more than one character, the longer ones first.
const SYMBOLS: [&str; 37] = [
    "**=", "<<=", ">>=", "..=", "...", "===", "!==", "??=", "#{", "${", "::", "=>", "->", "<-", ":=", "==",
    "!=", "<=", ">=", "&&", "||", "??", "?.", "?[", "**", "<<", ">>", "..", "+=", "-=", "*=", "/=", "%=",
    "&=", "|=", "^=", "++",
];

/// All tokens of a text, comments among them, in order.
pub(crate) fn tokens(text: &str) -> Vec<Token> {
    let mut lexer = Lexer {
        text,
        at: 0,
        tokens: Vec::new(),
        braces: 0,
        templates: Vec::new(),
    };
    if text.starts_with("#!") {
        lexer.at = lexer.line_end();
    }
    while let Some(c) = lexer.peek() {
        lexer.token(c);
    }
    lexer.tokens
}

struct Lexer<'t> {
    text: &'t str,
    at: usize,
    tokens: Vec<Token>,
    /// Braces that are open.
    braces: usize,
    /// For each string in backticks that is interrupted by `${`, how many braces were open before.
    templates: Vec<usize>,
}

impl<'t> Lexer<'t> {
    fn rest(&self) -> &'t str {
        self.text.get(self.at..).unwrap_or_default()
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn line_end(&self) -> usize {
        self.rest().find('\n').map_or(self.text.len(), |n| self.at + n)
    }

    /// Byte offset of the first character that `ends` takes.
    fn until(&self, from: usize, ends: impl Fn(char) -> bool) -> usize {
        let rest = self.text.get(from..).unwrap_or_default();
        rest.find(ends).map_or(self.text.len(), |n| from + n)
    }

    fn push(&mut self, kind: TokenKind, end: usize, open: bool) {
        self.tokens.push(Token {
            kind,
            span: self.at..end,
            open,
        });
        self.at = end;
    }

    fn token(&mut self, first: char) {
        let rest = self.rest();
        if first.is_whitespace() {
            self.at = self.until(self.at, |c| !c.is_whitespace());
        } else if rest.starts_with("//") {
            let is_doc = rest.starts_with("///") && !rest.starts_with("////");
            let kind = if is_doc {
                TokenKind::Doc
            } else {
                TokenKind::Comment
            };
            self.push(kind, self.line_end(), false);
        } else if rest.starts_with("/*") {
            self.block_comment();
        } else if first.is_alphabetic() || first == '_' {
            self.push(TokenKind::Word, self.until(self.at, |c| !is_word(c)), false);
        } else if first.is_ascii_digit() {
            self.push(TokenKind::Number, self.number_end(), false);
        } else if first == '"' {
            self.string('"');
        } else if first == '\'' {
            self.string('\'');
        } else if first == '`' {
            self.at += 1;
            self.template(self.at - 1);
        } else if let Some(end) = self.raw_string_end() {
            let (end, open) = end;
            self.push(TokenKind::Text, end, open);
        } else {
            self.symbol(first);
        }
    }

    fn symbol(&mut self, first: char) {
        let rest = self.rest();
        let is_not_in = rest
            .strip_prefix("!in")
            .is_some_and(|after| !after.starts_with(|c: char| c.is_alphanumeric() || c == '_'));
        let long = SYMBOLS.iter().find(|s| rest.starts_with(**s));
        let length = match long {
            _ if is_not_in => "!in".len(),
            Some(symbol) => symbol.len(),
            None => first.len_utf8(),
        };
        let symbol = rest.get(..length).unwrap_or_default();
        match symbol {
            "{" | "#{" | "${" => self.braces += 1,
            "}" => self.braces = self.braces.saturating_sub(1),
            _ => {}
        }
        let resumes = symbol == "}" && self.templates.last() == Some(&self.braces);
        self.push(TokenKind::Symbol, self.at + length, false);
        if resumes {
            self.templates.pop();
            self.template(self.at);
        }
    }

    /// Comments nest.
    fn block_comment(&mut self) {
        let rest = self.rest();
        let is_doc = rest.starts_with("/**") && !rest.starts_with("/***") && !rest.starts_with("/**/");
        let kind = if is_doc {
            TokenKind::Doc
        } else {
            TokenKind::Comment
        };
        let (mut depth, mut i) = (0usize, 0);
        let bytes = rest.as_bytes();
        while let Some(pair) = bytes.get(i..i + 2) {
            match pair {
                b"/*" => (depth, i) = (depth + 1, i + 2),
                b"*/" => (depth, i) = (depth - 1, i + 2),
                _ => i += 1,
            }
            if depth == 0 {
                return self.push(kind, self.at + i, false);
            }
        }
        self.push(kind, self.text.len(), true);
    }

    /// A string, or a character in single quotes. It goes on in the next line only after a backslash.
    fn string(&mut self, quote: char) {
        let mut escaped = false;
        for (i, c) in self.rest().char_indices().skip(1) {
            match c {
                '\n' if !escaped => return self.push(TokenKind::Text, self.at + i, true),
                // A carriage return before the line's end changes nothing about the backslash.
                '\r' if escaped => {}
                _ if escaped => escaped = false,
                '\\' => escaped = true,
                c if c == quote => return self.push(TokenKind::Text, self.at + i + 1, false),
                _ => {}
            }
        }
        self.push(TokenKind::Text, self.text.len(), true);
    }

    /// `#"..."#`, with any number of `#`: its end, and whether that is missing.
    fn raw_string_end(&self) -> Option<(usize, bool)> {
        let rest = self.rest();
        let hashes = rest.bytes().take_while(|b| *b == b'#').count();
        let body = rest.get(hashes..)?.strip_prefix('"').filter(|_| hashes > 0)?;
        let begin = self.at + hashes + 1;
        let close = format!("\"{}", "#".repeat(hashes));
        Some(match body.find(&close) {
            Some(n) => (begin + n + close.len(), false),
            None => (self.text.len(), true),
        })
    }

    /// What is left of a string in backticks from here on, up to its end or the next `${`; the token begins at `start`.
    fn template(&mut self, start: usize) {
        let mut chars = self.rest().char_indices().peekable();
        let mut end = None;
        while let Some((i, c)) = chars.next() {
            let next = chars.peek().map(|(_, c)| *c);
            match (c, next) {
                ('`', Some('`')) => drop(chars.next()),
                ('`', _) => {
                    end = Some((i + 1, false));
                    break;
                }
                ('$', Some('{')) => {
                    end = Some((i, true));
                    break;
                }
                _ => {}
            }
        }
        let (from, open) = (self.at, end.is_none());
        self.at = start;
        match end {
            Some((length, interrupted)) => {
                self.push(TokenKind::Text, from + length, open);
                if interrupted {
                    self.templates.push(self.braces);
                    self.symbol('$');
                }
            }
            None => self.push(TokenKind::Text, self.text.len(), open),
        }
    }

    fn number_end(&self) -> usize {
        let rest = self.rest();
        let bytes = rest.as_bytes();
        let digits = |from: usize, is_digit: fn(&u8) -> bool| {
            let tail = bytes.get(from..).unwrap_or_default();
            from + tail.iter().take_while(|b| is_digit(b) || **b == b'_').count()
        };
        let radix = bytes.get(1).map(u8::to_ascii_lowercase);
        if bytes.first() == Some(&b'0') && matches!(radix, Some(b'x' | b'o' | b'b')) {
            return self.at + digits(2, u8::is_ascii_hexdigit);
        }
        let mut end = digits(0, u8::is_ascii_digit);
        if bytes.get(end) == Some(&b'.') {
            match rest.get(end + 1..).and_then(|r| r.chars().next()) {
                Some(c) if c.is_ascii_digit() => end = digits(end + 1, u8::is_ascii_digit),
                // `1..2` is a range and `1.abs()` a call.
                Some(c) if c == '.' || is_word(c) => return self.at + end,
                _ => end += 1,
            }
        }
        if matches!(bytes.get(end), Some(b'e' | b'E')) {
            let sign = usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
            if bytes.get(end + 1 + sign).is_some_and(u8::is_ascii_digit) {
                end = digits(end + 1 + sign, u8::is_ascii_digit);
            }
        }
        self.at + end
    }
}

/// Whether `c` may stand in a name.
pub(crate) fn is_word(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

#[cfg(test)]
mod tests {
    use std::{fs, path::Path};

    use rhai::{Engine, Position, Token as Theirs};

    use super::*;

    fn words(text: &str) -> Vec<&str> {
        tokens(text).into_iter().map(|t| &text[t.span]).collect()
    }

    #[test]
    fn tokens_have_their_ends() {
        assert_eq!(
            words("let a=1.5e3+0x1f; // x\nf(\"a\\\"b\", 'c')"),
            [
                "let",
                "a",
                "=",
                "1.5e3",
                "+",
                "0x1f",
                ";",
                "// x",
                "f",
                "(",
                "\"a\\\"b\"",
                ",",
                "'c'",
                ")"
            ]
        );
        assert_eq!(words("a !in b !inner"), ["a", "!in", "b", "!", "inner"]);
        assert_eq!(
            words("0..10 1.abs() 2. 3._"),
            ["0", "..", "10", "1", ".", "abs", "(", ")", "2.", "3", ".", "_"]
        );
        assert_eq!(words("##\"a\"#\"## #{ }"), ["##\"a\"#\"##", "#{", "}"]);
        assert_eq!(words("/* a /* b */ c */ d"), ["/* a /* b */ c */", "d"]);
    }

    #[test]
    fn what_stands_in_a_string_is_code() {
        assert_eq!(
            words("`a ${ f(#{b: `x${1}y`}) } c ``d` + e"),
            [
                "`a ", "${", "f", "(", "#{", "b", ":", "`x", "${", "1", "}", "y`", "}", ")", "}", " c ``d`",
                "+", "e"
            ]
        );
    }

    #[test]
    fn what_is_not_closed_ends_with_the_line_or_the_text() {
        let open = |text| tokens(text).into_iter().find(|t| t.open).map(|t| t.span);
        assert_eq!(open("a \"bc\nd"), Some(2..5));
        assert_eq!(open("a \"bc\\\nd\" e"), None);
        for rest in ["`x\ny", "/* x\ny", "#\"x\ny"] {
            assert_eq!(open(rest), Some(0..rest.len()), "{rest}");
        }
    }

    /// Where Rhai's lexer finds tokens, as the parser would read them; `None` where it finds fault with one.
    fn rhai_starts(text: &str) -> Option<Vec<Position>> {
        let engine = Engine::new_raw();
        let scripts = [text];
        let (tokens, control) = engine.lex(&scripts);
        let (mut starts, mut depth, mut templates) = (Vec::new(), 0usize, Vec::new());
        for (token, pos) in tokens.take_while(|(t, _)| !matches!(t, Theirs::EOF)) {
            match &token {
                Theirs::LexError(_) => return None,
                Theirs::LeftBrace | Theirs::MapStart => depth += 1,
                Theirs::RightBrace => {
                    depth = depth.saturating_sub(1);
                    if templates.last() == Some(&depth) {
                        templates.pop();
                        control.borrow_mut().is_within_text = true;
                    }
                }
                Theirs::InterpolatedString(_) => templates.push(depth),
                _ => {}
            }
            let is_text = matches!(
                token,
                Theirs::InterpolatedString(_) | Theirs::StringConstant(_) | Theirs::CharConstant(_)
            );
            if !is_text {
                starts.push(pos);
            }
        }
        Some(starts)
    }

    fn scripts(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                scripts(&path, found);
            } else if path.extension().is_some_and(|e| e == "rhai") {
                found.push(path);
            }
        }
    }

    #[test]
    fn tokens_begin_where_rhais_do() {
        let root = Path::new(env!("CARGO_MANIFEST_DIR"));
        let mut files = Vec::new();
        for folder in ["scripts", "tests/scenes"] {
            scripts(&root.join(folder), &mut files);
        }
        assert!(files.len() > 100, "{}", files.len());
        let mut compared = 0;
        for path in files {
            let Ok(text) = fs::read_to_string(&path) else {
                continue;
            };
            let place = |offset: usize| {
                let before = &text[..offset];
                let line = before.matches('\n').count() + 1;
                let column = before.rsplit('\n').next().unwrap().chars().count() + 1;
                Position::new(line as u16, column as u16)
            };
            let code = tokens(&text)
                .into_iter()
                .filter(|t| matches!(t.kind, TokenKind::Word | TokenKind::Number | TokenKind::Symbol));
            let Some(theirs) = rhai_starts(&text) else {
                continue;
            };
            compared += 1;
            // A number with its sign is one token there, and so is `()`.
            let is_joined = |t: &Token| {
                let before = &text[..t.span.start];
                t.kind == TokenKind::Number && before.ends_with('-')
                    || text[t.span.clone()] == *")" && before.ends_with('(')
            };
            let ours: Vec<Position> = code
                .filter(|t| !is_joined(t) || theirs.binary_search(&place(t.span.start)).is_ok())
                // There the dollar sign belongs to the string.
                .map(|t| place(t.span.start + usize::from(text[t.span.clone()] == *"${")))
                .collect();
            let differs = ours.iter().zip(&theirs).find(|(a, b)| a != b);
            assert_eq!(differs, None, "{}", path.display());
            assert_eq!(ours.len(), theirs.len(), "{}", path.display());
        }
        assert!(compared > 100, "{compared}");
    }
}
