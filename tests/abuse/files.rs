//! Paths that lead out of the folder, and what is no file.

#![cfg(unix)]

use std::{
    fs,
    os::unix::fs::symlink,
    path::{Path, PathBuf},
    process::Command,
    sync::atomic::{AtomicBool, Ordering},
    thread,
    time::{Duration, Instant},
};

use rtscript::{DirHost, Host, Limits, diag::ErrorKind};

use crate::{first_line, run};

/// A folder with a folder to read in it, removed at the end.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let folder = std::env::temp_dir().join(format!("rtscript-{name}-{}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(folder.join("inside/sub")).unwrap();
        fs::write(folder.join("secret.txt"), "secret").unwrap();
        fs::write(folder.join("inside/a.txt"), "yes").unwrap();
        Self(folder)
    }

    fn inside(&self) -> PathBuf {
        self.0.join("inside")
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[test]
fn nothing_outside_the_folder_is_read() {
    let folder = Folder::new("outside");
    let inside = folder.inside();
    symlink("../secret.txt", inside.join("out.txt")).unwrap();
    symlink(folder.0.join("secret.txt"), inside.join("absolute.txt")).unwrap();
    symlink("..", inside.join("up")).unwrap();
    symlink("/", inside.join("root")).unwrap();
    symlink("/proc/self/environ", inside.join("environ")).unwrap();
    symlink("sub/../../secret.txt", inside.join("winding.txt")).unwrap();
    let host = DirHost::new(&inside);
    assert_eq!(host.read("a.txt", 10).unwrap(), b"yes");
    for path in [
        "../secret.txt",
        "/etc/passwd",
        "sub/../../secret.txt",
        "out.txt",
        "absolute.txt",
        "up/secret.txt",
        "up/inside/a.txt",
        "root/etc/passwd",
        "environ",
        "winding.txt",
    ] {
        let error = host.read(path, 1000).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Denied, "{path}: {error}");
        assert!(!error.message.contains("secret\n"), "{path}: {error}");
    }
    // Magic links of the kernel lead out although no text says so.
    for path in ["root/etc/passwd", "cwd/Cargo.toml", "exe", "fd/0"] {
        assert!(DirHost::new("/proc/self").read(path, 1 << 30).is_err(), "{path}");
    }
}

#[test]
fn links_that_stay_inside_are_followed() {
    let folder = Folder::new("links");
    let inside = folder.inside();
    symlink("../a.txt", inside.join("sub/back.txt")).unwrap();
    symlink("sub", inside.join("other")).unwrap();
    symlink("self", inside.join("self")).unwrap();
    let host = DirHost::new(&inside);
    for path in ["sub/back.txt", "other/back.txt", "./sub/../a.txt"] {
        assert_eq!(host.read(path, 10).unwrap(), b"yes", "{path}");
    }
    assert_eq!(host.read("self", 10).unwrap_err().kind, ErrorKind::Input);
}

#[test]
fn what_is_no_file_is_refused_and_nothing_is_waited_for() {
    let folder = Folder::new("devices");
    let inside = folder.inside();
    assert!(
        Command::new("mkfifo")
            .arg(inside.join("pipe"))
            .status()
            .unwrap()
            .success()
    );
    let socket = std::os::unix::net::UnixListener::bind(inside.join("socket")).unwrap();
    let start = Instant::now();
    let host = DirHost::new(&inside);
    for path in ["pipe", "socket", "sub", "."] {
        let error = host.read(path, 10).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Denied, "{path}: {error}");
        assert_eq!(error.message, format!("'{path}' is not a regular file"));
    }
    drop(socket);
    for path in ["zero", "null", "tty"] {
        let error = DirHost::new("/dev").read(path, 10).unwrap_err();
        assert_eq!(error.kind, ErrorKind::Denied, "{path}: {error}");
    }
    // A pipe that nobody writes to would be waited for until the end of days.
    assert!(start.elapsed() < Duration::from_secs(60));
    for path in ["missing", "a.txt/b", "", "a.txt\0", "\0", &"x".repeat(5000)] {
        let error = host.read(path, 10).unwrap_err();
        assert!(
            matches!(error.kind, ErrorKind::Input | ErrorKind::Denied),
            "{path:?}: {error}"
        );
    }
    assert_eq!(host.read("a.txt", 2).unwrap_err().kind, ErrorKind::Limit);
}

