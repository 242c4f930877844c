//! The corpus as a WebAssembly module that imports nothing. The embedder writes the corpus where [`room`] says, calls
//! [`load`], then [`render`] for each scene, and reads [`length`] bytes of text where that says.

use std::sync::Mutex;

use rtscript::RunOptions;

use crate::Corpus;

struct State {
    room: Vec<u8>,
    corpus: Corpus,
    scenes: Vec<String>,
    line: String,
}

static STATE: Mutex<State> = Mutex::new(State {
    room: Vec::new(),
    corpus: Corpus {
        files: std::collections::BTreeMap::new(),
    },
    scenes: Vec::new(),
    line: String::new(),
});

/// Makes room for `length` bytes and says where.
#[unsafe(no_mangle)]
extern "C" fn room(length: usize) -> *mut u8 {
    STATE.lock().map_or(std::ptr::null_mut(), |mut state| {
        state.room = vec![0; length];
        state.room.as_mut_ptr()
    })
}

/// Takes the corpus that was written and returns the number of its scenes.
#[unsafe(no_mangle)]
extern "C" fn load() -> usize {
    STATE.lock().map_or(0, |mut state| {
        let room = std::mem::take(&mut state.room);
        state.corpus = Corpus::from_bytes(&room).unwrap_or_default();
        state.scenes = state.corpus.scenes();
        state.scenes.len()
    })
}

/// The path of a scene, as [`render`] returns its text.
#[unsafe(no_mangle)]
extern "C" fn path(scene: usize) -> *const u8 {
    STATE.lock().map_or(std::ptr::null(), |mut state| {
        state.line = state.scenes.get(scene).cloned().unwrap_or_default();
        state.line.as_ptr()
    })
}

/// Renders a scene and says where its line of text is.
#[unsafe(no_mangle)]
extern "C" fn render(scene: usize) -> *const u8 {
    STATE.lock().map_or(std::ptr::null(), |mut state| {
        let path = state.scenes.get(scene).cloned().unwrap_or_default();
        state.line = state.corpus.line(&path, &RunOptions::default());
        state.line.as_ptr()
    })
}

/// Bytes of the last text.
#[unsafe(no_mangle)]
extern "C" fn length() -> usize {
    STATE.lock().map_or(0, |state| state.line.len())
}
