//! Rhai's `replace` with the size of the result known before it is made: its own builds it first and looks at
//! the limit later.

use rhai::{EvalAltResult, FuncRegistration, ImmutableString, Module, NativeCallContext, Position};

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
    let most = ctx.engine().max_string_size();
    if most > 0 && length > most {
        return Err(Box::new(EvalAltResult::ErrorDataTooLarge(
            "Length of string".to_owned(),
            Position::NONE,
        )));
    }
    if found > 0 {
        *text = text.replace(from, to).into();
    }
    Ok(())
}

pub(super) fn extend(module: &mut Module) {
    type Ctx<'a> = NativeCallContext<'a>;
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
