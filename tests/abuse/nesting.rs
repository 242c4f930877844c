//! The deepest nesting that is rendered fits on threads of 2 MiB, which is what rayon gives a pool that nothing was said of
//! and what Rust gives a thread. Without optimisation frames are largest, so it counts where `opt-level` is 0.
//!
//! A stack that overflows ends the process, so what might runs in processes of its own; the instructions are chosen once in
//! a process too.

use std::process::Command;

use rtscript::{
    Builder, DVec3, Limits, NoHost, RenderOptions,
    diag::ErrorKind,
    math::Ray,
    render,
    render::{
        LayerKind, World,
        show::{Show, show},
    },
    scene::{CsgOp, ROOT_GROUP, compare::compare},
};

use crate::{Quiet, first_line, run};

/// Levels inside levels that are rendered.
const DEEPEST: usize = 32;
/// What a thread has without being asked for more, less an eighth of it for the frames of whoever calls.
const STACK: usize = (2 << 20) / 8 * 7;
/// The instructions of a child process, by which it knows that it is one.
const CHOICE: &str = "RTSCRIPT_SIMD";

/// How a level is placed in the next; with how many levels that makes.
const WAYS: [(&str, usize); 4] = [
    ("instance(inner);", 1),
    ("rotate(0, 1, 0, 1); instance(inner);", 1),
    (
        "union { instance(inner); translate(0, 0.2, 0); sphere(0, 0, 0, 0.1); }",
        2,
    ),
    ("moving #{ translate: [0.01, 0, 0] } { instance(inner); }", 2),
];

/// Every look at a scene that goes through its levels in a way of its own: nearest hits, shadows that end at the first
/// thing in the way and shadows that count what they go through, soft ones too, and all crossings with solids.
fn script(way: &str, levels: usize, look: &str) -> String {
    format!(
        r##"size(6, 4); camera([0, 0.5, 5], [0, 0, 0], [0, 1, 0], 40); background("#cfe3f5"); maxDepth(2);
areaLight([-1, 4, 2], [1, 0, 0], [0, 0, 1], [0.5, 0.5, 0.5], 2); point([3, 3, 3], [0.4, 0.4, 0.4]);
environment([0.2, 0.2, 0.3]);
{look}
fn place(inner) {{ group {{ {way} }} }}
define "d0" {{ superellipsoid(0.7, 0.6); isosurface(sdfSphere(0.6).moved(0.3, 0.3, 0)); }}
for i in 1..={levels} {{ define `d${{i}}` {{ place(`d${{i - 1}}`); sphere(1, 0, 0, 0.2); }} }}
place("d{levels}");
group {{ translate(0, -1.2, 0); plane(); }}
"##
    )
}

const LOOKS: [&str; 3] = [
    "diffuse(0.7, 0.5, 0.3);",
    "diffuse(0.1, 0.1, 0.1); transmission(0.8, 0.9, 0.9); reflection(0.2, 0.2, 0.2); ior(1.1);",
    "diffuse(0.3, 0.3, 0.3); specular(0.4, 0.4, 0.4); roughness(0.3); reflection(0.5, 0.5, 0.5);",
];

/// Renders it and asks it everything that a program may.
fn look_at_all(script: &str) {
    let scene = run(script, &Limits::default(), &Quiet).unwrap().value.scene;
    for single_rays in [false, true] {
        let mut options = RenderOptions::default();
        options.single_rays = single_rays;
        options.coarse = true;
        options.layers = LayerKind::NAMES.map(|(_, kind)| kind).to_vec();
        render(&scene, &options, &NoHost).unwrap();
    }
    for what in [Show::Normal, Show::Object, Show::Cost] {
        show(&scene, what, &RenderOptions::default(), &NoHost).unwrap();
    }
    rtscript::render::inspect(&scene, &NoHost).unwrap();
    let world = World::compile(&scene).unwrap();
    world.explain(3, 2, &NoHost).unwrap();
    let rays = [0.0, 0.1, 0.2].map(|y| Ray::new(DVec3::new(0.0, y, 5.0), DVec3::NEG_Z));
    assert!(
        world
            .nearest_t_many(&rays, f64::INFINITY)
            .iter()
            .all(Option::is_some)
    );
    assert_eq!(world.are_occluded(&rays, &[f64::INFINITY; 3]), [true; 3]);
    assert!(world.raycast(&rays[0], f64::INFINITY).is_some());
    assert!(world.is_inside(DVec3::new(0.1, 0.2, 0.1)));
}

#[test]
fn the_deepest_nesting_fits_on_threads_of_two_mebibytes() {
    if std::env::var_os(CHOICE).is_some() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .stack_size(STACK)
            .build();
        let pool = pool.unwrap();
        for (way, levels) in WAYS {
            for look in LOOKS {
                pool.install(|| look_at_all(&script(way, (DEEPEST - 1) / levels, look)));
            }
        }
        return;
    }
    for choice in ["portable", "sse2", "avx2", "avx512"] {
        let child = Command::new(std::env::current_exe().unwrap())
            .env(CHOICE, choice)
            .args([
                "--exact",
                "nesting::the_deepest_nesting_fits_on_threads_of_two_mebibytes",
            ])
            .output()
            .unwrap();
        let said = String::from_utf8_lossy(&child.stdout) + String::from_utf8_lossy(&child.stderr);
        assert!(
            child.status.success() && said.contains("1 passed"),
            "{choice}: {said}"
        );
    }
}

#[test]
fn what_is_nested_deeper_is_refused_with_its_place() {
    let expected = "scene.rhai:5:27: error: instances and solids are nested more than 32 levels deep: the instance of line 5 \
                    is one level too many";
    let script = script(WAYS[0].0, DEEPEST, LOOKS[0]);
    let scene = run(&script, &Limits::untrusted(), &Quiet).unwrap().value.scene;
    let error = render(&scene, &RenderOptions::default(), &NoHost).unwrap_err();
    assert_eq!(
        (first_line(&error).as_str(), error.kind()),
        (expected, ErrorKind::Limit)
    );
}

/// What does not trace rays takes any nesting that can be made.
#[test]
fn scenes_nested_too_deep_to_render_are_described_all_the_same() {
    let mut b = Builder::new();
    let marks: Vec<_> = (0..Limits::default().transform_depth)
        .map(|_| b.begin_csg(CsgOp::Union).unwrap())
        .collect();
    b.sphere(DVec3::ZERO, 1.0).unwrap();
    for mark in marks.into_iter().rev() {
        b.end_csg(mark, true).unwrap();
    }
    let scene = b.finish().value;
    let describe = move || {
        let around = scene.bounds(ROOT_GROUP).unwrap();
        assert_eq!(around.size(), DVec3::splat(2.0));
        assert!(scene.hash() != Builder::new().finish().value.hash() && !scene.dump().is_empty());
        compare(&scene, &scene, &|_, loc| (0, loc.line), &mut |change| {
            panic!("{}", change.name)
        });
    };
    let thread = std::thread::Builder::new().stack_size(STACK).spawn(describe);
    thread.unwrap().join().unwrap();
}
