// Stage "step": the next level of the trees of many roots. Twin of crates/engine/src/wave.rs.
//
// One invocation is a tile and 32 roots. Of each square of its rows of cells it gathers the frontier words: of the whole
// tile, of a row of eight, or of single cells, as much of them as is seen; once what all eight cells see, then what more
// each of them does. A tile that sees no frontier sleeps: whoever makes one wakes the tiles that see it, by the number of
// the next level.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read> seen: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> sight: array<vec4<u32>>;
@group(0) @binding(4) var<storage, read_write> missing: array<u32>;
@group(0) @binding(5) var<storage, read> front: array<u32>;
@group(0) @binding(6) var<storage, read_write> next: array<u32>;
@group(0) @binding(7) var<storage, read_write> sums: array<u32>;
@group(0) @binding(8) var<storage, read_write> awake: array<atomic<u32>>;

// One bit for each row of a tile that has cells.
fn rows_with(cells: vec2<u32>) -> u32 {
    var found = 0u;
    found |= select(0u, 1u, (cells.x & 0xffu) != 0u) | select(0u, 2u, (cells.x & 0xff00u) != 0u);
    found |= select(0u, 4u, (cells.x & 0xff0000u) != 0u) | select(0u, 8u, (cells.x & 0xff000000u) != 0u);
    found |= select(0u, 16u, (cells.y & 0xffu) != 0u) | select(0u, 32u, (cells.y & 0xff00u) != 0u);
    found |= select(0u, 64u, (cells.y & 0xff0000u) != 0u) | select(0u, 128u, (cells.y & 0xff000000u) != 0u);
    return found;
}

