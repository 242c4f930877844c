//! The viewer without its window.

use std::{
    fs,
    path::{Path, PathBuf},
    thread,
    time::{Duration, Instant},
};

use rtscript::{DirHost, Limits, RenderOptions, RunOptions, Script, render};
use viewer::viewer::{Event, Viewer};

/// A slow machine's patience.
const LONG: Duration = Duration::from_secs(120);

/// A folder of its own for a test, with files in it.
fn folder(name: &str, files: &[(&str, &str)]) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    folder
}

/// Lets the viewer go on until something is true of what it told so far.
fn until(viewer: &mut Viewer, is_true: impl Fn(&Viewer, &[Event]) -> bool) -> Vec<Event> {
    let (start, mut events) = (Instant::now(), Vec::new());
    while !is_true(viewer, &events) {
        assert!(start.elapsed() < LONG, "it does not come: {events:?}");
        events.extend(viewer.tick());
        thread::sleep(Duration::from_millis(5));
    }
    events
}

fn is_over(_: &Viewer, events: &[Event]) -> bool {
    events
        .iter()
        .any(|event| matches!(event, Event::Finished { .. } | Event::Failed(_)))
}

fn failure(events: &[Event]) -> Option<&str> {
    events.iter().find_map(|event| match event {
        Event::Failed(message) => Some(message.as_str()),
        _ => None,
    })
}

/// What the library gives without a viewer, each pixel as 0xRRGGBB.
fn expected(path: &Path) -> Vec<u32> {
    let name = path.file_name().unwrap().to_string_lossy();
    let host = DirHost::new(path.parent().unwrap());
    let script = Script::compile(&name, &fs::read_to_string(path).unwrap(), &Limits::default()).unwrap();
    let scene = script.run(&host, &RunOptions::default()).unwrap().value.scene;
    let image = render(&scene, &RenderOptions::default(), &host)
        .unwrap()
        .value
        .image;
    let pixels = image.rgb8();
    let pixels = pixels.as_chunks::<3>().0.iter();
    pixels
        .map(|&[r, g, b]| u32::from_be_bytes([0, r, g, b]))
        .collect()
}

const BALL: &str = "directional(0, 1, 1, 1, 1, 1); diffuse(1, 0.4, 0.2); sphere(0, 0, 0, 1);";

/// Takes minutes.
fn endless(size: &str) -> String {
    format!("size({size}); samples(60000); {BALL}")
}

#[test]
fn the_picture_is_the_librarys() {
    let folder = folder("picture", &[("a.rhai", &format!("size(70, 50); {BALL}"))]);
    let path = folder.join("a.rhai");
    let mut viewer = Viewer::open(&path).unwrap();
    let events = until(&mut viewer, is_over);
    assert_eq!(failure(&events), None);
    assert_eq!(viewer.canvas().size(), (70, 50));
    assert_eq!(viewer.canvas().pixels(), expected(&path));
    let saved = folder.join("a.png");
    viewer.save(&saved).unwrap();
    let image = rtscript::testing::load_picture(&saved).unwrap();
    assert_eq!((image.width(), image.height()), (70, 50));
    assert!(viewer.save(&folder.join("a.txt")).is_err());
}

#[test]
fn tiles_are_shown_as_they_finish_and_a_change_ends_the_render() {
    let folder = folder("cancel", &[("a.rhai", &endless("200, 150"))]);
    let path = folder.join("a.rhai");
    let mut viewer = Viewer::open(&path).unwrap();
    // The canvas has no picture yet, then one color, then something of the picture.
    let is_begun = |viewer: &Viewer, _: &[Event]| viewer.canvas().size() == (200, 150);
    until(&mut viewer, is_begun);
    until(&mut viewer, |viewer, _| {
        let canvas = viewer.canvas();
        canvas.pixels().iter().any(|pixel| *pixel != canvas.pixels()[0])
    });
    let refused = viewer.save(&folder.join("a.png")).unwrap_err();
    assert!(refused.contains("not complete"), "{refused}");
    fs::write(&path, format!("size(40, 30); {BALL}")).unwrap();
    let events = until(&mut viewer, is_over);
    // The render that was ended tells nothing, not even that it was.
    assert!(matches!(&events[..], [Event::Finished { .. }]), "{events:?}");
    assert_eq!(viewer.canvas().pixels(), expected(&path));
}

