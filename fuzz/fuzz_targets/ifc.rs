//! Any bytes as IFC.
#![no_main]

#[path = "../checks/building.rs"]
mod building;
#[path = "../checks/ifc.rs"]
mod checks;

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| {
    checks::check(bytes);
});
