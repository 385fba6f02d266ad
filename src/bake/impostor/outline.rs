//! Polygons around what a frame shows, so that fewer transparent pixels are drawn.

use glam::DVec2;

use super::Window;

/// What the quads of an impostor are cut to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Outline {
    /// Four corners, whatever is inside.
    Rectangle,
    /// Up to eight corners around what is inside.
    Polygon,
}

/// Directions in which support is measured. Twice as many as sides may stay, so that there is a choice.
const DIRECTIONS: usize = 16;

/// Those along the axes of the frame, which always stay: the polygon may not leave the window.
const AXIS: usize = DIRECTIONS / 4;

/// The most sides.
const SIDES: usize = 8;

/// How far points reach in each direction.
pub(super) struct Supports([f64; DIRECTIONS]);

impl Supports {
    pub(super) const NONE: Self = Self([f64::NEG_INFINITY; DIRECTIONS]);

    pub(super) fn add(&mut self, point: DVec2) {
        for (support, normal) in self.0.iter_mut().zip(NORMALS) {
            *support = support.max(point.dot(normal));
        }
    }

    /// Lower left and upper right corner.
    pub(super) fn bounds(&self) -> (DVec2, DVec2) {
        let [right, top, left, bottom] = [0, 1, 2, 3].map(|quarter| self.0[quarter * AXIS]);
        (DVec2::new(-left, -bottom), DVec2::new(right, top))
    }
}

/// From the right counter-clockwise, 22.5° apart: cosine and sine.
const NORMALS: [DVec2; DIRECTIONS] = {
    const C: f64 = 0.923_879_532_511_286_7;
    const S: f64 = 0.382_683_432_365_089_8;
    const D: f64 = std::f64::consts::FRAC_1_SQRT_2;
    [
        DVec2::new(1.0, 0.0),
        DVec2::new(C, S),
        DVec2::new(D, D),
        DVec2::new(S, C),
        DVec2::new(0.0, 1.0),
        DVec2::new(-S, C),
        DVec2::new(-D, D),
        DVec2::new(-C, S),
        DVec2::new(-1.0, 0.0),
        DVec2::new(-C, -S),
        DVec2::new(-D, -D),
        DVec2::new(-S, -C),
        DVec2::new(0.0, -1.0),
        DVec2::new(S, -C),
        DVec2::new(D, -D),
        DVec2::new(C, -S),
    ]
};

/// The corners of a polygon with everything inside by `margin` at least, itself within the window.
pub(super) fn cut(outline: Outline, supports: &Supports, margin: f64, window: &Window) -> Vec<DVec2> {
    match outline {
        Outline::Rectangle => rectangle(window),
        Outline::Polygon => {
            let lines = supports.0.map(|support| support + margin);
            let sides = fewest(&lines, margin);
            let ends = sides.iter().zip(sides.iter().cycle().skip(1));
            let corners = ends.map(|(&a, &b)| meeting(&lines, a, b));
            corners.map(|corner| corner.clamp(window.min, window.max)).collect()
        }
    }
}

fn rectangle(&Window { min, max }: &Window) -> Vec<DVec2> {
    vec![min, DVec2::new(max.x, min.y), max, DVec2::new(min.x, max.y)]
}

/// The sides that stay: those go, one by one, whose going adds least to the area, until few enough are left and each of
/// them tells. All lines touch what is inside, so that they bound a polygon in this order.
fn fewest(lines: &[f64; DIRECTIONS], margin: f64) -> Vec<usize> {
    let mut sides: Vec<usize> = (0..DIRECTIONS).collect();
    loop {
        let added = |at: usize| added_area(lines, &sides, at);
        let going = (0..sides.len()).filter(|&at| !sides[at].is_multiple_of(AXIS));
        let Some(least) = going.min_by(|&a, &b| added(a).total_cmp(&added(b))) else { return sides };
        if sides.len() <= SIDES && added(least) > TELLING * margin * margin {
            return sides;
        }
        sides.remove(least);
    }
}

/// A side that saves less than this share of a quarter of a texel is of no use.
const TELLING: f64 = 0.25;

/// By how much the polygon grows where a side goes.
fn added_area(lines: &[f64; DIRECTIONS], sides: &[usize], at: usize) -> f64 {
    let (before, after) = (sides[(at + sides.len() - 1) % sides.len()], sides[(at + 1) % sides.len()]);
    let (start, end) = (meeting(lines, before, sides[at]), meeting(lines, sides[at], after));
    0.5 * (end - start).perp_dot(meeting(lines, before, after) - end).abs()
}

/// Where two lines meet that are less than half a turn apart.
fn meeting(lines: &[f64; DIRECTIONS], a: usize, b: usize) -> DVec2 {
    let (p, q) = (NORMALS[a], NORMALS[b]);
    DVec2::new(lines[a] * q.y - lines[b] * p.y, lines[b] * p.x - lines[a] * q.x) / p.perp_dot(q)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn area(corners: &[DVec2]) -> f64 {
        let next = corners.iter().cycle().skip(1);
        corners.iter().zip(next).map(|(a, b)| 0.5 * a.perp_dot(*b)).sum()
    }

    fn cut_around(points: &[DVec2], margin: f64) -> (Vec<DVec2>, Window) {
        let mut supports = Supports::NONE;
        points.iter().for_each(|&p| supports.add(p));
        let (min, max) = supports.bounds();
        let window = Window { min: min - margin, max: max + margin };
        (cut(Outline::Polygon, &supports, margin, &window), window)
    }

    proptest! {
        #[test]
        fn everything_is_inside_and_the_polygon_in_its_window(
            points in prop::collection::vec(prop::array::uniform2(-9.0..9.0_f64).prop_map(DVec2::from_array), 1..40),
            margin in 0.01..1.0_f64,
        ) {
            let (corners, window) = cut_around(&points, margin);
            prop_assert!((4..=8).contains(&corners.len()));
            for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
                let edge = *b - *a;
                let inside = points.iter().map(|p| edge.perp_dot(*p - *a));
                prop_assert!(inside.fold(f64::INFINITY, f64::min) >= edge.length() * margin - 1e-9);
                prop_assert!(a.cmpge(window.min).all() && a.cmple(window.max).all());
            }
            let whole = (window.max - window.min).element_product();
            prop_assert!(area(&corners) > 0.0 && area(&corners) <= whole * (1.0 + 1e-12));
        }
    }

    #[test]
    fn a_square_has_four_sides_and_a_disc_eight() {
        let square = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
        let (corners, window) = cut_around(&square, 1e-3);
        assert_eq!(corners.len(), 4);
        assert!((area(&corners) - area(&rectangle(&window))).abs() < 1e-12);
        let disc: Vec<DVec2> = (0..64).map(|i| DVec2::from_angle(f64::from(i) * 0.0982)).collect();
        let corners = cut_around(&disc, 1e-3).0;
        assert!(corners.len() == 8 && area(&corners) < 3.4, "{}", area(&corners));
    }
}
