use super::*;
use crate::{
    Builder, NoHost, Term,
    math::DVec3,
    render::{RenderOptions, render},
    scene::{Attenuation, Camera, CsgOp, Links, Spot},
    shape::{Cuboid, Shape},
};

/// A scene whose calls stand in lines 1, 2, ... of `a.rhai`: the camera at `[0, 0, 5]` looks at the origin, a light is
/// behind it, everything is gray.
fn scene(calls: &[&dyn Fn(&mut Builder)]) -> Scene {
    let mut b = Builder::new();
    let file = b.file("a.rhai");
    b.size(64, 48).unwrap();
    b.material_mut().ambient = Term::color(DVec3::ZERO);
    b.material_mut().diffuse = Term::color(DVec3::splat(0.5));
    for (call, line) in calls.iter().zip(1..) {
        b.set_loc(SourceLoc {
            line,
            column: 1,
            file,
        });
        call(&mut b);
    }
    b.finish().value
}

fn light(x: f64, y: f64, z: f64) -> impl Fn(&mut Builder) {
    move |b| b.point(DVec3::new(x, y, z), DVec3::ONE).unwrap()
}

fn sphere(x: f64, y: f64, z: f64, radius: f64) -> impl Fn(&mut Builder) {
    move |b| b.sphere(DVec3::new(x, y, z), radius).unwrap()
}

/// The warnings of a close look and those of a render: codes, lines and messages.
fn told(calls: &[&dyn Fn(&mut Builder)]) -> [Vec<(Code, u32, String)>; 2] {
    let scene = scene(calls);
    let short = |warnings: Vec<Diagnostic>| {
        let all = warnings.into_iter();
        all.map(|d| (d.code, d.line, format!("{} | {}", d.message, d.notes.join(" | "))))
            .collect::<Vec<_>>()
    };
    let rendered = render(&scene, &RenderOptions::default(), &NoHost).unwrap();
    [short(inspect(&scene, &NoHost).unwrap()), short(rendered.warnings)]
}

fn only(warnings: &[(Code, u32, String)], code: Code, line: u32, words: &str) {
    let [(found, at, message)] = warnings else {
        panic!("{warnings:?}");
    };
    assert_eq!((*found, *at), (code, line), "{message}");
    assert!(message.contains(words), "{message}");
}

#[test]
fn a_sound_scene_gives_no_warning() {
    let [look, render] = told(&[
        &light(0.0, 3.0, 5.0),
        &sphere(0.0, 0.0, 0.0, 1.0),
        &sphere(1.5, 0.0, 0.0, 0.3),
    ]);
    assert!(look.is_empty() && render.is_empty(), "{look:?} {render:?}");
}

#[test]
fn what_is_out_of_view_is_told_with_its_side() {
    for (x, y, z, side) in [
        (0.0, 0.0, 9.0, "behind the camera"),
        (-9.0, 0.0, 0.0, "to the left"),
        (9.0, 0.0, 0.0, "to the right"),
        (0.0, -9.0, 0.0, "below"),
        (0.0, 9.0, 0.0, "above"),
    ] {
        let [look, render] = told(&[&light(0.0, 3.0, 5.0), &sphere(x, y, z, 1.0)]);
        only(&render, Code::OutOfView, 0, side);
        assert_eq!(look[0], render[0]);
    }
}

#[test]
fn a_picture_of_the_background_is_told_where_boxes_leave_it_open() {
    // Both corners of the view are free, so the box around both is not.
    let [_, render] = told(&[
        &light(0.0, 3.0, 5.0),
        &sphere(-9.0, 0.0, 0.0, 1.0),
        &sphere(9.0, 0.0, 0.0, 1.0),
    ]);
    only(&render, Code::OutOfView, 0, "no ray of the camera meets anything");
}

