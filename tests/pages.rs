//! The pages that teach: every listing runs, every command does what the page says, every picture is what the reader
//! gets. `RTSCRIPT_ACCEPT=1 cargo test --test pages` writes pictures and outputs anew.
//!
//! A page is followed from top to bottom in a folder of its own. A block of `rhai` whose first line is `// name.rhai` is
//! saved under that name; any other has to run by itself. A block of `sh` is run by a shell that finds `rtscript`, and
//! has to succeed without a warning unless `<!-- exit N -->` or `<!-- may warn -->` stands before it. A block of `text` right after it is what it wrote. A picture
//! `images/PAGE/name.png` is the file `name.png` that the commands so far have written; where there is none,
//! `name.rhai` is rendered. Blocks of other languages are left alone.

#![cfg(unix)]
#![allow(clippy::unwrap_used, clippy::panic)]

use std::{
    env, fs,
    path::{Path, PathBuf},
    process::Command,
};

use rtscript::{Limits, NoHost, RunOptions, testing::load_picture};

/// What one step of a page is.
#[derive(Debug)]
enum Step {
    /// A fenced block: its language and its text.
    Block(String, String),
    /// A picture's path as the page gives it.
    Picture(String),
    /// The exit code that the next commands end with.
    Exit(i32),
    /// The next commands may warn.
    MayWarn,
    /// Anything else, a line of it.
    Line(String),
}

fn steps(page: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut lines = page.lines();
    while let Some(line) = lines.next() {
        if let Some(language) = line.strip_prefix("```") {
            let block: Vec<&str> = lines.by_ref().take_while(|l| *l != "```").collect();
            steps.push(Step::Block(language.to_owned(), block.join("\n") + "\n"));
        } else if let Some(code) = line.strip_prefix("<!-- exit ") {
            steps.push(Step::Exit(code.trim_end_matches(" -->").parse().unwrap()));
        } else if line == "<!-- may warn -->" {
            steps.push(Step::MayWarn);
        } else {
            steps.push(Step::Line(line.to_owned()));
            for rest in line.split("](images/").skip(1) {
                let path = rest.split(')').next().unwrap();
                steps.push(Step::Picture(format!("images/{path}")));
            }
        }
    }
    steps
}

/// A page being followed.
struct Reader {
    name: String,
    folder: PathBuf,
    accept: bool,
    exit: i32,
    may_warn: bool,
    /// What the last commands wrote, while nothing has come between.
    output: Option<String>,
    /// What is wrong with the page.
    wrong: Vec<String>,
}

impl Reader {
    fn listing(&self, text: &str) {
        let first = text.lines().next().unwrap();
        let name = first
            .strip_prefix("// ")
            .filter(|n| n.ends_with(".rhai") && !n.contains(' '));
        if let Some(name) = name {
            fs::write(self.folder.join(name), text).unwrap();
            return;
        }
        let run = rtscript::Script::compile("listing", text, &Limits::default())
            .and_then(|script| script.run(&NoHost, &RunOptions::default()));
        if let Err(e) = run {
            panic!("{}: {e}\n{text}", self.name);
        }
    }

    fn commands(&mut self, text: &str) {
        let program = Path::new(env!("CARGO_BIN_EXE_rtscript")).parent().unwrap();
        let path = format!("{}:{}", program.display(), env::var("PATH").unwrap_or_default());
        let ran = Command::new("sh")
            .args(["-euc", text])
            .current_dir(&self.folder)
            .env("PATH", path)
            .env("NO_COLOR", "1")
            .output()
            .unwrap();
        let [stdout, stderr] = [ran.stdout, ran.stderr].map(|b| String::from_utf8(b).unwrap());
        let code = ran.status.code();
        assert_eq!(code, Some(self.exit), "{}: {text}\n{stdout}{stderr}", self.name);
        if self.exit == 0 && !self.may_warn {
            let warned = stderr.lines().any(|line| line.starts_with("warning"));
            assert!(!warned, "{}: {text}\n{stderr}", self.name);
        }
        (self.exit, self.may_warn) = (0, false);
        self.output = Some(if stdout.is_empty() { stderr } else { stdout });
    }

