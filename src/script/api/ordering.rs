//! Sorting, and what else of Rhai's passes over the errors of comparisons that it makes: here a run that is to end ends
//! between two of them, where Rhai's own functions go on to the end of two million values.
//!
//! What comes out is the same, since both are stable. Where comparisons contradict one another there is no order, and it
//! depends on the steps that are taken: on those below, whatever version of Rust they are compiled with.

use std::{
    any::TypeId,
    cmp::Ordering::{self, Equal, Less},
    mem,
};

use rhai::{Array, Dynamic, EvalAltResult, FnPtr, ImmutableString, Module, NativeCallContext, Position};

use crate::script::{
    caller::Failure,
    engine::{Purity, register},
    steps::{self, PIECE, Work},
    value::{Outcome, ScriptError},
};

/// What comparing with a text may cost, in the measure of [`Work`]; other values cost 1.
fn of_a_text(value: &Dynamic) -> usize {
    value
        .as_immutable_string_ref()
        .map_or(1, |text| 1 + text.len() / 64)
}

/// Moves what two runs hold to the end of `merged`.
fn merge(
    left: &mut [Dynamic],
    right: &mut [Dynamic],
    merged: &mut Array,
    less: &mut impl FnMut(&Dynamic, &Dynamic) -> Outcome<bool>,
) -> Outcome<()> {
    let (mut left, mut right) = (left.iter_mut(), right.iter_mut());
    let (mut a, mut b) = (left.next(), right.next());
    while let (Some(x), Some(y)) = (&mut a, &mut b) {
        if less(y, x)? {
            merged.push(mem::take(*y));
            b = right.next();
        } else {
            merged.push(mem::take(*x));
            a = left.next();
        }
    }
    merged.extend(a.into_iter().chain(left).map(mem::take));
    merged.extend(b.into_iter().chain(right).map(mem::take));
    Ok(())
}

/// Merges neighboring runs until there is one. `ends` are the places behind each of them. As in Rust's own sort, `less` is
/// only ever asked whether a later value comes before an earlier one: so scripts may say `|x, y| x < y`.
fn merge_all(
    mut items: Array,
    mut ends: Vec<usize>,
    mut less: impl FnMut(&Dynamic, &Dynamic) -> Outcome<bool>,
) -> Outcome<Array> {
    let mut merged = Array::new();
    while ends.len() > 1 {
        merged.reserve(items.len());
        let mut rest = items.as_mut_slice();
        let mut start = 0;
        let mut wider = Vec::with_capacity(ends.len().div_ceil(2));
        for pair in ends.chunks(2) {
            let (middle, end) = match *pair {
                [middle, end] => (middle, end),
                [end] => (end, end),
                _ => continue,
            };
            let (both, others) = mem::take(&mut rest).split_at_mut(end - start);
            let (left, right) = both.split_at_mut(middle - start);
            merge(left, right, &mut merged, &mut less)?;
            (rest, start) = (others, end);
            wider.push(end);
        }
        items.clear();
        mem::swap(&mut items, &mut merged);
        ends = wider;
    }
    Ok(items)
}

/// Items at the start of `items`, at least one, that are together not too much for one piece of work.
fn piece(items: &[Dynamic], weight: impl Fn(&Dynamic) -> usize) -> (usize, usize) {
    let (mut count, mut sum) = (0, 0);
    for item in items {
        sum += weight(item);
        if count > 0 && sum > PIECE {
            break;
        }
        count += 1;
    }
    (count, sum)
}

/// Sorts by a total order that calls nothing of the script.
fn sorted(
    mut items: Array,
    weight: impl Fn(&Dynamic) -> usize,
    order: impl Fn(&Dynamic, &Dynamic) -> Ordering,
) -> Outcome<Array> {
    let mut work = Work::new();
    let mut ends = Vec::new();
    let mut last: Option<Dynamic> = None;
    let mut start = 0;
    let mut rest = items.as_mut_slice();
    while !rest.is_empty() {
        let (count, cost) = piece(rest, &weight);
        let (these, others) = mem::take(&mut rest).split_at_mut(count);
        work.done(cost)?;
        these.sort_by(&order);
        start += count;
        // What goes on where the last run ends is no run of its own.
        if let (Some(last), Some(first)) = (&last, these.first())
            && order(first, last) != Less
        {
            ends.pop();
        }
        ends.push(start);
        last = these.last().cloned();
        rest = others;
    }
    merge_all(items, ends, |x, y| {
        work.done(weight(x).min(weight(y)))?;
        Ok(order(x, y) == Less)
    })
}

