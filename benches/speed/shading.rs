//! Small pictures in which shading takes most of the time, on one thread; items are pixels.

use divan::{Bencher, counter::ItemsCount};
use rtscript::{Limits, NoHost, RenderOptions, RunOptions, Script, render};

use crate::common::one_thread;

const WIDTH: u32 = 200;
const HEIGHT: u32 = 150;

/// A ball, a box and a torus on a plane.
const THINGS: &str = r"
    camera([0, 2, 6], [0, 0.6, 0], [0, 1, 0], 40);
    background([0.3, 0.4, 0.6]);
    fn things() {
        plane();
        sphere(-1.2, 0.7, 0, 0.7);
        group { translate(0.4, 0.5, 0.6); rotate(0, 1, 0, 30); box(); }
        group { translate(1.7, 0.3, 0); torus(0.6, 0.25); }
    }
";

const LIGHTS: &str = r"
    for i in 0..50 { light([8 * cos(i), 6, 8 * sin(i)], [0.03, 0.03, 0.03]); }
    material(#{ diffuse: [0.6, 0.5, 0.4], specular: [0.4, 0.4, 0.4], shininess: 40, reflection: [0, 0, 0] });
    things();
";

const GLASS: &str = r"
    maxDepth(7);
    light([4, 6, 5], [0.9, 0.9, 0.9]);
    material(#{ ambient: [0, 0, 0], diffuse: [0.05, 0.05, 0.05], reflection: [0.1, 0.1, 0.1], transmission: [0.9, 0.9, 0.9] });
    things();
    translate(0, 0, -2);
    things();
";

const TEXTURES: &str = r"
    sphere(0, 1, 0, 1);
    let picture = render();
    light([4, 6, 5], [0.9, 0.9, 0.9]);
    material(#{ ambient: [0.1, 0.1, 0.1], diffuse: picture, specular: [0.3, 0.3, 0.3], shininess: 20, reflection: [0, 0, 0] });
    things();
";

const SOFT_SHADOWS: &str = r"
    areaLight([2, 6, 2], [2, 0, 0], [0, 0, 2], [1, 1, 1], 8);
    material(#{ diffuse: [0.6, 0.5, 0.4] });
    things();
";

/// A gyroid whose width varies, within a ball, and solids that are blended and twisted.
const ISOSURFACES: &str = r"
    camera([0, 2, 6], [0, 0.6, 0], [0, 1, 0], 40);
    background([0.3, 0.4, 0.6]);
    light([4, 6, 5], [0.9, 0.9, 0.9]);
    diffuse(0.6, 0.5, 0.4);
    plane();
    let web = sdf(|x, y, z| {
        let k = 5.2 - 0.9 * y;
        (abs(sin(k * x) * cos(k * y) + sin(k * y) * cos(k * z) + sin(k * z) * cos(k * x)) - 0.34) / (1.4 * k)
    });
    group { translate(-1.2, 1, 0); isosurface(sdfSphere(1) & web); }
    let rod = sdfCylinder(0.3, 1.6);
    translate(1.2, 1, 0);
    isosurface((rod.smoothUnion(rod.turned([1, 0, 0], 90), 0.2) | sdfBox(0.8, 0.8, 0.8).rounded(0.1)).twisted(40));
";

fn picture(bencher: Bencher<'_, '_>, script: &str) {
    let text = format!("size({WIDTH}, {HEIGHT});{THINGS}{script}");
    let script = Script::compile("bench.rhai", &text, &Limits::default()).unwrap();
    let scene = script.run(&NoHost, &RunOptions::default()).unwrap().value.scene;
    let pool = one_thread();
    bencher.counter(ItemsCount::new(WIDTH * HEIGHT)).bench_local(|| {
        pool.install(|| render(&scene, &RenderOptions::default(), &NoHost))
            .unwrap()
    });
}

#[divan::bench(sample_count = 10)]
fn fifty_lights(bencher: Bencher<'_, '_>) {
    picture(bencher, LIGHTS);
}

#[divan::bench(sample_count = 10)]
fn glass(bencher: Bencher<'_, '_>) {
    picture(bencher, GLASS);
}

#[divan::bench(sample_count = 10)]
fn textures(bencher: Bencher<'_, '_>) {
    picture(bencher, TEXTURES);
}

#[divan::bench(sample_count = 10)]
fn soft_shadows(bencher: Bencher<'_, '_>) {
    picture(bencher, SOFT_SHADOWS);
}

#[divan::bench(sample_count = 10)]
fn isosurfaces(bencher: Bencher<'_, '_>) {
    picture(bencher, ISOSURFACES);
}
