//! Tiles and pictures on the canvas.

use rtscript::{Image, render::Tile, scene::Encoding};
use viewer::canvas::Canvas;

#[test]
fn tiles_go_to_their_places() {
    let mut canvas = Canvas::default();
    canvas.begin(3, 2, Encoding::Srgb);
    let empty = canvas.pixels()[0];
    let pixels = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0; 3]];
    canvas.tile(&Tile {
        x: 1,
        y: 0,
        width: 2,
        height: 2,
        pixels: &pixels,
    });
    assert_eq!(
        canvas.pixels(),
        [empty, 0xff0000, 0x00ff00, empty, 0x0000ff, 0xffffff]
    );
    // What reaches beyond is left out.
    canvas.tile(&Tile {
        x: 2,
        y: 1,
        width: 2,
        height: 2,
        pixels: &[[0.0; 3]; 4],
    });
    canvas.tile(&Tile {
        x: 7,
        y: 7,
        width: 2,
        height: 2,
        pixels: &[[0.0; 3]; 4],
    });
    assert_eq!(
        canvas.pixels(),
        [empty, 0xff0000, 0x00ff00, empty, 0x0000ff, 0x000000]
    );
}

#[test]
fn what_was_there_stays_until_it_is_drawn_over() {
    let mut canvas = Canvas::default();
    canvas.begin(1, 1, Encoding::Srgb);
    canvas.tile(&Tile {
        x: 0,
        y: 0,
        width: 1,
        height: 1,
        pixels: &[[1.0; 3]],
    });
    canvas.begin(1, 1, Encoding::Srgb);
    assert_eq!(canvas.pixels(), [0xffffff]);
    // Of another size it is another picture.
    canvas.begin(2, 1, Encoding::Srgb);
    assert!(canvas.pixels().iter().all(|pixel| *pixel != 0xffffff));
}

#[test]
fn a_coarse_picture_covers_all() {
    let mut canvas = Canvas::default();
    canvas.begin(5, 2, Encoding::Srgb);
    canvas.fill(&Image::new(
        2,
        1,
        Encoding::Srgb,
        vec![[1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
    ));
    let row = [0xff0000, 0xff0000, 0xff0000, 0x0000ff, 0x0000ff];
    assert_eq!(canvas.pixels(), row.repeat(2));
}
