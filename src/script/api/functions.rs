//! Functions as values, errors as values, and the end of a script.

use rhai::{Dynamic, EvalAltResult, FnPtr, FuncRegistration, Module, Position};

use crate::script::value::ScriptError;

/// A closure bears a name made of a hash, which is nobody's business and not the same on every machine.
fn shown(f: &FnPtr) -> String {
    if f.is_anonymous() {
        "closure".to_owned()
    } else {
        f.fn_name().to_owned()
    }
}

pub(super) fn extend(module: &mut Module) {
    for name in ["print", "to_string", "debug", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |f: &mut FnPtr| format!("Fn({})", shown(f)));
    }
    for name in ["to_string", "to_debug"] {
        FuncRegistration::new(name).set_into_module(module, |e: &mut ScriptError| e.to_string());
    }
    FuncRegistration::new_getter("name").set_into_module(module, |f: &mut FnPtr| shown(f));
    FuncRegistration::new_getter("is_anonymous").set_into_module(module, |f: &mut FnPtr| f.is_anonymous());
    module.set_custom_type::<ScriptError>("error");
    FuncRegistration::new_getter("message").set_into_module(module, |e: &mut ScriptError| e.message.clone());
    FuncRegistration::new("exit").set_into_module(module, || -> Result<(), Box<EvalAltResult>> {
        Err(Box::new(EvalAltResult::Exit(Dynamic::UNIT, Position::NONE)))
    });
}
