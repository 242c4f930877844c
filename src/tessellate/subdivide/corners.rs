//! What the corners of faces carry, divided within each face.

use std::ops::{Add, Div};

use crate::{color::Color, math::DVec2, scene::Attribute};

/// What may be mixed.
pub(super) trait Linear: Copy + Default + Add<Output = Self> + Div<f64, Output = Self> {}

impl Linear for DVec2 {}
impl Linear for Color {}

/// What faces have at their corners, on its way to the corners of triangles.
pub(super) struct AtCorners<'n, T> {
    values: &'n [Vec<T>],
    /// The number of the first value of the face at hand.
    first: u32,
    indices: Vec<[u32; 3]>,
}

impl<'n, T: Linear> AtCorners<'n, T> {
    pub(super) fn new(values: &'n [Vec<T>]) -> Self {
        Self {
            values,
            first: 0,
            indices: Vec::new(),
        }
    }

    /// Adds a triangle of the face at hand, by the places of its corners among those of the face.
    pub(super) fn add(&mut self, face: usize, corners: [usize; 3]) {
        if let Some(own) = self.values.get(face) {
            let none = Attribute::<T>::NONE;
            let index = |i: usize| {
                if i < own.len() {
                    self.first + i as u32
                } else {
                    none
                }
            };
            self.indices.push(corners.map(index));
        }
    }

    /// Goes on behind a face.
    pub(super) fn next(&mut self, face: usize) {
        self.first += self.values.get(face).map_or(0, Vec::len) as u32;
    }

    pub(super) fn attribute(self) -> Option<Attribute<T>> {
        (!self.indices.is_empty()).then(|| Attribute {
            values: self.values.concat(),
            indices: self.indices,
        })
    }
}

/// What the faces that one of so many corners is divided into have at their corners, in their order.
pub(super) fn divided<T: Linear>(corners: usize, values: &[T], is_loop: bool) -> Vec<Vec<T>> {
    if values.is_empty() {
        return vec![Vec::new(); if is_loop { 4 } else { corners }];
    }
    if let ([a, b, c], true) = (values, is_loop) {
        let (a, b, c) = (*a, *b, *c);
        let (ab, bc, ca) = ((a + b) / 2.0, (b + c) / 2.0, (c + a) / 2.0);
        return vec![
            vec![a, ab, ca],
            vec![ab, b, bc],
            vec![ca, bc, c],
            vec![ab, bc, ca],
        ];
    }
    let count = values.len();
    let sum = values.iter().fold(T::default(), |sum, value| sum + *value);
    let center = sum / count as f64;
    let at = |i: usize| values.get(i % count).copied().unwrap_or_default();
    let corner = |i: usize| {
        let (before, value, next) = (at(i + count - 1), at(i), at(i + 1));
        vec![value, (value + next) / 2.0, center, (before + value) / 2.0]
    };
    (0..count).map(corner).collect()
}
