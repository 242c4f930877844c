//! Height fields.

use std::sync::Arc;

use rhai::{Array, Dynamic, FnPtr};

use super::{assets::with_assets, map, string};
use crate::{
    color::{Color, luminance},
    diag::ErrorKind,
    host::Host,
    scene::{ImageTexture, Mesh, SceneError, Texels},
    script::{
        call::{Call, kind_of, number_of},
        caller::{Caller, Failure},
        lists::number,
        options::Options,
        session::State,
        table::{Entry, Group, Kind, Param},
        value::{ImageValue, Outcome},
    },
    tessellate::{Allowance, HeightField, Heights},
};

const KEYS: [&str; 5] = ["base", "columns", "rows", "smooth", "solid"];
const OPTIONS: Param = map(
    "options",
    "columns and rows of the grid, 65 each, for a function alone; smooth: whether it is shaded smoothly, true; solid: whether it has walls and a floor, false; base: the height of that floor, -0.1",
)
.or("#{ }")
.keys(&KEYS);
const FUNCTION: Param = Param::new(
    "f",
    Kind::Function,
    "object units",
    "the height over x and z, each from -0.5 to 0.5",
);

pub(super) const ENTRIES: &[Entry] = &[Entry::calling(Group::Assets, "heightField", height_field)
    .takes(&[
        &[FUNCTION, OPTIONS],
        &[string("file", "a PNG or JPEG picture: black is 0, white 1; 16 bits are kept"), OPTIONS],
        &[Param::new("image", Kind::Image, "none", "a picture, a height for each pixel"), OPTIONS],
        &[Param::new("heights", Kind::Array, "object units", "rows of numbers, the far row first"), OPTIONS],
    ])
    .doc("A landscape over the unit square, x and z from -0.5 to 0.5, with heights along y: from a function of the script, a picture, or rows of numbers. The top of a picture is the far side, z = -0.5, and a texture of the same picture lies as its heights do. scale(w, h, d) gives it its size. solid: true closes it, so that it can be glass or a part of other solids.")
    .usage("heightField(|x, z| 0.1 * sin(20 * x) * cos(20 * z))")
    .example("background(\"#cfe3f5\");\nambient(0.04, 0.05, 0.07);\ncamera([0, 2.2, 4.2], [0, -0.4, 0], [0, 1, 0], 36);\ndirectional([-3, 2.5, 1.5], [0.95, 0.9, 0.8]);\ndiffuse(0.45, 0.55, 0.3);\nscale(4, 2, 4);\nheightField(|x, z| {\n  let r = sqrt(x * x + z * z);\n  0.35 * exp(-9 * r * r) * (1 + 0.5 * sin(40 * r)) + 0.05 * noise(9 * x, 0, 9 * z)\n}, #{ solid: true });")
    .also(&["height_field", "terrain", "landscape", "heightmap", "displace", "elevation"])];

/// Puts a mesh into the scene, counted as the scene's.
pub(super) fn place(caller: &Caller<'_, '_>, mesh: &Mesh) -> Result<Dynamic, Failure> {
    // Copied under the count of what is the scene's: what was made on the way was the script's, and is gone.
    caller.build(|state| Ok(state.builder.mesh(&Arc::new(mesh.clone()))?))?;
    Ok(Dynamic::UNIT)
}