#[test]
fn a_file_that_the_script_uses_is_watched_too() {
    let card = "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\n";
    let text = r#"size(40, 30); ambient(1, 1, 1); mesh("card.obj");"#;
    let folder = folder("used", &[("a.rhai", text)]);
    let path = folder.join("a.rhai");
    let mut viewer = Viewer::open(&path).unwrap();
    // It is not there; then it comes; then it is another.
    let events = until(&mut viewer, is_over);
    let message = failure(&events).expect("no card, no picture");
    assert!(
        message.contains("a.rhai:1:") && message.contains("card.obj"),
        "{message}"
    );
    fs::write(folder.join("card.obj"), card).unwrap();
    assert_eq!(failure(&until(&mut viewer, is_over)), None);
    let first = viewer.canvas().clone();
    assert_eq!(first.pixels(), expected(&path));
    fs::write(folder.join("card.obj"), card.replace("v 0 1 0", "v 0 0.25 0")).unwrap();
    assert_eq!(failure(&until(&mut viewer, is_over)), None);
    assert_eq!(viewer.canvas().pixels(), expected(&path));
    assert_ne!(*viewer.canvas(), first);
}

#[test]
fn what_is_wrong_is_told_and_the_last_picture_stays() {
    let folder = folder(
        "wrong",
        &[("a.rhai", &format!("print(\"hello\"); size(40, 30); {BALL}"))],
    );
    let path = folder.join("a.rhai");
    let mut viewer = Viewer::open(&path).unwrap();
    let events = until(&mut viewer, is_over);
    assert!(
        matches!(&events[0], Event::Printed(text) if text == "hello"),
        "{events:?}"
    );
    let good = viewer.canvas().clone();
    fs::write(&path, "size(40, 30);\nsphera(0, 0, 0, 1);").unwrap();
    let events = until(&mut viewer, is_over);
    let message = failure(&events).expect("there is no sphera");
    assert!(
        message.starts_with("a.rhai:2:1: error:") && message.contains("sphere"),
        "{message}"
    );
    assert_eq!(*viewer.canvas(), good);
    assert!(viewer.save(&folder.join("a.png")).is_err());
}

#[test]
fn a_script_that_renders_by_itself_shows_its_last_picture() {
    let text = format!("size(20, 10); {BALL} render(); size(30, 20); render(\"b.png\");");
    let folder = folder("itself", &[("a.rhai", &text)]);
    let mut viewer = Viewer::open(&folder.join("a.rhai")).unwrap();
    let events = until(&mut viewer, is_over);
    assert_eq!(failure(&events), None);
    assert_eq!(viewer.canvas().size(), (30, 20));
    assert!(!folder.join("b.png").exists());
}

#[test]
fn part_of_a_picture_fills_the_canvas() {
    let text = format!("size(200, 100); {BALL} crop(40, 20, 100, 60);");
    let folder = folder("part", &[("a.rhai", &text)]);
    let path = folder.join("a.rhai");
    let mut viewer = Viewer::open(&path).unwrap();
    assert_eq!(failure(&until(&mut viewer, is_over)), None);
    assert_eq!(viewer.canvas().size(), (100, 60));
    assert_eq!(viewer.canvas().pixels(), expected(&path));
}

#[test]
fn closing_ends_the_render() {
    let folder = folder("closed", &[("a.rhai", &endless("400, 300"))]);
    let mut viewer = Viewer::open(&folder.join("a.rhai")).unwrap();
    until(&mut viewer, |viewer, _| viewer.canvas().size() != (0, 0));
    let start = Instant::now();
    drop(viewer);
    assert!(start.elapsed() < Duration::from_secs(30), "{:?}", start.elapsed());
}

#[test]
fn what_is_not_there_is_not_opened() {
    let folder = folder("nothing", &[]);
    assert!(Viewer::open(&folder.join("a.rhai")).is_err());
    assert!(Viewer::open(&folder).is_err());
}
