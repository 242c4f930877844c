//! The program itself, on a screen that nobody sees: needs Xvfb, and xdotool to press keys.

use std::{
    fs,
    io::{BufRead, BufReader},
    path::{Path, PathBuf},
    process::{Child, Command, ExitStatus, Stdio},
    sync::mpsc::{self, Receiver},
    thread,
    time::{Duration, Instant},
};

const LONG: Duration = Duration::from_secs(120);

/// A child that does not outlive its test.
struct Ended(Child);

impl Drop for Ended {
    fn drop(&mut self) {
        let _ = self.0.kill();
        let _ = self.0.wait();
    }
}

/// The lines of a stream, as they come.
fn lines(stream: impl std::io::Read + Send + 'static) -> Receiver<String> {
    let (sender, receiver) = mpsc::channel();
    thread::spawn(move || {
        let lines = BufReader::new(stream).lines().map_while(Result::ok);
        lines
            .take_while(|line| sender.send(line.clone()).is_ok())
            .for_each(drop);
    });
    receiver
}

fn is_there(program: &str) -> bool {
    let paths = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&paths).any(|folder| folder.join(program).is_file())
}

/// A screen of 800 x 600, and the file that has its pixels.
fn screen(folder: &Path) -> (Ended, String, PathBuf) {
    let mut server = Command::new("Xvfb")
        .args([
            "-displayfd",
            "1",
            "-screen",
            "0",
            "800x600x24",
            "-nolisten",
            "tcp",
            "-fbdir",
        ])
        .arg(folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let number = lines(server.stdout.take().unwrap()).recv_timeout(LONG).unwrap();
    (Ended(server), format!(":{number}"), folder.join("Xvfb_screen0"))
}

/// The screen's pixels as 0xRRGGBB, from its dump in the format XWD: a header of big-endian words, then rows of BGRX.
fn pixels(dump: &Path) -> Vec<u32> {
    let bytes = fs::read(dump).unwrap();
    let word = |i: usize| u32::from_be_bytes(bytes[4 * i..][..4].try_into().unwrap()) as usize;
    let (header, height, row, colors) = (word(0), word(5), word(12), word(19));
    let pixels = &bytes[header + 12 * colors..][..row * height];
    let pixels = pixels.as_chunks::<4>().0.iter();
    pixels
        .map(|&[b, g, r, _]| u32::from_be_bytes([0, r, g, b]))
        .collect()
}

fn waits_for(what: &str, mut is_true: impl FnMut() -> bool) {
    let start = Instant::now();
    while !is_true() {
        assert!(start.elapsed() < LONG, "waited in vain: {what}");
        thread::sleep(Duration::from_millis(50));
    }
}

fn exit(child: &mut Child) -> ExitStatus {
    let mut status = None;
    waits_for("the program ends", || {
        status = child.try_wait().unwrap();
        status.is_some()
    });
    status.unwrap()
}

fn program() -> Command {
    Command::new(env!("CARGO_BIN_EXE_viewer"))
}

#[test]
fn a_window_shows_saves_shows_again_and_closes() {
    if let Some(missing) = ["Xvfb", "xdotool"].iter().find(|program| !is_there(program)) {
        eprintln!("no {missing}: no window was opened");
        return;
    }
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("window");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    let scene =
        |color: &str| format!("size(300, 200); background({color}); ambient(0, 0, 1); sphere(0, 0, 0, 1);");
    fs::write(folder.join("a.rhai"), scene("1, 0, 0")).unwrap();
    let (_server, display, dump) = screen(&folder);
    let mut child = program()
        .args(["a.rhai", "kept.png"])
        .current_dir(&folder)
        .env("DISPLAY", &display)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let (said, faults) = (
        lines(child.stdout.take().unwrap()),
        lines(child.stderr.take().unwrap()),
    );
    let mut child = Ended(child);
    let shown = said.recv_timeout(LONG).unwrap();
    assert!(shown.starts_with("a.rhai: 300 x 200, "), "{shown}");
    let count = |color| pixels(&dump).iter().filter(|pixel| **pixel == color).count();
    waits_for("the picture is on the screen", || count(0xff0000) > 20_000);
    assert!(count(0x0000ff) > 5_000, "no ball on the screen");
    let press = |key: &str| {
        let done = Command::new("xdotool")
            .args([
                "search",
                "--sync",
                "--name",
                "a.rhai",
                "windowfocus",
                "--sync",
                "key",
                key,
            ])
            .env("DISPLAY", &display)
            .status();
        assert!(done.unwrap().success(), "xdotool {key}");
    };
    press("s");
    assert_eq!(said.recv_timeout(LONG).unwrap(), "saved kept.png");
    let kept = rtscript::testing::load_picture(&folder.join("kept.png")).unwrap();
    assert_eq!((kept.width(), kept.height()), (300, 200));
    fs::write(folder.join("a.rhai"), scene("0, 1, 0")).unwrap();
    waits_for("the change is on the screen", || {
        count(0x00ff00) > 20_000 && count(0xff0000) == 0
    });
    fs::write(folder.join("a.rhai"), "sphera();").unwrap();
    let fault = faults.recv_timeout(LONG).unwrap();
    assert!(fault.contains("a.rhai:1:1: error"), "{fault}");
    press("Escape");
    assert_eq!(exit(&mut child.0).code(), Some(0));
}

#[test]
fn it_ends_with_a_code_where_it_cannot_begin() {
    let code = |arguments: &[&str]| program().args(arguments).env_remove("DISPLAY").output().unwrap();
    let usage = code(&[]);
    assert_eq!(usage.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&usage.stderr).starts_with("usage: viewer SCENE"));
    let missing = code(&["no-such-scene.rhai"]);
    assert_eq!(missing.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&missing.stderr).starts_with("error: no-such-scene.rhai: "));
    // No screen.
    let scene = Path::new(env!("CARGO_TARGET_TMPDIR")).join("unseen.rhai");
    fs::write(&scene, "sphere(0, 0, 0, 1);").unwrap();
    let unseen = code(&[scene.to_str().unwrap()]);
    assert_eq!(unseen.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&unseen.stderr).contains("error: no window: "));
}
