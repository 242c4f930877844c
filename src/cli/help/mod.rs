//! `rtscript help`: the reference of the language, from the one table of its functions.

mod definitions;
mod example;
pub(in crate::cli) mod forms;
mod json;
mod markdown;
mod text;

use std::{fs, path::Path};

use clap::{CommandFactory, error::ErrorKind as UsageError};

use self::example::{Example, Examples};
use super::{
    args::{Cli, HelpArgs},
    picture, usage, without_place, write_stdout,
};
use crate::{
    diag::{Code, Error, ErrorKind, nearest_names},
    host::HostError,
    output::{self, Format},
    script::{CONSTANTS, Entry, Group, PROPERTIES, entries, entry},
};

/// What the words after `rtscript help` ask for.
enum Topic {
    /// A function, by its own name or by what other systems call it.
    Function(&'static Entry),
    /// A constant or a property.
    Word(String),
    /// The functions of a group.
    Group(Group),
    /// A command of the program.
    Command(String),
    /// A class of errors or warnings.
    Code(Code),
}

impl Topic {
    fn of(name: &str) -> Option<Self> {
        let name = name.trim_end_matches("()");
        let is_called_so = |e: &&Entry| e.also.contains(&name);
        if let Some(entry) = entry(name) {
            return Some(Self::Function(entry));
        }
        if let Some(line) = text::word(name) {
            return Some(Self::Word(line));
        }
        if Cli::command().find_subcommand(name).is_some() {
            return Some(Self::Command(name.to_owned()));
        }
        if let Some(entry) = entries().find(is_called_so) {
            return Some(Self::Function(entry));
        }
        if let Some(code) = Code::from_name(name) {
            return Some(Self::Code(code));
        }
        let group = Group::ALL.into_iter().find(|g| group_name(*g) == name);
        group.map(Self::Group)
    }
}

/// What `rtscript help` calls a group: the first word of its heading.
fn group_name(group: Group) -> String {
    let title = group.title();
    title.split(' ').next().unwrap_or(title).to_lowercase()
}

/// Prints what the arguments ask for and returns the exit code of a command line that asks for nothing known.
///
/// # Errors
/// `Output` where it cannot be written; whatever is wrong with an example, which the tests rule out.
pub(super) fn help(args: &HelpArgs) -> Result<u8, Error> {
    if let Some(folder) = &args.write {
        return write_reference(folder).map(|()| 0);
    }
    if args.json {
        return print(&json::api(&Examples::run()?)?);
    }
    if args.definitions {
        return print(&definitions::definitions());
    }
    let Some(name) = args.name.as_deref() else {
        return print_styled(&text::contents());
    };
    match Topic::of(name) {
        Some(Topic::Function(entry)) => {
            let example = Example::of(entry)?;
            print_styled(&text::function(entry, &example, name))?;
            let shown = example.picture.as_ref();
            match shown.and_then(|image| picture::for_terminal(image, args.pictures)) {
                Some(picture) => print(&format!("\n{picture}")),
                None => Ok(0),
            }
        }
        Some(Topic::Word(line)) => print_styled(&line),
        Some(Topic::Group(group)) => print_styled(&text::group(group)),
        Some(Topic::Code(code)) => print_styled(&text::code(code)),
        Some(Topic::Command(name)) => Ok(command_help(&name)),
        None => Ok(unknown(name)),
    }
}

/// As `rtscript NAME --help`.
fn command_help(name: &str) -> u8 {
    use clap::Parser;
    match Cli::try_parse_from(["rtscript", name, "--help"]) {
        Err(help) => usage(&help),
        Ok(_) => 0,
    }
}

fn unknown(name: &str) -> u8 {
    let command = Cli::command();
    let commands = command.get_subcommands().map(clap::Command::get_name);
    let words = CONSTANTS.iter().map(|c| c.name);
    let properties = PROPERTIES.iter().map(|p| p.name);
    let functions = entries().flat_map(|e| e.also.iter().copied().chain([e.name]));
    let codes = Code::ALL.iter().map(|code| code.name());
    let all = functions
        .chain(words)
        .chain(properties)
        .chain(commands)
        .chain(codes);
    let near: Vec<String> = nearest_names(name, all)
        .into_iter()
        .map(|near| format!("'{near}'"))
        .collect();
    let message = if near.is_empty() {
        format!(
            "there is no '{name}'; 'rtscript help' lists what there is, and what is Rhai's own is in https://rhai.rs/book"
        )
    } else {
        format!("there is no '{name}'; did you mean {}?", near.join(" or "))
    };
    usage(&Cli::command().error(UsageError::InvalidValue, message))
}

/// Writes the reference with its pictures, the table as JSON and the definitions for editors into a folder.
fn write_reference(folder: &Path) -> Result<(), Error> {
    let images = folder.join(markdown::IMAGES);
    fs::create_dir_all(&images).map_err(|e| {
        let message = format!("cannot make '{}': {}", images.display(), output::reason(&e));
        without_place(HostError::new(ErrorKind::Output, message))
    })?;
    let write = |path: &Path, bytes: &[u8]| output::write_atomically(path, bytes).map_err(without_place);
    let examples = Examples::run()?;
    for entry in entries() {
        if let Some(image) = &examples.of(entry)?.picture {
            let path = images.join(format!("{}.png", entry.name));
            let png = output::encode(image, Format::Png).map_err(|e| {
                without_place(HostError::new(
                    ErrorKind::Output,
                    format!("cannot encode a picture: {e}"),
                ))
            })?;
            write(&path, &png)?;
        }
    }
    write(
        &folder.join("reference.md"),
        markdown::reference(&examples)?.as_bytes(),
    )?;
    write(&folder.join("api.json"), json::api(&examples)?.as_bytes())?;
    write(
        &folder.join("rtscript.d.rhai"),
        definitions::definitions().as_bytes(),
    )
}

fn print(text: &str) -> Result<u8, Error> {
    write_stdout(text.as_bytes()).map(|()| 0).map_err(without_place)
}

/// Prints text with ANSI styles, which only a terminal gets to see.
fn print_styled(text: &str) -> Result<u8, Error> {
    use std::io::IsTerminal;
    let plain =
        !std::io::stdout().is_terminal() || std::env::var_os("NO_COLOR").is_some_and(|v| !v.is_empty());
    if plain {
        print(&anstream::adapter::strip_str(text).to_string())
    } else {
        print(text)
    }
}