// The wanted roots on the frontier of some cells of a tile, whose words begin at `first`; of rows of which nothing else is
// shut, as a whole.
fn met(first: u32, cells: vec2<u32>, shut: vec2<u32>, wanted: u32) -> u32 {
    var need = wanted;
    for (var left = rows_with(cells); left != 0u && need != 0u; left &= left - 1u) {
        let row = firstTrailingBit(left);
        let together = front[first + (ROWS + row) * params.words] & need;
        let is_whole = row_of(shut, row) == 0u;
        need &= ~select(0u, together, is_whole);
        for (var of_row = select(row_of(cells, row), 0u, is_whole || together == 0u); of_row != 0u; of_row &= of_row - 1u) {
            need &= ~front[first + (CELLS + row * 8u + firstTrailingBit(of_row)) * params.words];
        }
    }
    return wanted & ~need;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = number_of(id);
    let plan = id.y;
    if number >= params.block_tiles * params.words {
        return;
    }
    let k = params.words;
    let head = number / k * HEAD;
    let own = params.first_tile + number / k;
    let tile = plan * params.tiles + own;
    let word = number % k;
    let first = tile * SLOTS * k + word;
    let sum = tile * SUMS * k + word;
    let is_first = params.first_square == 0u;
    var open = 0u;
    if atomicLoad(&awake[tile * k + word]) >= params.level {
        open = sums[sum + OPEN * k];
    }
    let near_end = rows[head + NEAR + 1u];
    var any = 0u;
    for (var near = rows[head + NEAR]; near < near_end && (open & ~any) != 0u; near++) {
        any |= front[(plan * params.tiles + rows[near]) * SLOTS * k + word];
    }
    any &= open;
    if any == 0u {
        if is_first {
            next[first] = 0u;
        }
        return;
    }
    var whole = 0u;
    var still = 0u;
    var s0 = 0u; var s1 = 0u; var s2 = 0u; var s3 = 0u; var s4 = 0u; var s5 = 0u; var s6 = 0u;
    if !is_first {
        whole = next[first];
        s0 = sums[sum]; s1 = sums[sum + k]; s2 = sums[sum + 2u * k]; s3 = sums[sum + 3u * k];
        s4 = sums[sum + 4u * k]; s5 = sums[sum + 5u * k]; s6 = sums[sum + 6u * k];
    }
    let occupied = vec2<u32>(rows[head], rows[head + 1u]);
    let seeing = sight[tile].xy;
    var row_rank = rows[head + 2u];
    for (var row = 0u; row < 8u; row++) {
        let cells = row_of(occupied, row);
        let members = row_of(seeing, row);
        let missing_at = (plan * params.vertices + row_rank) * k + word;
        var lacking: array<u32, 8>;
        var all = 0u;
        for (var left = members; left != 0u; left &= left - 1u) {
            let i = firstTrailingBit(left);
            let lacks = missing[missing_at + countOneBits(cells & ((1u << i) - 1u)) * k];
            lacking[i] = lacks;
            all |= lacks;
        }
        // What is gathered once for all.
        var shared_by_all = 0u;
        all &= any;
        let begin = rows[head + FIRST + row] + params.first_square;
        let end = min(rows[head + FIRST + row + 1u], begin + params.pass_squares);
        for (var square = begin; square < end && all != 0u; square++) {
            let to = rows[params.squares_at + square * 2u];
            let source = (plan * params.tiles + to) * SLOTS * k + word;
            let wanted = front[source] & all;
            var more = 0u;
            var cells_of_all = vec2<u32>(0u);
            var shut = vec2<u32>(0u);
            let at = (plan * params.squares + square) * SQUARE;
            if wanted != 0u {
                let of_all = seen[at];
                shut = sight[plan * params.tiles + to].xy & ~of_all;
                if is_any(shut) {
                    cells_of_all = of_all;
                    more = seen[at + MORE].x;
                } else {
                    shared_by_all |= wanted;
                }
            }
            shared_by_all |= met(source, cells_of_all, shut, wanted);
            all &= ~shared_by_all;
            // What none of them lacks is looked for no more, where each is looked at.
            var rest = select(all, 0u, more == members);
            for (; more != 0u; more &= more - 1u) {
                let i = firstTrailingBit(more);
                let mask = seen[at + EACH + i];
                let need = wanted & lacking[i] & ~shared_by_all;
                lacking[i] &= ~met(source, select(vec2<u32>(0u), mask, need != 0u), shut & ~mask, need);
                rest |= lacking[i];
            }
            all &= rest;
        }
        var together = 0u;
        if !is_first {
            together = next[first + (ROWS + row) * k];
        }
        for (var left = members; left != 0u; left &= left - 1u) {
            let i = firstTrailingBit(left);
            let missing_of = missing_at + countOneBits(cells & ((1u << i) - 1u)) * k;
            let lacks = missing[missing_of];
            let lacks_now = lacking[i] & ~shared_by_all;
            let found = lacks & ~lacks_now;
            if found != 0u {
                missing[missing_of] = lacks_now;
            }
            let shown = first + (CELLS + row * 8u + i) * k;
            if is_first {
                next[shown] = found;
            } else if found != 0u {
                next[shown] |= found;
            }
            still |= lacks_now;
            together |= found;
            // One more in the counter of each root that was met.
            var carry = s0 & found; s0 ^= found;
            var over = s1 & carry; s1 ^= carry; carry = over;
            over = s2 & carry; s2 ^= carry; carry = over;
            over = s3 & carry; s3 ^= carry; carry = over;
            over = s4 & carry; s4 ^= carry; carry = over;
            over = s5 & carry; s5 ^= carry; carry = over;
            s6 ^= carry;
        }
        next[first + (ROWS + row) * k] = together;
        whole |= together;
        row_rank += countOneBits(cells);
    }
    next[first] = whole;
    if params.is_last == 1u {
        sums[sum + OPEN * k] = still;
    }
    sums[sum] = s0; sums[sum + k] = s1; sums[sum + 2u * k] = s2; sums[sum + 3u * k] = s3;
    sums[sum + 4u * k] = s4; sums[sum + 5u * k] = s5; sums[sum + 6u * k] = s6;
    let wake_end = select(rows[head + NEAR], near_end, whole != 0u && params.is_last == 1u);
    for (var near = rows[head + NEAR]; near < wake_end; near++) {
        atomicStore(&awake[(plan * params.tiles + rows[near]) * k + word], params.level + 1u);
    }
}
