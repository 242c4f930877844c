//! The Rhai engine of a script: chosen packages, portable maths, every limit set, no way out but the host.

use std::{
    any::TypeId,
    sync::{
        Arc, LazyLock,
        atomic::{AtomicU64, Ordering},
    },
};

use rhai::{
    AST, ASTNode, Dynamic, Engine, EvalAltResult, EvalContext, Expression, FuncRegistration, LexError,
    Module, NativeCallContext, OptimizationLevel, ParseError, Position, RhaiFunc, Scope, Stmt, Token,
    packages::{
        ArithmeticPackage, BasicArrayPackage, BasicBlobPackage, BasicIteratorPackage, BasicMapPackage,
        BasicStringPackage, BitFieldPackage, LogicPackage, MoreStringPackage, Package,
    },
};

use super::{
    api,
    call::{Call, wrong_count},
    caller::{Caller, Failure},
    cells,
    clock::Clock,
    language::Language,
    link::Flags,
    modules::Resolver,
    power,
    session::{self, State, with_state},
    steps,
    table::{Entry, Run, arities, entries},
    value::{Outcome, ScriptError},
    vocabulary::CONSTANTS,
};
use crate::{
    diag::ErrorKind,
    limits::Limits,
    scene::{CsgOp, GroupMark, SceneError},
};

type EvalResult = Result<Dynamic, Box<EvalAltResult>>;

/// Rhai names closures by a hash; with this seed the names stay the same from run to run.
const HASHING_SEED: [u64; 4] = [0x7274, 0x7363, 0x7269, 0x7074];

/// What every engine shares: Rhai's packages, then ours, which comes first when a name is looked up.
static MODULES: LazyLock<Vec<Arc<Module>>> = LazyLock::new(|| {
    let mut modules = rhais_packages();
    modules.push(Arc::new(scene_module()));
    modules
});

/// Rhai's packages that touch neither clock nor thread.
pub(super) fn rhais_packages() -> Vec<Arc<Module>> {
    vec![
        ArithmeticPackage::new().as_shared_module(),
        LogicPackage::new().as_shared_module(),
        BitFieldPackage::new().as_shared_module(),
        BasicArrayPackage::new().as_shared_module(),
        BasicBlobPackage::new().as_shared_module(),
        BasicMapPackage::new().as_shared_module(),
        BasicIteratorPackage::new().as_shared_module(),
        BasicStringPackage::new().as_shared_module(),
        MoreStringPackage::new().as_shared_module(),
    ]
}

/// What scripts see.
#[cfg(test)]
pub(super) fn modules() -> &'static [Arc<Module>] {
    &MODULES
}

/// Names that Rhai has, too, for other arguments.
const SHARED: [&str; 1] = ["blob"];

/// All functions of the table, with what belongs to our types.
fn scene_module() -> Module {
    let mut module = Module::new();
    let dynamic = [TypeId::of::<Dynamic>(); MOST_DYNAMIC];
    for entry in entries().filter(|e| !matches!(e.run, Run::Syntax)) {
        let accepted = entry.arity_set();
        for arity in arities(accepted) {
            let mut add = |types: &[TypeId]| {
                register(&mut module, entry.name, types, Purity::Pure, move |ctx, args| {
                    invoke(entry, ctx, args)
                });
            };
            match dynamic.get(..arity) {
                Some(types) => add(types),
                None => numbers_beyond(&dynamic, arity)
                    .iter()
                    .for_each(|types| add(types)),
            }
        }
        if SHARED.contains(&entry.name) {
            continue;
        }
        // A slip by one argument gets the entry's own error, also where the script catches it. Where more is wrong,
        // Rhai's "function not found" is translated: each registration is paid for at every start.
        let slips = (accepted << 1 | accepted >> 1) & !accepted;
        for types in arities(slips).filter_map(|arity| dynamic.get(..arity)) {
            register(&mut module, entry.name, types, Purity::Pure, move |ctx, args| {
                let e = wrong_count(entry, args.len());
                Err(e.raise_in(ctx.call_source(), ctx.call_position()))
            });
        }
    }
    for constant in CONSTANTS {
        module.set_var(constant.name, constant.value);
    }
    for name in power::OPERATORS {
        register(
            &mut module,
            name,
            &[TypeId::of::<Dynamic>(); 2],
            Purity::Pure,
            |ctx, args| {
                let pos = ctx.call_position();
                match args {
                    [x, y] => power::power(x, y).map_err(|e| e.raise(pos)),
                    _ => Err(internal("** without two operands").raise(pos)),
                }
            },
        );
    }
    api::extend(&mut module);
    module.build_index();
    module
}

