//! What the terminal shows: a picture, a line that says how it stands, and what there is to say besides.

use std::{
    fmt::Write as _,
    sync::{Mutex, MutexGuard, PoisonError},
};

use super::terminal::{Size, Terminal};
use crate::{
    cli::{
        args::TerminalPictures,
        picture::{self, Colors, Pixels},
        sixel,
    },
    render::Image,
};

/// Sixels are plenty of text; a wider picture is not worth the wait.
const WIDEST_SIXEL: u32 = 960;
/// The picture keeps one part in so many of the rows, however much there is to say.
const KEPT_ROWS: u32 = 2;

/// A screen in a terminal.
#[derive(Debug)]
pub(super) struct Screen {
    terminal: Terminal,
    colors: Colors,
    shown: Mutex<Shown>,
}

#[derive(Debug, Default)]
struct Shown {
    picture: Option<Image>,
    status: String,
    messages: Vec<String>,
    /// They tell what is wrong with a run, which the next picture proves to be over.
    is_wrong: bool,
    /// Size of the terminal when it was drawn last.
    size: Option<Size>,
    /// Room for the picture then: a screen, and rows of it.
    drawn: Option<(Size, u32)>,
}

impl Screen {
    pub(super) fn new(terminal: Terminal) -> Self {
        Self {
            terminal,
            colors: picture::colors(),
            shown: Mutex::default(),
        }
    }

    pub(super) fn terminal(&self) -> &Terminal {
        &self.terminal
    }

    /// Shows a picture and how it stands; what was said before stays, but for what was wrong.
    pub(super) fn picture(&self, image: &Image, status: String) {
        let mut shown = self.shown();
        shown.picture = Some(image.clone());
        if shown.is_wrong {
            shown.messages.clear();
        }
        shown.status = status;
        self.draw(&mut shown, true);
    }

    /// Shows how it stands, and all there is to say, `is_wrong` where that is an error.
    pub(super) fn say(&self, status: String, messages: Vec<String>, is_wrong: bool) {
        let mut shown = self.shown();
        shown.is_wrong = is_wrong;
        let is_same = shown.messages == messages;
        (shown.status, shown.messages) = (status, messages);
        self.draw(&mut shown, !is_same);
    }

    /// Shows how it stands. Threads never wait for one another here.
    pub(super) fn status(&self, status: String) {
        if let Ok(mut shown) = self.shown.try_lock() {
            shown.status = status;
            self.draw(&mut shown, false);
        }
    }

    /// Draws all of it again where the terminal has another size.
    pub(super) fn refresh(&self) {
        let mut shown = self.shown();
        let size = self.terminal.size();
        if shown.size != Some(size) {
            self.draw(&mut shown, true);
        }
    }

    fn draw(&self, shown: &mut Shown, all: bool) {
        let mut size = self.terminal.size();
        shown.size = Some(size);
        if self.terminal.pictures == TerminalPictures::Sixel {
            size.columns = size.columns.min((WIDEST_SIXEL / size.cell.0).max(1));
        }
        let said: u32 = shown
            .messages
            .iter()
            .map(|text| text.lines().count() as u32)
            .sum();
        let rows = size.rows.saturating_sub(1);
        let picture_rows = rows.saturating_sub(said).max(rows / KEPT_ROWS);
        let all = all || shown.drawn != Some((size, picture_rows));
        // Shown at once, where the terminal can wait for the end.
        let mut text = "\x1b[?2026h".to_owned();
        if shown.drawn.is_some_and(|drawn| drawn != (size, picture_rows)) {
            text.push_str("\x1b[2J");
        }
        shown.drawn = Some((size, picture_rows));
        let mut status_row = picture_rows + 1;
        if let Some(image) = &shown.picture {
            let placed = Placed::of(image, size, picture_rows);
            status_row = placed.rows + 1;
            if all {
                text.push_str("\x1b[H");
                text.push_str(&self.drawn(image, &placed, size));
            }
        } else {
            status_row = status_row.min(1);
        }
        let _ = write!(text, "\x1b[{status_row};1H\x1b[7m{}\x1b[0m\x1b[K", shown.status);
        if all {
            let lines = shown.messages.iter().flat_map(|text| text.lines());
            for line in lines.take(rows.saturating_sub(status_row - 1) as usize) {
                let _ = write!(text, "\r\n{line}\x1b[0m\x1b[K");
            }
            text.push_str("\x1b[J");
        }
        text.push_str("\x1b[?2026l");
        self.terminal.show(&text);
    }

    /// The picture, from where the cursor stands.
    fn drawn(&self, image: &Image, placed: &Placed, size: Size) -> String {
        match self.terminal.pictures {
            TerminalPictures::Kitty => {
                // One picture with one number, put in the place of the last one.
                let placing = format!("i=1,p=1,q=2,C=1,c={},r={},", placed.columns, placed.rows);
                picture::kitty(image, &placing).unwrap_or_default()
            }
            TerminalPictures::Sixel => {
                let (width, height) = (placed.columns * size.cell.0, placed.rows * size.cell.1);
                let pixels = Pixels::of(image).resized(width, height);
                sixel::encode(&pixels)
            }
            _ => {
                let pixels = Pixels::of(image).resized(placed.columns, 2 * placed.rows);
                let lines = picture::half_blocks(&pixels, self.colors);
                lines.replace('\n', "\x1b[K\r\n")
            }
        }
    }

    fn shown(&self) -> MutexGuard<'_, Shown> {
        self.shown.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Where a picture stands, in characters from the upper left corner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Placed {
    columns: u32,
    rows: u32,
}

impl Placed {
    /// As large as fits, with its edges in proportion.
    fn of(image: &Image, size: Size, rows: u32) -> Self {
        let (width, height) = (f64::from(image.width().max(1)), f64::from(image.height().max(1)));
        let (across, down) = (
            f64::from(size.columns * size.cell.0),
            f64::from(rows * size.cell.1),
        );
        let scale = (across / width).min(down / height);
        let cells = |pixels: f64, cell: u32, most: u32| {
            ((pixels * scale / f64::from(cell)).round() as u32).clamp(1, most.max(1))
        };
        Self {
            columns: cells(width, size.cell.0, size.columns),
            rows: cells(height, size.cell.1, rows),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::from_rgb8;

    #[test]
    fn a_picture_fills_what_there_is_in_proportion() {
        let size = Size {
            columns: 100,
            rows: 40,
            cell: (10, 20),
        };
        let placed = |width: u32, height: u32, rows| {
            let image = from_rgb8(width, height, &vec![0; (width * height * 3) as usize]);
            let placed = Placed::of(&image, size, rows);
            (placed.columns, placed.rows)
        };
        assert_eq!(placed(200, 100, 39), (100, 25));
        assert_eq!(placed(10, 10, 39), (78, 39));
        assert_eq!(placed(640, 480, 20), (53, 20));
        assert_eq!(placed(1, 300, 1), (1, 1));
        assert_eq!(placed(80, 60, 20), placed(640, 480, 20));
    }
}
