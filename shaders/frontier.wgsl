// Stage "frontier": the next level of every breadth-first tree at once. Twin of src/analysis/forest.rs.
//
// One invocation gathers 32 vertices of one tree: what the frontier's vertices within a block of the
// matrix see, and the tree has not reached.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> seen: array<u32>;
@group(0) @binding(2) var<storage, read> counts: array<u32>;
@group(0) @binding(3) var<storage, read> reached: array<u32>;
@group(0) @binding(4) var<storage, read> frontier: array<u32>;
@group(0) @binding(5) var<storage, read_write> next: array<u32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let root = id.x / params.words;
    let word = id.x % params.words;
    let plan = id.y;
    if root >= params.roots {
        return;
    }
    let tree = plan * params.roots + root;
    if counts[params.slot_before * params.layouts * params.roots + tree] == 0u {
        return;
    }
    let first = tree * params.words;
    var missing = ~(reached[first + word] | next[first + word]);
    var found = 0u;
    let first_word = params.first_row / 32u;
    let end_word = min(first_word + (params.rows + 31u) / 32u, params.words);
    for (var w = first_word; w < end_word && missing != 0u; w++) {
        var left = frontier[first + w];
        while left != 0u && missing != 0u {
            let row = w * 32u + firstTrailingBit(left) - params.first_row;
            left &= left - 1u;
            let new_bits = seen[(plan * params.rows + row) * params.words + word] & missing;
            found |= new_bits;
            missing &= ~new_bits;
        }
    }
    if found != 0u {
        next[first + word] |= found;
    }
}
