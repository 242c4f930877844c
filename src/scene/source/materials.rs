//! Materials, and the numbers that their textures get by being named.

use std::fmt;

use super::{Writer, calls::Said};
use crate::scene::{Finish, Geometry, Material, Object, Term, literal::Text, number_text};

impl Writer<'_> {
    /// The material of an object, where it is not the current one.
    pub(super) fn material(&mut self, object: &Object) -> fmt::Result {
        let material = self.scene.materials.get(object.material.index());
        let Some(material) = material.filter(|_| self.material != Some(object.material)) else {
            return Ok(());
        };
        self.material = Some(object.material);
        let textures = material.textures().into_iter();
        let new: Vec<usize> = textures.map(|(_, id)| id.index()).collect();
        let mut numbers = self.next_texture;
        for i in new.iter().copied().filter(|i| *i >= self.next_texture) {
            numbers += usize::from(i == numbers);
        }
        let end = new.iter().max().map_or(0, |last| last + 1);
        if numbers < end {
            self.register_textures(end)?;
        }
        self.next_texture = self.next_texture.max(end);
        let Material {
            ambient,
            emission,
            diffuse,
            specular,
            shininess,
            reflection,
            transmission,
            ior,
            reflectance,
            finish,
        } = material;
        let own = reflectance.as_ref().map_or_else(String::new, |own| {
            format!(", reflectance: {}", Text(&own.identity()))
        });
        let varying = |of: fn(&Finish) -> Option<Term>, number: f64| {
            let term = finish.as_deref().and_then(of).unwrap_or(Term::number(number));
            number_text(&term, &|id| format!("texture_{}", id.0))
        };
        let shininess = varying(|finish| finish.shininess, *shininess);
        let ior = varying(|finish| finish.ior, *ior);
        let finish = if self.has_finishes {
            // What a material does not have must be taken away from the one before.
            let finish = finish.as_deref().cloned().unwrap_or_default();
            format!(", {}", finish.whole_text(&|id| format!("texture_{}", id.0)))
        } else {
            String::new()
        };
        let reflection = reflection.map_or("()".to_owned(), |term| Said(term).to_string());
        self.call(format_args!(
            "material(#{{ ambient: {}, emission: {}, diffuse: {}, specular: {}, shininess: {shininess}, \
             reflection: {reflection}, transmission: {}, ior: {ior}{own}{finish} }});",
            Said(*ambient),
            Said(*emission),
            Said(*diffuse),
            Said(*specular),
            Said(*transmission)
        ))
    }

    /// The textures before number `end` that nothing has yet get their numbers.
    pub(super) fn register_textures(&mut self, end: usize) -> fmt::Result {
        while self.next_texture < end {
            let i = self.next_texture;
            if self.is_named.get(i) == Some(&true) {
                self.call(format_args!("group {{ emission(texture_{i}); }}"))?;
            }
            self.next_texture += 1;
        }
        Ok(())
    }

    /// The textures of a mesh's own materials get their numbers as it is read.
    pub(super) fn skip_textures_of(&mut self, object: &Object) {
        let Geometry::Mesh(id) = object.geometry else {
            return;
        };
        if !self.order.is_new_mesh(id) {
            return;
        }
        let scene = self.scene;
        let faces = scene
            .meshes
            .get(id.index())
            .into_iter()
            .flat_map(|mesh| &mesh.face_materials);
        for id in faces {
            let material = scene.materials.get(id.index());
            for (_, texture) in material.into_iter().flat_map(Material::textures) {
                self.next_texture = self.next_texture.max(texture.index() + 1);
            }
        }
    }
}