/// Rhai looks for `Dynamic` parameters among the first 16.
const MOST_DYNAMIC: usize = 16;

/// The parameter types of a function with more parameters than may be `Dynamic`: those beyond are ints or floats.
fn numbers_beyond(dynamic: &[TypeId], arity: usize) -> Vec<Vec<TypeId>> {
    (dynamic.len()..arity).fold(vec![dynamic.to_vec()], |lists, _| {
        let number = [TypeId::of::<i64>(), TypeId::of::<f64>()];
        lists
            .iter()
            .flat_map(|list| number.map(|n| list.iter().copied().chain([n]).collect()))
            .collect()
    })
}

/// Whether a function leaves its first argument alone, so that it may be given a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Purity {
    Pure,
    Changes,
}

/// Registers a function that is never folded at compile time.
pub(super) fn register(
    module: &mut Module,
    name: &str,
    types: &[TypeId],
    purity: Purity,
    run: impl Fn(&NativeCallContext<'_>, &mut [&mut Dynamic]) -> EvalResult + Send + Sync + 'static,
) {
    FuncRegistration::new(name)
        .in_global_namespace()
        .set_into_module_raw(
            module,
            types,
            RhaiFunc::Method {
                func: Arc::new(
                    move |ctx: Option<NativeCallContext<'_>>, args: &mut [&mut Dynamic]| match ctx {
                        Some(ctx) => run(&ctx, args),
                        None => Err(internal("a call without a context").raise(Position::NONE)),
                    },
                ),
                has_context: true,
                is_pure: purity == Purity::Pure,
                is_volatile: true,
            },
        );
}

/// Calls a function of the table.
fn invoke(entry: &'static Entry, ctx: &NativeCallContext<'_>, args: &mut [&mut Dynamic]) -> EvalResult {
    let mut call = Call::new(entry, args);
    let result = match entry.run {
        Run::Pure(run) => run(&mut call),
        Run::Scene(run) => {
            let mut other = None;
            let work = |state: &mut State| {
                let source = ctx.global_runtime_state().source.as_ref();
                let result = match state.called(source, ctx.call_position()) {
                    Ok(()) => run(&mut call, state),
                    Err(error) => Err(error),
                };
                let left = Left::by(&result);
                if left != Left::Nothing {
                    other = Some(result);
                }
                left
            };
            let left =
                steps::for_the_scene(|| with_state(work), |left| left.is_some_and(Left::is_the_scenes));
            if left == Some(Left::Nothing) {
                return Ok(Dynamic::UNIT);
            }
            other.unwrap_or_else(|| Err(internal("a scene function outside a run")))
        }
        Run::Calling(run) => {
            return Caller::new(ctx).run(|caller| {
                run(&mut call, caller).map_err(|failure| match failure {
                    Failure::Said(e) => Failure::Said(call.as_given(e)),
                    raised @ Failure::Raised(_) => raised,
                })
            });
        }
        Run::Syntax => Err(internal("a block called as a function")),
    };
    result.map_err(|e| call.as_given(e).raise_in(ctx.call_source(), ctx.call_position()))
}

/// What a scene function leaves to the script. Most leave nothing, and a value that is none would be copied from frame to
/// frame half written, which a processor has to wait for each time.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Left {
    Nothing,
    /// A value no larger than a handle.
    Handle,
    /// A value of any size.
    Data,
    Error,
}

impl Left {
    fn by(result: &Outcome) -> Self {
        match result {
            Ok(value) if value.is_unit() => Self::Nothing,
            Ok(value) if is_data(value) => Self::Data,
            Ok(_) => Self::Handle,
            Err(_) => Self::Error,
        }
    }

    /// Whether what is held since is in the scene.
    fn is_the_scenes(self) -> bool {
        matches!(self, Self::Nothing | Self::Handle)
    }
}

/// Whether a value is as large as the script likes.
fn is_data(value: &Dynamic) -> bool {
    value.is_array() || value.is_map() || value.is_string() || value.is_blob() || value.is_fnptr()
}

#[cold]
fn internal(what: &str) -> Box<ScriptError> {
    ScriptError::of_kind(ErrorKind::Internal, what)
}

