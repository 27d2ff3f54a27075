//! Time to read drawings: a made one of 46 MB, and real ones where there are any.
//!
//! `cargo bench --bench reading`; real drawings: the folder `data/dxf` of `ENFILADE_SHARED`. One thread; times by the
//! clock, so look at the load too.

#![allow(clippy::unwrap_used, missing_docs)]

use std::fmt::Write;
use std::time::Instant;

use enfilade_cad::dxf::{ReadOptions, read};
use enfilade_plan::graph::Graph;
use enfilade_plan::{PlanOptions, structure, understand};
use enfilade_report::Report;

/// Size of the made drawing.
const BYTES: usize = 46_000_000;

/// How often each drawing is read; the quickest counts.
const TIMES: usize = 5;

fn main() {
    let made = made();
    let quickest = quickest(|| {
        let drawing = read("made.dxf", made.as_bytes(), &ReadOptions::default(), &mut Report::default());
        assert!(drawing.is_ok_and(|d| d.entities.len() > 100_000));
    });
    println!("{:<34} {:>8.1} MB  read in {:.3} s", "made", made.len() as f64 / 1e6, quickest);
    let shared = std::env::var("ENFILADE_SHARED").unwrap_or_else(|_| "../shared".into());
    let Ok(folder) = std::fs::read_dir(std::path::Path::new(&shared).join("data/dxf")) else { return };
    let mut paths: Vec<_> = folder.flatten().map(|e| e.path()).collect();
    paths.sort();
    for path in paths {
        let (name, bytes) = (path.file_stem().unwrap().to_string_lossy(), std::fs::read(&path).unwrap());
        let seconds = quickest_of(&name, &bytes);
        println!(
            "{name:<34} {:>8.1} MB  read in {:.3} s, understood in {:.3} s",
            bytes.len() as f64 / 1e6,
            seconds[0],
            seconds[1]
        );
    }
}

/// Seconds to read a real drawing, and to understand it: walls, views, axes, openings.
fn quickest_of(name: &str, bytes: &[u8]) -> [f64; 2] {
    let mut report = Report::default();
    let Ok(drawing) = read(name, bytes, &ReadOptions::default(), &mut report) else { return [f64::NAN; 2] };
    let reading = quickest(|| {
        assert!(read(name, bytes, &ReadOptions::default(), &mut Report::default()).is_ok());
    });
    let understanding = quickest(|| {
        if let Ok(plan) = understand(&drawing, &PlanOptions::default(), &mut Report::default()) {
            let (axes, marked) = structure::axes(&plan, &drawing);
            let fittings = enfilade_plan::fittings::fittings(&plan, &drawing, &axes, &marked);
            assert!(Graph::new(&plan).len > 0 && fittings.len() <= drawing.entities.len());
        }
    });
    [reading, understanding]
}

fn quickest(mut work: impl FnMut()) -> f64 {
    let once = |_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    };
    (0..TIMES).map(once).fold(f64::MAX, f64::min)
}

/// Lines, polylines and texts as a CAD program writes them.
fn made() -> String {
    let mut out = String::from(
        "  0\r\nSECTION\r\n  2\r\nHEADER\r\n  9\r\n$ACADVER\r\n  1\r\nAC1027\r\n  9\r\n$INSUNITS\r\n 70\r\n     4\r\n  0\r\nENDSEC\r\n  0\r\nSECTION\r\n  2\r\nENTITIES\r\n",
    );
    let mut i = 0u32;
    while out.len() < BYTES {
        let (x, y) = (f64::from(i % 997) * 113.7, f64::from(i / 997) * 87.3);
        let head = |kind: &str, class: &str| {
            format!(
                "  0\r\n{kind}\r\n  5\r\n{:X}\r\n100\r\nAcDbEntity\r\n  8\r\nA-WALL\r\n100\r\n{class}\r\n",
                0x100 + i
            )
        };
        match i % 8 {
            0 => write!(
                out,
                "{} 90\r\n        3\r\n 70\r\n     1\r\n 10\r\n{x}\r\n 20\r\n{y}\r\n 10\r\n{}\r\n 20\r\n{y}\r\n 42\r\n0.5\r\n 10\r\n{x}\r\n 20\r\n{}\r\n",
                head("LWPOLYLINE", "AcDbPolyline"),
                x + 91.25,
                y + 12.5
            ),
            1 => write!(
                out,
                "{} 10\r\n{x}\r\n 20\r\n{y}\r\n 30\r\n0.0\r\n 40\r\n2.5\r\n  1\r\nRoom {i}\r\n",
                head("TEXT", "AcDbText")
            ),
            _ => write!(
                out,
                "{} 10\r\n{x}\r\n 20\r\n{y}\r\n 30\r\n0.0\r\n 11\r\n{}\r\n 21\r\n{}\r\n 31\r\n0.0\r\n",
                head("LINE", "AcDbLine"),
                x + 73.125,
                y + 0.0625
            ),
        }
        .unwrap();
        i += 1;
    }
    out + "  0\r\nENDSEC\r\n  0\r\nEOF\r\n"
}