/// What `make` makes within the limits and the time of the run.
pub(super) fn within<T>(
    caller: &Caller<'_, '_>,
    make: impl FnOnce(&Allowance<'_>) -> Result<T, SceneError>,
) -> Outcome<T> {
    caller.with(|state| made(state, make))
}

/// As [`within`], for those who have the state.
pub(super) fn made<T>(
    state: &State,
    make: impl FnOnce(&Allowance<'_>) -> Result<T, SceneError>,
) -> Outcome<T> {
    let host = state.timed_host();
    let stop = || host.should_stop();
    make(&Allowance::of(&state.limits).asking(&stop)).map_err(|error| {
        if error.kind == ErrorKind::Cancelled && !state.host.should_stop() {
            return state.too_long();
        }
        error.into()
    })
}

fn height_field(call: &mut Call<'_, '_>, caller: &Caller<'_, '_>) -> Result<Dynamic, Failure> {
    let given = call.any()?.clone();
    let options = match call.rest() {
        0 => None,
        _ => Some(call.any()?),
    };
    call.end()?;
    let options = Options::new(call, options, &KEYS)?;
    let base = options.number("base")?;
    let solid = options.flag("solid", base.is_some())?;
    let smooth = options.flag("smooth", true)?;
    let of_pixels = given.is_string() || given.read_lock::<ImageValue>().is_some();
    let function = given.clone().try_cast::<FnPtr>();
    if function.is_none()
        && let Some(key) = ["columns", "rows"].iter().find(|key| options.get(key).is_some())
    {
        let what = kind_of(&given);
        return Err(call
            .error(format!(
                "{key} is for heights from a function; {what} has its own"
            ))
            .into());
    }
    let heights = if let Some(f) = function {
        let most = caller.with(|state| Ok(state.limits.texture_side as usize))?;
        let columns = options.count("columns", 2, most)?.unwrap_or(65);
        let rows = options.count("rows", 2, most)?.unwrap_or(65);
        of_function(call, caller, &f, columns, rows)?
    } else if let Some(image) = given.read_lock::<ImageValue>() {
        match image.image() {
            Some(image) => of_image(image)?,
            None => return Err(call.wrong_kind("image", "an image", &given).into()),
        }
    } else if let Ok(file) = given.clone().into_immutable_string() {
        let (columns, rows, values) = caller.with(|state| {
            with_assets(state, &file, |path, assets, _| {
                assets.levels(path).map_err(Box::new)
            })
        })?;
        Heights::new(columns, rows, values)?
    } else if let Some(rows) = given.read_lock::<Array>() {
        of_rows(call, &rows)?
    } else {
        return Err(call
            .wrong_kind("f", "a function, a picture or rows of numbers", &given)
            .into());
    };
    let field = HeightField {
        heights,
        smooth,
        of_pixels,
        base: solid.then(|| base.unwrap_or(-0.1)),
    };
    let mesh = within(caller, |allowance| field.mesh(allowance)).map_err(|mut error| {
        error.message = format!("heightField: {}", error.message);
        error
    })?;
    place(caller, &mesh)
}

fn of_function(
    call: &Call<'_, '_>,
    caller: &Caller<'_, '_>,
    f: &FnPtr,
    columns: usize,
    rows: usize,
) -> Result<Heights, Failure> {
    let count = columns.saturating_mul(rows);
    within(caller, |allowance| allowance.triangles(count))?;
    let mut values = Vec::with_capacity(count);
    for row in 0..rows {
        for column in 0..columns {
            let (x, z) = Heights::place(columns, rows, column, row);
            let height = caller.call(f, (x, z), || {
                call.error("f must take two numbers, x and z")
                    .hint(format!("for example {}", call.entry.usage))
            })?;
            values.push(match number_of(&height) {
                Some(height) if height.is_finite() => height,
                Some(height) => {
                    return Err(call
                        .error(format!(
                            "f must give a finite number, but f({x}, {z}) is {}",
                            if height.is_nan() { "NaN" } else { "infinite" }
                        ))
                        .into());
                }
                None => {
                    let what = kind_of(&height);
                    return Err(call
                        .error(format!("f must give a number, but f({x}, {z}) gives {what}"))
                        .hint("for example |x, z| 0.1 * sin(20 * x), without a ';' at the end")
                        .into());
                }
            });
        }
    }
    Ok(Heights::new(columns, rows, values)?)
}

/// Bytes count as they are stored, light by how bright it is.
fn of_image(image: &ImageTexture) -> Result<Heights, SceneError> {
    let values = match &image.texels {
        Texels::Srgb8(texels) => texels
            .iter()
            .map(|texel| luminance(Color::from_array(texel.map(f64::from))) / 255.0)
            .collect(),
        Texels::Linear(texels) => texels
            .iter()
            .map(|texel| luminance(Color::from_array(*texel)))
            .collect(),
    };
    Heights::new(image.width as usize, image.height as usize, values)
}

fn of_rows(call: &Call<'_, '_>, rows: &Array) -> Outcome<Heights> {
    let mut values = Vec::new();
    let mut columns = None;
    for (i, row) in rows.iter().enumerate() {
        let Some(row) = row.read_lock::<Array>() else {
            return Err(call
                .error(format!(
                    "heights[{i}] must be an array of numbers, not {}",
                    kind_of(row)
                ))
                .hint("for example heightField([[0, 0, 0], [0, 1, 0], [0, 0, 0]])"));
        };
        let wanted = *columns.get_or_insert(row.len());
        if row.len() != wanted {
            return Err(call.error(format!(
                "heights[{i}] has {} number{}, but the rows before have {wanted}",
                row.len(),
                if row.len() == 1 { "" } else { "s" }
            )));
        }
        for (j, d) in row.iter().enumerate() {
            values.push(number(call, || format!("heights[{i}][{j}]"), d)?);
        }
    }
    Ok(Heights::new(columns.unwrap_or(0), rows.len(), values)
        .map_err(|error| error.of(format_args!("heightField")))?)
}
