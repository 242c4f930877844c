//! What functions of the language are for, and what their parameters take.

/// Where the reference lists an entry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Size, samples, background, camera.
    Camera,
    /// The matrix stack and blocks.
    Transform,
    /// Shapes.
    Shapes,
    /// Solids as fields.
    Fields,
    /// The material state and textures.
    Materials,
    /// Meshes and pictures from files and arrays.
    Assets,
    /// Lights.
    Lights,
    /// What there is so far.
    Queries,
    /// Rendering.
    Output,
    /// What the caller may decide.
    Parameters,
    /// Vectors.
    Vectors,
    /// Numbers.
    Maths,
    /// Curves through points.
    Curves,
    /// Lists of values.
    Lists,
    /// Random numbers.
    Random,
}

impl Group {
    /// All groups, in the order of the reference.
    pub const ALL: [Self; 15] = [
        Self::Camera,
        Self::Transform,
        Self::Shapes,
        Self::Fields,
        Self::Materials,
        Self::Assets,
        Self::Lights,
        Self::Queries,
        Self::Output,
        Self::Parameters,
        Self::Vectors,
        Self::Maths,
        Self::Curves,
        Self::Lists,
        Self::Random,
    ];

    /// Its heading in the reference.
    ///
    /// ```
    /// use rtscript::script::{Group, Kind};
    /// assert!(!Group::Shapes.title().is_empty() && !Group::Shapes.doc().is_empty());
    /// // Where a point is wanted, three numbers do; where a number is wanted, they do not.
    /// assert!(Kind::Vec3.spreads() && !Kind::Number.spreads());
    /// assert!(!Kind::Vec3.doc().is_empty());
    /// ```
    #[must_use]
    pub const fn title(self) -> &'static str {
        match self {
            Self::Camera => "Picture and camera",
            Self::Transform => "Transformations and blocks",
            Self::Shapes => "Shapes",
            Self::Fields => "Distance fields and isosurfaces",
            Self::Materials => "Materials and colors",
            Self::Assets => "Meshes and pictures from files",
            Self::Lights => "Lights",
            Self::Queries => "Asking about the scene",
            Self::Output => "Rendering",
            Self::Parameters => "Parameters",
            Self::Vectors => "Vectors",
            Self::Maths => "Numbers",
            Self::Curves => "Curves",
            Self::Lists => "Lists",
            Self::Random => "Random numbers and noise",
        }
    }

    /// What its functions have in common.
    #[must_use]
    pub const fn doc(self) -> &'static str {
        match self {
            Self::Camera => {
                "What the picture is and from where it is taken. Where one of these is called more than once, the last \
                 call before the picture is rendered counts."
            }
            Self::Transform => {
                "The current matrix says where shapes and lights go that are made from now on; each shape keeps the one \
                 it was made under. The call nearest the shape acts first, as in OpenGL: translate, then rotate, then a \
                 shape is a shape that is turned and then moved. group { } ends what was begun in it."
            }
            Self::Shapes => {
                "All but spheres, triangles and polygons are centered at the origin with their axis along Y, and without \
                 arguments as large as the unit cube, so that scale(w, h, d) gives their size. Any of them may be \
                 moved, turned, stretched and sheared. Surfaces are seen from both sides."
            }
            Self::Fields => {
                "Solids told by a number at every point, negative inside, about the distance outside. They are values: made, \
                 moved, bent, joined by | & and - or blended, and seen once isosurface(solid) makes a shape of them."
            }
            Self::Materials => {
                "The material is a state: it counts for all shapes made from now on, and group { } restores it. A point \
                 has the color Ka + Ke + the sum over the lights of V L (Kd max(N.L, 0) + Ks max(N.H, 0)^s) + Kr times \
                 what its mirror sees + Kt times what is seen through it. L is the light, V how much of it arrives, N \
                 the normal, H the direction halfway between light and eye, s the shininess. fresnel, conductor, roughness, \
                 multiscatter, orenNayar, clearCoat, absorption, dispersion, bump and normalMap go beyond that. A texture, \
                 which is a picture, a pattern or made of such, may stand for any color or number."
            }
            Self::Assets => "Files are read below the script's folder only. The same file is read once.",
            Self::Lights => {
                "Lights stand under the current matrix, as shapes do. What is opaque blocks them, what is transparent \
                 tints them. Without any light, shapes show their ambient color and what they mirror."
            }
            Self::Output => {
                "A script that renders nothing itself is rendered once when it ends. One that does can make several \
                 pictures, and look at them."
            }
            Self::Queries => {
                "Where things are, while the script is still building: trees can stand on a landscape that is there \
                 already. Asked of a name, they look at what define \"name\" { } made, in its own object space; without \
                 one, at what was made so far, in the space of the scene or, inside define and moving, of the block. The current \
                 matrix does not count, and what moves is where its motion begins."
            }
            Self::Parameters => "What the one who runs the script may decide, and what it is otherwise.",
            Self::Vectors => "Points, directions and colors: three numbers that can be calculated with.",
            Self::Maths => {
                "The same bits on every machine. Angles are in radians here. Two whole numbers divided give a whole \
                 number: 1 / 2 is 0, 1 / 2.0 is 0.5."
            }
            Self::Curves => {
                "Smooth ways through points, for whatever moves or stands along them. A curve is a value: ask it for a \
                 position, a direction, or points evenly apart."
            }
            Self::Lists => {
                "Beside what arrays bring along: len, push, pop, insert, remove, map, filter, reduce, sort, reverse, \
                 contains, index_of and more of Rhai's."
            }
            Self::Random => {
                "The same numbers at each run and on every machine; another seed(n) gives others."
            }
        }
    }
}

