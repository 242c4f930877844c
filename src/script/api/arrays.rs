//! `push` in constant time.
//!
//! Rhai measures the whole array after every method called on it, so that a mesh of a hundred thousand points
//! built by `push` takes minutes. Here a small item is added after one look at the array's length.

use std::any::TypeId;

use rhai::{Array, Dynamic, EvalAltResult, Module, NativeCallContext, Position};

use crate::script::{
    engine::{Purity, register},
    value::ScriptError,
};

/// Elements that an item may have and still be small. Items within items are never small: what they hold
/// in all is only known by measuring.
const SMALL: usize = 16;

fn is_small(item: &Dynamic) -> bool {
    if item.is_map() || item.is_fnptr() || item.is_shared() {
        return false;
    }
    match item.as_array_ref() {
        Ok(array) => {
            array.len() <= SMALL
                && array
                    .iter()
                    .all(|d| !(d.is_array() || d.is_map() || d.is_string() || d.is_fnptr() || d.is_shared()))
        }
        Err(_) => true,
    }
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
        let most = ctx.engine().max_array_size();
        if most > 0 && array.len() >= most {
            return Err(Box::new(EvalAltResult::ErrorDataTooLarge(
                "Size of array/BLOB".to_owned(),
                Position::NONE,
            )));
        }
        array.push(item);
    }
    if small {
        // Rhai goes on to measure what stands first; now that is the place the item was taken from.
        args.swap(0, 1);
    }
    Ok(Dynamic::UNIT)
}

pub(super) fn extend(module: &mut Module) {
    let types = [TypeId::of::<Array>(), TypeId::of::<Dynamic>()];
    register(module, "push", &types, Purity::Changes, push);
}