/// Sorts by comparisons that the script makes. They take long, so runs that rise, or fall without equals, are found first.
fn sorted_by(mut items: Array, mut less: impl FnMut(&Dynamic, &Dynamic) -> Outcome<bool>) -> Outcome<Array> {
    let mut ends = Vec::new();
    let mut start = 0;
    let mut rest = items.as_mut_slice();
    while !rest.is_empty() {
        let mut count = 1;
        let mut falls = None;
        for pair in rest.windows(2) {
            let [x, y] = pair else { break };
            let less = less(y, x)?;
            if *falls.get_or_insert(less) != less {
                break;
            }
            count += 1;
        }
        let (run, others) = mem::take(&mut rest).split_at_mut(count);
        if falls == Some(true) {
            run.reverse();
        }
        start += count;
        ends.push(start);
        rest = others;
    }
    merge_all(items, ends, less)
}

/// Floats in order, and behind them what is no number: a sort of Rust's may panic where that equals all others.
fn order_of_floats(x: f64, y: f64, descending: bool) -> Ordering {
    match x.partial_cmp(&y) {
        Some(order) if descending => order.reverse(),
        Some(order) => order,
        None => x.is_nan().cmp(&y.is_nan()),
    }
}

/// Sorts values of one of the types that have an order.
fn sort_values(items: &mut Array, descending: bool) -> Result<(), Failure> {
    let [first, _, ..] = items.as_slice() else {
        return Ok(());
    };
    let id = first.type_id();
    let refused = |message: String| {
        let error = EvalAltResult::ErrorFunctionNotFound(message, Position::NONE);
        Err(Failure::Raised(Box::new(error)))
    };
    if items.iter().any(|item| item.type_id() != id) {
        return refused("elements of different types cannot be sorted".to_owned());
    }
    macro_rules! sort {
        ($weight:expr, $order:expr) => {{
            let order = $order;
            if descending {
                sorted(mem::take(items), $weight, |x, y| order(y, x))
            } else {
                sorted(mem::take(items), $weight, order)
            }
        }};
    }
    let sorted = if id == TypeId::of::<i64>() {
        sort!(|_| 1, |x: &Dynamic, y: &Dynamic| x
            .as_int()
            .unwrap_or_default()
            .cmp(&y.as_int().unwrap_or_default()))
    } else if id == TypeId::of::<f64>() {
        let float = |x: &Dynamic| x.as_float().unwrap_or(f64::NAN);
        sorted(
            mem::take(items),
            |_| 1,
            |x, y| order_of_floats(float(x), float(y), descending),
        )
    } else if id == TypeId::of::<ImmutableString>() {
        sort!(of_a_text, |x: &Dynamic, y: &Dynamic| {
            match (x.as_immutable_string_ref(), y.as_immutable_string_ref()) {
                (Ok(x), Ok(y)) => x.as_str().cmp(y.as_str()),
                _ => Equal,
            }
        })
    } else if id == TypeId::of::<char>() {
        sort!(|_| 1, |x: &Dynamic, y: &Dynamic| x
            .as_char()
            .unwrap_or_default()
            .cmp(&y.as_char().unwrap_or_default()))
    } else if id == TypeId::of::<bool>() {
        sort!(|_| 1, |x: &Dynamic, y: &Dynamic| x
            .as_bool()
            .unwrap_or_default()
            .cmp(&y.as_bool().unwrap_or_default()))
    } else if id == TypeId::of::<()>() {
        return Ok(());
    } else {
        return refused(format!("elements of {} cannot be sorted", first.type_name()));
    };
    *items = sorted?;
    Ok(())
}

/// Whether a function of the script puts `x` before `y`: by the sign of its number, by whether it says so, or else by the
/// types of the two. (Rhai orders those by numbers that every build has anew.) Errors count as nothing, but where they end
/// the run.
fn is_less(ctx: &NativeCallContext<'_>, by: &FnPtr, x: &Dynamic, y: &Dynamic) -> Outcome<bool> {
    let result = by.call_raw(ctx, None, [x.clone(), y.clone()]);
    if result.is_err() {
        steps::ended()?;
    }
    let result = result.unwrap_or_default();
    Ok(match (result.as_int(), result.as_bool()) {
        (Ok(number), _) => number < 0,
        (_, Ok(before)) => before,
        _ => x.type_name() < y.type_name(),
    })
}

