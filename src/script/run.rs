//! What a run is given and what it leaves behind.

use std::{collections::BTreeMap, fmt};

use crate::{
    import::KeptAssets,
    parameters::{Declared, Parameters},
    render::{Image, RenderOptions, RenderStats},
    scene::{self, AssetFiles, Region, Scene},
};

/// What the caller decides instead of the script. Where it is `None`, the script's own calls count.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, Script};
/// let script = Script::compile("a.rhai", "size(640, 480); sphere(0, 0, 0, 1);", &Limits::default())?;
/// let mut options = RunOptions::default();
/// options.size = Some((64, 48));
/// let settings = script.run(&NoHost, &options)?.value.scene.settings;
/// assert_eq!((settings.width, settings.height), (64, 48));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, Default)]
#[non_exhaustive]
pub struct RunOptions {
    /// Picture size in pixels; `size(width, height)` then does nothing.
    pub size: Option<(u32, u32)>,
    /// Rays per pixel; `samples(n)` then does nothing.
    pub samples: Option<u32>,
    /// Seed; `seed(n)` then does nothing.
    pub seed: Option<u64>,
    /// The part of the picture that is rendered; `crop(...)` then does nothing.
    pub region: Option<Region>,
    /// Values of the parameters that the script declares by `param(name, default)`, as text: `"0.5"`, `"true"`.
    pub parameters: BTreeMap<String, String>,
    /// `render()` traces a single ray and gives a picture of that color: for a run of which only the scene counts.
    pub dry: bool,
    /// Looks for what is wrong with the script beyond what a run comes by, and adds it to the warnings: lines that never
    /// ran, and calls there of functions that there are not.
    pub lint: bool,
    /// How `render()` renders.
    pub render: RenderOptions,
    /// Meshes and textures kept from one run to the next, for runs of nearly the same script; the scene is the same with
    /// and without.
    pub assets: Option<KeptAssets>,
}

impl From<&Parameters> for RunOptions {
    fn from(parameters: &Parameters) -> Self {
        Self {
            size: parameters.size,
            samples: parameters.samples,
            seed: parameters.seed,
            region: parameters
                .region
                .map(|[x, y, width, height]| Region { x, y, width, height }),
            parameters: parameters.values.clone(),
            ..Self::default()
        }
    }
}

/// What a script leaves behind.
///
/// ```
/// use rtscript::{Host, Image, Limits, RunOptions, Script, host::HostError, script::{Picture, Run}};
/// struct Album;
/// impl Host for Album {
///     fn read(&self, path: &str, _: u64) -> Result<Vec<u8>, HostError> {
///         rtscript::NoHost.read(path, 0)
///     }
///     fn write_image(&self, _: &str, _: &Image) -> Result<(), HostError> {
///         Ok(())
///     }
/// }
/// let text = r#"size(4, 3); render("first.png"); sphere(0, 0, 0, 1);"#;
/// let run: Run = Script::compile("a.rhai", text, &Limits::default())?.run(&Album, &RunOptions::default())?.value;
/// let first: &Picture = &run.pictures[0];
/// assert_eq!(first.name.as_deref(), Some("first.png"));
/// assert_eq!(run.scene.root().objects.len(), 1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Run {
    /// The scene as it stands at the end.
    pub scene: Scene,
    /// What its `render()` calls made, in order. Empty where it never calls it: render [`Run::scene`] then.
    pub pictures: Vec<Picture>,
    /// The parameters that it declared, in order.
    pub parameters: Vec<Declared>,
    /// Which files stand behind the scene's textures and meshes.
    pub(crate) files: AssetFiles,
    /// Where the run ended at a call that was looked for, how it came there.
    pub(crate) calls: Vec<CallSite>,
}

impl Run {
    /// Writes the scene as a script of its own, which gives a scene of the same [`Scene::hash`]: the language's own
    /// calls, one entity a line, without loops, variables or functions; textures stand in constants, so that what shares
    /// one shares it. Instances stay instances. Files that the scene was made from are named as they are, relative to
    /// the folder of the scene, so the text belongs there.
    ///
    /// With `places` each line that makes something ends in a comment that says where the scene's script makes it.
    /// Without, the text depends on nothing but the scene and the names of its groups and files.
    ///
    /// ```
    /// use rtscript::{Limits, NoHost, RunOptions, Script};
    /// let text = "for x in 0..2 { sphere(x, 0, 0, 0.5); }";
    /// let script = Script::compile("a.rhai", text, &Limits::default())?;
    /// let run = script.run(&NoHost, &RunOptions::default())?.value;
    /// let mut flat = String::new();
    /// let _ = run.write_source(true, &mut flat);
    /// assert!(flat.ends_with("sphere(0, 0, 0, 0.5); // a.rhai:1:17\nsphere(1, 0, 0, 0.5); // a.rhai:1:17\n"));
    /// # Ok::<(), rtscript::Error>(())
    /// ```
    ///
    /// # Errors
    /// Whatever `out` answers.
    pub fn write_source(&self, places: bool, out: &mut dyn fmt::Write) -> fmt::Result {
        scene::write_source(&self.scene, &self.files, places, out)
    }

    /// Which files stand behind the scene's textures and meshes.
    #[must_use]
    pub fn files(&self) -> &AssetFiles {
        &self.files
    }
}

/// A place in a script from which something was called.
///
/// ```
/// use rtscript::{Limits, NoHost, RunOptions, Script, scene::GroupId, script::CallSite};
/// let text = "fn ball() {\n    sphere(0, 0, 0, 1);\n}\nball();\n";
/// let script = Script::compile("a.rhai", text, &Limits::default())?;
/// let options = RunOptions::default();
/// let scene = script.run(&NoHost, &options)?.value.scene;
/// // How the first object of the root came to be.
/// let calls: Vec<CallSite> = script.call_stack(&NoHost, &options, &scene, (GroupId(0), 0))?;
/// assert!(calls.iter().any(|call| call.line == 4));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct CallSite {
    /// The function that the call stands in, or `a closure`; `None` outside all functions.
    pub function: Option<String>,
    /// The file as its reader knows it.
    pub file: String,
    /// Line, from 1; 0 where unknown.
    pub line: u32,
    /// Column in characters, from 1; 0 where unknown.
    pub column: u32,
    /// It is an import of a module, whose code outside functions made the call, not a call.
    pub imports: bool,
}

/// A picture that a script rendered.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Picture {
    /// The name it was written under, if any.
    pub name: Option<String>,
    /// The picture.
    pub image: Image,
    /// What rendering it took.
    pub stats: RenderStats,
}
