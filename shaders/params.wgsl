// What a dispatch is about; the same for every stage (`Params` in src/analysis/gpu.rs).
struct Params {
    // Words of 32 vertices in a row of bits.
    words: u32,
    // First row of the block of the matrix at hand, a multiple of 32, and how many rows it has.
    first_row: u32,
    rows: u32,
    // Segments of this pass: from which of a layout's own, and how many at most.
    first_segment: u32,
    segments: u32,
    // On the first pass over a block: 1 to start from what the fixed walls leave, 2 from all cells.
    is_first: u32,
    layouts: u32,
    // Roots of this pass, and how many there are before them.
    roots: u32,
    first_root: u32,
    // Level of the tree, 0 to begin with.
    level: u32,
    // Where the counts of the level before stand, and where those of this level go.
    slot_before: u32,
    slot: u32,
    vertices: u32,
}
