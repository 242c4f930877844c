//! stub
use super::outcome::{Case, Totals};
pub(super) fn html(_: &[Case], _: &Totals) -> String {
    String::new()
}
