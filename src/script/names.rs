//! "Did you mean": what names there are, and which of them is near.

use std::{
    collections::{BTreeMap, BTreeSet},
    sync::LazyLock,
};

use rhai::{AST, Engine, Position, Token};

use super::{
    call::{arguments, kind_name, wrong_count},
    engine,
    errors::habits,
    language::Language,
    session::Source,
    table::{Entry, Run, entries, entry},
    vocabulary::CONSTANTS,
};
use crate::{
    diag::{Code, Diagnostic, ErrorKind, nearest_names},
    limits::Limits,
};

/// True for the names Rhai gives to closures.
pub(super) fn is_closure(name: &str) -> bool {
    name.starts_with("anon$")
}

/// A getter or setter as its property, an operator in quotes, a function with brackets.
pub(super) fn plain(name: &str) -> String {
    match name.split_once('$') {
        Some(("get" | "set", property)) => format!("its property {property}"),
        Some(("index", _)) => "an index".to_owned(),
        _ => format!("{name}()"),
    }
}

/// The functions a script can call.
pub(super) struct Names<'l> {
    /// Of the script: parameters by name.
    own: BTreeMap<String, Vec<Vec<String>>>,
    /// With the program's.
    language: &'l Language,
}

impl<'l> Names<'l> {
    pub(super) fn of(ast: Option<&AST>, language: &'l Language) -> Self {
        let mut own: BTreeMap<String, Vec<Vec<String>>> = BTreeMap::new();
        for f in ast.into_iter().flat_map(AST::iter_functions) {
            if !is_closure(f.name) {
                let params = f.params.iter().map(|p| (*p).to_owned()).collect();
                own.entry(f.name.to_owned()).or_default().push(params);
            }
        }
        Self { own, language }
    }

    /// Rhai's "sphere (i64, i64)" explained.
    pub(super) fn unknown_function(&self, signature: &str, sources: &[Source]) -> Diagnostic {
        let (name, types) = signature.split_once(" (").unwrap_or((signature, ""));
        let types = types.strip_suffix(')').unwrap_or(types);
        let given: Vec<&str> = types.split(", ").filter(|t| !t.is_empty()).collect();
        if let Some(entry) = entry(name) {
            let e = wrong_count(entry, given.len());
            let mut d = error(e.code, e.message);
            d.hints = e.hints;
            return d;
        }
        if let Some(forms) = self.own.get(name) {
            return own_wrong_count(name, forms, given.len());
        }
        let kinds: Vec<String> = given.iter().map(|t| kind_name(t)).collect();
        if !name.starts_with(|c: char| c.is_alphabetic() || c == '_') {
            return operator(name, &kinds);
        }
        let (namespace, function) = match name.rsplit_once("::") {
            Some((namespace, function)) => (Some(namespace), function),
            None => (None, name),
        };
        if let Some(namespace) = namespace {
            let d = error(
                Code::UnknownFunction,
                format!(
                    "the module {namespace} has no function {function} for {}",
                    arguments(given.len())
                ),
            );
            let modules = sources.iter().skip(1).map(|module| Declared::of(&module.text));
            let theirs: Vec<String> = modules
                .flat_map(|module| module.functions)
                .map(|(name, ..)| name)
                .collect();
            return match nearest_names(function, theirs.iter().map(String::as_str)).first() {
                Some(near) if *near != function => d.hint(format!("did you mean {namespace}::{near}?")),
                _ => d,
            };
        }
        if sources
            .first()
            .is_some_and(|main| declared(&main.text).contains(name))
        {
            return error(
                Code::UnknownFunction,
                format!("{name} is a variable, not a function"),
            )
            .hint(format!("where it holds a function, {name}.call(...) calls that"));
        }
        if BUILTINS.contains(name) || self.language.has(name) {
            let d = error(
                Code::ArgumentType,
                match kinds.as_slice() {
                    [] => format!("{name}() needs arguments"),
                    kinds => format!("{name} cannot be called with {}", list(kinds)),
                },
            );
            return match (name, kinds.len()) {
                ("range", 1) => d.hint("a range is written 0..5, and runs from 0 to 4"),
                ("append", 2) => {
                    d.hint("array.push(value) adds one value, array.append(array) all of another")
                }
                _ => d,
            };
        }
        self.no_such_function(name)
    }

