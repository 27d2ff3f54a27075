//! Files of each format, read and written back.

mod dxf_against_ezdxf;
mod dxf_against_the_dxf_crate;
mod dxf_blocks;
mod dxf_corpus;
mod dxf_hazards;
mod dxf_patch;
mod support;
