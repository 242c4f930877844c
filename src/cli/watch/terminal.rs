//! The terminal that pictures are shown in: what it can, how large it is, what is typed, and how it gets back what it had.

use std::{
    io::{self, IsTerminal, Write},
    sync::{Arc, Mutex, PoisonError},
};

use crate::cli::{args::TerminalPictures, picture};

/// Takes back what [`BEGIN`] and pictures did: colors, clipped lines, the cursor, the other screen.
const END: &str = "\x1b[0m\x1b[?7h\x1b[?25h\x1b[?1049l";
/// Takes pictures of kitty's protocol away.
const NO_PICTURES: &str = "\x1b_Ga=d,q=2\x1b\\";
/// Empties the screen, of what a terminal may make of questions that it does not understand.
const CLEAR: &str = "\x1b[2J";
/// A screen of its own, without a cursor, lines clipped at the edge.
const BEGIN: &str = "\x1b[?1049h\x1b[?25l\x1b[?7l\x1b[H";

/// How large the terminal is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Size {
    pub(super) columns: u32,
    pub(super) rows: u32,
    /// Pixels of one character, across and down.
    pub(super) cell: (u32, u32),
}

/// Where a terminal does not tell.
const USUAL: Size = Size {
    columns: 80,
    rows: 24,
    cell: (8, 16),
};

/// A terminal that is ours until this is dropped.
#[derive(Debug)]
pub(super) struct Terminal {
    pub(super) pictures: TerminalPictures,
    lent: Arc<Lent>,
}

/// What must be given back, once.
#[derive(Debug)]
struct Lent {
    keyboard: Mutex<Option<keyboard::Keyboard>>,
    pictures: TerminalPictures,
}

impl Lent {
    fn give_back(&self) {
        let keyboard = self
            .keyboard
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .take();
        if let Some(keyboard) = keyboard {
            // A terminal that is gone needs nothing back.
            if self.pictures == TerminalPictures::Kitty {
                let _ = keyboard.write(NO_PICTURES);
            }
            let _ = keyboard.write(END);
            keyboard.give_back();
        }
    }
}

impl Terminal {
    /// Takes the terminal that standard output is, if it is one, can show pictures and nobody else is using it; `None`
    /// otherwise, or where no pictures are wanted.
    pub(super) fn take(wanted: TerminalPictures) -> Option<Self> {
        let able = picture::ability();
        let is_dumb = std::env::var_os("TERM").is_none_or(|term| term == "dumb" || term.is_empty());
        if wanted == TerminalPictures::None || is_dumb || !io::stdout().is_terminal() {
            return None;
        }
        if wanted == TerminalPictures::Auto && able == TerminalPictures::None {
            return None;
        }
        let keyboard = keyboard::Keyboard::take()?;
        // A terminal that does not take it shows at its own risk.
        let _ = keyboard.write(BEGIN);
        let pictures = match (wanted, able) {
            (TerminalPictures::Auto, TerminalPictures::Blocks) => keyboard.ask(),
            (TerminalPictures::Auto, able) => able,
            (wanted, _) => wanted,
        };
        let _ = keyboard.write(CLEAR);
        let lent = Lent {
            keyboard: Mutex::new(Some(keyboard)),
            pictures,
        };
        Some(Self {
            pictures,
            lent: Arc::new(lent),
        })
    }

    /// Gives the terminal back, for when there is no time left to drop anything.
    pub(super) fn rescue(&self) -> Box<dyn Fn() + Send> {
        let lent = Arc::clone(&self.lent);
        Box::new(move || lent.give_back())
    }

    /// What was typed since the last time.
    pub(super) fn typed(&self) -> Vec<u8> {
        let keyboard = self.lent.keyboard.lock().unwrap_or_else(PoisonError::into_inner);
        keyboard
            .as_ref()
            .map(keyboard::Keyboard::typed)
            .unwrap_or_default()
    }

    /// How large it is now.
    pub(super) fn size(&self) -> Size {
        let keyboard = self.lent.keyboard.lock().unwrap_or_else(PoisonError::into_inner);
        keyboard
            .as_ref()
            .and_then(keyboard::Keyboard::size)
            .unwrap_or(USUAL)
    }

    /// Shows what is written.
    pub(super) fn show(&self, text: &str) {
        // Without the lock, which whoever gives the terminal back must get, also while it takes no more. A terminal that
        // is gone ends the program by SIGHUP.
        let mut out = io::stdout().lock();
        let _ = out.write_all(text.as_bytes()).and_then(|()| out.flush());
    }
}

impl Drop for Terminal {
    fn drop(&mut self) {
        self.lent.give_back();
    }
}

#[cfg(unix)]
mod keyboard {
    use std::{
        fs::{File, OpenOptions},
        io::{self, Read, Write},
        thread,
        time::{Duration, Instant},
    };

    use rustix::{
        process::getpgrp,
        termios::{
            LocalModes, OptionalActions, SpecialCodeIndex, Termios, tcgetattr, tcgetpgrp, tcgetwinsize,
            tcsetattr,
        },
    };

    use super::{Size, TerminalPictures, USUAL};

    /// How long a terminal may take to say what it can; one far away takes that long to answer.
    const PATIENCE: Duration = Duration::from_millis(250);