/// An engine that reads scripts.
pub(super) fn compiler(limits: &Limits, language: &Language) -> Result<Engine, Box<ScriptError>> {
    // An embedder that runs Rhai of its own may have set it before; closures then bear other names, which no
    // script can see (see `api::functions`).
    let _ = rhai::config::hashing::set_hashing_seed(Some(HASHING_SEED));
    let mut engine = Engine::new_raw();
    for module in MODULES.iter() {
        engine.register_global_module(Arc::clone(module));
    }
    engine
        .set_optimization_level(OptimizationLevel::None)
        .set_strict_variables(true)
        .set_fail_on_invalid_map_property(true)
        .set_fast_operators(true)
        // Counted by `steps::watch`.
        .set_max_operations(0)
        .set_max_call_levels(limits.call_levels)
        .set_max_expr_depths(limits.expression_depth, limits.expression_depth)
        .set_max_string_size(limits.string_bytes)
        .set_max_array_size(limits.array_len)
        .set_max_map_size(limits.map_len)
        .set_max_variables(limits.variables)
        .set_max_functions(limits.functions)
        // Counted by `modules::Resolver`, which can say so.
        .set_max_modules(usize::MAX)
        .set_allow_anonymous_fn(limits.closures);
    // `eval` can hide anything from the reader, and `curry` builds chains that no limit counts.
    engine.disable_symbol("eval").disable_symbol("curry");
    blocks(&mut engine).map_err(|e| internal(&e))?;
    power::declare(&mut engine).map_err(|e| internal(&e))?;
    language.apply(&mut engine);
    read_tokens(&mut engine, limits);
    Ok(engine)
}

/// Lets `**` be ours, and ends the reading of a script that takes too long: the parser asks nobody else.
fn read_tokens(engine: &mut Engine, limits: &Limits) {
    let chains = power::Chains::default();
    let clock = Clock::start();
    let limit = limits.compile_time;
    let count = AtomicU64::new(0);
    #[allow(
        deprecated,
        reason = "marked so by Rhai because it may change; the version is pinned"
    )]
    engine.on_parse_token(move |token, _, _| {
        if count.fetch_add(1, Ordering::Relaxed) % 256 == 255 && clock.elapsed() > limit {
            return Token::LexError(Box::new(LexError::Runtime(format!(
                "reading the script takes too long: the limit 'compile_time' is {limit:?}"
            ))));
        }
        chains.map(token)
    });
}

/// Reads a script. Every call has an engine of its own, because the reader of tokens has a memory.
pub(super) fn compile(
    source: &str,
    limits: &Limits,
    language: &Language,
) -> Result<Result<AST, ParseError>, Box<ScriptError>> {
    let engine = compiler(limits, language)?;
    let mut scope = Scope::new();
    for constant in CONSTANTS {
        scope.push_constant(constant.name, constant.value);
    }
    Ok(engine.compile_with_scope(&scope, source))
}

/// Whether variables may come to be shared by closures: those of the script itself, or of files that it imports.
pub(super) fn may_share(ast: &AST) -> bool {
    // A walk that is stopped says no.
    !ast.walk(&mut |path| {
        !matches!(
            path.last(),
            Some(ASTNode::Stmt(Stmt::Share(..) | Stmt::Import(..)))
        )
    })
}

/// An engine that runs this script on the session of the current thread.
pub(super) fn runner(
    limits: &Limits,
    language: &Language,
    ast: &AST,
    flags: Arc<Flags>,
) -> Result<Engine, Box<ScriptError>> {
    let mut engine = compiler(limits, language)?;
    if may_share(ast) {
        #[allow(
            deprecated,
            reason = "marked so by Rhai because it may change; the version is pinned"
        )]
        engine.on_var(cells::on_variable);
    }
    engine.set_module_resolver(Resolver);
    engine.on_progress(steps::watch(limits, flags));
    engine.on_print(session::print);
    engine.on_debug(|text, source, pos| {
        let (line, column) = (pos.line().unwrap_or(0), pos.position().unwrap_or(0));
        session::print(&format!("{}:{line}:{column}: {text}", source.unwrap_or("")));
    });
    Ok(engine)
}

