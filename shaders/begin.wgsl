// Stage "begin": level 0 of the breadth-first trees of some roots. One invocation is a tile and 32 roots.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read> sight: array<vec4<u32>>;
// Number of each rank among the roots, or more than there are.
@group(0) @binding(3) var<storage, read> root_at: array<u32>;
@group(0) @binding(4) var<storage, read_write> missing: array<u32>;
@group(0) @binding(5) var<storage, read_write> front: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<u32>;
@group(0) @binding(7) var<storage, read_write> awake: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = number_of(id);
    let plan = id.y;
    if number >= params.block_tiles * params.words {
        return;
    }
    let head = number / params.words * HEAD;
    let tile = plan * params.tiles + params.first_tile + number / params.words;
    let word = number % params.words;
    let valid = params.roots - min(params.roots, word * 32u);
    let all = select((1u << (valid & 31u)) - 1u, 0xffffffffu, valid >= 32u);
    let can_see = sight[tile].xy;
    var rank = rows[head + 2u];
    var whole = 0u;
    var open = 0u;
    for (var row = 0u; row < 8u; row++) {
        var cells = row_of(vec2<u32>(rows[head], rows[head + 1u]), row);
        let seeing = row_of(can_see, row);
        var together = 0u;
        while cells != 0u {
            let bit = firstTrailingBit(cells);
            cells &= cells - 1u;
            let root = root_at[rank] - params.first_root;
            let own = select(0u, 1u << (root & 31u), root < params.roots && root / 32u == word);
            // What sees nothing is on no frontier, so that others may read its word without a look.
            let is_seeing = ((seeing >> bit) & 1u) == 1u;
            let shown = select(0u, own, is_seeing);
            missing[(plan * params.vertices + rank) * params.words + word] = all & ~own;
            front[(tile * SLOTS + CELLS + row * 8u + bit) * params.words + word] = shown;
            together |= shown;
            open |= select(0u, all & ~own, is_seeing);
            rank += 1u;
        }
        front[(tile * SLOTS + ROWS + row) * params.words + word] = together;
        whole |= together;
    }
    front[tile * SLOTS * params.words + word] = whole;
    sums[(tile * SUMS + OPEN) * params.words + word] = open;
    if whole != 0u {
        let end = rows[head + NEAR + 1u];
        for (var near = rows[head + NEAR]; near < end; near++) {
            awake[(plan * params.tiles + rows[near]) * params.words + word] = 1u;
        }
    }
}
