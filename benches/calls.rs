//! What a call of a scene function costs beyond what Rhai takes for it: the same loop with rtscript's functions,
//! with empty native functions of the same signatures in a bare engine, and in one that also counts
//! its steps and measures its values, without which a script could hang its host.
//!
//! usage: `cargo bench --bench calls -- [--reps N] [--only CASE]`; prints one line of comma-separated values for
//! each case: case, nanoseconds of CPU time a turn of the loop for the bare engine, for the limited engine and
//! for rtscript (medians of alternating runs), and the ratio of the last to each. With
//! `--once bare|limited|rtscript CASE TURNS` it runs one loop alone, for callgrind.

#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    clippy::indexing_slicing
)]

mod common;

use std::cell::Cell;

use common::{cpu_seconds, median};
use rhai::{
    AST, Engine, OptimizationLevel, Scope,
    packages::{ArithmeticPackage, BasicIteratorPackage, LogicPackage, Package},
};
use rtscript::{Limits, NoHost, RunOptions, Script};

/// Loops that call scene functions, each with the calls in it.
const CASES: [(&str, &str); 6] = [
    ("sphere", "for i in 0..N { sphere(1.0, 2.0, 3.0, 0.5); }"),
    (
        "sphere of variables",
        "let x = 1.5; for i in 0..N { sphere(x, x, x, 0.5); }",
    ),
    ("sphere of ints", "for i in 0..N { sphere(i, 2, 3, 1); }"),
    (
        "push translate sphere pop",
        "for i in 0..N { pushTransform(); translate(1.5, 2.0, 3.0); sphere(0.0, 0.0, 0.0, 0.5); popTransform(); }",
    ),
    (
        "grid",
        "let i = 0; while i < N { sphere(i % 100 - 50, i / 100 % 100 - 50, i / 10000 - 50, 0.3); i += 1; }",
    ),
    (
        "turned and scaled in a function",
        "fn ball(i) { pushTransform(); rotate(0.0, 1.0, 0.0, 60.0); translate(1.5, 0.0, 0.0); scale(0.5); \
         sphere(0.0, 0.0, 0.0, 1.0); popTransform(); } for i in 0..N { ball(i); }",
    ),
];

/// One way to run a loop.
enum Runner {
    Engine(Box<Engine>, AST),
    Script(Box<Script>),
}

impl Runner {
    fn new(kind: &str, source: &str) -> Self {
        match kind {
            "bare" => Self::engine(false, source),
            "limited" => Self::engine(true, source),
            _ => Self::Script(Box::new(
                Script::compile("calls.rhai", source, &Limits::default()).unwrap(),
            )),
        }
    }

    /// An engine set as rtscript's is, with functions that do nothing, for floats and for ints.
    fn engine(limited: bool, source: &str) -> Self {
        let mut engine = Engine::new_raw();
        engine.register_global_module(ArithmeticPackage::new().as_shared_module());
        engine.register_global_module(LogicPackage::new().as_shared_module());
        engine.register_global_module(BasicIteratorPackage::new().as_shared_module());
        engine
            .set_optimization_level(OptimizationLevel::None)
            .set_strict_variables(true)
            .set_fast_operators(true)
            .set_max_call_levels(64)
            .register_fn("pushTransform", || ())
            .register_fn("popTransform", || ())
            .register_fn("translate", |_: f64, _: f64, _: f64| ())
            .register_fn("rotate", |_: f64, _: f64, _: f64, _: f64| ())
            .register_fn("scale", |_: f64| ())
            .register_fn("sphere", |_: f64, _: f64, _: f64, _: f64| ())
            .register_fn("sphere", |_: i64, _: i64, _: i64, _: i64| ())
            .register_fn("sphere", |_: i64, _: i64, _: i64, _: f64| ());
        if limited {
            thread_local!(static STEPS: Cell<u64> = const { Cell::new(0) });
            engine
                .set_max_string_size(1 << 20)
                .set_max_array_size(2_000_000)
                .set_max_map_size(10_000);
            engine.on_progress(|_| {
                STEPS.set(STEPS.get() + 1);
                None
            });
        }
        let ast = engine.compile(source).unwrap();
        Self::Engine(Box::new(engine), ast)
    }

    fn run(&self) {
        match self {
            Self::Engine(engine, ast) => engine.run_ast_with_scope(&mut Scope::new(), ast).unwrap(),
            Self::Script(script) => {
                script.run(&NoHost, &RunOptions::default()).unwrap();
            }
        }
    }
}

fn main() {
    let args: Vec<String> = std::env::args().filter(|a| a != "--bench").collect();
    let after = |name: &str| args.iter().position(|a| a == name).map(|i| &args[i + 1..]);
    let source = |body: &str, turns: u32| body.replace('N', &turns.to_string());
    if let Some([kind, case, turns, ..]) = after("--once") {
        let body = CASES.iter().find(|(name, _)| name == case).unwrap().1;
        Runner::new(kind, &source(body, turns.parse().unwrap())).run();
        return;
    }
    let reps: usize = after("--reps").map_or(5, |a| a[0].parse().unwrap());
    let only = after("--only").map(|a| a[0].as_str());
    let turns = 500_000;
    println!("case,bare ns,limited ns,rtscript ns,of bare,of limited");
    for (name, body) in CASES {
        if only.is_some_and(|only| only != name) {
            continue;
        }
        let source = source(body, turns);
        // rtscript's comes first: it settles how Rhai hashes names, for all engines of a process.
        let [rtscript, bare, limited] =
            ["rtscript", "bare", "limited"].map(|kind| Runner::new(kind, &source));
        let runners = [bare, limited, rtscript];
        let mut times = [const { Vec::new() }; 3];
        for _ in 0..reps {
            for (runner, times) in runners.iter().zip(&mut times) {
                let start = cpu_seconds();
                runner.run();
                times.push((cpu_seconds() - start) / f64::from(turns) * 1e9);
            }
        }
        let [bare, limited, ours] = times.map(median);
        println!(
            "{name},{bare:.0},{limited:.0},{ours:.0},{:.2},{:.2}",
            ours / bare,
            ours / limited
        );
    }
}
