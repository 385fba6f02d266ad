//! What is seen on average: an estimate, from points spread over the surface and directions spread over what is valid.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use super::body::Body;
use super::frame::View;
use super::sights::polygon_area;
use super::{Facing, Impostor, Kind};

/// More give the mean square more digits, at a nanosecond or so for each pair of a point and a direction.
const POINTS: usize = 512;
const DIRECTIONS: usize = 128;

/// The root mean square error and the fill, as [`Impostor`] has them.
pub(super) fn looked_at(impostor: &Impostor, body: &Body) -> (f64, f64) {
    let (points, directions) = (points(body), directions(impostor));
    let squares: f64 = directions.iter().map(|&v| mean_square(impostor, &points, v)).sum();
    let fill: f64 = directions.iter().map(|&v| filled(impostor, v)).sum();
    let count = directions.len() as f64;
    // A texel stands for all that is in it.
    let texel = 1.0 / impostor.atlas.texels_per_unit;
    ((squares / count + texel * texel / 6.0).sqrt(), fill / count)
}

/// How far what is shown is from where it is, squared.
fn mean_square(impostor: &Impostor, points: &[DVec3], v: DVec3) -> f64 {
    let distance = impostor.validity.nearest;
    let seen = |p: DVec3| (p - p.dot(v) * v) * (distance / (distance - p.dot(v)));
    let quads = impostor.sights(v).into_iter().map(|sight| {
        let frame = &impostor.frames[sight.frame];
        (sight.weight, frame.view(), impostor.quad(frame, v))
    });
    let quads: Vec<_> = quads.collect();
    let square = |&p: &DVec3| {
        let off = |(weight, frame, quad): &(f64, View, View)| {
            weight * seen(quad.lift(frame.flat(p))).distance_squared(seen(p))
        };
        quads.iter().map(off).sum::<f64>()
    };
    points.iter().map(square).sum::<f64>() / points.len() as f64
}

/// Pixels that are drawn, in those of the bound's disc.
fn filled(impostor: &Impostor, v: DVec3) -> f64 {
    let shown: f64 = match impostor.kind {
        Kind::Octahedral { .. } => 4.0 * impostor.cover[0] * impostor.cover[1],
        Kind::CrossQuads { .. } => {
            impostor.frames.iter().map(|frame| polygon_area(frame) * frame.direction.dot(v).abs()).sum()
        }
        Kind::Billboard { facing, .. } => {
            let area = polygon_area(&impostor.frames[impostor.sights(v)[0].frame]);
            if facing == Facing::Axis { area * impostor.facing(v) } else { area }
        }
    };
    shown / (PI * impostor.radius * impostor.radius)
}

/// Points that are equally dense all over the surface; the corners of one that has no area.
fn points(body: &Body) -> Vec<DVec3> {
    let area = |triangle: usize| {
        let [a, b, c] = body.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    };
    let areas: Vec<f64> = (0..body.triangles.len()).map(area).collect();
    let whole: f64 = areas.iter().sum();
    if whole <= 0.0 {
        return body.points.clone();
    }
    let (mut triangle, mut before) = (0, 0.0);
    let point = |k: usize| {
        let at = whole * (k as f64 + 0.5) / POINTS as f64;
        while before + areas[triangle] < at && triangle + 1 < areas.len() {
            before += areas[triangle];
            triangle += 1;
        }
        within(body.corners(triangle), k)
    };
    (0..POINTS).map(point).collect()
}

/// The k-th of points that fill a triangle evenly: additive recurrence by the plastic number (M. Roberts, "The
/// unreasonable effectiveness of quasirandom sequences", 2018), mirrored into the lower half of the square.
fn within([a, b, c]: [DVec3; 3], k: usize) -> DVec3 {
    let at = (DVec2::new(0.754_877_666_246_692_8, 0.569_840_290_998_053_3) * (k as f64 + 1.0)).fract();
    let at = if at.x + at.y > 1.0 { DVec2::ONE - at } else { at };
    a + (b - a) * at.x + (c - a) * at.y
}

/// Unit vectors that are equally dense over what is valid: a spiral by the golden angle.
fn directions(impostor: &Impostor) -> Vec<DVec3> {
    let basis = impostor.basis();
    let [low, high] = impostor.validity.elevation_deg.map(|e| e.to_radians().sin());
    let yaw = impostor.validity.yaw_deg.to_radians();
    let direction = |k: usize| {
        let share = (k as f64 + 0.5) / DIRECTIONS as f64;
        let turn = (k as f64 * 0.618_033_988_749_894_9).fract();
        basis.direction(yaw * (2.0 * turn - 1.0), (low + (high - low) * share).asin())
    };
    (0..DIRECTIONS).map(direction).collect()
}
