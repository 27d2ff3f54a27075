use enfilade::formats::dxf;
use enfilade::plan::{PlanOptions, structure, understand, axes::OpeningKind};
use enfilade::report::Report;
use std::fmt::Write;
fn main() {
    let out = std::env::args().nth(1).unwrap();
    for f in std::env::args().skip(2) {
        let Ok(bytes) = std::fs::read(&f) else { continue };
        let mut r = Report::default();
        let Ok(d) = dxf::read(&f, &bytes, &dxf::ReadOptions::default(), &mut r) else { continue };
        let Ok(p) = understand(&d, &PlanOptions::default(), &mut r) else { println!("{f}: not understood"); continue };
        let (a, _) = structure::axes(&p, &d);
        let c = |k: OpeningKind, t: bool| a.openings.iter().filter(|o| o.kind == k && o.through.is_empty() != t).count();
        println!("{f}: doors gap {} through {}; windows gap {} through {}; passages gap {} through {}", c(OpeningKind::Door, false), c(OpeningKind::Door, true), c(OpeningKind::Window, false), c(OpeningKind::Window, true), c(OpeningKind::Passage, false), c(OpeningKind::Passage, true));
        let mut s = format!("scale {} unit {}\n", p.human_scale, p.unit.unit.metres);
        for w in &p.walls { for (_, _, g) in w.trace.segments() { writeln!(s, "w {} {} {} {}", g.a[0], g.a[1], g.b[0], g.b[1]).unwrap(); } }
        let um = |q: glam::DVec2| p.frame.um_from_plan(q * p.human_scale);
        for o in &a.openings { let (x, y) = (um(o.jambs[0].at), um(o.jambs[1].at)); writeln!(s, "o {} {} {} {}", x[0], x[1], y[0], y[1]).unwrap(); }
        for g in structure::infill_lines(&p, &d, &a) { writeln!(s, "i {} {} {} {}", g.a[0], g.a[1], g.b[0], g.b[1]).unwrap(); }
        let o = p.frame.um_from_file(glam::DVec2::ZERO); writeln!(s, "z {} {} 0 0", o[0], o[1]).unwrap();
        let parts: Vec<&str> = f.split('/').collect();
        let name = parts[parts.len().saturating_sub(2)..].join("_").replace(".dxf", "");
        std::fs::write(format!("{out}/{name}.seg"), s).unwrap();
    }
}
