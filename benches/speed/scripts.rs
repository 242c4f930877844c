//! The language: reading a script, and running one from its first line to the scene; items are calls of scene
//! functions, or lines read.

use divan::{Bencher, counter::ItemsCount};
use rtscript::{Limits, NoHost, RunOptions, Script};

fn run(bencher: Bencher<'_, '_>, calls: u32, text: &str) {
    let script = Script::compile("bench.rhai", text, &Limits::default()).unwrap();
    bencher
        .counter(ItemsCount::new(calls))
        .bench_local(|| script.run(&NoHost, &RunOptions::default()).unwrap());
}

#[divan::bench(sample_count = 20)]
fn numbers_as_arguments(bencher: Bencher<'_, '_>) {
    run(
        bencher,
        50_000,
        "for i in 0..50000 { sphere(1.0, 2.0, 3.0, 0.5); }",
    );
}

#[divan::bench(sample_count = 20)]
fn arrays_as_arguments(bencher: Bencher<'_, '_>) {
    run(
        bencher,
        50_000,
        "for i in 0..50000 { sphere([1.0, 2.0, 3.0], 0.5); }",
    );
}

#[divan::bench(sample_count = 20)]
fn matrix_stack(bencher: Bencher<'_, '_>) {
    run(
        bencher,
        50_000,
        "for i in 0..10000 { pushTransform(); translate(i, 0, 0); rotate(0, 1, 0, i); sphere(0, 0, 0, 1); popTransform(); }",
    );
}

#[divan::bench(sample_count = 20)]
fn groups(bencher: Bencher<'_, '_>) {
    run(
        bencher,
        20_000,
        "for i in 0..10000 { group { diffuse([0.5, 0.5, 0.5]); box(1, 1, 1); } }",
    );
}

#[divan::bench(sample_count = 20)]
fn reading(bencher: Bencher<'_, '_>) {
    let lines = 2_000u32;
    let text: String = (0..lines)
        .map(|i| format!("sphere({i}, {i} * 2.5 + 1, [1, 2, 3][{i} % 3], 0.5); // ball {i}\n"))
        .collect();
    bencher
        .counter(ItemsCount::new(lines))
        .bench_local(|| Script::compile("bench.rhai", &text, &Limits::default()).unwrap());
}

#[divan::bench(sample_count = 20)]
fn nothing(bencher: Bencher<'_, '_>) {
    run(bencher, 1, "sphere(0, 0, 0, 1);");
}
