//! `push` in constant time, and `append` in the time of what it adds.
//!
//! Rhai measures the whole array after every method called on it, so that a mesh of a hundred thousand points
//! built by `push` takes minutes. Here a small item is added after one look at the array's length. (What Rhai evaluates
//! without a call, `array += items`, stays measured, and so do the methods without an argument.)

use std::any::TypeId;

use rhai::{Array, Dynamic, EvalAltResult, Module, NativeCallContext, Position};

use crate::script::{
    engine::{Purity, register},
    value::ScriptError,
};

/// Elements that an item may have and still be small. Items within items are never small: what they hold
/// in all is only known by measuring.
const SMALL: usize = 16;

/// Whether nothing is within it.
fn is_flat(item: &Dynamic) -> bool {
    !(item.is_array()
        || item.is_blob()
        || item.is_map()
        || item.is_string()
        || item.is_fnptr()
        || item.is_shared())
}

fn is_small(item: &Dynamic) -> bool {
    if item.is_blob() || item.is_map() || item.is_fnptr() || item.is_shared() {
        return false;
    }
    match item.as_array_ref() {
        Ok(array) => array.len() <= SMALL && array.iter().all(is_flat),
        Err(_) => true,
    }
}

/// An array's elements at most, where the engine bounds them.
fn most(ctx: &NativeCallContext<'_>) -> usize {
    match ctx.engine().max_array_size() {
        0 => usize::MAX,
        most => most,
    }
}

fn too_long() -> Box<EvalAltResult> {
    Box::new(EvalAltResult::ErrorDataTooLarge(
        "Size of array/BLOB".to_owned(),
        Position::NONE,
    ))
}

fn push(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let [array, item] = args else {
        return Err(ScriptError::new("push takes an item").raise(ctx.call_position()));
    };
    let item = std::mem::take(*item);
    let small = is_small(&item);
    {
        let Some(mut array) = array.write_lock::<Array>() else {
            return Err(ScriptError::new("push works on an array").raise(ctx.call_position()));
        };
        if array.len() >= most(ctx) {
            return Err(too_long());
        }
        array.push(item);
    }
    if small {
        // Rhai goes on to measure what stands first; now that is the place the item was taken from.
        args.swap(0, 1);
    }
    Ok(Dynamic::UNIT)
}

fn append(ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> Result<Dynamic, Box<EvalAltResult>> {
    let [array, items] = args else {
        return Err(ScriptError::new("append takes an array").raise(ctx.call_position()));
    };
    let Ok(items) = std::mem::take(*items).into_array() else {
        return Err(ScriptError::new("append takes an array").raise(ctx.call_position()));
    };
    let small = items.iter().all(is_small);
    {
        let Some(mut array) = array.write_lock::<Array>() else {
            return Err(ScriptError::new("append works on an array").raise(ctx.call_position()));
        };
        if array.len().saturating_add(items.len()) > most(ctx) {
            return Err(too_long());
        }
        array.extend(items);
    }
    if small {
        // As with `push`.
        args.swap(0, 1);
    }
    Ok(Dynamic::UNIT)
}

pub(super) fn extend(module: &mut Module) {
    let [array, any] = [TypeId::of::<Array>(), TypeId::of::<Dynamic>()];
    register(module, "push", &[array, any], Purity::Changes, push);
    register(module, "append", &[array, array], Purity::Changes, append);
}
