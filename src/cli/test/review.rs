//! `--review`: one scene after the other, with its pictures, and the question whether it shall be kept.

use std::io::{self, BufRead};

use super::{
    case,
    outcome::{Case, Outcome},
    text::Terminal,
};
use crate::{
    cli::{args::TestArgs, picture},
    diag::Error,
    render::Image,
    testing::diff_picture,
};

/// Asks for each scene that changed or is new. The end of standard input is taken as `q`.
///
/// # Errors
/// `Output` where what is accepted cannot be written.
pub(super) fn review(args: &TestArgs, terminal: &Terminal, cases: &mut [Case]) -> Result<(), Error> {
    let open: Vec<&mut Case> = cases.iter_mut().filter(|case| case.is_open()).collect();
    let count = open.len();
    let mut answers = io::stdin().lock().lines();
    for (number, case) in (1..).zip(open) {
        terminal.line("");
        terminal.line(&format!("{number} of {count}"));
        terminal.case(case);
        show(args, terminal, case);
        let answer = loop {
            terminal.write("accept? [y]es, [n]o, [q]uit: ");
            match answers.next().and_then(Result::ok).as_deref().map(str::trim) {
                Some("y" | "yes" | "a") => break Answer::Yes,
                Some("n" | "no" | "s") => break Answer::No,
                Some("q" | "quit") | None => break Answer::Quit,
                Some(_) => {}
            }
        };
        match answer {
            Answer::Yes => case::accept(case, !args.no_pictures)?,
            Answer::No => {}
            Answer::Quit => break,
        }
    }
    Ok(())
}

enum Answer {
    Yes,
    No,
    Quit,
}

fn show(args: &TestArgs, terminal: &Terminal, case: &Case) {
    let combined: Image;
    let (image, caption) = match &case.outcome {
        Outcome::Changed(change) => match &change.reference {
            Some(reference) => {
                combined = diff_picture(&reference.image, &change.actual_image);
                (&combined, "expected | difference | actual")
            }
            None => (&change.actual_image, "now; there is no reference picture"),
        },
        Outcome::New(fresh) => (&fresh.image, "now"),
        Outcome::Passed | Outcome::Tolerated(_) | Outcome::Failed(_) => return,
    };
    if let Some(text) = picture::for_terminal(image, args.pictures) {
        terminal.write(&text);
        terminal.line(caption);
    }
}
