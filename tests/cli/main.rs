//! The command as a user meets it: every flag, exit code and message.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::indexing_slicing)]

mod course;
mod diff;
mod expand;
#[cfg(unix)]
mod faults;
mod files;
mod flags;
mod help;
mod lsp;
mod messages;
mod params;
mod pictures;
mod recipes;
mod scripts;
mod show;
mod snapshots;
mod starts;
mod sweep;
#[cfg(unix)]
mod system;
mod usage;
mod watch;
mod why;

use std::{
    fs,
    io::Write,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    sync::atomic::{AtomicU32, Ordering},
};

use rtscript::testing::load_picture;

/// A small scene with a message of its own in the pixels: a red ball on black, lit from the camera.
const BALL: &str = "size(16, 12);\nlight([0, 0, 5], [1, 1, 1]);\ndiffuse([1, 0, 0]);\nsphere(0, 0, 0, 1);\n";

/// A folder of the test's own, the current folder of the commands run in it; removed at the end.
struct Folder(PathBuf);

/// What a run of the command left behind.
struct Ran {
    code: i32,
    stdout: Vec<u8>,
    stderr: String,
}

impl Folder {
    fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let name = format!(
            "rtscript-cli-{}-{}",
            std::process::id(),
            COUNT.fetch_add(1, Ordering::Relaxed)
        );
        let path = std::env::temp_dir().join(name);
        fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A folder with `scene.rhai` in it.
    fn with(script: &str) -> Self {
        let folder = Self::new();
        folder.write("scene.rhai", script);
        folder
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        let path = self.path(name);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, content).unwrap();
    }

    /// Names of all files below, sorted, hidden ones too.
    fn files(&self) -> Vec<String> {
        let mut names = Vec::new();
        let mut folders = vec![self.0.clone()];
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    names.push(path.strip_prefix(&self.0).unwrap().display().to_string());
                }
            }
        }
        names.sort();
        names
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_rtscript"));
        command.args(args).current_dir(&self.0).stdin(Stdio::null());
        command
    }

    fn run(&self, args: &[&str]) -> Ran {
        let output = self.command(args).output().unwrap();
        Ran {
            code: output.status.code().expect("the command ends by itself"),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }

    /// Runs and expects success.
    fn ok(&self, args: &[&str]) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, 0, "{args:?}: {}", ran.stderr);
        ran
    }

    /// Runs and expects the exit code and a message that holds each of `texts`.
    #[track_caller]
    fn fails(&self, args: &[&str], code: i32, texts: &[&str]) -> Ran {
        let ran = self.run(args);
        assert_eq!(ran.code, code, "{args:?}: {}", ran.stderr);
        for text in texts {
            assert!(
                ran.stderr.contains(text),
                "{args:?}: no '{text}' in: {}",
                ran.stderr
            );
        }
        assert!(!ran.stderr.contains("panicked"), "{}", ran.stderr);
        ran
    }

    /// The hash that the command tells for `scene.rhai` with these arguments.
    fn hash(&self, args: &[&str]) -> String {
        let ran = self.ok(&[&["scene.rhai"], args].concat());
        ran.stderr.split_whitespace().last().unwrap().to_owned()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.0).unwrap();
    }
}

/// Width and height of a picture file.
fn size_of(path: &Path) -> (u32, u32) {
    let image = load_picture(path).unwrap();
    (image.width(), image.height())
}