    /// Compares a picture of the page with what the reader has.
    fn picture(&mut self, path: &str) {
        let page = self.name.trim_end_matches(".md");
        let Some(own) = path.strip_prefix(&format!("images/{page}/")) else {
            return;
        };
        let got = self.folder.join(own);
        if !got.exists() {
            self.commands(&format!("rtscript {}\n", own.replace(".png", ".rhai")));
        }
        let kept = docs().join(path);
        let hash = |path: &Path| load_picture(path).ok().map(|image| image.hash());
        if hash(&kept).is_none() || hash(&kept) != hash(&got) {
            if self.accept {
                fs::create_dir_all(kept.parent().unwrap()).unwrap();
                fs::copy(&got, &kept).unwrap();
            } else {
                self.wrong.push(format!("{path} is not what the listing gives"));
            }
        }
    }

    /// Follows the page and gives it back with what the commands really wrote.
    fn follow(&mut self, page: &str) -> String {
        let mut again = String::new();
        for step in steps(page) {
            match step {
                Step::Block(language, text) => {
                    let mut text = text;
                    match language.as_str() {
                        "rhai" => self.listing(&text),
                        "sh" => self.commands(&text),
                        "text" => {
                            if let Some(output) = self.output.take() {
                                if output != text {
                                    let said = format!("the page says\n{text}and it writes\n{output}");
                                    self.wrong.push(said);
                                }
                                text = output;
                            }
                        }
                        _ => {}
                    }
                    again += &format!("```{language}\n{text}```\n");
                }
                Step::Picture(path) => self.picture(&path),
                Step::Exit(code) => {
                    self.exit = code;
                    again += &format!("<!-- exit {code} -->\n");
                }
                Step::MayWarn => {
                    self.may_warn = true;
                    again += "<!-- may warn -->\n";
                }
                Step::Line(line) => {
                    if !line.is_empty() {
                        self.output = None;
                    }
                    again += &line;
                    again.push('\n');
                }
            }
        }
        again
    }
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("docs")
}

fn follow(name: &str) {
    let path = docs().join(name);
    let page = fs::read_to_string(&path).unwrap().replace("\r\n", "\n");
    let folder = env::temp_dir().join(format!("rtscript-pages-{}-{name}", std::process::id()));
    fs::create_dir_all(&folder).unwrap();
    let mut reader = Reader {
        name: name.to_owned(),
        folder: folder.clone(),
        accept: env::var_os("RTSCRIPT_ACCEPT").is_some(),
        exit: 0,
        may_warn: false,
        output: None,
        wrong: Vec::new(),
    };
    let again = reader.follow(&page);
    fs::remove_dir_all(folder).unwrap();
    if reader.accept {
        fs::write(path, again).unwrap();
        return;
    }
    assert!(reader.wrong.is_empty(), "{name}: {}", reader.wrong.join("\n"));
}

#[test]
fn the_tutorial_can_be_followed() {
    follow("tutorial.md");
}

#[test]
fn people_from_povray_find_what_they_know() {
    follow("from-povray.md");
}

#[test]
fn people_from_openscad_find_what_they_know() {
    follow("from-openscad.md");
}

#[test]
fn a_page_is_taken_apart() {
    let page = "text ![a](images/p/a.png)\n<!-- exit 1 -->\n```sh\nrtscript x\n```\n";
    let steps = steps(page);
    assert!(
        matches!(&steps[1], Step::Picture(p) if p == "images/p/a.png"),
        "{steps:?}"
    );
    assert!(matches!(steps[2], Step::Exit(1)), "{steps:?}");
    assert!(
        matches!(&steps[3], Step::Block(l, t) if l == "sh" && t == "rtscript x\n"),
        "{steps:?}"
    );
}
