//! Every limit of the reader, each with its reason.

/// Largest file taken: spans are 32-bit, and memory is about twice the file.
pub const MAX_FILE_BYTES: usize = 1 << 30;

/// Most records taken (entities, and what else a group code 0 begins). A record takes half a kilobyte of memory, and the
/// largest plan seen has a tenth of them.
pub const MAX_RECORDS: usize = 2_000_000;

/// Most pairs of group code and value taken.
pub const MAX_PAIRS: usize = 50_000_000;

/// Longest line taken. Real ones reach a few hundred kB (embedded texts); a longer one is no DXF.
pub const MAX_LINE_BYTES: usize = 64 << 20;

/// Most drawn pieces that INSERTs may unfold to, all of them together: stops 2^30 doubling blocks and
/// 32767 × 32767 arrays, and is twice the largest plan seen. A piece takes up to a kilobyte of memory.
pub const MAX_EXPANDED_SEGMENTS: u64 = 1_000_000;

/// Most entities taken, those of blocks as often as they are shown. Each takes a kilobyte of memory until it is
/// understood; the largest plan seen has fewer, and more are not understood within the limit of time.
pub const MAX_ENTITIES: usize = 500_000;

/// Deepest nesting of blocks; real drawings reach 5.
pub const MAX_BLOCK_DEPTH: usize = 100;

/// Most vertices of one polyline: a scan or a survey has more, no part of a building does. The longest in 55 drawings of
/// buildings has 1,839.
pub const MAX_VERTICES: usize = 100_000;

/// Largest coordinate in metres (a hundred times the earth's size); beyond, a value is a mistake.
pub const MAX_COORDINATE_M: f64 = 1e9;

/// Largest bulge: an arc that lacks a millionth of a turn of its circle.
pub const MAX_BULGE: f64 = 1e6;

/// Most findings of one kind that are listed one by one; the rest is counted.
pub const MAX_NOTES: usize = 20;

/// Most pieces that one curve is cut into.
pub const MAX_CURVE_PIECES: usize = 2048;

/// The limits, so that tests can trip them with small files.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// See [`MAX_FILE_BYTES`].
    pub max_file_bytes: usize,
    /// See [`MAX_RECORDS`].
    pub max_records: usize,
    /// See [`MAX_PAIRS`].
    pub max_pairs: usize,
    /// See [`MAX_LINE_BYTES`].
    pub max_line_bytes: usize,
    /// See [`MAX_EXPANDED_SEGMENTS`].
    pub max_expanded_segments: u64,
    /// See [`MAX_ENTITIES`].
    pub max_entities: usize,
    /// See [`MAX_BLOCK_DEPTH`].
    pub max_block_depth: usize,
    /// See [`MAX_VERTICES`].
    pub max_vertices: usize,
    /// See [`MAX_COORDINATE_M`].
    pub max_coordinate_m: f64,
    /// See [`MAX_BULGE`].
    pub max_bulge: f64,
    /// See [`MAX_NOTES`].
    pub max_notes: usize,
}

impl Default for Limits {
    fn default() -> Self {
        Self {
            max_file_bytes: MAX_FILE_BYTES,
            max_records: MAX_RECORDS,
            max_pairs: MAX_PAIRS,
            max_line_bytes: MAX_LINE_BYTES,
            max_expanded_segments: MAX_EXPANDED_SEGMENTS,
            max_entities: MAX_ENTITIES,
            max_block_depth: MAX_BLOCK_DEPTH,
            max_vertices: MAX_VERTICES,
            max_coordinate_m: MAX_COORDINATE_M,
            max_bulge: MAX_BULGE,
            max_notes: MAX_NOTES,
        }
    }
}
