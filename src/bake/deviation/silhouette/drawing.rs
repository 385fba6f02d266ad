//! Triangles drawn on a sheet: the pixels that they touch, and those whose centres they cover.

use glam::{DVec2, Vec2};

use super::mask::Mask;

/// How a sheet lies over the plane: pixels are squares.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    corner: DVec2,
    /// The side of a pixel, in object units.
    pub pixel: f64,
    columns: usize,
    rows: usize,
}

/// What was drawn of a surface.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Drawing {
    /// Pixels that share a point with a triangle: nothing is too thin to be seen.
    pub touched: Mask,
    /// Pixels whose centre is in a triangle: on average as many as the area says.
    pub covered: Mask,
}

impl Frame {
    /// `resolution` pixels along the longer side of the box around all points, half a pixel on either side being left.
    pub(super) fn around<'a>(points: impl Iterator<Item = &'a DVec2>, resolution: usize) -> Self {
        let start = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        let grow = |(min, max): (DVec2, DVec2), &point: &DVec2| (min.min(point), max.max(point));
        let (min, max) = points.fold(start, grow);
        let size = max - min;
        // What has no extent is one pixel of any size.
        let pixel = (size.max_element() / (resolution - 2) as f64).max(f64::MIN_POSITIVE);
        let count = |length: f64| (length / pixel) as usize + 2;
        Self { corner: min - 0.5 * pixel, pixel, columns: count(size.x), rows: count(size.y) }
    }

    /// Draws triangles of points. Single precision places them within a thousandth of a pixel.
    pub(super) fn draw(&self, points: &[DVec2], triangles: &[[u32; 3]]) -> Drawing {
        let place = |point: &DVec2| ((point - self.corner) / self.pixel).as_vec2();
        let places: Vec<Vec2> = points.iter().map(place).collect();
        let sheet = Mask::new(self.columns, self.rows);
        let mut drawing = Drawing { touched: sheet.clone(), covered: sheet };
        for corners in triangles {
            drawing.add(corners.map(|point| places[point as usize]));
        }
        drawing
    }
}

impl Drawing {
    /// Adds a triangle, in pixels.
    fn add(&mut self, corners: [Vec2; 3]) {
        let [a, b, c] = corners;
        let (min, max) = (a.min(b).min(c), a.max(b).max(c));
        self.touch(&corners, min, max);
        let [first_row, end_row] = [min.y, max.y].map(|y| (y + 0.5) as usize);
        for row in first_row..end_row {
            self.cover(&corners, row);
        }
    }

    fn touch(&mut self, corners: &[Vec2; 3], min: Vec2, max: Vec2) {
        let [first_row, last_row] = [min.y, max.y].map(|y| y as usize);
        if first_row == last_row {
            return self.touched.set(first_row, min.x as usize, max.x as usize);
        }
        for row in first_row..=last_row {
            let [left, right] = reach(corners, row as f32, (row + 1) as f32);
            self.touched.set(row, left as usize, right as usize);
        }
    }

    /// Adds the pixels of a row whose centres, at columns and a half, are between the sides.
    fn cover(&mut self, corners: &[Vec2; 3], row: usize) {
        let center = row as f32 + 0.5;
        let [first, end] = reach(corners, center, center).map(|x| (x + 0.5) as usize);
        if first < end {
            self.covered.set(row, first, end - 1);
        }
    }
}

