// Stage "shade": what the moving walls of a layout leave of what is seen without them. Twin of
// crates/engine/src/visibility.rs.
//
// One invocation holds the cells of a tile that one viewer sees against all walls of a pass; eight are those of a square.
// Coordinates are whole micrometres from the middle of the plan, within ±2^30; cross products have 64 bits in two words.

@group(0) @binding(0) var<uniform> params: Params;
@group(0) @binding(1) var<storage, read> rows: array<u32>;
@group(0) @binding(2) var<storage, read> unmoved: array<vec2<u32>>;
// Lower left cell of each tile.
@group(0) @binding(3) var<storage, read> corners: array<vec2<i32>>;
@group(0) @binding(4) var<storage, read> segments: array<vec4<i32>>;
// First segment and number of segments of each layout.
@group(0) @binding(5) var<storage, read> ranges: array<vec2<u32>>;
// Cells of each tile that may see, then those that a solid covers; by layout.
@group(0) @binding(6) var<storage, read> sight: array<vec4<u32>>;
@group(0) @binding(7) var<storage, read_write> seen: array<vec2<u32>>;

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

fn centre(tile: u32, bit: u32) -> vec2<i32> {
    return corners[tile] + vec2<i32>(vec2<u32>(bit & 7u, bit >> 3u) * params.spacing);
}

fn lowest(bits: vec2<u32>) -> u32 {
    return select(32u + firstTrailingBit(bits.y), firstTrailingBit(bits.x), bits.x != 0u);
}

// The sides that decide whether a wall stops sight, in single precision, as seen from the eye.
struct Forms {
    // Ends of the wall, and from one to the other.
    a: vec2<f32>,
    b: vec2<f32>,
    along: vec2<f32>,
    // Lower left cell of the tile, and distance of cells.
    low: vec2<f32>,
    spacing: f32,
    // On which side of the wall's line the eye lies; 0 where that is not sure.
    eye: f32,
    // What a side must be more than to be sure of its sign: more than twice what eight roundings to 24 bits make of the
    // largest products.
    margins: vec3<f32>,
}

const ROUNDING: f32 = 0.00000095367431640625;

fn cross(a: vec2<f32>, b: vec2<f32>) -> f32 {
    return a.x * b.y - a.y * b.x;
}

fn forms_of(wall: vec4<i32>, eye: vec2<i32>, low: vec2<i32>) -> Forms {
    var f: Forms;
    f.a = vec2<f32>(wall.xy - eye);
    f.b = vec2<f32>(wall.zw - eye);
    f.along = vec2<f32>(wall.zw - wall.xy);
    f.low = vec2<f32>(low - eye);
    f.spacing = f32(params.spacing);
    let far = abs(f.low) + vec2<f32>(7.0 * f.spacing);
    let along = abs(f.along);
    let a = abs(f.a);
    let b = abs(f.b);
    let of_wall = along.x * (far.y + a.y) + along.y * (far.x + a.x);
    f.margins = ROUNDING * vec3<f32>(of_wall, far.x * a.y + far.y * a.x, far.x * b.y + far.y * b.x);
    let side = cross(f.along, -f.a);
    f.eye = select(0.0, side, abs(side) > f.margins.x);
    return f;
}

// Of the wall's line and a cell of the tile; of the line of sight to this cell, and both ends of the wall.
fn sides_of(f: Forms, cell: vec2<f32>) -> vec3<f32> {
    let to = f.low + cell * f.spacing;
    return vec3<f32>(cross(f.along, to - f.a), cross(to, f.a), cross(to, f.b));
}

// Which cells of a tile a wall certainly leaves as they are, and which it stops.
const NONE: u32 = 0u;
const SOME: u32 = 1u;
const ALL: u32 = 2u;

