//! How much a script may use: one struct, every limit with its default and its own error.

use std::time::Duration;

/// Upper bounds on what a script and the scene it builds may use. Each has an error of its own that names the
/// limit, its value and the line.
///
/// ```
/// use rtscript::Limits;
/// let mut limits = Limits::untrusted();
/// // This host has textures for its scripts, and less patience.
/// limits.files = 100;
/// limits.script_time = std::time::Duration::from_secs(1);
/// assert!(limits.primitives < Limits::default().primitives);
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub struct Limits {
    /// Bytes of script text. Default: 32 MiB: several times what a scene of the gallery takes written out flat.
    pub source_bytes: usize,
    /// Operations of the script. Default: 500 million.
    pub operations: u64,
    /// Time that reading the text of a script or a module may take. Default: 10 s.
    pub compile_time: Duration,
    /// Time the script may run, rendering not counted. Default: 60 s. Without a clock (wasm32-unknown-unknown) time
    /// stands still, and `operations` is what ends a script.
    pub script_time: Duration,
    /// Bytes that the script's values may hold, what it puts into the scene not counted. Default: 1 GiB. Looked at after
    /// every step of the script, so a single call may go beyond by what its result takes. Only where the program has
    /// installed a [`Meter`](crate::meter::Meter), as the command has.
    pub script_memory: u64,
    /// Time that the pictures of a run may take, with their trees; `None` is any. Default: any. The same for a render of one's own:
    /// [`RenderOptions::within`](crate::RenderOptions::within).
    pub render_time: Option<Duration>,
    /// Rays of every kind that the pictures of a run may take; `None` is any number. Default: any.
    pub rays: Option<u64>,
    /// Pictures that a script renders itself. Default: 100,000.
    pub pictures: usize,
    /// Whether there are closures, `|x| x + 1`. Default: true. Functions by name,
    /// `list.map(Fn("f"))`, always are.
    pub closures: bool,
    /// Script functions calling one another. Default: 64, also the most where a script has no stack of its own
    /// (wasm32-unknown-unknown).
    pub call_levels: usize,
    /// Nesting of expressions. Default: 64, also the most where a script has no stack of its own.
    pub expression_depth: usize,
    /// Bytes of one string. Default: 1 MiB.
    pub string_bytes: usize,
    /// Elements of one array. Default: 2 million (a mesh from arrays is one array).
    pub array_len: usize,
    /// Entries of one map. Default: 10,000.
    pub map_len: usize,
    /// Variables in scope. Default: 5,000.
    pub variables: usize,
    /// Functions a script defines. Default: 1,000.
    pub functions: usize,
    /// Script files imported, each counted once; 0 turns imports off. Default: 64.
    pub modules: usize,
    /// Levels of `pushTransform` and `group`. Default: 1,024.
    pub transform_depth: usize,
    /// Shapes, triangles of meshes counted each, instances counted once. Default: 20 million.
    pub primitives: usize,
    /// Lights. Default: 4,096.
    pub lights: usize,
    /// Files read. Default: 1,024.
    pub files: usize,
    /// Bytes of one file read. Default: 1 GiB.
    pub file_bytes: u64,
    /// Bytes of all files read. Default: 4 GiB.
    pub total_file_bytes: u64,
    /// Edge of a texture in texels. Default: 16,384.
    pub texture_side: u32,
    /// Bytes an image decoder may take. Default: 1 GiB.
    pub decode_bytes: u64,
    /// Bytes that all pictures which a script reads or makes take as textures, with the copies of them for what is far away.
    /// Default: 4 GiB. Looked at after each, so that one more may go beyond.
    pub total_decode_bytes: u64,
    /// Edge of the picture in pixels. Default: 32,768.
    pub image_side: u32,
    /// Pixels of the picture. Default: 256 million.
    pub pixels: u64,
    /// Rays per pixel. Default: 65,536.
    pub samples: u32,
    /// Secondary bounces. Default: 64, also the largest that can be asked for.
    pub depth: u32,
    /// Bytes a script may print. Default: 16 MiB.
    pub print_bytes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            source_bytes: 32 << 20,
            operations: 500_000_000,
            compile_time: Duration::from_secs(10),
            script_time: Duration::from_secs(60),
            script_memory: 1 << 30,
            render_time: None,
            rays: None,
            pictures: 100_000,
            closures: true,
            call_levels: 64,
            expression_depth: 64,
            string_bytes: 1 << 20,
            array_len: 2_000_000,
            map_len: 10_000,
            variables: 5_000,
            functions: 1_000,
            modules: 64,
            transform_depth: 1_024,
            primitives: 20_000_000,
            lights: 4_096,
            files: 1_024,
            file_bytes: 1 << 30,
            total_file_bytes: 4 << 30,
            texture_side: 16_384,
            decode_bytes: 1 << 30,
            total_decode_bytes: 4 << 30,
            image_side: 32_768,
            pixels: 256_000_000,
            samples: 65_536,
            depth: 64,
            print_bytes: 16 << 20,
        }
    }
}

impl Limits {
    /// Limits for scripts of strangers: seconds of work, megabytes of data.
    #[must_use]
    pub fn untrusted() -> Self {
        Self {
            source_bytes: 256 << 10,
            operations: 10_000_000,
            compile_time: Duration::from_secs(1),
            script_time: Duration::from_secs(5),
            script_memory: 64 << 20,
            render_time: Some(Duration::from_secs(20)),
            rays: Some(200_000_000),
            pictures: 2,
            closures: false,
            call_levels: 32,
            string_bytes: 64 << 10,
            array_len: 10_000,
            map_len: 1_000,
            variables: 256,
            functions: 100,
            modules: 0,
            transform_depth: 256,
            primitives: 200_000,
            lights: 64,
            files: 32,
            file_bytes: 16 << 20,
            total_file_bytes: 64 << 20,
            texture_side: 2_048,
            decode_bytes: 64 << 20,
            total_decode_bytes: 128 << 20,
            image_side: 2_048,
            pixels: 2_000_000,
            samples: 64,
            depth: 8,
            print_bytes: 64 << 10,
            // The same for everyone, and written out so that a new limit is decided for strangers too.
            expression_depth: 64,
        }
    }
}
