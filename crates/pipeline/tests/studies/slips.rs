//! Slips of the pen: valid drawings with entities that have no length, no area or no inside, on every role of layer,
//! through the whole job to the written file. A few of each here; all pairs, and as many draws as there is time for,
//! by `ENFILADE_SLIPS_SECS=600 cargo test --test slips`.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a failing helper fails the test")]

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::{Duration, Instant};

use enfilade_config::{Partial, Settings};
use enfilade_pipeline::Input;
use enfilade_report::Cancel;
use rand::{RngExt, SeedableRng};

/// A layer of every role: those of the sample, and names that are believed.
const LAYERS: [&str; 12] = [
    "0",
    "A-WALL",
    "A-DOOR",
    "A-GLAZ",
    "A-COLS",
    "A-FURN",
    "A-AREA",
    "A-ANNO-TEXT",
    "EF-MOVE",
    "EF-KEEP",
    "EF-QUERY",
    "EF-REFERENCE",
];

/// Entities with nothing in them, each as group codes and values between bars; `@` is the layer.
const SLIPS: [&str; 30] = [
    "LWPOLYLINE|8|@|90|0|70|0",
    "LWPOLYLINE|8|@|90|1|70|0|10|3|20|3",
    "LWPOLYLINE|8|@|90|1|70|1|10|3|20|3|42|1",
    "LWPOLYLINE|8|@|90|2|70|1|10|3|20|3|10|3|20|3",
    "LWPOLYLINE|8|@|90|2|70|1|10|3|20|3|42|1|10|3|20|3|42|-1",
    "LWPOLYLINE|8|@|90|3|70|1|10|3|20|3|10|4|20|3|10|3|20|3",
    "LWPOLYLINE|8|@|90|4|70|1|43|0.2|10|3|20|3|10|4|20|3|10|3|20|3|10|4|20|3",
    "LWPOLYLINE|8|@|90|1|70|0|43|0.3|10|3|20|3",
    "POLYLINE|8|@|66|1|70|1|10|0|20|0|0|SEQEND|8|@",
    "POLYLINE|8|@|66|1|70|0|10|0|20|0|0|VERTEX|8|@|10|3|20|3|0|SEQEND|8|@",
    "LINE|8|@|10|3|20|3|11|3|21|3",
    "LINE|8|@|10|3|20|3|11|3.0000000001|21|3",
    "ARC|8|@|10|3|20|3|40|0|50|0|51|90",
    "ARC|8|@|10|3|20|3|40|1|50|45|51|45",
    "ARC|8|@|10|3|20|3|40|0.0000001|50|0|51|359.9999999",
    "CIRCLE|8|@|10|3|20|3|40|0",
    "CIRCLE|8|@|10|3|20|3|40|0.00000001",
    "ELLIPSE|8|@|10|3|20|3|11|0|21|0|40|1|41|0|42|6.28",
    "ELLIPSE|8|@|10|3|20|3|11|1|21|0|40|0|41|0|42|6.28",
    "ELLIPSE|8|@|10|3|20|3|11|1|21|0|40|1|41|1|42|1",
    "SPLINE|8|@|70|0|71|3|72|0|73|0|74|0",
    "SPLINE|8|@|70|8|71|3|72|8|73|4|74|0|40|0|40|0|40|0|40|0|40|1|40|1|40|1|40|1|10|3|20|3|10|3|20|3|10|3|20|3|10|3|20|3",
    "SPLINE|8|@|70|8|71|1|72|4|73|2|74|0|40|0|40|0|40|0|40|0|10|3|20|3|10|4|20|3",
    "HATCH|8|@|10|0|20|0|30|0|2|SOLID|70|1|71|0|91|0|75|0|76|1|98|0",
    "HATCH|8|@|10|0|20|0|30|0|2|SOLID|70|1|71|0|91|1|92|2|72|0|73|1|93|1|10|3|20|3|97|0|75|0|76|1|98|0",
    "SOLID|8|@|10|3|20|3|11|3|21|3|12|3|22|3|13|3|23|3",
    "TRACE|8|@|10|3|20|3|11|4|21|3|12|3|22|3|13|4|23|3",
    "POINT|8|@|10|3|20|3",
    "TEXT|8|@|10|3|20|3|40|0|1|",
    "INSERT|8|@|2|NOTHING|10|3|20|3|41|0|42|0",
];

