//! A program whose scripts call its own functions and find their files in its memory: no folder, no file system.
//!
//! `cargo run --example assets -- picture.png`

#![allow(clippy::print_stdout, reason = "a program may print")]

use std::{error::Error, path::Path, sync::Arc};

use rtscript::{
    DVec3, Limits, MemoryHost, RenderOptions, RunOptions, Script, Term, output, render,
    scene::SceneError,
    script::{
        Language, build,
        rhai::{Array, EvalAltResult, NativeCallContext},
    },
};

/// What the program knows and scripts ask for.
struct Stock {
    name: &'static str,
    prices: Vec<f64>,
}

const SCRIPT: &str = r#"
import "style" as style;

size(160, 120);
camera(vec3(0, 4, 14), vec3(0, 1.5, 0), vec3(0, 1, 0), 40);
style::studio();
let prices = prices("ACME");
for i in 0..prices.len() {
    pushTransform();
    translate(i - prices.len() / 2.0, 0, 0);
    bar(prices[i]);
    popTransform();
}
translate(0, 2, -5);
diffuse(0.8, 0.75, 0.6);
mesh("card.obj");
"#;

const STYLE: &str = "fn studio() { directional(-1, 2, 3, 0.7, 0.7, 0.7); background(0.3, 0.4, 0.55); ambient(0.05, 0.05, 0.05); diffuse(0.3, 0.32, 0.35); plane(); }";

const CARD: &str = "v -7 -3 0\nv 7 -3 0\nv 7 3 0\nv -7 3 0\nf 1 2 3 4\n";

fn main() -> Result<(), Box<dyn Error>> {
    let stocks = Arc::new([Stock {
        name: "ACME",
        prices: vec![1.0, 1.5, 1.2, 2.4, 3.0, 2.2, 3.6],
    }]);

    let mut language = Language::new();
    language.engine_mut(move |engine| {
        let stocks = Arc::clone(&stocks);
        // An error says what is wrong; its place in the script is added.
        engine.register_fn("prices", move |name: &str| -> Result<Array, Box<EvalAltResult>> {
            let stock = stocks.iter().find(|stock| stock.name == name);
            let stock = stock.ok_or_else(|| format!("there is no stock {name:?}; there is \"ACME\""))?;
            Ok(stock.prices.iter().map(|price| (*price).into()).collect())
        });
        // A shape made of others, under the script's matrix: red where it is high.
        engine.register_fn("bar", |ctx: NativeCallContext, height: f64| {
            build(&ctx, |b| {
                if !(height > 0.0) {
                    return Err(SceneError::new(format!("a bar is higher than 0, not {height}")));
                }
                let before = b.material().clone();
                b.material_mut().diffuse = Term::color(DVec3::new(0.9, 0.15 + 0.5 / height, 0.1));
                let size = DVec3::new(0.8, height, 0.8);
                b.push_transform()?;
                b.translate(DVec3::Y * height / 2.0)?;
                b.shape(rtscript::shape::Shape::Cuboid(rtscript::shape::Cuboid::new(
                    size,
                )?))?;
                b.pop_transform()?;
                b.set_material(before);
                Ok(())
            })
        });
    });

    let host = MemoryHost::new().with("style.rhai", STYLE).with("card.obj", CARD);
    // The script may be anybody's, but it may import what the program has for it.
    let mut limits = Limits::untrusted();
    limits.modules = 4;
    let script = Script::compile_in(&language, "report", SCRIPT, &limits)?;
    let run = script.run(&host, &RunOptions::default())?;
    let rendered = render(&run.value.scene, &RenderOptions::default(), &host)?;
    let picture = std::env::args().nth(1);
    output::save(
        Path::new(picture.as_deref().unwrap_or("assets.png")),
        &rendered.value.image,
    )?;
    println!("{}", rendered.value.image.hash());
    Ok(())
}