// Whether the wall stops sight of the tile's cells: of none if the tile lies on the eye's side of it, or all of the wall
// beside all lines of sight; of all if the tile lies beyond it, between its ends. Sides are linear, so that the corners say.
fn blocked(f: Forms) -> u32 {
    let first = sides_of(f, vec2<f32>(0.0, 0.0));
    let second = sides_of(f, vec2<f32>(7.0, 0.0));
    let third = sides_of(f, vec2<f32>(0.0, 7.0));
    let fourth = sides_of(f, vec2<f32>(7.0, 7.0));
    let least = min(min(first, second), min(third, fourth));
    let most = max(max(first, second), max(third, fourth));
    let is_before = (f.eye > 0.0 && least.x > f.margins.x) || (f.eye < 0.0 && most.x < -f.margins.x);
    let is_right = least.y > f.margins.y && least.z > f.margins.z;
    let is_left = most.y < -f.margins.y && most.z < -f.margins.z;
    let is_beyond = (f.eye > 0.0 && most.x < -f.margins.x) || (f.eye < 0.0 && least.x > f.margins.x);
    let is_between = (least.y > f.margins.y && most.z < -f.margins.z) || (most.y < -f.margins.y && least.z > f.margins.z);
    if is_beyond && is_between {
        return ALL;
    }
    return select(SOME, NONE, is_before || is_right || is_left);
}

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3<u32>) {
    let number = number_of(id);
    let plan = id.y;
    let square = number / 8u;
    if square >= params.squares {
        return;
    }
    let tile = rows[params.squares_at + square * 2u];
    let viewer = rows[params.squares_at + square * 2u + 1u] * 8u + number % 8u;
    let at = (plan * params.squares + square) * SQUARE + EACH + number % 8u;
    var open = seen[at];
    if params.first_segment == 0u {
        let own = row_of(sight[plan * params.tiles + viewer / 64u].xy, viewer % 64u / 8u);
        let apart = unmoved[square * SQUARE] | unmoved[square * SQUARE + EACH + number % 8u];
        let others = ~select(vec2<u32>(0u), one(viewer & 63u), viewer / 64u == tile);
        let all = apart & others & sight[plan * params.tiles + tile].xy;
        open = select(vec2<u32>(0u), all, ((own >> (viewer & 7u)) & 1u) == 1u);
    }
    let eye = centre(viewer / 64u, viewer & 63u);
    let low = centre(tile, 0u);
    let lo = min(eye, low);
    let hi = max(eye, centre(tile, 63u));
    let range = ranges[plan];
    let end = range.x + min(params.first_segment + params.segments, range.y);
    for (var s = range.x + params.first_segment; s < end && is_any(open); s++) {
        let wall = segments[s];
        var unsure = vec2<u32>(0u);
        var left = vec2<u32>(0u);
        let forms = forms_of(wall, eye, low);
        if boxes_meet(lo, hi, wall) {
            let of_tile = blocked(forms);
            if of_tile == ALL {
                open = left;
            } else if of_tile == SOME {
                left = open;
            }
        }
        while is_any(left) {
            let bit = lowest(left);
            let only = one(bit);
            left &= ~only;
            let sides = sides_of(forms, vec2<f32>(vec2<u32>(bit & 7u, bit >> 3u)));
            let is_sure = forms.eye != 0.0 && all(abs(sides) > forms.margins);
            let blocks = (sides.x > 0.0) != (forms.eye > 0.0) && (sides.y > 0.0) != (sides.z > 0.0);
            if !is_sure {
                unsure |= only;
            } else if blocks {
                open &= ~only;
            }
        }
        while is_any(unsure) {
            let bit = lowest(unsure);
            let only = one(bit);
            unsure &= ~only;
            let to = centre(tile, bit);
            // Two closed segments touch iff their boxes meet and each straddles the other's line.
            if boxes_meet(min(eye, to), max(eye, to), wall)
                && side(wall.xy, wall.zw, eye) * side(wall.xy, wall.zw, to) <= 0
                && side(eye, to, wall.xy) * side(eye, to, wall.zw) <= 0 {
                open &= ~only;
            }
        }
    }
    seen[at] = open;
}
