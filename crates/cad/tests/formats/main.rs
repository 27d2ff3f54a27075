//! Files of each format, read and written back.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

mod cleaned;
mod dxf_against_ezdxf;
mod dxf_against_the_dxf_crate;
mod dxf_blocks;
mod dxf_clips;
mod dxf_corpus;
mod dxf_hazards;
mod dxf_hidden;
mod dxf_patch;
mod dxf_storeys;
mod dxf_works;
mod gltf_against_the_gltf_crate;
mod gltf_scenes;
mod gltf_works;
mod ifc_left_out;
mod ifc_works;
mod support;
