//! The model: a plan in metres, and how it is understood from a drawing.

pub mod drawing;
pub mod geometry;