/// What a function does to an array, by the comparer that it is given.
type Change = fn(&NativeCallContext<'_>, &mut Array, Option<&FnPtr>) -> Result<(), Failure>;

fn ascending(ctx: &NativeCallContext<'_>, items: &mut Array, by: Option<&FnPtr>) -> Result<(), Failure> {
    match by {
        Some(_) if items.len() <= 1 => {}
        Some(by) => *items = sorted_by(mem::take(items), |x, y| is_less(ctx, by, x, y))?,
        None => sort_values(items, false)?,
    }
    Ok(())
}

fn descending(_: &NativeCallContext<'_>, items: &mut Array, _: Option<&FnPtr>) -> Result<(), Failure> {
    sort_values(items, true)
}

/// Leaves the first of neighbors that are equal.
fn dedup(ctx: &NativeCallContext<'_>, items: &mut Array, by: Option<&FnPtr>) -> Result<(), Failure> {
    let mut kept = Array::with_capacity(items.len());
    for item in mem::take(items) {
        let Some(last) = kept.last() else {
            kept.push(item);
            continue;
        };
        let (mut x, mut y): (Dynamic, Dynamic) = (last.clone(), item.clone());
        let same = match by {
            Some(by) => by.call_raw(ctx, None, [x, y]),
            None => ctx.call_native_fn_raw("==", false, &mut [&mut x, &mut y]),
        };
        if same.is_err() {
            steps::ended()?;
        }
        if !same.is_ok_and(|same| same.as_bool().unwrap_or(false)) {
            kept.push(item);
        }
    }
    *items = kept;
    Ok(())
}

/// Whether a function changes its array, or gives a changed copy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Works {
    InPlace,
    OnACopy,
}

fn call(
    ctx: &NativeCallContext<'_>,
    args: &mut [&mut Dynamic],
    change: Change,
    works: Works,
) -> Result<Dynamic, Failure> {
    let (array, by) = match args {
        [array] => (array, None),
        [array, by] => (array, Some(mem::take(*by))),
        _ => return Err(ScriptError::new("not the arguments of a sort").into()),
    };
    let by = match by.map(|by| by.try_cast_result::<FnPtr>()) {
        None => None,
        Some(Ok(by)) => Some(by),
        Some(Err(name)) => Some(FnPtr::new(name.into_immutable_string().unwrap_or_default())?),
    };
    let Some(mut array) = array.write_lock::<Array>() else {
        return Err(ScriptError::new("not an array to sort").into());
    };
    Ok(match works {
        Works::InPlace => {
            change(ctx, &mut array, by.as_ref())?;
            Dynamic::UNIT
        }
        Works::OnACopy => {
            let mut copy = array.clone();
            change(ctx, &mut copy, by.as_ref())?;
            copy.into()
        }
    })
}

pub(super) fn extend(module: &mut Module) {
    let array = TypeId::of::<Array>();
    let (by, by_name) = (TypeId::of::<FnPtr>(), TypeId::of::<ImmutableString>());
    let functions: [(&str, &[TypeId], Change, Works); 12] = [
        ("sort", &[array], ascending, Works::InPlace),
        ("sort", &[array, by], ascending, Works::InPlace),
        ("sort", &[array, by_name], ascending, Works::InPlace),
        ("sort_by", &[array, by], ascending, Works::InPlace),
        ("sort_desc", &[array], descending, Works::InPlace),
        ("order", &[array], ascending, Works::OnACopy),
        ("order", &[array, by], ascending, Works::OnACopy),
        ("order_by", &[array, by], ascending, Works::OnACopy),
        ("order_desc", &[array], descending, Works::OnACopy),
        ("dedup", &[array], dedup, Works::InPlace),
        ("dedup", &[array, by], dedup, Works::InPlace),
        ("dedup", &[array, by_name], dedup, Works::InPlace),
    ];
    for (name, types, change, works) in functions {
        register(module, name, types, Purity::Changes, move |ctx, args| {
            call(ctx, args, change, works)
                .map_err(|failure| failure.raise(ctx.call_source(), ctx.call_position()))
        });
    }
}

#[cfg(test)]
pub(super) mod tests;
