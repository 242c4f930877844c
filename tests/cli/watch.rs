//! `rtscript watch`, without a terminal and in one.

use super::*;

use std::{
    io::Read,
    process::Child,
    sync::{Arc, Mutex},
    thread::{self, sleep},
    time::{Duration, Instant},
};

/// A command that runs until it is told to end, and what it said so far.
struct Watch {
    child: Child,
    said: Arc<Mutex<String>>,
}

impl Watch {
    fn start(folder: &Folder, args: &[&str]) -> Self {
        Self::spawn(folder.command(&[&["watch", "scene.rhai"], args].concat()))
    }

    fn spawn(mut command: Command) -> Self {
        let mut child = command
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let said = Arc::<Mutex<String>>::default();
        let streams: [Box<dyn Read + Send>; 2] = [
            Box::new(child.stdout.take().unwrap()),
            Box::new(child.stderr.take().unwrap()),
        ];
        for mut stream in streams {
            let said = Arc::clone(&said);
            thread::spawn(move || {
                let mut bytes = [0; 1 << 16];
                while let Ok(count @ 1..) = stream.read(&mut bytes) {
                    said.lock()
                        .unwrap()
                        .push_str(&String::from_utf8_lossy(&bytes[..count]));
                }
            });
        }
        Self { child, said }
    }

    fn said(&self) -> String {
        self.said.lock().unwrap().clone()
    }

    /// Waits until it has said so.
    #[track_caller]
    fn says(&self, text: &str) {
        wait_until(&format!("{text:?} in {}", self.said()), || {
            self.said().contains(text)
        });
    }

    #[cfg(unix)]
    fn signal(&self, name: &str) {
        let id = self.child.id().to_string();
        assert!(Command::new("kill").args([name, &id]).status().unwrap().success());
    }

    fn end(mut self) -> Option<i32> {
        wait_until("the end", || self.child.try_wait().unwrap().is_some());
        self.child.wait().unwrap().code()
    }
}