    /// What is wrong with any call of `name` with this many arguments, whatever they are; `None` where it may be right.
    pub(super) fn wrong_call(&self, name: &str, given: usize) -> Option<Diagnostic> {
        if self.has_own(name, given) || self.language.has(name) {
            return None;
        }
        if let Some(entry) = entry(name) {
            let is_right = matches!(entry.run, Run::Syntax) || entry.arities().contains(&given);
            return (!is_right).then(|| {
                let e = wrong_count(entry, given);
                let mut d = error(e.code, e.message);
                d.hints = e.hints;
                d
            });
        }
        match self.own.get(name) {
            _ if BUILTINS.contains(name) => None,
            Some(forms) => Some(own_wrong_count(name, forms, given)),
            None => Some(self.no_such_function(name)),
        }
    }

    /// Whether the script has such a function itself.
    pub(super) fn has_own(&self, name: &str, given: usize) -> bool {
        let forms = self.own.get(name);
        forms.is_some_and(|forms| forms.iter().any(|form| form.len() == given))
    }

    fn no_such_function(&self, name: &str) -> Diagnostic {
        let d = error(Code::UnknownFunction, format!("unknown function {name}"));
        match self.near(name).as_slice() {
            [] => d.hint("'rtscript help' lists the functions that there are"),
            near => d.hint(format!("did you mean {}?", near.join(" or "))),
        }
    }

    /// Functions that a misspelt or foreign name may stand for.
    fn near(&self, name: &str) -> Vec<String> {
        let folded = name.to_lowercase();
        let foreign = entries().filter(|e| e.also.iter().any(|a| a.to_lowercase() == folded));
        let foreign: Vec<String> = foreign.map(|e| e.name.to_owned()).collect();
        if !foreign.is_empty() {
            return foreign;
        }
        let known = entries()
            .map(|e| e.name)
            .chain(self.own.keys().map(String::as_str))
            .chain(BUILTINS.iter().map(String::as_str));
        // Sorted by distance: what comes after the first is seldom meant.
        nearest_names(name, known)
            .into_iter()
            .take(1)
            .map(str::to_owned)
            .collect()
    }
}

fn error(code: Code, message: impl Into<String>) -> Diagnostic {
    Diagnostic::error(ErrorKind::Script, message).class(code)
}

/// The error for a call of a function of the script with a number of arguments that it does not take.
fn own_wrong_count(name: &str, forms: &[Vec<String>], given: usize) -> Diagnostic {
    let forms: Vec<String> = forms.iter().map(|p| format!("({})", p.join(", "))).collect();
    let message = format!("{name} takes {}, not {}", forms.join(" or "), arguments(given));
    error(Code::ArgumentCount, message)
}

fn list(kinds: &[String]) -> String {
    kinds.join(" and ")
}

/// An operator whose operands do not fit.
fn operator(symbol: &str, kinds: &[String]) -> Diagnostic {
    if let Some(("get" | "set", property)) = symbol.split_once('$') {
        return error(
            Code::UnknownProperty,
            format!("no property {property} of {}", list(kinds)),
        );
    }
    let d = error(
        Code::OperandTypes,
        match kinds {
            [one] => format!("'{symbol}' does not work on {one}"),
            _ => format!("'{symbol}' does not work between {}", list(kinds)),
        },
    );
    if kinds.iter().any(|k| k == "an array") && matches!(symbol, "+" | "-" | "*" | "/") {
        return d.hint("an array does not calculate; vec3(x, y, z) does");
    }
    if kinds.iter().any(|k| k == "nothing") {
        return d
            .hint("a function without a result gives nothing, and so does a statement that ends with ';'");
    }
    d
}

