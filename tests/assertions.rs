//! What the assertions of `rtscript::testing::assert` do for a crate that uses them: what fails, what is written and
//! when a picture becomes the reference.
//!
//! What insta does depends on the environment of its process, so each step runs `step` below in a process of its own.

#![allow(clippy::unwrap_used, clippy::expect_used)]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use rtscript::{
    Builder, DVec3, Report, Scene, Term,
    testing::{
        Tolerance,
        assert::{SnapshotOptions, insta, snapshot_site},
        assert_render_snapshot, load_picture,
    },
};

/// A ball of some brightness and size, in a picture of 32 x 24.
fn ball(brightness: f64, radius: f64) -> Report<Scene> {
    let mut b = Builder::new();
    b.size(32, 24).unwrap();
    b.directional(DVec3::ONE, DVec3::ONE).unwrap();
    b.material_mut().diffuse = Term::color(DVec3::splat(brightness));
    b.sphere(DVec3::ZERO, radius).unwrap();
    b.finish()
}

/// One run of a user's test. `STEP` says which.
#[test]
#[ignore = "run by the other tests, in a process of its own"]
fn step() {
    let folder = PathBuf::from(env::var("STEP_FOLDER").unwrap());
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path(&folder);
    let _guard = settings.bind_to_scope();
    match env::var("STEP").unwrap().as_str() {
        "dark" => assert_render_snapshot!("ball", ball(0.5, 1.0), description: "A dark ball."),
        "bright" => assert_render_snapshot!("ball", ball(0.501, 1.0)),
        "bright, near" => assert_render_snapshot!("ball", ball(0.501, 1.0), tolerance: near(false)),
        "bright, near, any scene" => {
            assert_render_snapshot!("ball", ball(0.501, 1.0), tolerance: near(true));
        }
        "large, near, any scene" => {
            assert_render_snapshot!("ball", ball(0.5, 1.2), tolerance: near(true));
        }
        "same picture" => {
            let mut scene = ball(0.5, 1.0).value;
            scene.files.push("another name".to_owned());
            assert_render_snapshot!("ball", scene);
        }
        pattern => {
            let mut site = snapshot_site!();
            site.manifest_folder = folder.to_str().unwrap().to_owned().leak();
            if let Err(message) = site.check_glob(pattern, &SnapshotOptions::default()) {
                panic!("{message}");
            }
        }
    }
}

fn near(scene_may_differ: bool) -> Tolerance {
    Tolerance {
        max_difference: 1,
        scene_may_differ,
        ..Tolerance::ANY
    }
}

/// A folder of its own for a test, and what is in it.
struct Project(PathBuf);