impl Drop for Watch {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// As long as it takes on a busy machine.
#[track_caller]
fn wait_until(what: &str, mut done: impl FnMut() -> bool) {
    let start = Instant::now();
    while !done() {
        assert!(
            start.elapsed() < Duration::from_secs(120),
            "waited too long for {what}"
        );
        sleep(Duration::from_millis(5));
    }
}

/// The hash of the scene's pixels, by a run of its own.
fn hash_of_scene(folder: &Folder, args: &[&str]) -> String {
    let printed = String::from_utf8(folder.ok(&[&["hash", "scene.rhai"], args].concat()).stdout).unwrap();
    printed.split_whitespace().next().unwrap().to_owned()
}

fn hash_of(path: &Path) -> String {
    load_picture(path).unwrap().hash()
}

/// Waits until the picture that was written is that of the scene as it stands.
#[track_caller]
fn is_up_to_date(folder: &Folder, watch: &Watch) {
    let hash = hash_of_scene(folder, &[]);
    watch.says(&hash);
    assert_eq!(hash_of(&folder.path("scene.png")), hash);
}

const PARTS: &str = "size(16, 12);\nlight([0, 0, 5], [1, 1, 1]);\nimport \"lib/part\" as part;\npart::ball();\n\
    translate(-0.7, 0, 0);\nmesh(\"m.obj\");\ndiffuse(image(\"t.png\"));\nsphere(1, 0, 0, 0.5);\n";
const OBJ: &str = "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl one\nf 1 2 3\n";

fn with_parts() -> Folder {
    let folder = Folder::with(PARTS);
    folder.write(
        "lib/part.rhai",
        "fn ball() { diffuse(1, 0, 0); sphere(0, 0, 0, 0.4); }\n",
    );
    folder.write("m.obj", OBJ);
    folder.write("m.mtl", "newmtl one\nKd 0 1 0\n");
    folder.write("t.png", texture(200));
    folder
}

fn texture(level: u8) -> Vec<u8> {
    let image = rtscript::testing::from_rgb8(1, 1, &[level, 0, level]);
    rtscript::output::encode(&image, rtscript::output::Format::Png).unwrap()
}

#[test]
fn every_change_gives_the_picture_that_a_render_would() {
    let folder = with_parts();
    let watch = Watch::start(&folder, &[]);
    is_up_to_date(&folder, &watch);
    watch.says("watching scene.rhai, lib/part.rhai, m.mtl, m.obj, t.png");
    // Each of the files, the same length as before where that is possible.
    for (name, content) in [
        ("scene.rhai", PARTS.replace("0.5);", "0.6);").into_bytes()),
        (
            "lib/part.rhai",
            b"fn ball() { diffuse(1, 1, 0); sphere(0, 0, 0, 0.4); }\n".to_vec(),
        ),
        ("m.obj", OBJ.replace("v 0 1 0", "v 0 2 0").into_bytes()),
        ("m.mtl", b"newmtl one\nKd 0 0 1\n".to_vec()),
        ("t.png", texture(90)),
        ("scene.rhai", PARTS.as_bytes().to_vec()),
    ] {
        folder.write(name, content);
        is_up_to_date(&folder, &watch);
    }
    assert!(!watch.said().contains("error"), "{}", watch.said());
    let rendered = folder.ok(&["scene.rhai", "-o", "again.png"]);
    assert_eq!(rendered.code, 0);
    // The recipe too: the whole file is what `rtscript render` writes.
    assert_eq!(
        fs::read(folder.path("scene.png")).unwrap(),
        fs::read(folder.path("again.png")).unwrap()
    );
}

#[test]
fn editors_that_put_a_new_file_in_the_place_of_the_old_one_are_understood() {
    let folder = Folder::with(BALL);
    let watch = Watch::start(&folder, &[]);
    is_up_to_date(&folder, &watch);
    folder.write("new", BALL.replace("1, 0, 0", "0, 1, 0"));
    fs::rename(folder.path("new"), folder.path("scene.rhai")).unwrap();
    is_up_to_date(&folder, &watch);
    // The old one is moved away first, as editors with backups do.
    fs::rename(folder.path("scene.rhai"), folder.path("scene.rhai~")).unwrap();
    folder.write("scene.rhai", BALL.replace("1, 0, 0", "0, 0, 1"));
    is_up_to_date(&folder, &watch);
    assert!(!watch.said().contains("error"), "{}", watch.said());
}

#[test]
fn an_error_is_told_and_replaces_nothing() {
    let folder = Folder::with(&format!("{BALL}render(\"named.png\");\n"));
    let watch = Watch::start(&folder, &["-o", "last.png"]);
    watch.says("last.png  16x12");
    let files = ["named.png", "last.png"].map(|name| folder.path(name));
    let before = files.each_ref().map(|path| fs::read(path).unwrap());
    let wrong = BALL.replace("1, 0, 0", "0, 1, 0") + "render(\"named.png\");\nspher(0, 0, 0, 1);\n";
    folder.write("scene.rhai", wrong);
    watch.says("scene.rhai:6:1");
    assert_eq!(files.each_ref().map(|path| fs::read(path).unwrap()), before);
    folder.write("scene.rhai", "size(16, 12); let");
    watch.says("scene.rhai:1:");
    // So is a folder in its place, for as long as it is there.
    fs::remove_file(folder.path("scene.rhai")).unwrap();
    fs::create_dir(folder.path("scene.rhai")).unwrap();
    watch.says("cannot watch 'scene.rhai': it is not a regular file");
    fs::remove_dir(folder.path("scene.rhai")).unwrap();
    folder.write("scene.rhai", "size(16, 12); box");
    watch.says("scene.rhai:1:1");
    // Gone is an error, too, and no reason to end.
    fs::remove_file(folder.path("scene.rhai")).unwrap();
    watch.says("cannot read 'scene.rhai': no such file");
    assert_eq!(files.each_ref().map(|path| fs::read(path).unwrap()), before);
    folder.write("scene.rhai", BALL.replace("1, 0, 0", "0, 0, 1"));
    watch.says(&hash_of_scene(&folder, &[]));
    assert_eq!(hash_of(&files[1]), hash_of_scene(&folder, &[]));
}

#[test]
fn a_picture_that_the_script_reads_again_is_there() {
    let script = "size(16, 12);\nbackground(0.2, 0.4, 0.6);\nrender(\"wall.png\");\nlight([0, 0, 5], [1, 1, 1]);\n\
        diffuse(image(\"wall.png\"));\nsphere(0, 0, 0, 1);\nrender();\n";
    let folder = Folder::with(script);
    let watch = Watch::start(&folder, &["-o", "scene.png"]);
    watch.says("scene.png  16x12");
    folder.write("scene.rhai", script.replace("0.2", "0.9"));
    wait_until("another picture", || {
        watch.said().matches("scene.png  16x12").count() == 2
    });
    let other = Folder::with(&script.replace("0.2", "0.9"));
    other.ok(&["scene.rhai", "-o", "scene.png"]);
    assert_eq!(
        hash_of(&folder.path("scene.png")),
        hash_of(&other.path("scene.png"))
    );
}

#[test]
fn a_file_that_is_missing_is_waited_for() {
    let folder = Folder::with(&format!("{BALL}mesh(\"late.obj\");\n"));
    let watch = Watch::start(&folder, &[]);
    watch.says("cannot read 'late.obj': no such file");
    folder.write("late.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    is_up_to_date(&folder, &watch);
}

#[test]
fn a_change_ends_the_run_under_way() {
    let folder = Folder::with("print(\"running\");\nloop { }\n");
    let watch = Watch::start(&folder, &["--size", "20x10"]);
    watch.says("running");
    folder.write(
        "scene.rhai",
        format!("{BALL}size(9, 9);\nsamples(40000);\nprint(\"tracing\");\n"),
    );
    watch.says("tracing");
    folder.write("scene.rhai", BALL);
    watch.says(&hash_of_scene(&folder, &["--size", "20x10"]));
    // Not by itself: neither was told to be done or too long.
    assert!(!watch.said().contains("too "), "{}", watch.said());
    assert_eq!(watch.said().matches("scene.png  20x10").count(), 1);
}

#[test]
fn what_cannot_be_watched_is_said_at_once() {
    let folder = Folder::with(BALL);
    folder.fails(&["watch", "-"], 3, &["standard input cannot be watched"]);
    folder.fails(
        &["watch", "nothing.rhai"],
        3,
        &["cannot read 'nothing.rhai': no such file"],
    );
    folder.fails(&["watch", "."], 3, &["not a regular file"]);
    folder.fails(
        &["watch", "scene.rhai", "-o", "a.gif"],
        4,
        &["'.gif' is not a picture format"],
    );
    folder.fails(
        &["watch", "scene.rhai", "-o", "scene.rhai"],
        4,
        &["cannot write 'scene.rhai'"],
    );
    assert_eq!(folder.files(), ["scene.rhai"]);
}

#[cfg(unix)]
#[test]
fn signals_end_the_watch_at_rest_and_at_work() {
    for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        for (script, sign) in [(BALL, "watching"), ("print(\"running\"); loop { }", "running")] {
            let folder = Folder::with(script);
            let watch = Watch::start(&folder, &[]);
            watch.says(sign);
            watch.signal(signal);
            assert_eq!(watch.end(), Some(code), "{signal} {sign}");
        }
    }
}

/// In a terminal of its own, which `script` of util-linux makes.
#[cfg(target_os = "linux")]
mod terminal {
    use super::*;
    use std::io::Write;

