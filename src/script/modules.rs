//! `import`: script files read through the host, relative to the file that imports them, each run once.

use std::sync::Arc;

use rhai::{
    Engine, EvalAltResult, GlobalRuntimeState, ImmutableString, Module, ModuleResolver, Position, Scope,
};

use super::{
    engine, normal,
    session::{Source, State, limit, with_state},
    value::{Outcome, ScriptError},
};
use crate::{
    diag::{Code, ErrorKind},
    host::resolve,
};

/// Modules that may import one another in a row.
const DEPTH: usize = 8;

/// Resolves imports on the session of the current thread.
pub(super) struct Resolver;

impl Resolver {
    /// The module's text, once it is known to be allowed.
    fn load(
        state: &mut State,
        source: Option<&ImmutableString>,
        path: &str,
        pos: Position,
    ) -> Result<Found, Box<ScriptError>> {
        state.at(source, pos);
        if path.is_empty() {
            return Err(
                ScriptError::new("import needs the name of a file").hint("import \"parts\" as parts;")
            );
        }
        let file = if path.ends_with(".rhai") {
            path.to_owned()
        } else {
            format!("{path}.rhai")
        };
        let host_path = state.host_path(&file);
        if let Some(module) = state.modules.get(&host_path) {
            return Ok(Found::Module(Arc::clone(module)));
        }
        let main = state.sources.first().map_or("", |s| s.name.as_str());
        let own_name = main.rsplit('/').next().unwrap_or(main);
        let mut chain = vec![own_name.to_owned()];
        chain.extend(state.loading.iter().cloned());
        if let Some(start) = chain.iter().position(|p| *p == host_path) {
            let circle: Vec<&str> = chain
                .iter()
                .skip(start)
                .map(String::as_str)
                .chain([host_path.as_str()])
                .collect();
            return Err(ScriptError::new(format!(
                "files import one another in a circle: {}",
                circle.join(" -> ")
            ))
            .class(Code::ImportCircle));
        }
        if state.loading.len() >= DEPTH {
            return Err(ScriptError::of_kind(
                ErrorKind::Limit,
                format!("imports are nested too deep: the limit is {DEPTH}"),
            ));
        }
        if state.modules.len() + state.loading.len() >= state.limits.modules {
            return Err(limit(
                "too many files are imported",
                "modules",
                state.limits.modules,
            ));
        }
        let name = resolve(main, &host_path);
        let bytes = state.read_script(&host_path)?;
        let text = String::from_utf8(bytes).map_err(|e| {
            ScriptError::of_kind(
                ErrorKind::Input,
                format!(
                    "'{host_path}' is not UTF-8: byte {} is wrong",
                    e.utf8_error().valid_up_to()
                ),
            )
        })?;
        let text: Arc<str> = normal(&text).into();
        state.sources.push(Source {
            name: name.clone(),
            host_path: host_path.clone(),
            text: Arc::clone(&text),
        });
        Ok(Found::Text {
            name,
            host_path,
            text,
        })
    }
}

enum Found {
    Module(Arc<Module>),
    Text {
        name: String,
        host_path: String,
        text: Arc<str>,
    },
}

impl ModuleResolver for Resolver {
    fn resolve(
        &self,
        engine: &Engine,
        source: Option<&str>,
        path: &str,
        pos: Position,
    ) -> Result<Arc<Module>, Box<EvalAltResult>> {
        let mut global = engine.new_global_runtime_state();
        global.source = source.map(Into::into);
        self.resolve_raw(engine, &mut global, &mut Scope::new(), path, pos)
    }

    /// Runs the module with the counters of the run it belongs to.
    fn resolve_raw(
        &self,
        engine: &Engine,
        global: &mut GlobalRuntimeState,
        _scope: &mut Scope<'_>,
        path: &str,
        pos: Position,
    ) -> Result<Arc<Module>, Box<EvalAltResult>> {
        let found = with_state(|state| {
            let found = Self::load(state, global.source.as_ref(), path, pos)?;
            Ok((found, state.limits.clone(), state.language.clone()))
        });
        let found: Outcome<_> = found.unwrap_or_else(|| {
            Err(ScriptError::of_kind(
                ErrorKind::Internal,
                "an import outside a run",
            ))
        });
        let (found, limits, language) = found.map_err(|e| e.raise(pos))?;
        let (name, host_path, text) = match found {
            Found::Module(module) => return Ok(module),
            Found::Text {
                name,
                host_path,
                text,
            } => (name, host_path, text),
        };
        let in_module = |e: Box<EvalAltResult>| Box::new(EvalAltResult::ErrorInModule(name.clone(), e, pos));
        let mut ast = engine::compile(&text, &limits, &language)
            .map_err(|e| e.raise(pos))?
            .map_err(|e| in_module(Box::new(EvalAltResult::ErrorParsing(*e.0, e.1))))?;
        ast.set_source(name.as_str());
        with_state(|state| state.loading.push(host_path.clone()));
        // A scope of its own: a module does not see the variables of who imports it.
        let module = Module::eval_ast_as_new_raw(engine, &mut Scope::new(), global, &ast);
        with_state(|state| state.loading.pop());
        let module: Arc<Module> = Arc::new(module.map_err(in_module)?);
        with_state(|state| state.modules.insert(host_path, Arc::clone(&module)));
        Ok(module)
    }
}
