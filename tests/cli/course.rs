//! The course's scenes, rendered and converted.

use super::*;

const COURSE: &str =
    "# a ball\nsize 16 12\ncamera 0 0 5 0 0 0 0 1 0 45\npoint 0 0 5 1 1 1\ndiffuse 1 0 0\nsphere 0 0 0 1\n";

#[test]
fn a_course_scene_is_rendered_and_converted() {
    let folder = Folder::new();
    folder.write("ball.test", COURSE);
    let of_test = folder.ok(&["ball.test"]).stderr;
    let script = folder.ok(&["convert", "ball.test"]).stdout;
    folder.ok(&["convert", "ball.test", "-o", "ball.rhai"]);
    assert_eq!(fs::read(folder.path("ball.rhai")).unwrap(), script);
    let of_script = folder.ok(&["ball.rhai"]).stderr;
    let hash = |line: &str| line.split_whitespace().last().unwrap().to_owned();
    assert_eq!(hash(&of_test), hash(&of_script));
    assert_eq!(folder.files(), ["ball.png", "ball.rhai", "ball.test"]);
}

#[test]
fn flags_take_the_place_of_a_course_scenes_settings() {
    let folder = Folder::new();
    folder.write("ball.TEST", COURSE);
    folder.ok(&["ball.TEST", "--size", "9x7", "--samples", "2", "--seed", "3"]);
    assert_eq!(size_of(&folder.path("ball.png")), (9, 7));
    folder.fails(&["ball.TEST", "--samples", "1000000"], 5, &["'samples'"]);
}

#[test]
fn a_conversion_that_fails_writes_nothing() {
    let folder = Folder::new();
    folder.write("bad.test", "size 16 12\nspere 0 0 0 1\n");
    folder.write("ball.test", COURSE);
    folder.fails(
        &["convert", "bad.test", "-o", "bad.rhai"],
        3,
        &["bad.test:2", "spere"],
    );
    folder.fails(&["convert", "ball.test", "-o", "ball.test"], 4, &["made from"]);
    folder.fails(
        &["convert", "ball.test", "-o", "no/ball.rhai"],
        4,
        &["there is no folder"],
    );
    folder.fails(&["convert", "missing.test"], 3, &["no such file"]);
    assert_eq!(folder.files(), ["bad.test", "ball.test"]);
}
