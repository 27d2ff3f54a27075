use std::f64::consts::{FRAC_1_SQRT_2, FRAC_PI_2, PI};

use super::*;

fn points(shape: &Shape) -> Vec<DVec2> {
    let Shape::Polyline { vertices, .. } = shape else { panic!("{shape:?}") };
    vertices.iter().map(|v| v.at).collect()
}

#[test]
fn mirrored_arcs_swap_their_ends_and_bulges_their_sign() {
    let mirror = ocs_to_world(DVec3::NEG_Z, 0.0);
    let arc = Shape::Arc { centre: DVec2::new(1.0, 2.0), radius: 3.0, start_rad: 0.0, end_rad: FRAC_PI_2 };
    let Shape::Arc { centre, radius, start_rad, end_rad } = mapped(&arc, &mirror, None) else { panic!() };
    assert_eq!((centre, radius), (DVec2::new(-1.0, 2.0), 3.0));
    assert!((start_rad - FRAC_PI_2).abs() < 1e-15 && (end_rad - PI).abs() < 1e-15, "{start_rad} {end_rad}");
    let line = Shape::Polyline {
        vertices: vec![Vertex { at: DVec2::ZERO, bulge: 0.5 }, Vertex { at: DVec2::X, bulge: 0.0 }],
        closed: false,
    };
    let Shape::Polyline { vertices, .. } = mapped(&line, &mirror, None) else { panic!() };
    assert_eq!(vertices[0].bulge, -0.5);
}

#[test]
fn flattened_curves_stay_within_their_tolerance() {
    let stretch = DAffine2::from_scale(DVec2::new(2.0, 1.0));
    let circle = Shape::Circle { centre: DVec2::ZERO, radius: 1000.0 };
    let ring = points(&mapped(&circle, &stretch, Some(5.0)));
    let worst = (0..ring.len())
        .map(|i| (ring[i] + ring[(i + 1) % ring.len()]) / 2.0)
        .map(|p| (1.0 - DVec2::new(p.x / 2000.0, p.y / 1000.0).length()) * 1000.0)
        .fold(0.0, f64::max);
    assert!(worst > 0.0 && worst <= 5.0, "{worst} with {} points", ring.len());
}

#[test]
fn a_rational_spline_is_the_quarter_circle_it_stands_for() {
    let control = [DVec2::X, DVec2::ONE, DVec2::Y];
    let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let curve = spline(2, &knots, &control, &[1.0, FRAC_1_SQRT_2, 1.0], Some(1e-4)).unwrap();
    assert!(curve.len() > 10, "{}", curve.len());
    assert!(curve.iter().all(|p| (p.length() - 1.0).abs() < 1e-12));
    assert_eq!((curve[0], curve[curve.len() - 1]), (DVec2::X, DVec2::Y));
}

#[test]
fn a_straight_spline_is_two_points() {
    let control: Vec<DVec2> = (0..6).map(|i| DVec2::new(f64::from(i), 2.0 * f64::from(i))).collect();
    let knots = [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0, 4.0];
    assert_eq!(spline(2, &knots, &control, &[], None).unwrap().len(), 2);
}

#[test]
fn broken_splines_say_why() {
    let c = [DVec2::ZERO, DVec2::X, DVec2::Y];
    assert!(spline(0, &[0.0; 4], &c, &[], None).unwrap_err().contains("degree"));
    assert!(spline(3, &[0.0; 7], &c, &[], None).unwrap_err().contains("too few"));
    assert!(spline(2, &[0.0; 5], &c, &[], None).unwrap_err().contains("number of knots"));
    assert!(spline(2, &[0.0, 0.0, 1.0, 0.5, 2.0, 2.0], &c, &[], None).unwrap_err().contains("rise"));
    assert!(
        spline(2, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0], &c, &[1.0, -1.0, 1.0], None)
            .unwrap_err()
            .contains("weights")
    );
}

#[test]
fn the_curve_through_fit_points_meets_them_and_its_tangents() {
    let fit: Vec<DVec2> = (0..9).map(|i| DVec2::from_angle(f64::from(i) * PI / 8.0)).collect();
    let curve = fit_spline(&fit, [Some(DVec2::Y), Some(DVec2::NEG_Y)], Some(1e-4));
    assert!(curve.iter().all(|p| (p.length() - 1.0).abs() < 2e-4));
    assert!(fit.iter().all(|p| curve.iter().any(|q| p.distance(*q) < 1e-12)));
}

#[test]
fn no_curve_has_more_pieces_than_the_limit() {
    assert_eq!(pieces_of(1e30, 1e6 * PI, Some(1e-9)), MAX_CURVE_PIECES);
}

#[test]
fn a_turned_spline_has_as_many_pieces() {
    let control = [DVec2::ZERO, DVec2::new(9.0, 4.0), DVec2::new(2.0, 7.0), DVec2::new(30.0, 1.0)];
    let knots = [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let pieces = |turn: f64| {
        let turned = control.map(|p| DVec2::from_angle(turn).rotate(p));
        spline(3, &knots, &turned, &[], Some(5.0)).unwrap().len()
    };
    assert!(pieces(0.0) > 4);
    assert!((0..90).all(|k| pieces(f64::from(k) * 0.07) == pieces(0.0)));
}