/// Names of Rhai's own functions.
pub(super) static BUILTINS: LazyLock<BTreeSet<String>> = LazyLock::new(|| {
    let Ok(engine) = engine::compiler(&Limits::default(), &Language::new()) else {
        return BTreeSet::new();
    };
    callable_names(&engine)
        .chain(OF_THE_PARSER.map(str::to_owned))
        .collect()
});

/// Names of the functions that a script can call by an engine.
pub(super) fn callable_names(engine: &Engine) -> impl Iterator<Item = String> + use<> {
    engine
        .collect_fn_metadata(None, |f| Some(f.metadata.name.to_string()), true)
        .into_iter()
        .filter(|name| name.starts_with(char::is_alphabetic) && !name.contains('$'))
}

/// Functions that Rhai knows without a definition.
const OF_THE_PARSER: [&str; 10] = [
    // What a closure over a variable becomes.
    "curry",
    "print",
    "debug",
    "type_of",
    "call",
    "Fn",
    "is_def_fn",
    "is_def_var",
    "is_shared",
    "eval",
];

/// Every name that a text declares.
pub(super) fn declared(text: &str) -> BTreeSet<String> {
    Declared::of(text).all
}

/// Names of colors with their codes, as CSS has them; only for hints.
pub(super) const COLORS: [(&str, &str); 18] = [
    ("black", "#000000"),
    ("white", "#ffffff"),
    ("gray", "#808080"),
    ("grey", "#808080"),
    ("silver", "#c0c0c0"),
    ("red", "#ff0000"),
    ("green", "#008000"),
    ("lime", "#00ff00"),
    ("blue", "#0000ff"),
    ("navy", "#000080"),
    ("yellow", "#ffff00"),
    ("orange", "#ffa500"),
    ("gold", "#ffd700"),
    ("brown", "#a52a2a"),
    ("purple", "#800080"),
    ("magenta", "#ff00ff"),
    ("cyan", "#00ffff"),
    ("pink", "#ffc0cb"),
];

/// A name that stands for no variable.
pub(super) fn unknown_variable(name: &str, pos: Position, text: &str) -> Diagnostic {
    let d = error(Code::UnknownVariable, format!("unknown variable {name}"));
    if let Some(entry) = entry(name) {
        return d.hint(format!("{name} is a function: write {}", entry.usage));
    }
    if line_before(text, pos).trim_end().ends_with("define") {
        return d.hint(format!(
            "the name of a define is a string: define \"{name}\" {{ ... }}"
        ));
    }
    if let Some(here) = habits::named(name, pos, text) {
        return d.hint(here);
    }
    if let Some((_, code)) = COLORS.iter().find(|(color, _)| *color == name.to_lowercase()) {
        return d.hint(format!("a color is written as its code: \"{code}\""));
    }
    let declared = Declared::of(text);
    if let Some(function) = declared.function_at(pos)
        && declared.outside.contains(name)
    {
        return d.hint(format!(
            "a function does not see the variables outside it: give {name} to {function} as a parameter, or declare it const and write global::{name}"
        ));
    }
    let known = declared
        .all
        .iter()
        .map(String::as_str)
        .chain(CONSTANTS.iter().map(|c| c.name));
    if let Some(here) = habits::word(name).filter(|_| !declared.all.contains(name)) {
        return d.hint(here);
    }
    let folded = name.to_lowercase();
    let foreign = |e: &&Entry| e.also.iter().any(|also| also.to_lowercase() == folded);
    if line_before(text, pos).trim().is_empty()
        && let Some(entry) = entries().find(foreign)
    {
        return d.hint(format!("did you mean the function {}?", entry.usage));
    }
    // Any two words of a letter or two are near one another.
    let long = name.chars().count() > 2;
    let known = known.filter(|n| *n != name && (long || n.eq_ignore_ascii_case(name)));
    if let Some(near) = nearest_names(name, known).first() {
        return d.hint(format!("did you mean {near}?"));
    }
    let functions = entries().map(|e| e.name);
    if long
        && let Some(near) = nearest_names(name, functions).first()
        && let Some(entry) = entry(near)
    {
        return d.hint(format!("did you mean the function {}?", entry.usage));
    }
    if declared.all.contains(name) {
        return d.hint(format!("{name} is declared elsewhere, but it is not known here"));
    }
    d.hint(format!("declare it first: let {name} = ...;"))
}

