//! Runs: pictures, warnings, prints, threads, and what the caller decides.

use std::sync::atomic::{AtomicUsize, Ordering};

use rtscript::{
    DVec3, Host, Image, Limits, RunOptions, Script, diag::ErrorKind, host::HostError, scene::Texture,
};

use crate::host::{Notes, printed, run, run_on, try_run};

/// Asks to stop after a while.
struct Impatient(AtomicUsize);

impl Host for Impatient {
    fn read(&self, _: &str, _: u64) -> Result<Vec<u8>, HostError> {
        Err(HostError::new(ErrorKind::Denied, "no files"))
    }

    fn should_stop(&self) -> bool {
        self.0.fetch_add(1, Ordering::Relaxed) > 3
    }
}

/// A host with a fault.
struct Broken;

impl Host for Broken {
    fn read(&self, _: &str, _: u64) -> Result<Vec<u8>, HostError> {
        panic!("the host's own fault");
    }

    fn write_image(&self, _: &str, _: &Image) -> Result<(), HostError> {
        Err(HostError::new(ErrorKind::Output, "the disk is full"))
    }
}

#[test]
fn a_script_without_render_is_left_to_its_caller() {
    let host = Notes::default();
    let run = run_on(&host, "sphere(0, 0, 0, 1);").unwrap().value;
    assert!(run.pictures.is_empty() && host.written().is_empty());
}