/// What a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// An int or a float.
    Number,
    /// A whole number.
    Int,
    /// `[x, y, z]`, a `vec3`, or three numbers in its place.
    Vec3,
    /// A vector in scene-linear RGB, three numbers in its place, or `"#rrggbb"`.
    Color,
    /// A color or a texture.
    Term,
    /// A number or a vector.
    NumberOrVec3,
    /// A number or a texture.
    NumberOrTexture,
    /// A string.
    String,
    /// An array.
    Array,
    /// An array, or a blob of floats as `write_le` writes them.
    List,
    /// `#{ }` with known keys.
    Map,
    /// A picture.
    Image,
    /// Random numbers of their own.
    Stream,
    /// A curve.
    Curve,
    /// A function: `|x| x + 1` or `Fn("name")`.
    Function,
    /// A solid as a field.
    Sdf,
    /// A field, or a function of the coordinates.
    Field,
    /// A block of statements.
    Block,
    /// A number, a string, true or false.
    Any,
}

impl Kind {
    /// All kinds, in the order of the reference.
    pub const ALL: [Self; 19] = [
        Self::Number,
        Self::Int,
        Self::Vec3,
        Self::Color,
        Self::Term,
        Self::NumberOrVec3,
        Self::NumberOrTexture,
        Self::String,
        Self::Array,
        Self::List,
        Self::Map,
        Self::Image,
        Self::Stream,
        Self::Curve,
        Self::Function,
        Self::Sdf,
        Self::Field,
        Self::Block,
        Self::Any,
    ];

    /// True where three numbers may stand in its place.
    #[must_use]
    pub const fn spreads(self) -> bool {
        matches!(self, Self::Vec3 | Self::Color | Self::Term)
    }

    /// As the reference and editors name it.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Number => "number",
            Self::Int => "int",
            Self::Vec3 => "vec3",
            Self::Color => "color",
            Self::Term => "color | texture",
            Self::NumberOrVec3 => "number | vec3",
            Self::NumberOrTexture => "number | texture",
            Self::String => "string",
            Self::Array => "array",
            Self::List => "array | blob",
            Self::Map => "map",
            Self::Image => "image",
            Self::Stream => "random stream",
            Self::Curve => "curve",
            Self::Function => "Fn",
            Self::Sdf => "sdf",
            Self::Field => "field | function",
            Self::Block => "block",
            Self::Any => "any",
        }
    }

    /// What may be written for it.
    #[must_use]
    pub const fn doc(self) -> &'static str {
        match self {
            Self::Number => {
                "A whole number or one with a point, such as 2 or 0.5: either will do everywhere."
            }
            Self::Int => "A whole number, such as 640.",
            Self::Vec3 => "A vector: [1, 2, 3], vec3(1, 2, 3), or the three numbers in its place.",
            Self::Color => {
                "Red, green and blue in scene-linear light, as a vector or three numbers, 1 being full and more \
                 allowed; or \"#rrggbb\", \"#rgb\" as on a screen (sRGB)."
            }
            Self::Term => "A color, or a texture: what checker(a, b, size) or image(file) returns.",
            Self::NumberOrVec3 => "One number for all three components, or a vector.",
            Self::NumberOrTexture => {
                "A number, or a texture for one that varies: the mean of red, green and blue."
            }
            Self::String => "Text in double quotes.",
            Self::Array => "A list in brackets, such as [1, 2, 3].",
            Self::List => "A list in brackets, or a blob of floats as write_le writes them.",
            Self::Map => "Names and values: #{ min: 0, max: 2 }. A name that is not known is an error.",
            Self::Image => "A picture: what render() or image(file) returns.",
            Self::Stream => "What randomStream(name) returns.",
            Self::Curve => "What catmullRom(points) or bezier(points) returns.",
            Self::Function => "A function: |x| x * 2, or Fn(\"name\") for one that the script defines.",
            Self::Sdf => {
                "A solid as a distance field: what sdfSphere(radius) and its like return, joined by | & and -."
            }
            Self::Field => {
                "A function |x, y, z| of the coordinates, called once with fields in their place, which + - * / ** and the \
                 functions sin, cos, sqrt, abs, min, max and noise take; or a field, a number, a solid."
            }
            Self::Block => "Statements in braces.",
            Self::Any => "A number, a string, true or false.",
        }
    }
}
