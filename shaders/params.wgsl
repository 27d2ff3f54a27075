// What a dispatch is about; the same for every stage (`Params` in crates/engine/src/gpu.rs).
struct Params {
    // Vertices and tiles of the lattice, layouts of the dispatch.
    vertices: u32,
    tiles: u32,
    layouts: u32,
    // Tiles of the block at hand: from which on, and how many; its squares, and where in `rows` they stand.
    first_tile: u32,
    block_tiles: u32,
    squares: u32,
    squares_at: u32,
    // Roots of this walk, how many there are before them and in all, and words of 32 of this walk's.
    roots: u32,
    first_root: u32,
    all_roots: u32,
    words: u32,
    // Level of the trees that is made, 1 the first.
    level: u32,
    // Squares of each row of cells in this pass: from which on, how many, and whether it is the last pass.
    first_square: u32,
    pass_squares: u32,
    is_last: u32,
    // Where the counts go.
    slot: u32,
    // Segments of this pass: from which of a layout's own, and how many at most.
    first_segment: u32,
    segments: u32,
    // Distance of cells, micrometres.
    spacing: u32,
}

// Invocations along the first axis of a dispatch; the rest is along the third.
const LINE: u32 = 2097152u;

fn number_of(id: vec3<u32>) -> u32 {
    return id.z * LINE + id.x;
}

// Words of a tile's head in `rows`: its cells in two words, their first rank, from where to where the tiles that it sees
// stand, and the first square of each of its rows of cells, one more.
const HEAD: u32 = 14u;
const NEAR: u32 = 3u;
const FIRST: u32 = 5u;

// A square is what the eight cells of a row see of one tile. Two words in `rows`: that tile, and the number of the row. In
// `seen`: what all of them see, or is no matter to them; which of them see more; and for each what more.
const SQUARE: u32 = 10u;
const MORE: u32 = 1u;
const EACH: u32 = 2u;

// Words of a tile on a frontier: the union of all, of each row of eight, then each cell.
const SLOTS: u32 = 73u;
const ROWS: u32 = 1u;
const CELLS: u32 = 9u;

// Words of a tile's sums: seven planes of bits that count its new cells, and what its cells miss.
const SUMS: u32 = 8u;
const OPEN: u32 = 7u;

// The eight bits of a row of a tile.
fn row_of(cells: vec2<u32>, row: u32) -> u32 {
    return (select(cells.x, cells.y, row >= 4u) >> (row % 4u * 8u)) & 255u;
}

fn one(bit: u32) -> vec2<u32> {
    let word = 1u << (bit & 31u);
    return select(vec2<u32>(word, 0u), vec2<u32>(0u, word), bit >= 32u);
}

fn is_any(cells: vec2<u32>) -> bool {
    return (cells.x | cells.y) != 0u;
}