#[test]
fn cameras_and_lights_inside_of_solids_are_told() {
    let ball = sphere(0.0, 0.0, 5.5, 1.0);
    let [_, render] = told(&[&light(0.0, 9.0, 5.0), &ball]);
    only(
        &render,
        Code::CameraInside,
        2,
        "the camera is inside the sphere of line 2",
    );
    // A room has its light inside.
    let [_, render] = told(&[&light(0.0, 0.3, 5.5), &ball]);
    assert!(render.is_empty(), "{render:?}");
    let [_, render] = told(&[
        &sphere(0.0, 0.0, 0.0, 1.0),
        &sphere(0.0, 3.0, 3.0, 0.5),
        &light(0.0, 3.0, 3.2),
    ]);
    only(
        &render,
        Code::LightInside,
        3,
        "the light is inside the sphere of line 2",
    );
    let glass = |b: &mut Builder| b.material_mut().transmission = Term::color(DVec3::ONE);
    let [_, render] = told(&[
        &sphere(0.0, 0.0, 0.0, 1.0),
        &glass,
        &sphere(0.0, 3.0, 3.0, 0.5),
        &light(0.0, 3.0, 3.2),
    ]);
    assert!(render.is_empty(), "{render:?}");
}

#[test]
fn the_reason_of_darkness_is_told() {
    let floor = |b: &mut Builder| b.sphere(DVec3::ZERO, 1.5).unwrap();
    let [look, render] = told(&[&light(0.0, 0.0, -9.0), &floor]);
    only(&render, Code::Unlit, 0, "turned away from the light");
    only(&look, Code::Unlit, 0, "turned away from the light");
    let wall = |b: &mut Builder| {
        b.translate(DVec3::new(0.0, 0.0, 7.0)).unwrap();
        b.shape(Shape::Cuboid(Cuboid::new(DVec3::new(50.0, 50.0, 0.5)).unwrap()))
            .unwrap();
    };
    let [_, render] = told(&[&light(0.0, 0.0, 9.0), &floor, &wall]);
    only(
        &render,
        Code::Unlit,
        3,
        "the box of line 3 stands between the light",
    );
    let faint = |b: &mut Builder| b.point(DVec3::new(0.0, 0.0, 5.0), DVec3::splat(1e-6)).unwrap();
    let [_, render] = told(&[&faint, &floor]);
    only(
        &render,
        Code::Unlit,
        0,
        "too weak; the brightest pixel has a value of 5.0e-7",
    );
    let aside = |b: &mut Builder| {
        let (from, to) = (DVec3::new(0.0, 0.0, 5.0), DVec3::new(4.0, 0.0, 5.0));
        let spot = Spot::new(from, to, (30.0, 5.0), 0.0, Attenuation::default()).unwrap();
        b.spot(spot, DVec3::ONE).unwrap();
    };
    let [look, render] = told(&[&aside, &floor]);
    only(&render, Code::Unlit, 0, "lies outside of the cone of the light");
    only(&look, Code::Unlit, 0, "lies outside of the cone of the light");
    let elsewhere = |b: &mut Builder| {
        let mark = b.begin_define("other").unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.end_define(mark, true);
        let other = b.group_called("other").unwrap();
        b.light_linking(Links::new(Some(vec![other]), Vec::new()).unwrap())
            .unwrap();
    };
    let [_, render] = told(&[&elsewhere, &light(0.0, 0.0, 5.0), &floor]);
    only(&render, Code::Unlit, 0, "does not reach the groups");
    let black = |b: &mut Builder| b.material_mut().diffuse = Term::color(DVec3::ZERO);
    let [_, render] = told(&[&light(0.0, 0.0, 5.0), &black, &floor]);
    only(&render, Code::Unlit, 0, "answer no light");
}

#[test]
fn faces_in_one_plane_are_told_where_they_look_different() {
    let cuboid = |x: f64, color: f64| {
        move |b: &mut Builder| {
            b.material_mut().diffuse = Term::color(DVec3::splat(color));
            b.translate(DVec3::new(x, 0.0, 0.0)).unwrap();
            b.shape(Shape::Cuboid(Cuboid::new(DVec3::ONE).unwrap())).unwrap();
        }
    };
    let [look, render] = told(&[&light(0.0, 3.0, 5.0), &cuboid(0.0, 0.5), &cuboid(0.3, 0.9)]);
    only(
        &look,
        Code::CoincidentFaces,
        3,
        "the very place of a face of the box of line 2",
    );
    assert!(render.is_empty(), "{render:?}");
    let [look, _] = told(&[&light(0.0, 3.0, 5.0), &cuboid(0.0, 0.5), &cuboid(0.3, 0.5)]);
    assert!(look.is_empty(), "{look:?}");
}

