//! The commented settings file that `enfilade init` writes.

/// Every key with its default, as a comment.
pub const TEXT: &str = r#"# Settings of the drawings in this folder. A file `<drawing>.enfilade.toml` beside one drawing says it for
# that drawing alone; the command line overrides both. Lines that begin with # are comments.

# How a drawing is read
# unit = "mm"                       # mm, cm, m, in, ft: overrides the file
# wall-layer = ["A-WALL*"]          # layers of the walls, * and ? may stand in them
# query-layer = "EF-QUERY"          # where people stand
# reference-layer = "EF-REFERENCE"  # what they should see
# storey = "Level 1"                # of a building, or its number from the lowest; by default the one with most walls
# over-stairs = true                # steps are counted over the stairs to the other storeys too
# of-storey = "Level 1"             # moves, regions, works and pins here are of that storey, and not used on others
# query = "space:Gallery*"           # spaces of a building that are the region of query
# accept-missing-eof = false        # read a DXF that ends without its end mark
# unsure = "ask"                    # an unsure reading: ask and make no option; or "optimise"

# How it is measured
# spacing = 0.5                     # metres between cell centres; by default about 1500 cells
# lattice-centre = [0.0, 0.0]       # a cell centre, metres
# seed-point = [[2.0, 2.0]]         # the region is what a flood from here reaches, drawing units
# level = "eye"                     # eye: windows are seen through; knee: they block
# threads = 4                       # all cores by default

# What is better, in order, each with the share of the reachable gain that every option must keep
# Measures: degree, depth, entropy, mean-depth, reach, connectivity, integration (-p-value, -tekl),
# relativised-entropy, isovist-area, -perimeter, -compactness, -occlusivity, -drift, -max-radial, -min-radial;
# and, slower, clustering, control, controllability, first-moment, second-moment, metric-distance, metric-angle,
# metric-straight, angular-depth, angular-total, through-vision.
# Their mean, or with -min, -max, -p10 behind: the least, the most, a percentile. @entrance: over the regions
# drawn on EF-QUERY-entrance and EF-REFERENCE-entrance
# objective = "degree max 0.7, depth min 0.7, entropy max 0.7"
# score = "degree +1, depth -1, entropy +1"
# penalty = "none"   # or "clearance 1, wall-length 0.5"; also alignment, overlap, passage, room-area

# What no option may break
# limit = "wall-length -5%, room-area -5%, clearance 3, passage 0.9 m, degree-p10 >= 40"
# link = ["same: door-1, door-2", "mirror-x: left, right", "equal: a, b, c"]   # groups that move together
# snap = "0.1 m, 5 deg"             # modules that moves keep to
# most-moves = 4                    # groups that an option may move
# until-converged = true            # end at about 95 % of what would be found; evaluations and seconds are the most
# together = 16                     # layouts measured at once: more fill more cores or a card, fewer learn sooner
# only-marked = true                # nothing moves where nothing is marked
# brief = "none"                    # or "kitchen area min 8 m2; rule=ways-out-35m": checked for the present layout
# budget = "none"                   # or "2 works, 4 m": what the building works of an option may cost
# allow = "none"                    # or structure, open-joints, crossings, narrow-ways, things, any-step
# pin = [[0.5, 0.0]]                # parameters of options that stay; others are found unlike them
# like = [0.5, 0.0]                 # look near this one only
# warm = [[0.2, 0.1]]               # layouts worth knowing before the search begins

# The search
# members = 5                       # options wanted
# distance = 0.2                    # how far apart, as a share of the largest distance
# mode = "diverse"                  # or "best": the single optimum
# method = "default"                # or "paper": the algorithms as published
# evaluations = 1000                # layouts to measure
# seconds = 20.0                    # or a time: the result then depends on the machine
# write-every = 10.0                # seconds after which what was found so far is written, into so-far/
# seed = 1

# What is shown
# colours = "safe"                  # for colour-blind eyes; or "blue-to-red"
# overlay = "drawn"                 # heat maps, notes and traces; or "attach": in a DXF of their own
# pictures = true                   # false: the numbers alone, sooner
# out = "results"                   # results go to results/plan.enfilade/, below this file, not beside the drawing

# Moves and regions that are not drawn (they stand in a drawing's own file)
# ignore-move-markers = false
# [[move]]
# name = "door-1"
# moves = "x -1 1; rotate -15 15"      # or works: "open 0.9m 2.4m; remove"
# nodes = [[12.5, 4.0], [13.4, 4.0]]   # wall ends, drawing units
# handles = ["2F3"]                    # or whole entities
# layers = ["A-WALL-MOVE"]             # or layers
# [reading]                            # corrections; here of layers and blocks, in a drawing's own file of handles too
# wall = ["layer:A-FULL*"]             # these are walls
# not_wall = ["block:SINK-*"]          # these are none
# door = ["layer:L7"]                  # these show doors
# window = ["layer:L8"]                # these show windows
# as_drawn = false                     # true: every line stops sight, nothing is interpreted
# In a drawing's own file also: view = 1 or [0, 0, 20, 15], inside = [[4.0, 3.0]], outside = [[9.0, 3.0]],
# rooms = ["3=bath"]
# [[region]]
# kind = "query"                       # query, reference, keep
# pair = "entrance"                    # of a named pair; without it, of the unnamed one
# points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]]
# [[work]]                             # a building work that is decided: the plan is read as it will be
# kind = "open"                        # open, remove, new: as EF-OPEN, EF-REMOVE and EF-NEW
# points = [[3.7, 2.0], [4.3, 2.0], [4.3, 3.2], [3.7, 3.2]]
# text = "door 0.9m"                   # or "glass"; of what is new its thickness

# The daemon
# [watch]
# quiet-secs = 0.7                  # a save has ended when the file rests that long
# network-quiet-secs = 10.0
# grace-secs = 5.0                  # how long a drawing may be gone in the middle of a save
# max-wait-secs = 60.0              # then an unfinished file is reported
# rescan-secs = 60.0                # everything is looked at that often, whatever was heard
# poll = false                      # true: trust no events, look every poll-secs
# poll-secs = 2.0
# depth = 0                         # folders below
# ignore = ["*-backup.dxf"]
# newest-first = false              # of many drawings waiting
# fallback = "results"              # results go there where nothing may be written beside a drawing
# jobs = 2                          # drawings worked on at once; without it, by the cores, 2 to 4
# memory-mb = 8192                  # memory for all jobs together; without it, nine tenths of the machine's
# read-limit-secs = 300.0           # a drawing that is read longer is given up and reported
# job-limit-secs = 3600.0           # the same for the whole job
# job-memory-mb = 4096              # the same for the memory of one job; without it, three quarters of memory-mb
"#;

#[cfg(test)]
mod tests {
    use enfilade_config::{Partial, Settings};

    #[test]
    fn every_commented_key_is_a_key() {
        let keys: String = super::TEXT
            .lines()
            .filter_map(|l| l.strip_prefix("# "))
            .filter(|l| l.starts_with('[') || l.split_once(" = ").is_some_and(|(k, _)| !k.contains(' ')))
            .map(|l| format!("{l}\n"))
            .collect();
        let partial = Partial::from_toml("enfilade.toml", &keys).unwrap();
        assert_eq!(partial.moves.len(), 1);
        Settings::new(partial).unwrap();
    }
}