/// The text of the line before `pos`.
pub(super) fn line_before(text: &str, pos: Position) -> &str {
    let line = text.lines().nth(pos.line().unwrap_or(1) - 1).unwrap_or("");
    let end = line
        .char_indices()
        .nth(pos.position().unwrap_or(1).saturating_sub(1))
        .map_or(line.len(), |(i, _)| i);
    &line[..end]
}

/// The text of the line from `pos` on, without blanks before it.
pub(super) fn line_after(text: &str, pos: Position) -> &str {
    let line = text.lines().nth(pos.line().unwrap_or(1) - 1).unwrap_or("");
    line.get(line_before(text, pos).len()..)
        .unwrap_or("")
        .trim_start()
}

/// The word that begins at `pos`.
pub(super) fn word_at(text: &str, pos: Position) -> &str {
    let rest = line_after(text, pos);
    let end = rest
        .find(|c: char| !c.is_alphanumeric() && c != '_')
        .unwrap_or(rest.len());
    &rest[..end]
}

/// What a text declares, found by looking over its tokens: good enough for a hint.
#[derive(Default)]
pub(super) struct Declared {
    /// Every name declared anywhere.
    all: BTreeSet<String>,
    /// Names declared outside functions.
    outside: BTreeSet<String>,
    /// Functions with the places where their bodies begin and end.
    functions: Vec<(String, Position, Position)>,
}

impl Declared {
    pub(super) fn of(text: &str) -> Self {
        let engine = Engine::new_raw();
        let scripts = [text];
        let (tokens, _) = engine.lex(&scripts);
        let mut found = Self::default();
        let mut depth = 0usize;
        // The function being read: its name, where its body begins, the depth around it.
        let mut function: Option<(String, Option<Position>, usize)> = None;
        let mut previous = Token::EOF;
        for (token, pos) in tokens.take_while(|(t, _)| !matches!(t, Token::EOF | Token::LexError(_))) {
            match &token {
                Token::Identifier(name) => {
                    let declares = matches!(previous, Token::Let | Token::Const | Token::For | Token::As);
                    let in_header =
                        matches!(&function, Some((_, None, _))) || matches!(previous, Token::Pipe);
                    if matches!(previous, Token::Fn) {
                        function = Some((name.to_string(), None, depth));
                    } else if declares || in_header {
                        found.all.insert(name.to_string());
                        if function.is_none() {
                            found.outside.insert(name.to_string());
                        }
                    }
                }
                Token::LeftBrace | Token::MapStart => {
                    if let Some((_, begin @ None, _)) = &mut function {
                        *begin = Some(pos);
                    }
                    depth += 1;
                }
                Token::RightBrace => {
                    depth = depth.saturating_sub(1);
                    if let Some((name, Some(begin), outer)) = &function
                        && *outer == depth
                    {
                        found.functions.push((name.clone(), *begin, pos));
                        function = None;
                    }
                }
                _ => {}
            }
            previous = token;
        }
        found
    }

    /// The function whose body the place is in.
    pub(super) fn function_at(&self, pos: Position) -> Option<&str> {
        self.functions
            .iter()
            .find(|(_, begin, end)| *begin < pos && pos < *end)
            .map(|(name, ..)| name.as_str())
    }
}