#[test]
fn shapes_that_no_ray_meets_are_told_with_the_reason() {
    let ball = sphere(0.0, 0.0, 0.0, 1.0);
    let lamp = light(0.0, 3.0, 5.0);
    let [look, render] = told(&[&lamp, &ball, &sphere(0.0, 0.0, 9.0, 1.0)]);
    only(&look, Code::UnseenShape, 3, "it lies behind the camera");
    assert!(render.is_empty(), "{render:?}");
    let [look, _] = told(&[&lamp, &ball, &sphere(0.0, 0.0, -2.0, 0.5)]);
    only(&look, Code::UnseenShape, 3, "the sphere of line 2 hides it");
    let [look, _] = told(&[&lamp, &ball, &sphere(1.5, 0.0, 0.0, 0.004)]);
    assert!(look.is_empty(), "a small thing has rays of its own: {look:?}");
    let unplaced = |b: &mut Builder| {
        let mark = b.begin_define("car").unwrap();
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.end_define(mark, true);
    };
    let [look, _] = told(&[&lamp, &ball, &unplaced]);
    only(&look, Code::UnseenShape, 3, "no instance(...) places the group");
    let mirror = |b: &mut Builder| b.material_mut().reflection = Some(Term::color(DVec3::ONE));
    let [look, _] = told(&[&lamp, &mirror, &ball, &sphere(0.0, 0.0, 9.0, 3.0)]);
    assert!(
        look.is_empty(),
        "a mirror shows what is behind the camera: {look:?}"
    );
}

#[test]
fn the_host_hears_of_it_before_the_render() {
    use std::sync::Mutex;
    #[derive(Default)]
    struct Ears(Mutex<Vec<Code>>);
    impl Host for Ears {
        fn read(&self, _: &str, _: u64) -> Result<Vec<u8>, crate::host::HostError> {
            unreachable!()
        }
        fn warn(&self, warning: &Diagnostic) {
            self.0.lock().unwrap().push(warning.code);
        }
        fn progress(&self, _: &crate::render::Progress) {
            assert_eq!(*self.0.lock().unwrap(), [Code::OutOfView]);
        }
    }
    let ears = Ears::default();
    let scene = scene(&[&light(0.0, 3.0, 5.0), &sphere(0.0, 0.0, 9.0, 1.0)]);
    render(&scene, &RenderOptions::default(), &ears).unwrap();
    assert_eq!(*ears.0.lock().unwrap(), [Code::OutOfView]);
}

#[test]
fn a_camera_only_needs_to_miss_one_side() {
    let mut s = scene(&[&light(0.0, 3.0, 5.0), &sphere(0.0, 0.0, 0.0, 1.0)]);
    s.camera = Camera::new(
        DVec3::new(0.0, 0.0, 5.0),
        DVec3::new(0.0, 0.0, 9.0),
        DVec3::Y,
        45.0,
    )
    .unwrap();
    let warnings = inspect(&s, &NoHost).unwrap();
    assert_eq!(
        warnings[0].hints,
        ["look at its middle: camera([0, 0, 5], [0, 0, 0], [0, 1, 0], 45)"]
    );
}

#[test]
fn who_stands_inside_of_what_is_put_together_is_told() {
    let put = |op: CsgOp, z: f64, radius: f64| {
        move |b: &mut Builder| {
            let mark = b.begin_csg(op).unwrap();
            sphere(0.0, 0.0, 5.0, 3.0)(b);
            sphere(0.0, 0.0, z, radius)(b);
            b.end_csg(mark, true).unwrap();
        }
    };
    let codes = |y, op, z, radius| {
        let [look, _] = told(&[&light(0.0, y, 5.0), &put(op, z, radius)]);
        let inside = [Code::CameraInside, Code::LightInside];
        let told = look.into_iter().filter(|(code, ..)| inside.contains(code));
        told.map(|(_, _, message)| message).collect::<Vec<_>>()
    };
    // A second ball that the camera is beside or in, and whose surface is or is not that of the whole.
    let beside = codes(9.0, CsgOp::Difference, 0.0, 3.5);
    assert!(
        beside
            .iter()
            .any(|m| m.contains("inside the difference of line 2")),
        "{beside:?}"
    );
    let hollow = codes(1.0, CsgOp::Difference, 5.0, 2.5);
    assert!(hollow.is_empty(), "{hollow:?}");
    let both = codes(9.0, CsgOp::Union, 4.0, 2.5);
    assert!(
        both.iter().any(|m| m.contains("inside the union of line 2")),
        "{both:?}"
    );
}
