//! Operators and functions of fields and solids, and the functions of the coordinates that make fields.

use rhai::{Dynamic, EvalAltResult, FnPtr, FuncRegistration, Map, Module, NativeCallContext};

use super::field_of;
use crate::{
    script::value::ScriptError,
    shape::{Field, Sdf},
};

type Raised<T> = Result<T, Box<EvalAltResult>>;

/// Calls a function of the coordinates, which are fields: what it returns is the expression.
fn expression(ctx: &NativeCallContext<'_>, f: &FnPtr) -> Raised<Field> {
    let [x, y, z] = Field::point();
    let returned: Dynamic = f.call_within_context(ctx, (x, y, z))?;
    field_of(&returned).ok_or_else(|| {
        let kind = crate::script::call::kind_of(&returned);
        ScriptError::new(format!("the function must return a field, not {kind}"))
            .hint("for example |x, y, z| x * x + y * y + z * z - 1")
            .raise_in(ctx.call_source(), ctx.call_position())
    })
}

pub(in crate::script::api) fn extend(module: &mut Module) {
    module.set_custom_type::<Sdf>("sdf");
    module.set_custom_type::<Field>("field");
    FuncRegistration::new("sdf").set_into_module(
        module,
        |ctx: NativeCallContext<'_>, f: FnPtr| -> Raised<Sdf> {
            Ok(Sdf::from_field(expression(&ctx, &f)?, None))
        },
    );
    FuncRegistration::new("isosurface").set_into_module(
        module,
        |ctx: NativeCallContext<'_>, f: FnPtr, options: Map| -> Raised<Dynamic> {
            let field = expression(&ctx, &f)?;
            ctx.call_native_fn("isosurface", (field, options))
        },
    );
    FuncRegistration::new("isosurface").set_into_module(
        module,
        |ctx: NativeCallContext<'_>, f: FnPtr| -> Raised<Dynamic> {
            let field = expression(&ctx, &f)?;
            ctx.call_native_fn("isosurface", (field,))
        },
    );
    for (symbol, run) in [
        ("|", Sdf::union as fn(&Sdf, &Sdf) -> Sdf),
        ("&", Sdf::intersection),
        ("-", Sdf::difference),
    ] {
        FuncRegistration::new(symbol).set_into_module(module, move |a: Sdf, b: Sdf| run(&a, &b));
    }
    macro_rules! operators {
        ($($symbol:literal $op:tt;)*) => {$(
            FuncRegistration::new($symbol).set_into_module(module, |a: Field, b: Field| a $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: Field, b: f64| a $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: Field, b: i64| a $op b as f64);
            FuncRegistration::new($symbol).set_into_module(module, |a: f64, b: Field| Field::constant(a) $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: i64, b: Field| Field::constant(a as f64) $op b);
        )*};
    }
    operators! { "+" +; "-" -; "*" *; "/" /; }
    FuncRegistration::new("-").set_into_module(module, |a: Field| -a);
    FuncRegistration::new("+").set_into_module(module, |a: Field| a);
    for (name, run) in [
        ("sin", Field::sin as fn(&Field) -> Field),
        ("cos", Field::cos),
        ("sqrt", Field::sqrt),
        ("abs", Field::abs),
    ] {
        FuncRegistration::new(name).set_into_module(module, move |a: Field| run(&a));
    }
    for (name, run) in [
        ("min", Field::min as fn(&Field, &Field) -> Field),
        ("max", Field::max),
    ] {
        FuncRegistration::new(name).set_into_module(module, move |a: Field, b: Field| run(&a, &b));
        FuncRegistration::new(name)
            .set_into_module(module, move |a: Field, b: f64| run(&a, &Field::constant(b)));
        FuncRegistration::new(name).set_into_module(module, move |a: Field, b: i64| {
            run(&a, &Field::constant(b as f64))
        });
        FuncRegistration::new(name)
            .set_into_module(module, move |a: f64, b: Field| run(&Field::constant(a), &b));
        FuncRegistration::new(name).set_into_module(module, move |a: i64, b: Field| {
            run(&Field::constant(a as f64), &b)
        });
    }
    FuncRegistration::new("pow").set_into_module(module, |a: Field, b: f64| a.pow(b));
    FuncRegistration::new("pow").set_into_module(module, |a: Field, b: i64| a.pow(b as f64));
    for name in crate::script::power::OPERATORS {
        FuncRegistration::new(name).set_into_module(module, |a: Field, b: f64| a.pow(b));
        FuncRegistration::new(name).set_into_module(module, |a: Field, b: i64| a.pow(b as f64));
    }
    FuncRegistration::new("noise")
        .set_into_module(module, |x: Field, y: Field, z: Field| Field::noise(&[x, y, z]));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DVec3;

    #[test]
    fn the_noise_of_fields_is_that_of_scripts() {
        let field = Field::noise(&Field::point());
        for i in 0..2_000 {
            let p = DVec3::new(0.371, -0.913, 0.577) * (f64::from(i) * 0.37);
            assert_eq!(field.at(p), crate::noise::perlin(p), "{p}");
        }
    }
}
