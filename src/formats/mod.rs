//! Exchange formats: one deep module a format, read and patch together.
pub mod dxf;
