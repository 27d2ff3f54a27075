// Stage "count": adds the sums of tiles, one number a root. One invocation is 32 roots and up to TILES tiles.

@group(0) @binding(0) var<uniform> params: Params;
// Whose first word of a tile is 0 has no sums.
@group(0) @binding(1) var<storage, read> next: array<u32>;
@group(0) @binding(2) var<storage, read> sums: array<u32>;
// By slot, then tree.
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;

const TILES: u32 = 64u;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = number_of(id);
    let plan = id.y;
    let k = params.words;
    let begin = number / k * TILES;
    let word = number % k;
    if begin >= params.tiles {
        return;
    }
    let end = min(begin + TILES, params.tiles);
    var any = 0u;
    // 64 tiles of 64 cells: thirteen planes.
    var s0 = 0u; var s1 = 0u; var s2 = 0u; var s3 = 0u; var s4 = 0u; var s5 = 0u; var s6 = 0u;
    var s7 = 0u; var s8 = 0u; var s9 = 0u; var s10 = 0u; var s11 = 0u; var s12 = 0u;
    for (var t = begin; t < end; t++) {
        let tile = plan * params.tiles + t;
        let met = next[tile * SLOTS * k + word];
        any |= met;
        var at = tile * SUMS * k + word;
        // Most tiles have none: a loop, as software skips loops alone.
        for (var left = met; left != 0u; left = 0u) {
            var b = sums[at];
            var c = s0 & b; s0 ^= b;
            b = sums[at + k]; var x = s1 ^ b; var d = (s1 & b) | (c & x); s1 = x ^ c; c = d;
            b = sums[at + 2u * k]; x = s2 ^ b; d = (s2 & b) | (c & x); s2 = x ^ c; c = d;
            b = sums[at + 3u * k]; x = s3 ^ b; d = (s3 & b) | (c & x); s3 = x ^ c; c = d;
            b = sums[at + 4u * k]; x = s4 ^ b; d = (s4 & b) | (c & x); s4 = x ^ c; c = d;
            b = sums[at + 5u * k]; x = s5 ^ b; d = (s5 & b) | (c & x); s5 = x ^ c; c = d;
            b = sums[at + 6u * k]; x = s6 ^ b; d = (s6 & b) | (c & x); s6 = x ^ c; c = d;
            d = s7 & c; s7 ^= c; c = d;
            d = s8 & c; s8 ^= c; c = d;
            d = s9 & c; s9 ^= c; c = d;
            d = s10 & c; s10 ^= c; c = d;
            d = s11 & c; s11 ^= c; c = d;
            s12 ^= c;
        }
    }
    let first = (params.slot * params.layouts + plan) * params.roots;
    while any != 0u {
        let i = firstTrailingBit(any);
        any &= any - 1u;
        let one = vec4<u32>(1u);
        let a = dot((vec4<u32>(s0, s1, s2, s3) >> vec4<u32>(i)) & one, vec4<u32>(1u, 2u, 4u, 8u));
        let b = dot((vec4<u32>(s4, s5, s6, s7) >> vec4<u32>(i)) & one, vec4<u32>(16u, 32u, 64u, 128u));
        let c = dot((vec4<u32>(s8, s9, s10, s11) >> vec4<u32>(i)) & one, vec4<u32>(256u, 512u, 1024u, 2048u));
        let n = a + b + c + (((s12 >> i) & 1u) << 12u);
        let root = word * 32u + i;
        if root < params.roots {
            atomicAdd(&counts[first + root], n);
        }
    }
}