    const IN_TERMINAL: &str = "stty cols 60 rows 20; stty -a > before; sh -c 'echo $$ > pid; exec \"$0\" watch scene.rhai \
        --pictures blocks' \"$RTSCRIPT\"; echo \"code $?\"; stty -a > after; cat before after > both";

    fn start(folder: &Folder) -> Watch {
        let mut command = Command::new("script");
        command
            .args(["-q", "-f", "-c", IN_TERMINAL, "/dev/null"])
            .current_dir(&folder.0)
            .env("RTSCRIPT", env!("CARGO_BIN_EXE_rtscript"))
            .env("TERM", "xterm-256color")
            .env("COLORTERM", "truecolor")
            .env_remove("NO_COLOR")
            .stdin(Stdio::piped());
        Watch::spawn(command)
    }

    /// What `stty` said before and after is the same, and the screen is as it was.
    fn is_given_back(folder: &Folder, watch: &Watch, code: i32) {
        watch.says(&format!("code {code}"));
        wait_until("stty", || folder.path("both").exists());
        wait_until("stty", || {
            let [before, after] =
                ["before", "after"].map(|name| fs::read_to_string(folder.path(name)).unwrap());
            before.contains("icanon") && before == after
        });
        let said = watch.said();
        let (begin, end) = (
            said.find("\x1b[?1049h").unwrap(),
            said.rfind("\x1b[?1049l").unwrap(),
        );
        assert!(begin < end && said[end..].contains("code"), "{said}");
        assert!(said.rfind("\x1b[?25h") > said.rfind("\x1b[?25l"), "{said}");
    }

    #[test]
    fn the_picture_and_what_is_wrong_are_shown() {
        let folder = Folder::with(&BALL.replace("16, 12", "320, 240"));
        let mut watch = start(&folder);
        watch.says("scene.rhai  coarse  40x30");
        watch.says("scene.rhai  320x240");
        let said = watch.said();
        let begin = said.find("\x1b[H").unwrap();
        assert_eq!(
            said[begin..].lines().next().unwrap().matches('▀').count(),
            51,
            "{said}"
        );
        folder.write("scene.rhai", "size(320, 240);\nspher(0, 0, 0, 1);\n");
        watch.says("error: this is the last good picture");
        watch.says("did you mean");
        folder.write("scene.rhai", BALL);
        watch.says("scene.rhai  16x12");
        watch.child.stdin.as_mut().unwrap().write_all(b"q").unwrap();
        is_given_back(&folder, &watch, 0);
        // The line that stays.
        watch.says("scene.png  16x12");
        assert!(watch.said().contains(&hash_of_scene(&folder, &[])));
    }

    #[test]
    fn signals_give_the_terminal_back() {
        for (signal, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
            for (script, sign) in [(BALL, "scene.rhai  16x12"), ("loop { }", "\x1b[?1049h")] {
                let folder = Folder::with(script);
                let watch = start(&folder);
                watch.says(sign);
                let pid = fs::read_to_string(folder.path("pid")).unwrap();
                assert!(
                    Command::new("kill")
                        .args([signal, pid.trim()])
                        .status()
                        .unwrap()
                        .success()
                );
                is_given_back(&folder, &watch, code);
            }
        }
    }
}
