//! Light from all around: what a direction looks like, and directions that are bright.

use crate::{
    color::Color,
    math::{self, DVec2, DVec3, PI},
    scene::{Environment, ImageTexture, Scene, Sky, Texture},
};

use super::daylight::Daylight;

/// Cells of the table of a sky that is no picture.
const CELLS: (u32, u32) = (128, 64);

/// An environment ready for a picture.
#[derive(Debug)]
pub(super) struct Surround<'s> {
    environment: &'s Environment,
    look: Look<'s>,
    /// Sine and cosine of the rotation.
    turn: (f64, f64),
    /// Where it is bright; `None` where it does not shine.
    table: Option<Table>,
}

#[derive(Debug)]
enum Look<'s> {
    Gradient(Color, Color, Color),
    Image(&'s ImageTexture),
    Daylight(Box<Daylight>, Color),
}

/// Rows of cells from the top, each a rectangle of angle around Y and height: cumulated light, of the rows and in each row.
#[derive(Debug)]
struct Table {
    width: usize,
    height: usize,
    rows: Vec<f64>,
    /// `width` for each row.
    cells: Vec<f64>,
}

impl<'s> Surround<'s> {
    pub(super) fn new(scene: &'s Scene) -> Option<Self> {
        let environment = scene.settings.surroundings.environment.as_ref()?;
        let look = match *environment.sky() {
            Sky::Gradient {
                zenith,
                horizon,
                ground,
            } => Look::Gradient(zenith, horizon, ground),
            Sky::Image(id) => match &**scene.textures.get(id.index())? {
                Texture::Image(image) => Look::Image(image),
                _ => return None,
            },
            Sky::Daylight {
                sun,
                turbidity,
                ground,
            } => Look::Daylight(Box::new(Daylight::new(sun, turbidity)), ground),
        };
        let mut surround = Self {
            environment,
            look,
            turn: math::sin_cos_degrees(environment.rotation()),
            table: None,
        };
        if environment.n() > 0 && environment.strength() != Color::ZERO {
            surround.table = surround.tabulate();
        }
        Some(surround)
    }

    /// What a ray in the direction of the unit vector `dir` sees.
    pub(super) fn radiance(&self, dir: DVec3) -> Color {
        self.environment.strength() * self.look(self.unturned(dir))
    }

    fn unturned(&self, dir: DVec3) -> DVec3 {
        let (sin, cos) = self.turn;
        DVec3::new(dir.x * cos - dir.z * sin, dir.y, dir.x * sin + dir.z * cos)
    }

    fn look(&self, dir: DVec3) -> Color {
        match &self.look {
            Look::Gradient(zenith, horizon, ground) => {
                if dir.y >= 0.0 {
                    *horizon + (*zenith - *horizon) * dir.y.min(1.0)
                } else {
                    *ground
                }
            }
            Look::Daylight(sky, ground) => {
                if dir.y >= 0.0 {
                    sky.color(dir)
                } else {
                    *ground
                }
            }
            Look::Image(image) => {
                let u = 0.5 + math::atan2(dir.x, -dir.z) / (2.0 * PI);
                let v = 1.0 - math::acos(dir.y.clamp(-1.0, 1.0)) / PI;
                // The poles do not blend into each other.
                let edge = 0.5 / f64::from(image.height);
                image.bilinear(DVec2::new(u, v.clamp(edge, 1.0 - edge)))
            }
        }
    }

    /// Directions along each edge of the grid; 0 where it does not shine.
    pub(super) fn n(&self) -> u32 {
        if self.table.is_some() {
            self.environment.n()
        } else {
            0
        }
    }

    /// A direction for `(u, v)` in [0, 1)^2 with its density by solid angle.
    pub(super) fn direction(&self, (u, v): (f64, f64)) -> Option<(DVec3, f64)> {
        let table = self.table.as_ref()?;
        let (row, down, row_share) = pick(&table.rows, v)?;
        let cells = table.cells.get(row * table.width..(row + 1) * table.width)?;
        let (column, across, cell_share) = pick(cells, u)?;
        let (top, bottom) = (table.cosine(row), table.cosine(row + 1));
        let y = top + (bottom - top) * down;
        let angle = 2.0 * PI * ((column as f64 + across) / table.width as f64 - 0.5);
        let side = (1.0 - y * y).max(0.0).sqrt();
        let local = DVec3::new(side * math::sin(angle), y, -side * math::cos(angle));
        let solid = 2.0 * PI / table.width as f64 * (top - bottom);
        let (sin, cos) = self.turn;
        let dir = DVec3::new(
            local.x * cos + local.z * sin,
            local.y,
            local.z * cos - local.x * sin,
        );
        Some((dir, row_share * cell_share / solid))
    }

