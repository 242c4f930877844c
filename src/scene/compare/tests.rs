use super::*;
use crate::scene::{AnimatedTransform, Builder, Term};

/// A scene whose calls stand in the lines that the closure sets.
fn scene(build: impl Fn(&mut Builder)) -> Scene {
    let mut b = Builder::new();
    b.file("a.rhai");
    build(&mut b);
    b.finish().value
}

fn line(b: &mut Builder, line: u32) {
    b.set_loc(SourceLoc {
        line,
        column: 1,
        file: 0,
    });
}

fn row(b: &mut Builder, xs: impl Iterator<Item = u32>, y: f64, radius: f64) {
    for x in xs {
        b.sphere(DVec3::new(f64::from(x), y, 0.0), radius).unwrap();
    }
}

/// `+ name`, `- name` or the ways of each change.
fn changes(before: &Scene, after: &Scene) -> Vec<String> {
    let mut all = Vec::new();
    let place = |_: bool, loc: SourceLoc| (u32::from(loc.file), loc.line);
    compare(before, after, &place, &mut |change| {
        all.push(match (change.before, change.after) {
            (Some(_), Some(_)) => format!("{} {:?}", change.name, change.ways),
            (Some(_), None) => format!("- {} {}", change.name, change.at),
            (None, _) => format!("+ {} {}", change.name, change.at),
        });
    });
    all
}

#[test]
fn order_and_lines_do_not_count() {
    let a = scene(|b| {
        line(b, 1);
        row(b, 0..3, 0.0, 0.5);
        b.point(DVec3::ONE, DVec3::ONE).unwrap();
        b.directional(DVec3::ONE, DVec3::ONE).unwrap();
    });
    let b = scene(|b| {
        line(b, 9);
        b.directional(DVec3::ONE, DVec3::ONE).unwrap();
        b.point(DVec3::ONE, DVec3::ONE).unwrap();
        row(b, (0..3).rev(), 0.0, 0.5);
    });
    assert_ne!(a.hash(), b.hash());
    assert_eq!(changes(&a, &b), Vec::<String>::new());
}

#[test]
fn what_is_one_more_is_the_one_that_is_added() {
    let a = scene(|b| {
        line(b, 1);
        row(b, 0..5, 0.0, 0.5);
    });
    let b = scene(|b| {
        line(b, 1);
        row(b, 0..6, 0.0, 0.5);
    });
    assert_eq!(changes(&a, &b), ["+ sphere [5, 0, 0]"]);
    assert_eq!(changes(&b, &a), ["- sphere [5, 0, 0]"]);
    let moved = scene(|b| {
        line(b, 1);
        row(b, 0..6, 0.25, 0.5);
    });
    let found = changes(&a, &moved);
    assert_eq!(found.len(), 6);
    assert_eq!(found[0], "+ sphere [5, 0.25, 0]");
    assert!(
        found[1..]
            .iter()
            .all(|c| c == "sphere [Moved(DVec3(0.0, 0.25, 0.0))]")
    );
}

#[test]
fn a_line_is_followed_before_another_is_looked_at() {
    let build = |x: f64, far: f64| {
        scene(|b| {
            line(b, 1);
            b.sphere(DVec3::X * x, 1.0).unwrap();
            line(b, 2);
            b.sphere(DVec3::X * far, 1.0).unwrap();
        })
    };
    // What line 2 makes is now where what line 1 makes was, and nearly so the other way round.
    let found = changes(&build(0.0, 5.0), &build(4.0, 0.5));
    assert_eq!(
        found,
        [
            "sphere [Moved(DVec3(4.0, 0.0, 0.0))]",
            "sphere [Moved(DVec3(-4.5, 0.0, 0.0))]"
        ]
    );
}

#[test]
fn things_of_different_kinds_are_never_one() {
    let a = scene(|b| {
        line(b, 1);
        b.sphere(DVec3::ZERO, 1.0).unwrap();
        b.point(DVec3::ONE, DVec3::ONE).unwrap();
    });
    let b = scene(|b| {
        line(b, 1);
        b.triangle([DVec3::ZERO, DVec3::X, DVec3::Y], None).unwrap();
        b.directional(DVec3::Y, DVec3::ONE).unwrap();
    });
    assert_eq!(
        changes(&a, &b),
        [
            "- sphere [0, 0, 0]",
            "+ tri [0, 0, 0]",
            "- light [1, 1, 1]",
            "+ directional [0, 1, 0]"
        ]
    );
}

#[test]
fn groups_are_compared_by_name_and_bring_their_lights_once() {
    let build = |radius: f64, color: f64| {
        scene(|b| {
            line(b, 1);
            let mark = b.begin_define("lamp").unwrap();
            b.sphere(DVec3::ZERO, radius).unwrap();
            b.point(DVec3::ZERO, DVec3::splat(color)).unwrap();
            b.end_define(mark, true);
            b.instance("lamp").unwrap();
            b.instance("lamp").unwrap();
        })
    };
    let found = changes(&build(1.0, 1.0), &build(2.0, 0.5));
    assert_eq!(found.len(), 2, "{found:?}");
    assert!(found[0].contains("radius") && found[1].contains("color"));
}

#[test]
fn a_move_and_a_look_are_told_together() {
    let build = |x: f64, red: f64| {
        scene(|b| {
            line(b, 3);
            b.material_mut().diffuse = Term::color(DVec3::new(red, 0.0, 0.0));
            b.triangle(
                [DVec3::X * x, DVec3::X * x + DVec3::Y, DVec3::X * x + DVec3::Z],
                None,
            )
            .unwrap();
        })
    };
    assert_eq!(
        changes(&build(0.1, 1.0), &build(0.3, 0.5)),
        [
            "tri [Moved(DVec3(0.19999999999999998, 0.0, 0.0)), Value { what: \"diffuse\", from: \"[1, 0, 0]\", to: \"[0.5, 0, 0]\" }]"
        ]
    );
}

#[test]
fn a_hundred_thousand_things_are_matched_soon() {
    let build = |y: f64| {
        scene(|b| {
            line(b, 1);
            row(b, 0..100_000, y, 0.5);
        })
    };
    let found = changes(&build(0.0), &build(1.0));
    assert_eq!(found.len(), 100_000);
    assert!(found.iter().all(|c| c == "sphere [Moved(DVec3(0.0, 1.0, 0.0))]"));
}

#[test]
fn another_motion_is_told_of_what_moves() {
    let moving = |way: f64, radius: f64| {
        scene(|b| {
            line(b, 1);
            let translate = DVec3::X * way;
            let motion = AnimatedTransform {
                translate,
                ..AnimatedTransform::default()
            };
            let mark = b.begin_moving(motion).unwrap();
            b.sphere(DVec3::ZERO, radius).unwrap();
            b.end_moving(mark, true).unwrap();
        })
    };
    let a = moving(1.0, 0.5);
    assert_eq!(changes(&a, &moving(1.0, 0.5)), Vec::<String>::new());
    let [faster] = <[String; 1]>::try_from(changes(&a, &moving(2.0, 0.5))).unwrap();
    assert!(
        faster.starts_with("moving") && faster.contains("translate: [2, 0, 0]"),
        "{faster}"
    );
    let [larger] = <[String; 1]>::try_from(changes(&a, &moving(1.0, 0.7))).unwrap();
    assert!(
        larger.starts_with("sphere") && larger.contains("radius"),
        "{larger}"
    );
    assert_ne!(a.hash(), moving(2.0, 0.5).hash());
}
