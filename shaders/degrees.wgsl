// Stage "degrees": how many vertices, and how many of the region of reference, each vertex of the region of query sees.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read> seen: array<vec2<u32>>;
@group(0) @binding(3) var<storage, read> sight: array<vec4<u32>>;
// Cells of each tile in the region of reference.
@group(0) @binding(4) var<storage, read> region: array<vec2<u32>>;
// Tile and bit of every root.
@group(0) @binding(5) var<storage, read> roots: array<u32>;
@group(0) @binding(6) var<storage, read_write> degrees: array<vec2<u32>>;

fn ones(bits: vec2<u32>) -> u32 {
    let n = countOneBits(bits);
    return n.x + n.y;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let root = number_of(id);
    let plan = id.y;
    if root >= params.roots || roots[root] / 64u - params.first_tile >= params.block_tiles {
        return;
    }
    let own = roots[root] / 64u;
    let bit = roots[root] & 63u;
    let first = (own - params.first_tile) * HEAD + FIRST + bit / 8u;
    let is_member = ((row_of(sight[plan * params.tiles + own].xy, bit / 8u) >> (bit & 7u)) & 1u) == 1u;
    let end = select(rows[first], rows[first + 1u], is_member);
    var found = vec2<u32>(0u);
    for (var square = rows[first]; square < end; square++) {
        let at = (plan * params.squares + square) * SQUARE;
        let tile = rows[params.squares_at + square * 2u];
        let mask = (seen[at] | seen[at + EACH + (bit & 7u)]) & ~select(vec2<u32>(0u), one(bit), tile == own);
        found += vec2<u32>(ones(mask & region[tile]), ones(mask));
    }
    degrees[plan * params.roots + root] = found;
}
