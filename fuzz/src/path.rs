//! Names of files: what a script can make of them reads nothing outside of its folder.

use std::{fs, os::unix::fs::symlink, path::PathBuf, sync::LazyLock};

use rtscript::{
    DirHost, Host, MemoryHost,
    host::resolve,
    import::{AssetCache, Assets},
};

use crate::oracle::{check, limits};

const SECRET: &[u8] = b"secret";

/// Words that paths are made of, beside the fuzzer's own.
const PARTS: &[&str] = &[
    "..",
    ".",
    "",
    "a.txt",
    "sub",
    "b.txt",
    "link",
    "loop",
    "out",
    "up",
    "secret.txt",
    "dev",
    "proc",
    "self",
    "C:",
    "~",
    "\\",
    "pipe",
    "etc",
    "inside",
    "\0",
    "a.txt/",
    "sub/..",
];

static FOLDER: LazyLock<PathBuf> = LazyLock::new(|| {
    let root = std::env::temp_dir().join(format!("rtscript-fuzz-path-{}", std::process::id()));
    let inside = root.join("inside");
    let made = || -> std::io::Result<()> {
        fs::create_dir_all(inside.join("sub"))?;
        fs::write(root.join("secret.txt"), SECRET)?;
        fs::write(inside.join("a.txt"), "a")?;
        fs::write(inside.join("sub/b.txt"), "b")?;
        symlink("a.txt", inside.join("link"))?;
        symlink("loop", inside.join("loop"))?;
        symlink("../secret.txt", inside.join("out"))?;
        symlink("..", inside.join("up"))?;
        Ok(())
    };
    made().expect("a folder of temporary files");
    inside
});

pub fn run(data: &[u8]) {
    let path = path(data);
    let disk = DirHost::new(&*FOLDER);
    let memory = MemoryHost::new()
        .with("a.txt", "a")
        .with("sub/b.txt", "b")
        .with("link", "a");
    for path in [resolve("a.rhai", &path), resolve("sub/a.rhai", &path), path] {
        let found = disk.read(&path, 100);
        if let Ok(bytes) = &found {
            assert_ne!(bytes, SECRET, "read from outside by {path:?}");
            if !path.contains("up") {
                assert_eq!(memory.read(&path, 100).as_ref(), Ok(bytes), "{path:?}");
            }
        }
        let limits = limits();
        let mut cache = AssetCache::default();
        if let Err(error) = Assets::new(&disk, &limits, &mut cache).read(&path) {
            check(&error, &[]);
        }
    }
}

/// The bytes as a path: half of them choose from the words, the others are taken as they are.
fn path(data: &[u8]) -> String {
    let (mut path, mut rest) = (String::new(), data);
    while let Some((first, after)) = rest.split_first() {
        rest = after;
        match first {
            128.. => {
                path.push_str(PARTS[usize::from(*first) % PARTS.len()]);
                path.push('/');
            }
            _ => path.push(char::from(*first)),
        }
    }
    if data.first().is_some_and(|first| first.is_multiple_of(2)) {
        path.truncate(path.trim_end_matches('/').len());
    }
    path
}