/// A check of the path and an opening afterwards would read the other file now and then.
#[test]
fn a_link_that_comes_and_goes_is_never_followed_out() {
    let folder = Folder::new("race");
    let inside = folder.inside();
    let put = |target: &str| {
        let temporary = inside.join("next");
        let _ = fs::remove_file(&temporary);
        match target {
            "" => fs::write(&temporary, "yes").unwrap(),
            target => symlink(target, &temporary).unwrap(),
        }
        fs::rename(&temporary, inside.join("swapped.txt")).unwrap();
    };
    put("");
    let host = DirHost::new(&inside);
    let over = AtomicBool::new(false);
    let (mut read, mut refused) = (0, 0);
    thread::scope(|scope| {
        scope.spawn(|| {
            while !over.load(Ordering::Relaxed) {
                put("../secret.txt");
                put("");
            }
        });
        // On a busy machine the other thread may not have a turn for as long as all of these take.
        let patience = Instant::now() + Duration::from_secs(60);
        while read + refused < 20_000 || (read == 0 || refused == 0) && Instant::now() < patience {
            match host.read("swapped.txt", 100) {
                Ok(bytes) => {
                    assert_eq!(bytes, b"yes");
                    read += 1;
                }
                Err(error) => {
                    assert_ne!(error.kind, ErrorKind::Limit, "{error}");
                    refused += 1;
                }
            }
        }
        over.store(true, Ordering::Relaxed);
    });
    assert!(read > 0 && refused > 0, "{read} read, {refused} refused");
}

/// The folder is the one that was opened, whatever its path is later.
#[test]
fn the_folder_stays_the_same_one() {
    let folder = Folder::new("moved");
    let host = DirHost::new(folder.inside());
    assert_eq!(host.read("a.txt", 10).unwrap(), b"yes");
    fs::rename(folder.inside(), folder.0.join("elsewhere")).unwrap();
    symlink("/", folder.inside()).unwrap();
    assert_eq!(host.read("a.txt", 10).unwrap(), b"yes");
    assert_eq!(
        host.read("etc/passwd", 1 << 20).unwrap_err().kind,
        ErrorKind::Input
    );
}

/// As a script meets them: with its line, and without a word of what is in the file.
#[test]
fn scripts_are_told_which_path_is_refused() {
    let folder = Folder::new("scripts");
    symlink("/etc/passwd", folder.inside().join("x.obj")).unwrap();
    symlink("/etc/passwd", folder.inside().join("m.rhai")).unwrap();
    let host = DirHost::new(folder.inside());
    let told = |script: &str| first_line(&run(script, &Limits::default(), &host).unwrap_err());
    let expected = [
        (
            "\nmesh(\"x.obj\");",
            "scene.rhai:2:1: error: 'x.obj' leads outside the script's folder; only files below it can be read",
        ),
        (
            "import \"m\" as m;",
            "scene.rhai:1:8: error: 'm.rhai' leads outside the script's folder; only files below it can be read",
        ),
        (
            "image(\"../secret.txt\");",
            "scene.rhai:1:1: error: '../secret.txt' is outside the script's folder; only files below it can be read",
        ),
        (
            "image(\"/etc/passwd\");",
            "scene.rhai:1:1: error: '/etc/passwd' is an absolute path; only files below the script's folder can be read",
        ),
        (
            "mesh(\"sub\");",
            "scene.rhai:1:1: error: 'sub' is not a regular file",
        ),
    ];
    for (script, line) in expected {
        assert_eq!(told(script), line, "{script}");
    }
    assert!(Path::new("/etc/passwd").exists());
}