    /// Density by solid angle with which [`Surround::direction`] gives the unit vector `dir`.
    pub(super) fn density(&self, dir: DVec3) -> f64 {
        let Some(table) = &self.table else { return 0.0 };
        let local = self.unturned(dir);
        let u = 0.5 + math::atan2(local.x, -local.z) / (2.0 * PI);
        let v = math::acos(local.y.clamp(-1.0, 1.0)) / PI;
        let place = |x: f64, n: usize| ((x * n as f64) as usize).min(n - 1);
        let (column, row) = (place(u, table.width), place(v, table.height));
        let cells = table.cells.get(row * table.width..(row + 1) * table.width);
        let own = |list: &[f64], i: usize| {
            let begin = i.checked_sub(1).and_then(|i| list.get(i)).copied().unwrap_or(0.0);
            let total = list.last().copied().unwrap_or(0.0);
            let end = list.get(i).copied().unwrap_or(0.0);
            if total > 0.0 { (end - begin) / total } else { 0.0 }
        };
        let solid = 2.0 * PI / table.width as f64 * (table.cosine(row) - table.cosine(row + 1));
        own(&table.rows, row) * cells.map_or(0.0, |cells| own(cells, column)) / solid
    }

    /// `None` where it is black all around.
    fn tabulate(&self) -> Option<Table> {
        let (width, height) = match &self.look {
            Look::Image(image) => (image.width, image.height),
            _ => CELLS,
        };
        let strength = self.environment.strength();
        let bright = |color: Color| (color * strength).max_element();
        let mut table = Table {
            width: width as usize,
            height: height as usize,
            rows: Vec::with_capacity(height as usize),
            cells: Vec::with_capacity(width as usize * height as usize),
        };
        let mut of_rows = 0.0;
        for row in 0..height {
            let solid = table.cosine(row as usize) - table.cosine(row as usize + 1);
            let mut sum = 0.0;
            for column in 0..width {
                let weight = match &self.look {
                    Look::Image(image) => around_texel(image, column, row, &bright),
                    _ => {
                        // The corners as well as the middle: no direction that shines is without a chance.
                        let places = [(0.5, 0.5), (0.01, 0.01), (0.99, 0.01), (0.01, 0.99), (0.99, 0.99)];
                        let at = |(x, y): (f64, f64)| {
                            let angle = 2.0 * PI * ((f64::from(column) + x) / f64::from(width) - 0.5);
                            let polar = PI * (f64::from(row) + y) / f64::from(height);
                            let (side, up) = (math::sin(polar), math::cos(polar));
                            bright(self.look(DVec3::new(
                                side * math::sin(angle),
                                up,
                                -side * math::cos(angle),
                            )))
                        };
                        places.into_iter().map(at).fold(0.0, f64::max)
                    }
                };
                sum += weight;
                table.cells.push(sum);
            }
            of_rows += sum * solid;
            table.rows.push(of_rows);
        }
        (of_rows > 0.0 && of_rows.is_finite()).then_some(table)
    }
}

impl Table {
    /// Cosine of the angle from the top to the upper edge of a row.
    fn cosine(&self, row: usize) -> f64 {
        if row >= self.height {
            -1.0
        } else {
            math::cos(PI * row as f64 / self.height as f64)
        }
    }
}

/// Light of the texels that bilinear lookups within one texel's square see, by how much they do: 6 of 8 parts of the
/// texel's own row and column.
fn around_texel(image: &ImageTexture, x: u32, y: u32, bright: &impl Fn(Color) -> f64) -> f64 {
    let columns = [(x + image.width - 1) % image.width, x, (x + 1) % image.width];
    let rows = [y.saturating_sub(1), y, (y + 1).min(image.height - 1)];
    let mut sum = Color::ZERO;
    for (row, down) in rows.into_iter().zip([0.125, 0.75, 0.125]) {
        for (column, across) in columns.into_iter().zip([0.125, 0.75, 0.125]) {
            sum += image.texel(column, row) * (down * across);
        }
    }
    bright(sum)
}

/// The part of a cumulated list in which the share `at` of its sum lies: its number, where in it, its share.
fn pick(cumulated: &[f64], at: f64) -> Option<(usize, f64, f64)> {
    let total = *cumulated.last()?;
    if !(total > 0.0) {
        return None;
    }
    let at = at * total;
    let index = cumulated
        .partition_point(|end| *end <= at)
        .min(cumulated.len() - 1);
    let end = cumulated.get(index)?;
    let begin = index
        .checked_sub(1)
        .and_then(|i| cumulated.get(i))
        .copied()
        .unwrap_or(0.0);
    let own = end - begin;
    (own > 0.0).then(|| (index, ((at - begin) / own).clamp(0.0, 1.0), own / total))
}
