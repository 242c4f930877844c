//! What several commands take.

use clap::Args;

use crate::{
    cli::range,
    parameters::{Parameters, parse_region, parse_size},
};

/// What is decided on the command line instead of in the scene.
#[derive(Debug, Args)]
pub(in crate::cli) struct Overrides {
    /// Size of the picture in pixels, such as 640x480, in place of the scene's
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    pub(in crate::cli) size: Option<(u32, u32)>,

    /// Rays per pixel, in place of the scene's
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    pub(in crate::cli) samples: Option<u32>,

    /// Seed of every random choice, in place of the scene's
    #[arg(long, value_name = "N", allow_negative_numbers = true)]
    pub(in crate::cli) seed: Option<u64>,

    /// Part of the picture to render, such as 10,20,64x48 for 64x48 pixels from column 10 and row 20 on
    #[arg(long, value_name = "X,Y,WxH", value_parser = parse_region_value)]
    pub(in crate::cli) region: Option<Region>,

    #[command(flatten)]
    pub(in crate::cli) define: Defines,
}

/// A part of the picture: first column, first row, columns, rows. A list would mean to clap that there may be several.
#[derive(Clone, Copy, Debug)]
pub(in crate::cli) struct Region([u32; 4]);

fn parse_region_value(text: &str) -> Result<Region, String> {
    parse_region(text).map(Region)
}

impl Overrides {
    pub(in crate::cli) fn parameters(&self) -> Parameters {
        let mut parameters = self.define.parameters();
        parameters.size = self.size.or(parameters.size);
        parameters.samples = self.samples.or(parameters.samples);
        parameters.seed = self.seed.or(parameters.seed);
        parameters.region = self.region.map(|Region(region)| region).or(parameters.region);
        parameters
    }
}

/// Parameters of the script.
#[derive(Debug, Args)]
pub(in crate::cli) struct Defines {
    /// Value of a parameter that the script declares by param(name, default); rtscript params lists them
    #[arg(short = 'D', long = "define", value_name = "NAME=VALUE", value_parser = parse_define)]
    define: Vec<(String, String)>,
}

impl Defines {
    pub(in crate::cli) fn parameters(&self) -> Parameters {
        let mut parameters = Parameters::default();
        for (name, value) in &self.define {
            // What cannot be set was refused when it was parsed.
            let _ = parameters.set(name, value);
        }
        parameters
    }
}

/// `radius=0.5` to name and value, both as they may be.
fn parse_define(text: &str) -> Result<(String, String), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or("expected NAME=VALUE, such as radius=0.5")?;
    Parameters::default().set(name, value)?;
    Ok((name.to_owned(), value.to_owned()))
}

/// `radius=0.1..1:10` to the name and all values.
pub(super) fn parse_values(text: &str) -> Result<(String, Vec<String>), String> {
    let (name, list) = text
        .split_once('=')
        .ok_or("expected NAME=VALUES, such as radius=0.1..1:10")?;
    let values = range::values(list)?;
    for value in &values {
        Parameters::default().set(name, value)?;
    }
    Ok((name.to_owned(), values))
}

/// How many threads render.
#[derive(Debug, Args)]
pub(in crate::cli) struct Threads {
    /// Threads to render with; the picture is the same for any number [default: one for each processor]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
}

impl Threads {
    /// As [`RenderOptions`](crate::RenderOptions) want it: 0 where nothing is said.
    pub(in crate::cli) fn count(&self) -> usize {
        self.threads.map_or(0, usize::from)
    }
}
