//! What is wrong with a script wherever a run comes by, found without running it.

use std::collections::BTreeSet;

use rhai::{AST, ASTNode, Expr, Position};

use super::{
    errors::{self, Context},
    language::Language,
    names::{self, Names},
    session::Lines,
    table::{Run, entry},
};
use crate::diag::{Code, Diagnostic};

/// Things of one kind that are told of at most.
const MOST: usize = 20;

/// Calls of functions that there are not, in the order of their places.
pub(super) fn unknown_calls(ast: &AST, file: &str, context: &Context<'_>) -> Vec<Diagnostic> {
    let names = Names::of(Some(ast), context.language);
    // A variable may hold a function, and who calls it so has made another mistake.
    let declared = names::declared(context.text(file));
    let mut found = Vec::new();
    let mut seen = BTreeSet::new();
    each_call(ast, |call, position| {
        if call.is_operator_call() || !call.namespace.is_empty() || declared.contains(call.name.as_str()) {
            return;
        }
        if let Some(diagnostic) = names.wrong_call(&call.name, call.args.len())
            && seen.insert(position)
        {
            found.push((
                position,
                errors::finish(context.place(diagnostic, file, position)),
            ));
        }
    });
    found.sort_by_key(|(position, _)| *position);
    found.into_iter().map(|(_, diagnostic)| diagnostic).collect()
}

/// Calls of functions that there are not, but for the one that ended the run.
pub(super) fn others(ast: &AST, ended: &Diagnostic, file: &str, context: &Context<'_>) -> Vec<Diagnostic> {
    let place = |d: &Diagnostic| (d.file.clone(), d.line, d.column);
    let mut others = unknown_calls(ast, file, context);
    others.retain(|d| place(d) != place(ended));
    others.truncate(MOST);
    others
}

/// Lines with calls of scene functions that the run never came by. Lines that follow one another are one warning.
pub(super) fn unreached(ast: &AST, ran: &Lines, file: &str, context: &Context<'_>) -> Vec<Diagnostic> {
    let text = context.text(file);
    let declared = names::Declared::of(text);
    let mut warnings: Vec<Diagnostic> = Vec::new();
    let calls = scene_calls(ast, context.language);
    let never = |position: &Position| !ran.contains(position.line().unwrap_or(0));
    if calls
        .iter()
        .all(|call| never(call) && declared.function_at(*call).is_some())
    {
        // A file of functions for others to import.
        return warnings;
    }
    // The first call of a stretch that never ran, and the last line of it.
    let mut stretch: Option<(Position, usize)> = None;
    let tell = |(first, last): (Position, usize)| {
        let line = first.line().unwrap_or(0);
        let lines = if last == line {
            "this line".to_owned()
        } else {
            format!("lines {line} to {last}")
        };
        let d = Diagnostic::warning(Code::UnreachedLine, format!("{lines} never ran"));
        let d = match declared.function_at(first) {
            Some(name) => d.note(format!("in the function {name}")),
            None => d,
        };
        context.place(d, file, first)
    };
    for position in calls {
        let line = position.line().unwrap_or(0);
        let in_same = |first: Position| declared.function_at(first) == declared.function_at(position);
        match &mut stretch {
            _ if !never(&position) => warnings.extend(stretch.take().map(&tell)),
            Some((first, last)) if in_same(*first) => *last = line,
            _ => warnings.extend(stretch.replace((position, line)).map(&tell)),
        }
    }
    warnings.extend(stretch.take().map(&tell));
    warnings.truncate(MOST);
    warnings
}

/// Where scene functions are called, in order.
pub(super) fn scene_calls(ast: &AST, language: &Language) -> BTreeSet<Position> {
    let names = Names::of(Some(ast), language);
    let mut places = BTreeSet::new();
    each_call(ast, |call, position| {
        let is_scene =
            entry(&call.name).is_some_and(|entry| matches!(entry.run, Run::Scene(_) | Run::Calling(_)));
        if is_scene && call.namespace.is_empty() && !names.has_own(&call.name, call.args.len()) {
            places.insert(position);
        }
    });
    places
}

/// Visits the calls of a script, those of methods and operators of other values left out.
fn each_call(ast: &AST, mut visit: impl FnMut(&rhai::FnCallExpr, Position)) {
    ast.walk(&mut |path| {
        let call = match path.last() {
            Some(ASTNode::Expr(Expr::FnCall(call, position))) => Some((call, *position)),
            Some(ASTNode::Stmt(rhai::Stmt::FnCall(call, position))) => Some((call, *position)),
            _ => None,
        };
        if let Some((call, position)) = call {
            visit(call, position);
        }
        true
    });
}