impl Project {
    fn new(test: &str) -> Self {
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR"))
            .join("assertions")
            .join(test);
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn snapshot(&self) -> PathBuf {
        self.path("assertions__ball.snap")
    }

    fn pending(&self) -> PathBuf {
        self.path("assertions__ball.snap.new")
    }

    fn picture(&self) -> PathBuf {
        self.path("assertions__ball.png")
    }

    /// Runs a step under a setting of `INSTA_UPDATE`: what it printed, as an error where it failed.
    fn run(&self, step: &str, update: &str) -> Result<String, String> {
        self.run_with(step, update, &[])
    }

    fn run_with(&self, step: &str, update: &str, more: &[(&str, &str)]) -> Result<String, String> {
        let output = Command::new(env::current_exe().unwrap())
            .args(["--exact", "step", "--ignored", "--nocapture"])
            .env("STEP", step)
            .env("STEP_FOLDER", &self.0)
            .env("INSTA_UPDATE", update)
            .env("RUST_BACKTRACE", "0")
            .env_remove("CI")
            .envs(more.iter().copied())
            .output()
            .unwrap();
        let text = [output.stdout, output.stderr].concat();
        let text = String::from_utf8_lossy(&text).into_owned();
        if output.status.success() {
            Ok(text)
        } else {
            Err(text)
        }
    }

    fn hash_on_record(&self) -> String {
        let text = fs::read_to_string(self.snapshot()).unwrap();
        let hash = text.lines().find_map(|line| line.strip_prefix("hash "));
        hash.unwrap().to_owned()
    }

    fn hash_of_picture(&self) -> String {
        load_picture(&self.picture()).unwrap().hash()
    }
}

/// The file whose address stands in `text`.
fn shown(text: &str) -> PathBuf {
    let start = text.find("file://").expect(text);
    let address = text[start + 7..].split(['"', '\n']).next();
    PathBuf::from(address.unwrap().replace("%20", " "))
}

#[test]
fn nothing_is_on_record_until_it_is_accepted() {
    let project = Project::new("first");
    let failed = project.run("dark", "new").unwrap_err();
    assert!(
        failed.contains("\"assertions__ball\" is not the one on record"),
        "{failed}"
    );
    assert_eq!(load_picture(&shown(&failed)).unwrap().width(), 32);
    assert!(project.pending().exists() && !project.snapshot().exists() && !project.picture().exists());

    project.run("dark", "always").unwrap();
    assert_eq!(project.hash_of_picture(), project.hash_on_record());
    let text = fs::read_to_string(project.snapshot()).unwrap();
    assert!(
        text.contains("description: A dark ball.\n---\nsize 32 x 24\nhash "),
        "{text}"
    );
    project.run("dark", "no").unwrap();
}

#[test]
fn a_change_fails_with_numbers_and_a_picture_of_all_three() {
    let project = Project::new("change");
    project.run("dark", "always").unwrap();
    let (hash, before) = (project.hash_on_record(), fs::read(project.picture()).unwrap());
    for update in ["no", "new"] {
        let failed = project.run("bright", update).unwrap_err();
        assert!(failed.contains(" of 768 pixels, by 1 at most, PSNR "), "{failed}");
        let picture = load_picture(&shown(&failed)).unwrap();
        assert_eq!((picture.width(), picture.height()), (3 * 32 + 8, 24));
        assert_eq!(project.pending().exists(), update == "new");
    }
    assert_eq!(hash, project.hash_on_record());
    assert_eq!(before, fs::read(project.picture()).unwrap());
    let failed = project.run("same picture", "no").unwrap_err();
    assert!(
        failed.contains("no pixel; the scene is written differently"),
        "{failed}"
    );
    // What is as before again waits for nothing.
    project.run("dark", "new").unwrap();
    assert!(!project.pending().exists());
}

#[test]
fn the_picture_follows_a_review() {
    let project = Project::new("review");
    project.run("dark", "always").unwrap();
    let dark = project.hash_of_picture();
    project.run("bright", "new").unwrap_err();
    let pending = fs::read_to_string(project.pending()).unwrap();
    assert!(shown(&pending).exists(), "{pending}");
    // What `cargo insta accept` does.
    fs::rename(project.pending(), project.snapshot()).unwrap();

    let failed = project.run("bright", "no").unwrap_err();
    assert!(failed.contains("still tells how it differed"), "{failed}");
    let failed = project.run_with("bright", "auto", &[("CI", "true")]).unwrap_err();
    assert!(failed.contains("still tells how it differed"), "{failed}");
    assert_eq!(project.hash_of_picture(), dark);

    project.run("bright", "auto").unwrap();
    assert_eq!(project.hash_of_picture(), project.hash_on_record());
    assert_ne!(project.hash_of_picture(), dark);
    let settled = fs::read_to_string(project.snapshot()).unwrap();
    assert!(
        !settled.contains("file://") && !settled.contains("info:"),
        "{settled}"
    );
    assert!(
        settled.contains("source:") && settled.contains("\nsize 32 x 24\n"),
        "{settled}"
    );
    project.run("bright", "no").unwrap();

    fs::remove_file(project.picture()).unwrap();
    let failed = project.run("bright", "no").unwrap_err();
    assert!(failed.contains("is not the picture of its snapshot"), "{failed}");
    project.run("bright", "new").unwrap();
    project.run("bright", "no").unwrap();
}

#[test]
fn accepting_at_once_leaves_no_trace_of_this_machine() {
    let project = Project::new("at-once");
    project.run("dark", "always").unwrap();
    project.run("bright", "always").unwrap();
    assert_eq!(project.hash_of_picture(), project.hash_on_record());
    assert!(!fs::read_to_string(project.snapshot()).unwrap().contains("info:"));
}

#[test]
fn cargo_insta_collects_changes_without_a_failure() {
    let project = Project::new("forced");
    project.run("dark", "always").unwrap();
    let dark = project.hash_on_record();
    project
        .run_with("bright", "new", &[("INSTA_FORCE_PASS", "1")])
        .unwrap();
    assert!(project.pending().exists());
    assert_eq!(
        (project.hash_on_record(), project.hash_of_picture()),
        (dark.clone(), dark)
    );
}

#[test]
fn what_is_near_enough_passes_and_the_record_stays() {
    let project = Project::new("tolerance");
    let failed = project.run("bright, near, any scene", "no").unwrap_err();
    assert!(
        failed.contains("is not the one on record"),
        "nothing to be near to: {failed}"
    );
    project.run("dark", "always").unwrap();
    let dark = project.hash_on_record();
    let failed = project.run("bright, near", "no").unwrap_err();
    assert!(
        failed.contains("within the tolerance, the text of its scene is not"),
        "{failed}"
    );
    let failed = project.run("large, near, any scene", "no").unwrap_err();
    assert!(!failed.contains("within the tolerance"), "{failed}");
    for update in ["no", "new", "always"] {
        project.run("bright, near, any scene", update).unwrap();
    }
    assert_eq!(project.hash_on_record(), dark);
    assert!(!project.pending().exists());
    // A reference that is not of the snapshot measures nothing.
    let other = load_picture(&shown(&project.run("large, near, any scene", "no").unwrap_err())).unwrap();
    rtscript::output::save(&project.picture(), &other).unwrap();
    let failed = project.run("bright, near, any scene", "no").unwrap_err();
    assert!(failed.contains("is not the picture on record"), "{failed}");
}

#[test]
fn a_pattern_checks_every_scene_that_it_finds() {
    let project = Project::new("glob");
    let write = |name: &str, text: &str| {
        let path = project.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, text).unwrap();
    };
    let scene = "// A gray ball.\nsize(16, 12); light([5, 5, 5], [1, 1, 1]); sphere(0, 0, 0, 1);";
    write("scenes/a.rhai", scene);
    write("scenes/deep/er/b.rhai", scene);
    write(
        "scenes/c.test",
        "size 16 12\ncamera 0 0 4 0 0 0 0 1 0 30\nsphere 0 0 0 1\n",
    );
    project.run("scenes/**/*.rhai", "always").unwrap();
    let snapshot = fs::read_to_string(project.path("scenes/deep/er/b.snap")).unwrap();
    assert!(snapshot.contains("description: A gray ball."), "{snapshot}");
    assert!(project.path("scenes/a.png").exists() && !project.path("scenes/c.snap").exists());
    project.run("scenes/**/*.rhai", "no").unwrap();

    write("scenes/a.rhai", &scene.replace("1);", "0.9);"));
    write("scenes/deep/d.rhai", "// A fault.\nspher(1);");
    let failed = project.run("scenes/**/*.rhai", "no").unwrap_err();
    assert!(
        failed.contains("2 of 3 scenes:\nscenes/a.rhai: the picture"),
        "{failed}"
    );
    assert!(
        failed.contains("scenes/deep/d.rhai: d.rhai:2:1: error: "),
        "{failed}"
    );
    let failed = project.run("scenes/*.txt", "no").unwrap_err();
    assert!(
        failed.contains("\"scenes/*.txt\" finds no file below"),
        "{failed}"
    );

    write(
        "scenes/a.test",
        "size 16 12\ncamera 0 0 4 0 0 0 0 1 0 30\nsphere 0 0 0 1\n",
    );
    let failed = project.run("scenes/a.*", "always").unwrap_err();
    assert!(failed.contains("another scene has the same snapshot"), "{failed}");
}
