// Stage "share": of the squares what all eight viewers see, and what more each of them does. One invocation is a square.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
// Cells of each tile that may see, then those that a solid covers; by layout.
@group(0) @binding(2) var<storage, read> sight: array<vec4<u32>>;
@group(0) @binding(3) var<storage, read_write> seen: array<vec2<u32>>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let square = number_of(id);
    let plan = id.y;
    if square >= params.squares {
        return;
    }
    let tile = rows[params.squares_at + square * 2u];
    let viewers = rows[params.squares_at + square * 2u + 1u];
    let members = row_of(sight[plan * params.tiles + viewers / 8u].xy, viewers % 8u);
    let seeing = sight[plan * params.tiles + tile].xy;
    let at = (plan * params.squares + square) * SQUARE;
    // Cells that see nothing are never on a frontier, and a viewer misses no root whose frontier it is on.
    var of_all = select(vec2<u32>(0u), seeing, members != 0u);
    for (var left = members; left != 0u; left &= left - 1u) {
        let i = firstTrailingBit(left);
        let own = select(vec2<u32>(0u), one(viewers % 8u * 8u + i), viewers / 8u == tile);
        of_all &= seen[at + EACH + i] | own;
    }
    var more = 0u;
    for (var i = 0u; i < 8u; i++) {
        let rest = seen[at + EACH + i] & ~of_all;
        seen[at + EACH + i] = rest;
        more |= select(0u, 1u << i, is_any(rest));
    }
    seen[at] = of_all;
    seen[at + MORE] = vec2<u32>(more, 0u);
}