    /// The terminal with its keyboard, which passes on each key as it is typed and does not print it.
    #[derive(Debug)]
    pub(super) struct Keyboard {
        tty: File,
        before: Termios,
    }

    impl Keyboard {
        /// Takes the process's terminal; `None` where it has none or is in its background.
        pub(super) fn take() -> Option<Self> {
            let tty = OpenOptions::new().read(true).write(true).open("/dev/tty").ok()?;
            // From the background a change of modes would stop the process.
            if tcgetpgrp(&tty).ok()? != getpgrp() {
                return None;
            }
            let before = tcgetattr(&tty).ok()?;
            let mut modes = before.clone();
            modes.local_modes.remove(LocalModes::ICANON | LocalModes::ECHO);
            // Reading never waits.
            modes.special_codes[SpecialCodeIndex::VMIN] = 0;
            modes.special_codes[SpecialCodeIndex::VTIME] = 0;
            // Stopped or aborted from the keyboard, the terminal would stay as it is now. 0 is no key.
            modes.special_codes[SpecialCodeIndex::VSUSP] = 0;
            modes.special_codes[SpecialCodeIndex::VQUIT] = 0;
            tcsetattr(&tty, OptionalActions::Now, &modes).ok()?;
            Some(Self { tty, before })
        }

        pub(super) fn give_back(&self) {
            // Late answers are nobody's business.
            self.typed();
            // A terminal that is gone has no modes. One that takes no more output is not waited for.
            let _ = tcsetattr(&self.tty, OptionalActions::Now, &self.before);
        }

        pub(super) fn write(&self, text: &str) -> io::Result<()> {
            let mut tty = &self.tty;
            tty.write_all(text.as_bytes())?;
            tty.flush()
        }

        pub(super) fn typed(&self) -> Vec<u8> {
            let mut bytes = [0; 256];
            let read = (&self.tty).read(&mut bytes).unwrap_or(0);
            bytes.get(..read).unwrap_or_default().to_vec()
        }

        pub(super) fn size(&self) -> Option<Size> {
            let size = tcgetwinsize(&self.tty).ok()?;
            let (columns, rows) = (u32::from(size.ws_col), u32::from(size.ws_row));
            if columns == 0 || rows == 0 {
                return None;
            }
            let cell = (
                u32::from(size.ws_xpixel) / columns,
                u32::from(size.ws_ypixel) / rows,
            );
            Some(Size {
                columns,
                rows,
                cell: if cell.0 > 0 && cell.1 > 0 {
                    cell
                } else {
                    USUAL.cell
                },
            })
        }

        /// Asks whether it knows kitty's protocol, and for its attributes (DA1), which every terminal answers: the
        /// answer to the second says that there is none to the first.
        pub(super) fn ask(&self) -> TerminalPictures {
            if self
                .write("\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b[c")
                .is_err()
            {
                return TerminalPictures::Blocks;
            }
            let (start, mut answer) = (Instant::now(), Vec::new());
            while start.elapsed() < PATIENCE {
                answer.extend(self.typed());
                if let Some(able) = answered(&answer) {
                    return able;
                }
                thread::sleep(Duration::from_millis(1));
            }
            TerminalPictures::Blocks
        }
    }

    /// What the answers say; `None` where they are not all there.
    fn answered(answer: &[u8]) -> Option<TerminalPictures> {
        let text = String::from_utf8_lossy(answer);
        let (before, attributes) = text.split_once("\x1b[?")?;
        let (attributes, _) = attributes.split_once('c')?;
        Some(if before.contains("\x1b_Gi=31;OK") {
            TerminalPictures::Kitty
        } else if attributes.split(';').any(|attribute| attribute == "4") {
            TerminalPictures::Sixel
        } else {
            TerminalPictures::Blocks
        })
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn what_a_terminal_says_it_can() {
            let able = |answer: &str| answered(answer.as_bytes());
            assert_eq!(
                able("\x1b_Gi=31;OK\x1b\\\x1b[?62;c"),
                Some(TerminalPictures::Kitty)
            );
            assert_eq!(able("\x1b[?62;4;22c"), Some(TerminalPictures::Sixel));
            assert_eq!(able("\x1b[?1;2c"), Some(TerminalPictures::Blocks));
            assert_eq!(
                able("\x1b_Gi=31;EINVAL\x1b\\\x1b[?64;14;44c"),
                Some(TerminalPictures::Blocks)
            );
            for partial in ["", "q", "\x1b_Gi=31;OK\x1b\\", "\x1b[?62;4"] {
                assert_eq!(able(partial), None, "{partial:?}");
            }
        }
    }
}

/// Where terminals work otherwise, pictures are files.
#[cfg(not(unix))]
mod keyboard {
    use super::{Size, TerminalPictures};

    #[derive(Debug)]
    pub(super) struct Keyboard;

    impl Keyboard {
        pub(super) fn take() -> Option<Self> {
            None
        }

        pub(super) fn give_back(&self) {}

        pub(super) fn write(&self, _text: &str) -> std::io::Result<()> {
            Ok(())
        }

        pub(super) fn typed(&self) -> Vec<u8> {
            Vec::new()
        }

        pub(super) fn size(&self) -> Option<Size> {
            None
        }

        pub(super) fn ask(&self) -> TerminalPictures {
            TerminalPictures::None
        }
    }
}