/// How far to the left and right a triangle reaches between two heights, one of which at least it has.
fn reach(corners: &[Vec2; 3], low: f32, high: f32) -> [f32; 2] {
    let mut reach = [f32::INFINITY, f32::NEG_INFINITY];
    for k in 0..3 {
        let [a, b] = [corners[k], corners[(k + 1) % 3]];
        let (a, b) = if a.y <= b.y { (a, b) } else { (b, a) };
        if a.y <= high && b.y >= low {
            let at = |y: f32| a.x + (b.x - a.x) * ((y - a.y) / (b.y - a.y));
            let start = if a.y >= low { a.x } else { at(low) };
            let end = if b.y <= high { b.x } else { at(high) };
            reach = [reach[0].min(start).min(end), reach[1].max(start).max(end)];
        }
    }
    reach
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// How far a triangle and a square are apart along the line of least overlap, negative where they overlap
    /// (separating axes).
    fn gap(corners: &[DVec2; 3], square: DVec2) -> f64 {
        let along = |axis: DVec2, points: &[DVec2]| {
            let places = points.iter().map(|point| point.dot(axis));
            places.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), x| (low.min(x), high.max(x)))
        };
        let pixel = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE].map(|offset| square + offset);
        let sides = (0..3).map(|k| (corners[(k + 1) % 3] - corners[k]).perp().normalize_or_zero());
        let apart = |axis: DVec2| {
            let (triangle, pixel) = (along(axis, corners), along(axis, &pixel));
            (triangle.0 - pixel.1).max(pixel.0 - triangle.1)
        };
        sides.chain([DVec2::X, DVec2::Y]).map(apart).fold(f64::NEG_INFINITY, f64::max)
    }

    /// How far inside a triangle a point is, negative outside.
    fn depth(corners: &[DVec2; 3], point: DVec2) -> f64 {
        let turn = (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).signum();
        let side = |k: usize| {
            let along = (corners[(k + 1) % 3] - corners[k]).normalize();
            along.perp_dot(point - corners[k]) * turn
        };
        (0..3).map(side).fold(f64::INFINITY, f64::min)
    }

    fn triangle() -> impl Strategy<Value = [DVec2; 3]> {
        let number = prop_oneof![3 => 0.5..15.5, 1 => (1_u32..30).prop_map(|n| 0.5 * f64::from(n))];
        prop::array::uniform3(prop::array::uniform2(number).prop_map(DVec2::from))
    }

    proptest! {
        #[test]
        fn pixels_are_touched_and_covered_as_geometry_says(corners in triangle()) {
            let sheet = Mask::new(16, 16);
            let mut drawing = Drawing { touched: sheet.clone(), covered: sheet };
            drawing.add(corners.map(|corner| corner.as_vec2()));
            let is_set = |mask: &Mask, x: usize, y: usize| mask.in_row(y).any(|column| column == x);
            for (x, y) in (0..16).flat_map(|y| (0..16).map(move |x| (x, y))) {
                let pixel = DVec2::new(x as f64, y as f64);
                let apart = gap(&corners, pixel);
                if apart.abs() > 1e-5 {
                    prop_assert_eq!(is_set(&drawing.touched, x, y), apart < 0.0, "{} {} {}", x, y, apart);
                }
                let inside = depth(&corners, pixel + 0.5);
                if inside.abs() > 1e-5 {
                    prop_assert_eq!(is_set(&drawing.covered, x, y), inside > 0.0, "{} {} {}", x, y, inside);
                }
            }
        }
    }

    #[test]
    fn a_frame_holds_what_it_is_around() {
        let triangles = [[DVec2::new(-3.0, 1e6), DVec2::new(5.0, 1e6), DVec2::new(0.0, 1e6 + 2.0)]];
        let frame = Frame::around(triangles.as_flattened().iter(), 34);
        assert_eq!((frame.pixel, frame.columns, frame.rows), (0.25, 34, 10));
        let drawing = frame.draw(triangles.as_flattened(), &[[0, 1, 2]]);
        assert_eq!(drawing.touched.in_row(0).count(), 33);
        let area = drawing.covered.count() as f64 * frame.pixel.powi(2);
        // Off by less than half a pixel along the sides, which are 17.1 units long.
        assert!((area - 8.0).abs() < 0.5 * frame.pixel * 17.1, "{area}");
        let point = [[DVec2::splat(7.0); 3]];
        let drawing = Frame::around(point.as_flattened().iter(), 16).draw(point.as_flattened(), &[[0, 1, 2]]);
        assert_eq!((drawing.touched.count(), drawing.covered.count() <= 1), (1, true));
    }
}
