//! Against shapely: `tests/demands/make_shapely.py` made the figures, by other ways than ours.

use glam::DVec2;
use serde_json::Value;

use crate::items::circle;
use crate::items::smallest_box;
use crate::polygon::Polygon;
use crate::view::Scene;
use crate::walk::Ground;

const FIGURES: &str = include_str!("../tests/demands/shapely.json");

/// What is promised: a centimetre and a tenth of a degree; areas to what a centimetre makes of them.
const LENGTH_M: f64 = 0.01;
const ANGLE_DEG: f64 = 0.1;
const AREA_M2: f64 = 0.01;

fn point(v: &Value) -> DVec2 {
    DVec2::new(v[0].as_f64().unwrap(), v[1].as_f64().unwrap())
}

fn ring(v: &Value) -> Vec<DVec2> {
    v.as_array().unwrap().iter().map(point).collect()
}

fn cases() -> Vec<(Value, Polygon)> {
    let all: Vec<Value> = serde_json::from_str(FIGURES).unwrap();
    let floor = |c: &Value| {
        let holes: Vec<Vec<DVec2>> = c["holes"].as_array().unwrap().iter().map(ring).collect();
        Polygon::new(&ring(&c["outline"]), &holes)
    };
    all.into_iter().map(|c| (c.clone(), floor(&c))).collect()
}

fn near(found: f64, c: &Value, key: &str, by: f64) {
    let wanted = c[key].as_f64().unwrap();
    assert!((found - wanted).abs() <= by, "{key}: {found}, shapely has {wanted}");
}

#[test]
fn outlines_agree_with_shapely() {
    for (c, floor) in cases() {
        near(floor.area_m2(), &c, "area_m2", 1e-6);
        near(2.0 * circle(&floor, &[]).unwrap().1, &c, "circle_m", LENGTH_M);
        let [long, short] = smallest_box(&floor).unwrap().1;
        near(long / short, &c, "proportion", 1e-6);
    }
}

#[test]
fn views_agree_with_shapely() {
    for (c, floor) in cases() {
        let (scene, place) = (Scene::new(&floor), point(&c["place"]));
        near(scene.seen(place, None).area_m2(), &c, "seen_m2", AREA_M2);
        let window = [point(&c["window"][0]), point(&c["window"][1])];
        near(scene.width_rad(place, &[window]).to_degrees(), &c, "angle_deg", ANGLE_DEG);
    }
}

#[test]
fn ways_agree_with_shapely() {
    for (c, floor) in cases() {
        let ground = Ground::new(&floor).unwrap();
        let exit = point(&c["exit"]);
        let way = ground.ways(&[[exit, exit]]);
        near(way.from(point(&c["place"])).unwrap().length_m, &c, "walk_m", LENGTH_M);
    }
}
