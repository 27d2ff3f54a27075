// Stage "levels": counts what the frontier stage found, and makes it the frontier. Twin of `tally` in
// src/analysis/forest.rs. One invocation is 32 vertices of one tree.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read_write> reached: array<u32>;
@group(0) @binding(2) var<storage, read_write> frontier: array<u32>;
@group(0) @binding(3) var<storage, read_write> next: array<u32>;
// Vertices a level, by slot, then tree.
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>>;
// Neighbours in the region of reference of every tree's root, then what every root lost.
@group(0) @binding(5) var<storage, read_write> roots_out: array<atomic<u32>>;
// Bits of the region of reference, the component of each vertex in the initial plan, the roots.
@group(0) @binding(6) var<storage, read> region: array<u32>;
@group(0) @binding(7) var<storage, read> blind: array<u32>;

// Those of 32 vertices that belonged to a root's component and are not covered now.
fn candidates(bits: u32, word: u32, plan: u32, root: u32) -> u32 {
    let covered = blind[plan * params.words + root / 32u] >> (root & 31u);
    var left = select(bits & ~blind[plan * params.words + word], 0u, (covered & 1u) == 1u);
    var kept = 0u;
    let label = region[params.words + root];
    while left != 0u {
        let bit = firstTrailingBit(left);
        left &= left - 1u;
        if region[params.words + word * 32u + bit] == label {
            kept |= 1u << bit;
        }
    }
    return kept;
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = id.x / params.words;
    let word = id.x % params.words;
    let plan = id.y;
    if number >= params.roots {
        return;
    }
    let trees = params.layouts * params.roots;
    let tree = plan * params.roots + number;
    let at = tree * params.words + word;
    let root = region[params.words + params.vertices + params.first_root + number];
    if params.level == 0u {
        let own = select(0u, 1u << (root & 31u), root / 32u == word);
        reached[at] = own;
        frontier[at] = own;
        next[at] = 0u;
        let tail = params.vertices - min(params.vertices, word * 32u);
        let valid = select((1u << (tail & 31u)) - 1u, 0xffffffffu, tail >= 32u);
        let others = countOneBits(candidates(valid & ~own, word, plan, root));
        if others != 0u {
            atomicAdd(&roots_out[trees + tree], others);
        }
        if word == 0u {
            atomicStore(&counts[tree], 1u);
        }
        return;
    }
    if atomicLoad(&counts[params.slot_before * trees + tree]) == 0u {
        return;
    }
    let fresh = next[at];
    frontier[at] = fresh;
    if fresh == 0u {
        return;
    }
    reached[at] |= fresh;
    next[at] = 0u;
    atomicAdd(&counts[params.slot * trees + tree], countOneBits(fresh));
    atomicSub(&roots_out[trees + tree], countOneBits(candidates(fresh, word, plan, root)));
    if params.level == 1u {
        atomicAdd(&roots_out[tree], countOneBits(fresh & region[word]));
    }
}
