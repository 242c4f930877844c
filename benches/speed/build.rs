//! From a scene to its compiled world, on one thread.

use divan::{Bencher, counter::ItemsCount};
use rtscript::{Scene, render::World};

use crate::common::{one_thread, scenes};

fn compile(bencher: Bencher<'_, '_>, scene: &Scene, count: usize) {
    let pool = one_thread();
    bencher
        .counter(ItemsCount::new(count))
        .bench_local(|| pool.install(|| World::compile(scene)).unwrap());
}

#[divan::bench(args = [1_000, 100_000], sample_count = 10)]
fn triangles(bencher: Bencher<'_, '_>, count: usize) {
    compile(bencher, &scenes::triangles(count), count);
}

#[divan::bench(args = [1_000, 100_000], sample_count = 10)]
fn spheres(bencher: Bencher<'_, '_>, count: usize) {
    compile(bencher, &scenes::spheres(count), count);
}

#[divan::bench(args = [1_000, 100_000], sample_count = 10)]
fn instances(bencher: Bencher<'_, '_>, count: usize) {
    compile(bencher, &scenes::instances(count), count);
}
