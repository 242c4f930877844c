//! Functions of strings in place of Rhai's: its `replace` builds the result first and looks at the limit later, its `pad`
//! never ends where there is nothing to pad with.

use rhai::{EvalAltResult, FuncRegistration, ImmutableString, Module, NativeCallContext, Position};

use crate::script::value::ScriptError;

/// The limit that a string of so many bytes would break.
fn within_limit(ctx: &NativeCallContext<'_>, length: usize) -> Result<(), Box<EvalAltResult>> {
    let most = ctx.engine().max_string_size();
    if most > 0 && length > most {
        return Err(Box::new(EvalAltResult::ErrorDataTooLarge(
            "Length of string".to_owned(),
            Position::NONE,
        )));
    }
    Ok(())
}

fn replace(
    ctx: &NativeCallContext<'_>,
    text: &mut ImmutableString,
    from: &str,
    to: &str,
) -> Result<(), Box<EvalAltResult>> {
    if text.is_empty() {
        return Ok(());
    }
    let found = text.matches(from).count();
    let length = (text.len() - found * from.len()).saturating_add(found.saturating_mul(to.len()));
    within_limit(ctx, length)?;
    if found > 0 {
        *text = text.replace(from, to).into();
    }
    Ok(())
}

fn pad(
    ctx: &NativeCallContext<'_>,
    text: &mut ImmutableString,
    length: i64,
    padding: &str,
) -> Result<(), Box<EvalAltResult>> {
    let wanted = usize::try_from(length).unwrap_or(0);
    let missing = wanted.saturating_sub(text.chars().count());
    if missing == 0 {
        return Ok(());
    }
    if padding.is_empty() {
        return Err(
            ScriptError::new("pad needs something to pad with, not an empty string")
                .hint("for example text.pad(10, \".\")")
                .raise_in(ctx.call_source(), ctx.call_position()),
        );
    }
    within_limit(ctx, text.len().saturating_add(missing))?;
    let more: String = padding.chars().cycle().take(missing).collect();
    within_limit(ctx, text.len() + more.len())?;
    *text += more.as_str();
    Ok(())
}

pub(super) fn extend(module: &mut Module) {
    type Ctx<'a> = NativeCallContext<'a>;
    FuncRegistration::new("pad").set_into_module(
        module,
        |ctx: Ctx<'_>, s: &mut ImmutableString, length: i64, padding: &str| pad(&ctx, s, length, padding),
    );
    FuncRegistration::new("replace").set_into_module(
        module,
        |ctx: Ctx<'_>, s: &mut ImmutableString, from: &str, to: &str| replace(&ctx, s, from, to),
    );
    FuncRegistration::new("replace").set_into_module(
        module,
        |ctx: Ctx<'_>, s: &mut ImmutableString, from: &str, to: char| {
            replace(&ctx, s, from, to.encode_utf8(&mut [0; 4]))
        },
    );
    FuncRegistration::new("replace").set_into_module(
        module,
        |ctx: Ctx<'_>, s: &mut ImmutableString, from: char, to: &str| {
            replace(&ctx, s, from.encode_utf8(&mut [0; 4]), to)
        },
    );
    FuncRegistration::new("replace").set_into_module(
        module,
        |ctx: Ctx<'_>, s: &mut ImmutableString, from: char, to: char| {
            replace(
                &ctx,
                s,
                from.encode_utf8(&mut [0; 4]),
                to.encode_utf8(&mut [0; 4]),
            )
        },
    );
}
