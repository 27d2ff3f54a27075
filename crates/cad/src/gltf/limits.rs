//! What is too much for a glTF file, each with its reason.

/// Brackets inside each other: the format nests eight deep, extras a little more.
pub const NESTING_MAX: usize = 128;

/// Nodes from a scene's root to a mesh.
pub const DEPTH_MAX: usize = 10_000;

/// Nodes shown, instances of one mesh counted each time.
pub const NODES_MAX: usize = 500_000;

/// Nodes shown again because they hang in several others, which the standard forbids: where each names its child
/// twice, a few levels would be millions.
pub const REPEATS_MAX: usize = 1_000;

/// Instances of meshes that nodes show many times, in all: a building has thousands of chairs, not of walls; more is a wood.
pub const INSTANCES_MAX: usize = 100_000;

/// Triangles cut in one scene.
pub const TRIANGLES_MAX: usize = 20_000_000;

/// Characters of all data URIs: larger scenes keep their data in a GLB.
pub const DATA_MAX: usize = 64 << 20;

/// Pieces of one mesh that are moved one by one: a floor of a building has fewer walls; more are bricks.
pub const PIECES_MAX: usize = 1_000;

/// Bytes of one file of data beside a `.gltf`: a scanned building has hundreds of megabytes.
pub const OUTER_MAX: u64 = 1 << 30;

/// Bytes of all pictures beside a scene: they are copied with every round, and a building's textures are a few megabytes.
pub const PICTURES_MAX: u64 = 256 << 20;