/// A room of 8 by 6 m with a door and a wall that may move, and the slips in it.
fn drawing(slips: &[(&str, &str)]) -> String {
    let line = |layer: &str, [a, b, c, d]: [f64; 4]| format!("0|LINE|8|{layer}|10|{a}|20|{b}|11|{c}|21|{d}|");
    let walls = [
        [0.0, 0.0, 8.0, 0.0],
        [8.0, 0.0, 8.0, 6.0],
        [8.0, 6.0, 0.0, 6.0],
        [0.0, 6.0, 0.0, 0.0],
        [4.0, 0.0, 4.0, 2.0],
        [4.0, 3.0, 4.0, 6.0],
    ];
    let mut out = String::from("0|SECTION|2|HEADER|9|$ACADVER|1|AC1024|9|$INSUNITS|70|6|0|ENDSEC|");
    out +=
        "0|SECTION|2|BLOCKS|0|BLOCK|8|0|2|NOTHING|70|0|10|0|20|0|0|ENDBLK|8|0|0|ENDSEC|0|SECTION|2|ENTITIES|";
    walls.iter().for_each(|w| out += &line("A-WALL", *w));
    out += &line("A-DOOR", [4.0, 2.0, 4.9, 2.0]);
    out += "0|ARC|8|A-DOOR|10|4|20|2|40|1|50|0|51|90|";
    for (slip, layer) in slips {
        out += &format!("0|{}|", slip.replace('@', layer));
    }
    (out + "0|ENDSEC|0|EOF|").replace('|', "\n")
}

/// The whole job, then each written drawing is read again; refusals are fine, panics are not.
fn survive(slips: &[(&str, &str)], evaluations: u64) -> Result<usize, String> {
    let text = drawing(slips);
    let partial = Partial {
        evaluations: Some(evaluations),
        spacing: Some(0.5),
        seed: Some(1),
        least_gain: Some("0".into()),
        unsure: Some(enfilade_config::Unsure::Optimise),
        raw: Some(true),
        ..Partial::default()
    };
    let settings = Settings::new(partial).unwrap();
    let work = || {
        let input = Input::new("plan.dxf", text.as_bytes(), 1);
        let done = enfilade_pipeline::run(&input, &settings, Instant::now(), &mut |_| {}, &Cancel::default());
        let Ok(done) = done else { return 0 };
        let options = done.files.iter().filter(|f| f.path.extension().is_some_and(|e| e == "dxf"));
        let read_again = |f: &enfilade_report::OutFile| {
            enfilade_pipeline::check(&Input::new("option.dxf", &f.bytes, 1), &settings)
                .expect("an option is read again");
        };
        options.map(read_again).count()
    };
    catch_unwind(AssertUnwindSafe(work)).map_err(|_| format!("a panic with {slips:?}"))
}

/// The room itself has options, so that the slips below meet the whole job.
#[test]
fn the_room_without_slips_has_options() {
    assert!(survive(&[], 20).unwrap() > 0);
}

/// All slips at once on each role of layer, and some drawn at random.
#[test]
fn slips_of_the_pen_are_survived() {
    for layer in LAYERS {
        let all: Vec<(&str, &str)> = SLIPS.iter().map(|s| (*s, layer)).collect();
        survive(&all, 6).unwrap();
    }
    let mut rng = rand_chacha::ChaCha8Rng::seed_from_u64(14);
    for _ in 0..20 {
        survive(&draw(&mut rng), 6).unwrap();
    }
}

fn draw(rng: &mut rand_chacha::ChaCha8Rng) -> Vec<(&'static str, &'static str)> {
    let count = rng.random_range(1..6);
    let one = |rng: &mut rand_chacha::ChaCha8Rng| {
        (SLIPS[rng.random_range(0..SLIPS.len())], LAYERS[rng.random_range(0..LAYERS.len())])
    };
    (0..count).map(|_| one(rng)).collect()
}

/// Where there is time: each slip alone on each layer, then draws until it is over.
#[test]
fn every_slip_alone_and_many_together_are_survived() {
    let Some(secs) = std::env::var("ENFILADE_SLIPS_SECS").ok().and_then(|s| s.parse().ok()) else { return };
    let (began, limit) = (Instant::now(), Duration::from_secs(secs));
    for layer in LAYERS {
        for slip in SLIPS {
            survive(&[(slip, layer)], 20).unwrap();
        }
    }
    let (mut rng, mut count) = (rand_chacha::ChaCha8Rng::seed_from_u64(secs), 0);
    while began.elapsed() < limit {
        survive(&draw(&mut rng), 20).unwrap();
        count += 1;
    }
    println!("{count} draws");
}
