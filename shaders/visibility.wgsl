// Stage "visibility": which cells see each other, exactly. Twin of src/analysis/visibility.rs.
//
// One invocation holds 32 cells against all walls of a pass for one viewer. Coordinates are whole
// micrometres from the middle of the plan, within ±2^30; cross products have 64 bits in two words.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> centres: array<vec2<i32>>;
// Smallest and largest ordinates of the 32 cells of each word.
@group(0) @binding(2) var<storage, read> boxes: array<vec4<i32>>;
@group(0) @binding(3) var<storage, read> segments: array<vec4<i32>>;
// First segment and number of segments of each layout.
@group(0) @binding(4) var<storage, read> ranges: array<vec2<u32>>;
// Cells that a solid covers, a row of bits a layout.
@group(0) @binding(5) var<storage, read> blind: array<u32>;
@group(0) @binding(6) var<storage, read> base: array<u32>;
@group(0) @binding(7) var<storage, read_write> seen: array<u32>;

// Low and high word of a signed product.
fn product(a: i32, b: i32) -> vec2<u32> {
    let x = u32(abs(a));
    let y = u32(abs(b));
    let low = (x & 0xffffu) * (y & 0xffffu);
    let one = (x & 0xffffu) * (y >> 16u);
    let other = (x >> 16u) * (y & 0xffffu);
    let middle = (low >> 16u) + (one & 0xffffu) + (other & 0xffffu);
    let lo = (low & 0xffffu) | (middle << 16u);
    let hi = (x >> 16u) * (y >> 16u) + (one >> 16u) + (other >> 16u) + (middle >> 16u);
    if (a ^ b) >= 0 {
        return vec2<u32>(lo, hi);
    }
    return vec2<u32>(~lo + 1u, ~hi + select(0u, 1u, lo == 0u));
}

// On which side of the line from a to b the point c lies: -1, 0 or 1.
fn side(a: vec2<i32>, b: vec2<i32>, c: vec2<i32>) -> i32 {
    let p = product(b.x - a.x, c.y - a.y);
    let q = product(b.y - a.y, c.x - a.x);
    if p.y != q.y {
        return select(-1, 1, bitcast<i32>(p.y) > bitcast<i32>(q.y));
    }
    return select(select(-1, 1, p.x > q.x), 0, p.x == q.x);
}

fn boxes_meet(lo: vec2<i32>, hi: vec2<i32>, wall: vec4<i32>) -> bool {
    return all(min(wall.xy, wall.zw) <= hi) && all(max(wall.xy, wall.zw) >= lo);
}

// What no wall has been held against yet: what the fixed walls leave, or every other cell.
fn start(row: u32, word: u32, plan: u32, u: u32) -> u32 {
    let is_blind = (blind[plan * params.words + u / 32u] >> (u & 31u)) & 1u;
    if is_blind == 1u {
        return 0u;
    }
    if params.is_first == 1u {
        return base[row * params.words + word] & ~blind[plan * params.words + word];
    }
    let tail = params.vertices - word * 32u;
    let all = select((1u << (tail & 31u)) - 1u, 0xffffffffu, tail >= 32u);
    return select(all, all & ~(1u << (u & 31u)), u / 32u == word);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let row = id.x;
    let word = id.y;
    let plan = id.z;
    if row >= params.rows {
        return;
    }
    let u = params.first_row + row;
    let at = (plan * params.rows + row) * params.words + word;
    var open = seen[at];
    if params.is_first != 0u {
        open = start(row, word, plan, u);
    }
    let eye = centres[u];
    let box = boxes[word];
    let lo = min(eye, box.xy);
    let hi = max(eye, box.zw);
    let range = ranges[plan];
    let end = range.x + min(params.first_segment + params.segments, range.y);
    for (var s = range.x + params.first_segment; s < end && open != 0u; s++) {
        let wall = segments[s];
        if !boxes_meet(lo, hi, wall) {
            continue;
        }
        let near = side(wall.xy, wall.zw, eye);
        var left = open;
        while left != 0u {
            let bit = firstTrailingBit(left);
            left &= left - 1u;
            let to = centres[word * 32u + bit];
            // Two closed segments touch iff their boxes meet and each straddles the other's line.
            if boxes_meet(min(eye, to), max(eye, to), wall)
                && near * side(wall.xy, wall.zw, to) <= 0
                && side(eye, to, wall.xy) * side(eye, to, wall.zw) <= 0 {
                open &= ~(1u << bit);
            }
        }
    }
    seen[at] = open;
}
