//! How the work of a card is cut: no buffer, dispatch or loop is larger than an adapter takes.

/// Pairs of words of a square in `seen`; `SQUARE` in `shaders/params.wgsl`, which says what they are.
pub(super) const SQUARE: usize = 10;

/// Words of a tile on a frontier, and words of its sums; `SLOTS` and `SUMS` in `shaders/params.wgsl`.
pub(super) const SLOTS: u64 = 73;
pub(super) const SUMS: u64 = 8;

/// Bytes of a frontier, at most: three of them with what is missing take less than a gigabyte.
const FRONT_BYTES_MAX: u64 = 256 << 20;

/// Levels of a submission, at most.
pub(super) const LEVELS_MAX: u32 = 64;

/// Iterations of the stage "step" in one of the eight rows of a tile beside those for squares: its cells twice, and itself.
const PER_ROW: u64 = 17;

/// Iterations for a square: itself and eight viewers with it, for each of these nine the eight rows of a tile, and the cells
/// of each.
const PER_SQUARE: u64 = 9 * (1 + 8 * (1 + 8));

/// What of a plan decides how it is cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Extent {
    pub tiles: u32,
    pub roots: u32,
    /// Squares of the largest block.
    pub squares: u64,
    /// Squares of a row of cells, and tiles that the cells of a tile see, at most.
    pub row: u32,
    pub near: u32,
}

/// How the work is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shape {
    /// Layouts of a submission.
    pub layouts: u32,
    /// Words of 32 roots that are walked from at a time, in each layout.
    pub words: u32,
    /// Squares of a row that one invocation gathers from, and passes that takes.
    pub pass_squares: u32,
    pub passes: u32,
    /// Levels of a submission, at most.
    pub levels: u32,
}

impl Shape {
    /// Cuts the work so that no buffer has more than `bytes_max` bytes and no invocation of the stage "step" more iterations
    /// than `iterations_max`; up to `layouts` at a time.
    ///
    /// # Errors
    /// The plan is too large, in words for the report.
    pub fn new(of: Extent, layouts: u32, (bytes_max, iterations_max): (u64, u64)) -> Result<Self, String> {
        let bytes = bytes_max.min(FRONT_BYTES_MAX);
        let words_all = padded(u64::from(of.roots.div_ceil(32).max(1)));
        let fit = bytes / 4 / (u64::from(of.tiles.max(1)) * SLOTS);
        if fit == 0 {
            return Err(format!("{} tiles of 64 cells are more than a buffer of the card holds", of.tiles));
        }
        let by_squares = bytes_max / (8 * SQUARE as u64) / of.squares.max(1);
        let layouts = u64::from(layouts.max(1)).min(fit / words_all).min(by_squares).max(1);
        // Whole lines of memory where there are more roots than fit.
        let words = if fit / layouts >= words_all { words_all } else { whole_lines(fit) };
        let trees = layouts * words * 32;
        let levels = (bytes / 4 / trees).clamp(3, u64::from(LEVELS_MAX) + 1) - 1;
        let pass_squares = pass_squares(of, iterations_max)?;
        Ok(Self {
            layouts: layouts as u32,
            words: words as u32,
            pass_squares,
            passes: of.row.div_ceil(pass_squares).max(1),
            levels: levels as u32,
        })
    }

    /// Roots that are walked from at a time.
    pub fn roots(&self) -> u32 {
        self.words * 32
    }
}

/// Words so that what runs together has one tile: a cache line of them, or a whole part of one.
fn padded(words: u64) -> u64 {
    words.next_multiple_of(words.next_power_of_two().min(8))
}

/// A number of words without a broken line of 32, where it has a whole one.
fn whole_lines(words: u64) -> u64 {
    if words < 32 { words } else { words / 32 * 32 }
}

/// Iterations of an invocation of the stage "step" that gathers from so many squares of a row.
pub(super) fn step_iterations(of: Extent, squares: u32) -> u64 {
    8 * (PER_ROW + PER_SQUARE * u64::from(squares)) + 2 * u64::from(of.near)
}

fn pass_squares(of: Extent, iterations_max: u64) -> Result<u32, String> {
    let too_many = || format!("cells that see {} tiles are more than an invocation takes", of.near);
    let left = iterations_max.checked_sub(step_iterations(of, 0)).ok_or_else(too_many)?;
    let squares = (left / (8 * PER_SQUARE)).min(u64::from(u32::MAX)) as u32;
    if squares == 0 { Err(too_many()) } else { Ok(squares.min(of.row.max(1))) }
}