/// `group { }`, `define "name" { }`, `moving #{ ... } { }`, and the blocks that make a solid.
fn blocks(engine: &mut Engine) -> Result<(), String> {
    for op in CsgOp::ALL {
        engine
            .register_custom_syntax([op.name(), "$block$"], false, move |ctx, inputs| {
                csg(op, ctx, inputs)
            })
            .map_err(|e| e.to_string())?;
    }
    engine
        .register_custom_syntax(["group", "$block$"], false, group)
        .and_then(|engine| engine.register_custom_syntax(["define", "$expr$", "$block$"], false, define))
        .and_then(|engine| engine.register_custom_syntax(["moving", "$expr$", "$block$"], false, moving))
        .map(|_| ())
        .map_err(|e| e.to_string())
}

fn group(ctx: &mut EvalContext<'_, '_, '_, '_, '_, '_>, inputs: &[Expression<'_>]) -> EvalResult {
    let [block] = inputs else {
        return Err(internal("group without a block").raise(Position::NONE));
    };
    let mark = begin(ctx, block.position(), |builder| builder.begin_group())?;
    let result = ctx.eval_expression_tree(block);
    with_state(|state| state.builder.end_group(mark));
    result
}

fn csg(op: CsgOp, ctx: &mut EvalContext<'_, '_, '_, '_, '_, '_>, inputs: &[Expression<'_>]) -> EvalResult {
    let [block] = inputs else {
        return Err(internal("a solid without a block").raise(Position::NONE));
    };
    let pos = block.position();
    let mark = begin(ctx, pos, |builder| builder.begin_csg(op))?;
    let result = ctx.eval_expression_tree(block);
    let keep = result.as_ref().err().is_none_or(|e| e.is_pseudo_error());
    let ended = with_state(|state| state.builder.end_csg(mark, keep));
    match ended {
        Some(Err(e)) if keep => Err(Box::<ScriptError>::from(e).raise_in(ctx.source(), pos)),
        _ => result,
    }
}

fn define(ctx: &mut EvalContext<'_, '_, '_, '_, '_, '_>, inputs: &[Expression<'_>]) -> EvalResult {
    let [name, block] = inputs else {
        return Err(internal("define without a name and a block").raise(Position::NONE));
    };
    let pos = name.position();
    let name = ctx.eval_expression_tree(name)?;
    let name = name.into_immutable_string().map_err(|kind| {
        ScriptError::new(format!(
            "define: the name must be a string, not {}",
            super::call::kind_name(kind)
        ))
        .hint("for example define \"car\" { box(2, 1, 4); }")
        .raise(pos)
    })?;
    let mark = begin(ctx, pos, |builder| builder.begin_define(&name))?;
    let result = ctx.eval_expression_tree(block);
    // Left by break, continue or return, what is built so far is the group; left by an error, it is none.
    let keep = result.as_ref().err().is_none_or(|e| e.is_pseudo_error());
    with_state(|state| state.builder.end_define(mark, keep));
    result
}

fn moving(ctx: &mut EvalContext<'_, '_, '_, '_, '_, '_>, inputs: &[Expression<'_>]) -> EvalResult {
    let (Some(entry), [motion, block]) = (super::table::entry("moving"), inputs) else {
        return Err(internal("moving without a motion and a block").raise(Position::NONE));
    };
    let pos = motion.position();
    let given = ctx.eval_expression_tree(motion)?;
    let motion =
        api::moving::motion(&Call::new(entry, &[]), &given).map_err(|e| e.raise_in(ctx.source(), pos))?;
    let mark = begin(ctx, pos, |builder| builder.begin_moving(motion))?;
    let result = ctx.eval_expression_tree(block);
    let keep = result.as_ref().err().is_none_or(|e| e.is_pseudo_error());
    let ended = with_state(|state| state.builder.end_moving(mark, keep));
    match ended {
        Some(Err(e)) if keep => Err(Box::<ScriptError>::from(e).raise_in(ctx.source(), pos)),
        _ => result,
    }
}

fn begin(
    ctx: &EvalContext<'_, '_, '_, '_, '_, '_>,
    pos: Position,
    begin: impl FnOnce(&mut crate::scene::Builder) -> Result<GroupMark, SceneError>,
) -> Result<GroupMark, Box<EvalAltResult>> {
    let mark: Option<Outcome<GroupMark>> = with_state(|state| {
        state.called(ctx.global_runtime_state().source.as_ref(), pos)?;
        begin(&mut state.builder).map_err(Into::into)
    });
    let mark = mark.unwrap_or_else(|| Err(internal("a block outside a run")));
    mark.map_err(|e| e.raise_in(ctx.source(), pos))
}
