//! Vectors: `vec3`, its functions, properties and operators.

use rhai::{Array, Dynamic, EvalAltResult, FuncRegistration, Module, Position};

use super::{number, vec3};
use crate::{
    diag::Code,
    math::DVec3,
    script::{
        call::{Call, number_of},
        table::{Entry, Group, Param},
        value::{Outcome, ScriptError},
    },
};

const A: Param = vec3("a", "none", "a vector");
const B: Param = vec3("b", "none", "another");

pub(super) const ENTRIES: &[Entry] = &[
    Entry::pure(Group::Vectors, "vec3", |call| vector(call, "v", |v| v))
        .takes(&[
            &[
                number("x", "none", "component along x"),
                number("y", "none", "component along y"),
                number("z", "none", "component along z"),
            ],
            &[vec3("v", "none", "a vector or an array of three numbers")],
        ])
        .returns("vec3")
        .doc("A vector with + - * / (with vectors and numbers, component by component), unary -, ==, .x .y .z and v[0] v[1] v[2]. Arrays of three numbers may stand beside it: vec3(1, 2, 3) + [1, 0, 0].")
        .usage("vec3(1, 2, 3)")
        .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\nlet a = vec3(-2, -1, 0);\nlet step = (vec3(2, 1, 0) - a) / 8;\nfor i in 0..9 {\n  diffuse(0.1 * i, 0.3, 0.9 - 0.1 * i);\n  sphere(a + i * step, 0.15 + 0.02 * i);\n}")
        .also(&["vector", "vec", "Vec3", "vec3d"]),
    Entry::pure(Group::Vectors, "dot", |call| {
        let (a, b) = two(call)?;
        Ok(Dynamic::from(a.dot(b)))
    })
    .takes(&[&[A, B]])
    .returns("float")
    .doc("The dot product; also a.dot(b).")
    .usage("dot([1, 0, 0], [0, 1, 0])")
    .example("print(dot([1, 2, 3], [4, 5, 6]));"),
    Entry::pure(Group::Vectors, "cross", |call| {
        let (a, b) = two(call)?;
        Ok(Dynamic::from(a.cross(b)))
    })
    .takes(&[&[A, B]])
    .returns("vec3")
    .doc("The cross product, at right angles to both; also a.cross(b).")
    .usage("cross([1, 0, 0], [0, 1, 0])")
    .example("print(cross([1, 0, 0], [0, 1, 0]));"),
    Entry::pure(Group::Vectors, "length", |call| {
        let v = call.vec3("v")?;
        call.end()?;
        Ok(Dynamic::from(v.length()))
    })
    .takes(&[&[vec3("v", "none", "a vector")]])
    .returns("float")
    .doc("The length of a vector; also v.length(). An array's number of elements is a.len().")
    .usage("length([3, 4, 0])")
    .example("print(length([3, 4, 0]));")
    .also(&["magnitude", "norm"]),
    Entry::pure(Group::Vectors, "normalize", |call| {
        let v = call.vec3("v")?;
        call.end()?;
        let length = v.length();
        if length > 0.0 && length.is_finite() {
            return Ok(Dynamic::from(v / length));
        }
        Err(call.error(format!("v has no direction: it is [{}, {}, {}]", v.x, v.y, v.z)))
    })
    .takes(&[&[vec3("v", "none", "a vector of any length but 0")]])
    .returns("vec3")
    .doc("The vector of length 1 in the same direction; also v.normalize().")
    .usage("normalize([3, 4, 0])")
    .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ndirectional([2, 4, 3], [0.9, 0.9, 0.9]);\ndiffuse(0.15, 0.5, 0.4);\nfor i in 0..400 {   // scattered, but all as far from the middle\n  let d = normalize([random(-1, 1), random(-1, 1), random(-1, 1)]);\n  sphere(d * 1.5, 0.1);\n}")
    .also(&["normalized", "unit"]),
    Entry::pure(Group::Vectors, "distance", |call| {
        let (a, b) = two(call)?;
        Ok(Dynamic::from(a.distance(b)))
    })
    .takes(&[&[A, B]])
    .returns("float")
    .doc("How far two points are apart; also a.distance(b).")
    .usage("distance([0, 0, 0], [3, 4, 0])")
    .example("print(distance([0, 0, 0], [3, 4, 0]));")
    .also(&["dist"]),
];

fn vector(call: &mut Call<'_, '_>, name: &str, f: impl Fn(DVec3) -> DVec3) -> Outcome {
    let v = call.vec3(name)?;
    call.end()?;
    Ok(Dynamic::from(f(v)))
}

fn two(call: &mut Call<'_, '_>) -> Outcome<(DVec3, DVec3)> {
    let pair = (call.vec3("a")?, call.vec3("b")?);
    call.end()?;
    Ok(pair)
}

/// `a + (b - a) t` in the form that gives `a` and `b` exactly at 0 and 1. Used by `lerp` and `mix`.
pub(super) fn lerp(call: &mut Call<'_, '_>) -> Outcome {
    let numbers = call.peek().and_then(number_of).is_some() && call.len() == 3;
    let result = if numbers {
        let (a, b, t) = (call.number("a")?, call.number("b")?, call.number("t")?);
        Dynamic::from(a * (1.0 - t) + b * t)
    } else {
        let (a, b, t) = (call.vec3("a")?, call.vec3("b")?, call.number("t")?);
        Dynamic::from(a * (1.0 - t) + b * t)
    };
    call.end()?;
    Ok(result)
}

/// Parameters of `lerp` and `mix`.
pub(super) const LERP: &[&[Param]] = &[
    &[
        number("a", "none", "the value at 0"),
        number("b", "none", "the value at 1"),
        number("t", "none", "0 to 1; beyond, the line goes on"),
    ],
    &[
        vec3("a", "none", "the vector at 0"),
        vec3("b", "none", "the vector at 1"),
        number("t", "none", "0 to 1; beyond, the line goes on"),
    ],
];

type Raised<T> = Result<T, Box<EvalAltResult>>;

/// An array beside a vector in an operator.
fn from_array(array: &Array) -> Raised<DVec3> {
    if let [x, y, z] = array.as_slice()
        && let (Some(x), Some(y), Some(z)) = (number_of(x), number_of(y), number_of(z))
    {
        return Ok(DVec3::new(x, y, z));
    }
    Err(Box::new(EvalAltResult::ErrorArithmetic(
        format!("an array beside a vec3 must hold 3 numbers, not {}", array.len()),
        Position::NONE,
    )))
}

/// As Rhai compares floats: equal within a relative epsilon, so that `0.1 + 0.2 == 0.3` holds here too.
fn equal(a: DVec3, b: DVec3) -> bool {
    let same = |x: f64, y: f64| {
        let scale = if x * y == 0.0 { 1.0 } else { x.abs().max(y.abs()) };
        (x - y).abs() / scale <= f64::EPSILON
    };
    same(a.x, b.x) && same(a.y, b.y) && same(a.z, b.z)
}

/// Type name, properties, index and operators of `vec3`.
pub(super) fn extend(module: &mut Module) {
    module.set_custom_type::<DVec3>("vec3");
    macro_rules! operators {
        ($($symbol:literal $op:tt;)*) => {$(
            FuncRegistration::new($symbol).set_into_module(module, |a: DVec3, b: DVec3| a $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: DVec3, b: f64| a $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: DVec3, b: i64| a $op b as f64);
            FuncRegistration::new($symbol).set_into_module(module, |a: f64, b: DVec3| a $op b);
            FuncRegistration::new($symbol).set_into_module(module, |a: i64, b: DVec3| a as f64 $op b);
            FuncRegistration::new($symbol)
                .set_into_module(module, |a: DVec3, b: Array| -> Raised<DVec3> { Ok(a $op from_array(&b)?) });
            FuncRegistration::new($symbol)
                .set_into_module(module, |a: Array, b: DVec3| -> Raised<DVec3> { Ok(from_array(&a)? $op b) });
        )*};
    }
    operators! { "+" +; "-" -; "*" *; "/" /; }
    FuncRegistration::new("-").set_into_module(module, |v: DVec3| -v);
    FuncRegistration::new("+").set_into_module(module, |v: DVec3| v);
    FuncRegistration::new("==").set_into_module(module, equal);
    FuncRegistration::new("!=").set_into_module(module, |a: DVec3, b: DVec3| !equal(a, b));
    FuncRegistration::new("==").set_into_module(module, |a: DVec3, b: Array| {
        from_array(&b).is_ok_and(|b| equal(a, b))
    });
    FuncRegistration::new("!=").set_into_module(module, |a: DVec3, b: Array| {
        !from_array(&b).is_ok_and(|b| equal(a, b))
    });
    FuncRegistration::new("==").set_into_module(module, |a: Array, b: DVec3| {
        from_array(&a).is_ok_and(|a| equal(a, b))
    });
    FuncRegistration::new("!=").set_into_module(module, |a: Array, b: DVec3| {
        !from_array(&a).is_ok_and(|a| equal(a, b))
    });

    macro_rules! components {
        ($($name:ident),*) => {$(
            FuncRegistration::new_getter(stringify!($name)).set_into_module(module, |v: &mut DVec3| v.$name);
            FuncRegistration::new_setter(stringify!($name)).set_into_module(module, |v: &mut DVec3, x: f64| v.$name = x);
            FuncRegistration::new_setter(stringify!($name)).set_into_module(module, |v: &mut DVec3, x: i64| v.$name = x as f64);
        )*};
    }
    components!(x, y, z);
    FuncRegistration::new_index_getter()
        .set_into_module(module, |v: &mut DVec3, i: i64| component(v, i).map(|x| *x));
    FuncRegistration::new_index_setter().set_into_module(module, |v: &mut DVec3, i: i64, x: f64| {
        component(v, i).map(|to| *to = x)
    });
    FuncRegistration::new_index_setter().set_into_module(module, |v: &mut DVec3, i: i64, x: i64| {
        component(v, i).map(|to| *to = x as f64)
    });
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |v: &mut DVec3| {
            format!("[{:?}, {:?}, {:?}]", v.x, v.y, v.z)
        });
    }
    FuncRegistration::new("to_array").set_into_module(module, |v: &mut DVec3| -> Array {
        v.to_array().map(Dynamic::from).to_vec()
    });
}

fn component(v: &mut DVec3, i: i64) -> Raised<&mut f64> {
    match i {
        0 | -3 => Ok(&mut v.x),
        1 | -2 => Ok(&mut v.y),
        2 | -1 => Ok(&mut v.z),
        _ => Err(ScriptError::new(format!("a vector has no component {i}"))
            .class(Code::IndexRange)
            .hint("its components are [0], [1] and [2], or .x, .y and .z")
            .raise(Position::NONE)),
    }
}
