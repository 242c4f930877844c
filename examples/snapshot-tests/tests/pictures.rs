//! What the scenes look like. `README.md` tells how a change is looked at and accepted.

use rtscript::{
    NoHost, RenderOptions, render,
    testing::{Tolerance, assert_render_snapshot, glob_render_snapshots},
};
use snapshot_tests::bar_chart;

/// A scene made by the library: rendered by the assertion.
#[test]
fn a_chart_of_five_bars() {
    let scene = bar_chart(&[0.3, 0.9, 0.5, 0.7, 0.2]).unwrap();
    assert_render_snapshot!("five-bars", scene, description: "Five bars, the second the highest.");
}

/// A picture that is there already, and a tolerance: a little light more or less is no reason to fail, and neither is
/// the number that makes it.
#[test]
fn a_chart_of_one_bar() {
    let scene = bar_chart(&[0.5]).unwrap();
    let picture = render(&scene, &RenderOptions::default(), &NoHost)
        .unwrap()
        .value
        .image;
    let close = Tolerance {
        max_difference: 2,
        psnr: 45.0,
        scene_may_differ: true,
        ..Tolerance::ANY
    };
    assert_render_snapshot!("one-bar", (&scene, &picture), tolerance: close);
}

/// What must fail has its message on record.
#[test]
fn a_bar_without_height_is_refused() {
    let error = bar_chart(&[0.5, 0.0]).unwrap_err();
    assert_render_snapshot!("no-height", error);
}

/// Every script under `scenes`, its snapshot beside it.
#[test]
fn scripts() {
    glob_render_snapshots!("scenes/**/*.rhai");
}
