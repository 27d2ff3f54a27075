// Stage "kept": who of a root's area in the initial layout is still reached. Twin of `disconnected` in
// crates/engine/src/forest.rs. One invocation is a tile and 32 roots; the sums go where those of a level go.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read> sight: array<vec4<u32>>;
// Initial component of every rank, of every root, and of every 32 roots, where these have the same one.
@group(0) @binding(3) var<storage, read> labels: array<u32>;
@group(0) @binding(4) var<storage, read> missing: array<u32>;
@group(0) @binding(5) var<storage, read_write> next: array<u32>;
@group(0) @binding(6) var<storage, read_write> sums: array<u32>;

const NONE: u32 = 0xffffffffu;

// The roots of a word with a label.
fn with_label(label: u32, first: u32, valid: u32) -> u32 {
    var found = 0u;
    for (var i = 0u; i < valid; i++) {
        found |= select(0u, 1u << i, labels[first + i] == label);
    }
    return found;
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
    let tile = plan * params.tiles + params.first_tile + number / k;
    let word = number % k;
    let valid = min(params.roots - min(params.roots, word * 32u), 32u);
    let all = select((1u << (valid & 31u)) - 1u, 0xffffffffu, valid == 32u);
    let first_root = params.vertices + params.first_root + word * 32u;
    let of_word = labels[params.vertices + params.all_roots + params.first_root / 32u + word];
    let covered = sight[tile].zw;
    var left = vec2<u32>(rows[head], rows[head + 1u]);
    var rank = rows[head + 2u];
    var whole = 0u;
    var s0 = 0u; var s1 = 0u; var s2 = 0u; var s3 = 0u; var s4 = 0u; var s5 = 0u; var s6 = 0u;
    while any(left != vec2<u32>(0u)) {
        let is_low = left.x != 0u;
        let bit = select(firstTrailingBit(left.y), firstTrailingBit(left.x), is_low);
        left = select(vec2<u32>(0u, left.y & (left.y - 1u)), vec2<u32>(left.x & (left.x - 1u), left.y), is_low);
        let is_covered = (select(covered.y, covered.x, is_low) >> bit) & 1u;
        let reached = all & ~missing[(plan * params.vertices + rank) * k + word];
        let label = labels[rank];
        rank += 1u;
        var found = select(0u, reached, label == of_word && is_covered == 0u);
        let asked = select(0u, valid, of_word == NONE && is_covered == 0u && reached != 0u);
        found |= reached & with_label(label, first_root, asked);
        whole |= found;
        var carry = s0 & found; s0 ^= found;
        var more = s1 & carry; s1 ^= carry; carry = more;
        more = s2 & carry; s2 ^= carry; carry = more;
        more = s3 & carry; s3 ^= carry; carry = more;
        more = s4 & carry; s4 ^= carry; carry = more;
        more = s5 & carry; s5 ^= carry; carry = more;
        s6 ^= carry;
    }
    let sum = tile * SUMS * k + word;
    next[tile * SLOTS * k + word] = whole;
    sums[sum] = s0; sums[sum + k] = s1; sums[sum + 2u * k] = s2; sums[sum + 3u * k] = s3;
    sums[sum + 4u * k] = s4; sums[sum + 5u * k] = s5; sums[sum + 6u * k] = s6;
}
