//! `portability render|record|pack ROOT [options]`: what each scene of the corpus below ROOT comes to here, what is on
//! record for it, or all files of the corpus as one, on standard output.

use std::{
    error::Error,
    fs,
    io::{self, Write},
    path::Path,
};

use portability::{Corpus, line, record};
use rtscript::{DirHost, RunOptions};

const USAGE: &str =
    "usage: portability render|record|pack ROOT [--threads N] [--tile N] [--shuffle SEED] [--single-rays]";

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let (Some(action), Some(root)) = (arguments.next(), arguments.next()) else {
        return Err(USAGE.into());
    };
    let mut options = RunOptions::default();
    while let Some(flag) = arguments.next() {
        let mut value = || arguments.next().ok_or(USAGE);
        match flag.as_str() {
            "--threads" => options.render.threads = value()?.parse()?,
            "--tile" => options.render.tile = value()?.parse()?,
            "--shuffle" => options.render.shuffle = Some(value()?.parse()?),
            "--single-rays" => options.render.single_rays = true,
            _ => return Err(USAGE.into()),
        }
    }
    let root = Path::new(&root);
    let corpus = read(root)?;
    let mut out = io::stdout().lock();
    match action.as_str() {
        "render" => {
            for path in corpus.scenes() {
                let file = root.join(&path);
                let assets = DirHost::new(file.parent().unwrap_or(root));
                let name = file.file_name().unwrap_or_default().to_string_lossy();
                writeln!(out, "{}", line(&path, &name, fs::read(&file)?, &assets, &options))?;
            }
        }
        "record" => {
            for path in corpus.scenes() {
                writeln!(out, "{}", on_record(root, &path)?)?;
            }
        }
        "pack" => out.write_all(&corpus.to_bytes())?,
        _ => return Err(USAGE.into()),
    }
    Ok(out.flush()?)
}

/// The scenes of the tests and of the gallery, and what they read: every file but snapshots and their pictures.
fn read(root: &Path) -> io::Result<Corpus> {
    let mut corpus = Corpus::default();
    let mut folders = vec!["tests/scenes".to_owned(), "scripts".to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(root.join(&folder))? {
            let entry = entry?;
            let path = format!("{folder}/{}", entry.file_name().to_string_lossy());
            let is_picture = path.strip_suffix("png").is_some_and(|stem| {
                root.join(format!("{stem}rhai")).exists() || root.join(format!("{stem}test")).exists()
            });
            if entry.file_type()?.is_dir() {
                folders.push(path);
            } else if !is_picture && !path.ends_with(".snap") {
                corpus.files.insert(path, fs::read(entry.path())?);
            }
        }
    }
    Ok(corpus)
}

/// The line on record for a scene, from the snapshot beside it or from that of the gallery.
fn on_record(root: &Path, path: &str) -> Result<String, Box<dyn Error>> {
    let contents = |path: &Path| -> Result<String, Box<dyn Error>> {
        let text = fs::read_to_string(path).map_err(|e| format!("{}: {e}", path.display()))?;
        let (_, contents) = text
            .strip_prefix("---\n")
            .and_then(|text| text.split_once("\n---\n"))
            .ok_or_else(|| format!("{} is no snapshot", path.display()))?;
        Ok(contents.to_owned())
    };
    if let Some(name) = path
        .strip_prefix("scripts/")
        .and_then(|name| name.strip_suffix(".rhai"))
    {
        let gallery = contents(&root.join("tests/snapshots/gallery__gallery.snap"))?;
        let hash = gallery
            .lines()
            .find_map(|line| line.strip_prefix(name)?.strip_prefix(' '));
        return Ok(record(path, hash.unwrap_or("none"), ""));
    }
    let snapshot = contents(&root.join(path).with_extension("snap"))?;
    let hash = snapshot.lines().find_map(|line| line.strip_prefix("hash "));
    Ok(record(path, hash.unwrap_or("error"), &snapshot))
}