#[test]
fn render_hands_over_pictures_in_order() {
    let host = Notes::default();
    let source = "
        size(8, 6); background(0.25, 0.5, 1);
        let first = render();
        print(first);
        print([first.width, first.height]);
        print(first.pixel(7, 5));
        size(4, 4);
        render(\"second.png\");
        sphere(0, 0, 0, 1);
    ";
    let run = run_on(&host, source).unwrap().value;
    assert_eq!(host.printed(), ["image(8 x 6)", "[8, 6]", "[0.25, 0.5, 1.0]"]);
    assert_eq!(host.written(), ["second.png 4 x 4"]);
    let names: Vec<_> = run.pictures.iter().map(|p| p.name.as_deref()).collect();
    assert_eq!(names, [None, Some("second.png")]);
    assert_eq!(run.pictures[0].image.width(), 8);
    assert_eq!(run.pictures[1].stats.camera_rays, 16);
    assert_eq!(
        run.scene.root().objects.len(),
        1,
        "the scene goes on after render()"
    );
}

#[test]
fn a_picture_is_a_texture() {
    let source = "
        size(2, 2); background(0.25, 0.5, 1);
        let picture = render();
        diffuse(picture); emission(picture * 0.5); specular(vec3(1, 0, 0) * picture);
        sphere(0, 0, 0, 1);
    ";
    let scene = run(source).scene;
    let material = &scene.materials[0];
    assert_eq!(scene.textures.len(), 1, "one texture, used three times");
    assert_eq!(material.emission.color, DVec3::splat(0.5));
    assert_eq!(material.specular.color, DVec3::X);
    let Texture::Image(image) = &*scene.textures[0] else {
        panic!("an image");
    };
    assert_eq!((image.width, image.texel(1, 1)), (2, DVec3::new(0.25, 0.5, 1.0)));
}

#[test]
fn pushes_never_popped_are_warned_of() {
    let report = try_run("sphere(0, 0, 0, 1);\n  pushTransform();\ngroup { pushTransform(); }").unwrap();
    let texts: Vec<String> = report.warnings.iter().map(ToString::to_string).collect();
    assert_eq!(texts.len(), 2, "{texts:?}");
    assert!(
        texts[0].starts_with("scene.rhai:3:9: warning: pushTransform is never popped"),
        "{texts:?}"
    );
    assert!(
        texts[1].starts_with("scene.rhai:2:3: warning: pushTransform is never popped"),
        "{texts:?}"
    );
    assert_eq!(
        report.warnings[1].source_line.as_deref(),
        Some("  pushTransform();")
    );
}

#[test]
fn an_empty_script_is_an_empty_scene_with_a_warning() {
    for source in ["", "\n\n// nothing\n", "\u{feff}"] {
        let report = try_run(source).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!(report.value.scene.root().objects.len(), 0);
        assert!(
            report.warnings[0].message.starts_with("the scene is empty"),
            "{:?}",
            report.warnings
        );
    }
}

#[test]
fn warnings_come_with_errors_too() {
    let e = try_run("group { pushTransform(); } sphere(1);").unwrap_err();
    assert_eq!(e.warnings.len(), 1);
    assert_eq!(e.warnings[0].message, "pushTransform is never popped");
}

#[test]
fn printing_and_debugging() {
    let source = "print(1.0); print(\"a\\nb\"); print([1, \"x\", #{ a: 2.5 }]); print(());\n debug(\"x\"); print(|x| x); fn f() { } print(f);";
    assert_eq!(
        printed(source),
        [
            "1.0",
            "a\nb",
            "[1, \"x\", #{\"a\": 2.5}]",
            "",
            "scene.rhai:2:2: \"x\"",
            "Fn(closure)",
            "Fn(f)"
        ]
    );
}

#[test]
fn exit_ends_a_script() {
    let run = run("sphere(0, 0, 0, 1); fn f() { exit(); } group { f(); } sphere(0, 0, 0, 2);");
    assert_eq!(run.scene.root().objects.len(), 1);
}

#[test]
fn one_script_runs_on_many_threads_at_once() {
    let source = "size(16, 12); let n = 0; for i in 0..200 { sphere(random(-1, 1), random(-1, 1), 0, 0.1); } ambient(1, 1, 1); render();";
    let script = Script::compile("scene.rhai", source, &Limits::default()).unwrap();
    let hash = || {
        let report = script.run(&Notes::default(), &RunOptions::default()).unwrap();
        report.value.pictures[0].image.hash()
    };
    let wanted = hash();
    std::thread::scope(|scope| {
        let threads: Vec<_> = (0..4).map(|_| scope.spawn(hash)).collect();
        for thread in threads {
            assert_eq!(thread.join().unwrap(), wanted);
        }
    });
}

#[test]
fn the_host_can_stop_a_script() {
    for source in [
        "loop { }",
        "loop { try { loop { } } catch { } }",
        "fn f() { loop { } } f();",
    ] {
        let script = Script::compile("scene.rhai", source, &Limits::default()).unwrap();
        let e = script
            .run(&Impatient(AtomicUsize::new(0)), &RunOptions::default())
            .unwrap_err();
        assert_eq!(e.kind(), ErrorKind::Cancelled, "{e}");
    }
}

#[test]
fn a_host_that_panics_does_not_leave_the_script_running() {
    let script = Script::compile(
        "scene.rhai",
        "try { import \"a\" as a; } catch { } loop { }",
        &Limits::default(),
    );
    let script = script.unwrap();
    let run = std::panic::AssertUnwindSafe(|| script.run(&Broken, &RunOptions::default()));
    assert!(std::panic::catch_unwind(run).is_err());
}

#[test]
fn a_picture_that_cannot_be_kept_is_an_error() {
    let script = Script::compile(
        "scene.rhai",
        "size(2, 2);\nrender(\"a.png\");",
        &Limits::default(),
    )
    .unwrap();
    let e = script.run(&Broken, &RunOptions::default()).unwrap_err();
    assert_eq!(e.kind(), ErrorKind::Output);
    assert!(
        e.to_string()
            .starts_with("scene.rhai:2:1: error: the disk is full"),
        "{e}"
    );
}

#[test]
fn the_caller_decides_before_the_script() {
    let source = "size(64, 48); samples(4); seed(3); print(random()); size(100, 100);";
    let script = Script::compile("scene.rhai", source, &Limits::default()).unwrap();
    let host = Notes::default();
    let mut options = RunOptions::default();
    options.size = Some((10, 20));
    options.samples = Some(9);
    options.seed = Some(7);
    let s = script.run(&host, &options).unwrap().value.scene.settings;
    assert_eq!((s.width, s.height, s.samples, s.seed), (10, 20, 9, 7));
    assert_eq!(host.printed(), printed("seed(7); print(random());"));
    options.size = Some((0, 20));
    let e = script.run(&host, &options).unwrap_err();
    assert_eq!(
        e.diagnostic.message,
        "the picture's size must be at least 1 x 1, not 0 x 20"
    );
}
