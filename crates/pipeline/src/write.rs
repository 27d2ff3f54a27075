//! What is shown and written: pictures, page, results, drawings.

pub(crate) mod asked;
pub(crate) mod bounded;
pub(crate) mod doors;
pub(crate) mod files;
pub mod geojson;
pub(crate) mod graph;
pub(crate) mod joints;
pub(crate) mod leaving;
pub(crate) mod made;
pub(crate) mod named;
pub(crate) mod overlaps;
pub(crate) mod page;
pub(crate) mod reading;
pub(crate) mod show;
pub(crate) mod told;
pub(crate) mod traces;
