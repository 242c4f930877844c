//! `viewer SCENE [PICTURE]`: the window and its keys.
//!
//! Escape closes it, S saves the picture, as `PICTURE` or as the script's name with `.png`. Messages are lines on the
//! terminal. The exit code is 0 after the window was closed, 1 where there is no script to begin with or no window to be
//! had, 2 for wrong arguments.

use std::{
    path::{Path, PathBuf},
    process::ExitCode,
    sync::mpsc::{self, Sender},
    thread,
    time::Duration,
};

use minifb::{InputCallback, Key, ScaleMode, Window, WindowOptions};
use viewer::viewer::{Event, Viewer};

/// Pixels of the largest window that is opened; it may be made larger.
const LARGEST: (usize, usize) = (1600, 1000);
/// Of a window for a script that has not given a picture yet.
const USUAL: (usize, usize) = (640, 480);
/// Looks at files, keys and pixels.
const PER_SECOND: usize = 30;

fn main() -> ExitCode {
    let arguments: Vec<PathBuf> = std::env::args_os().skip(1).map(PathBuf::from).collect();
    let (scene, picture) = match &arguments[..] {
        [scene] => (
            scene,
            PathBuf::from(scene.with_extension("png").file_name().unwrap_or_default()),
        ),
        [scene, picture] => (scene, picture.clone()),
        _ => {
            eprintln!("usage: viewer SCENE [PICTURE]\n  Escape closes the window, S saves the picture");
            return ExitCode::from(2);
        }
    };
    match look(scene, &picture) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

/// Shows the script's picture until the window is closed.
fn look(scene: &Path, picture: &Path) -> Result<(), String> {
    let mut viewer = Viewer::open(scene).map_err(|e| format!("{}: {e}", scene.display()))?;
    let name = scene.file_name().unwrap_or_default().to_string_lossy();
    let mut window = None;
    let (pressed, keys) = mpsc::channel();
    loop {
        let mut has_failed = false;
        for event in viewer.tick() {
            has_failed |= matches!(event, Event::Failed(_));
            tell(&name, &viewer, &event);
        }
        let canvas = viewer.canvas();
        // Its size is known when the script has run.
        let size = canvas.size();
        let window = match &mut window {
            Some(window) => window,
            None if size != (0, 0) => window.insert(open(&name, fitted(size), &pressed)?),
            None if has_failed => window.insert(open(&name, USUAL, &pressed)?),
            None => {
                drop(canvas);
                thread::sleep(Duration::from_millis(5));
                continue;
            }
        };
        let pixels = canvas.pixels().to_vec();
        // The render goes on while the window is drawn.
        drop(canvas);
        if pixels.is_empty() {
            window.update();
        } else {
            let drawn = window.update_with_buffer(&pixels, size.0, size.1);
            drawn.map_err(|e| format!("the window: {e}"))?;
        }
        if !window.is_open() {
            return Ok(());
        }
        for key in keys.try_iter() {
            match key {
                Key::Escape => return Ok(()),
                Key::S => match viewer.save(picture) {
                    Ok(()) => println!("saved {}", picture.display()),
                    Err(message) => eprintln!("not saved: {message}"),
                },
                _ => {}
            }
        }
    }
}

fn tell(name: &str, viewer: &Viewer, event: &Event) {
    match event {
        Event::Printed(text) => println!("{text}"),
        Event::Warning(warning) => eprintln!("{warning}"),
        Event::Failed(message) => eprintln!("{message}"),
        Event::Finished { took } => {
            let (width, height) = viewer.canvas().size();
            println!("{name}: {width} x {height}, {:.2} s", took.as_secs_f64());
        }
    }
}

/// As large as the picture, or as much of that as is usual for a window.
fn fitted((width, height): (usize, usize)) -> (usize, usize) {
    let share = (LARGEST.0 as f64 / width as f64)
        .min(LARGEST.1 as f64 / height as f64)
        .min(1.0);
    let scaled = |length: usize| ((length as f64 * share) as usize).max(1);
    (scaled(width), scaled(height))
}

/// Tells every key that is pressed, however shortly: the window itself only says which are down when it is asked.
struct Pressed(Sender<Key>);

impl InputCallback for Pressed {
    fn add_char(&mut self, _character: u32) {}

    fn set_key_state(&mut self, key: Key, is_down: bool) {
        if is_down {
            // The other end lives as long as the window.
            let _ = self.0.send(key);
        }
    }
}

fn open(name: &str, (width, height): (usize, usize), pressed: &Sender<Key>) -> Result<Window, String> {
    let options = WindowOptions {
        resize: true,
        scale_mode: ScaleMode::AspectRatioStretch,
        ..WindowOptions::default()
    };
    let mut window = Window::new(name, width, height, options).map_err(|e| format!("no window: {e}"))?;
    window.set_target_fps(PER_SECOND);
    window.set_input_callback(Box::new(Pressed(pressed.clone())));
    Ok(window)
}
