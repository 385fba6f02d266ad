//! One kind of attribute on its way through a simplification: normals, texture coordinates or colours.
//!
//! H. Hoppe, "New quadric metric for simplifying meshes with appearance attributes", 1999. Over a triangle an attribute
//! is a linear function of the place. What a vertex's attribute costs is the squared difference from the functions of
//! all triangles that were contracted into it, weighted by their areas; the best value at a place is the mean of the
//! functions there. With that value put in, the cost is a quadratic form of the place alone, and adds to the geometric
//! one. Where we depart from the paper: each kind of attribute has wedges of its own, so that a hard edge in the normals
//! does not tear the texture.

use glam::DVec3;

use super::form::Form;
use crate::bake::simplify::fans::Fans;
use crate::bake::simplify::link::others;

/// The triangles as they are now, and who uses a vertex.
#[derive(Clone, Copy)]
pub(super) struct Around<'a> {
    pub(super) triangles: &'a [[u32; 3]],
    pub(super) fans: &'a Fans,
}

impl Around<'_> {
    /// The triangles at an edge.
    pub(super) fn edge(self, a: u32, b: u32) -> impl Iterator<Item = usize> {
        let fan = self.fans.of(a).iter().map(|&t| t as usize);
        fan.filter(move |&t| others(self.triangles[t], a).contains(&b))
    }

    /// Which corner of a triangle a vertex is.
    fn corner(self, triangle: usize, vertex: u32) -> usize {
        let [a, b, _] = self.triangles[triangle];
        if a == vertex {
            0
        } else if b == vertex {
            1
        } else {
            2
        }
    }
}

/// A contraction of two vertices, seen from the first.
#[derive(Clone, Copy)]
pub(super) struct Move {
    pub(super) kept: u32,
    pub(super) gone: u32,
    /// From the first to the second.
    pub(super) edge: DVec3,
    /// Where both go: zero for exactly where the first is, `edge` for exactly where the second is.
    pub(super) to: DVec3,
}

/// What is known of a wedge, seen from its vertex.
#[derive(Clone, Copy, Default)]
struct Wedge {
    /// Area of the triangles that were contracted into it.
    area: f64,
    /// The sum of the squares of their functions, weighted by area.
    squares: Form,
}

/// The area-weighted sum of linear functions of the place.
#[derive(Clone, Copy, Default)]
struct Linear {
    slope: DVec3,
    value: f64,
}

impl Linear {
    #[inline]
    fn seen_from(self, origin: DVec3) -> Self {
        Self { value: self.value + self.slope.dot(origin), ..self }
    }

    #[inline]
    fn plus(self, other: Self) -> Self {
        Self { slope: self.slope + other.slope, value: self.value + other.value }
    }
}

/// Wedges of both ends of an edge that become one.
#[derive(Default)]
struct Group {
    kept: Vec<u32>,
    gone: Vec<u32>,
}

/// A vertex with more than one wedge.
const SEVERAL: u32 = u32::MAX;

/// The wedges of one kind of attribute: a wedge is shared by neighbouring corners of a vertex that have the same value.
pub(super) struct Layer {
    /// Values per wedge.
    width: usize,
    /// Squared weight of an attribute's difference against a distance; 0 for one that goes along and does not count.
    weight: f64,
    /// Per triangle and corner, its wedge.
    corners: Vec<[u32; 3]>,
    /// Per vertex, its only wedge, or [`SEVERAL`].
    only: Vec<u32>,
    wedges: Vec<Wedge>,
    /// Per wedge and value, the sum of its triangles' functions.
    sums: Vec<Linear>,
    /// Per wedge and value, what it is now.
    values: Vec<f32>,
}

impl Layer {
    /// The layer of some triangles' corners, whose wedges have `width` of the `values` each.
    pub(super) fn new(width: usize, weight: f64, corners: Vec<[u32; 3]>, values: Vec<f32>) -> Self {
        let count = values.len() / width;
        Self {
            width,
            weight,
            corners,
            only: Vec::new(),
            wedges: vec![Wedge::default(); count],
            sums: vec![Linear::default(); count * width],
            values,
        }
    }

    /// Adds the functions of all triangles, whose areas are weighted, and notes which vertices have several wedges.
    pub(super) fn sum_up(&mut self, triangles: &[[u32; 3]], places: &[DVec3], weights: &[f64]) {
        self.only = vec![0; places.len()];
        let mut met = vec![false; places.len()];
        for (t, corners) in triangles.iter().enumerate() {
            self.add_triangle(t, corners.map(|v| places[v as usize]), weights[t]);
            for (&vertex, &wedge) in corners.iter().zip(&self.corners[t]) {
                let only = &mut self.only[vertex as usize];
                let is_same = !std::mem::replace(&mut met[vertex as usize], true) || *only == wedge;
                *only = if is_same { wedge } else { SEVERAL };
            }
        }
    }

    fn add_triangle(&mut self, triangle: usize, places: [DVec3; 3], weight: f64) {
        let flat = Flat::new(places);
        let area = flat.area * weight;
        let corners = self.corners[triangle].map(|w| w as usize);
        for wedge in corners {
            self.wedges[wedge].area += area;
        }
        for i in 0..self.width {
            let values = corners.map(|w| f64::from(self.values[w * self.width + i]));
            let slope = flat.slope(values);
            for (wedge, value) in corners.into_iter().zip(values) {
                let sum = &mut self.sums[wedge * self.width + i];
                *sum = sum.plus(Linear { slope: area * slope, value: area * value });
                let squares = &mut self.wedges[wedge].squares;
                *squares = *squares + Form::square(slope, value, area * self.weight);
            }
        }
    }

    /// Whether the attribute differs across an edge of two triangles.
    pub(super) fn differs(&self, around: Around, [a, b]: [u32; 2], [s, t]: [usize; 2]) -> bool {
        [a, b].iter().any(|&v| self.at(around, s, v) != self.at(around, t, v))
    }

    /// Whether it adds to the error.
    pub(super) fn counts(&self) -> bool {
        self.weight > 0.0
    }

    /// The wedge of a corner of a triangle.
    pub(super) fn corner(&self, triangle: usize, corner: usize) -> u32 {
        self.corners[triangle][corner]
    }

    /// The values of a wedge.
    pub(super) fn values(&self, wedge: u32) -> &[f32] {
        &self.values[wedge as usize * self.width..][..self.width]
    }

    fn at(&self, around: Around, triangle: usize, vertex: u32) -> u32 {
        self.corners[triangle][around.corner(triangle, vertex)]
    }

    /// What the attribute adds to the error of both ends of an edge, seen from the first.
    #[inline]
    pub(super) fn error(&self, around: Around, a: u32, b: u32, edge: DVec3) -> Form {
        let only = [self.only[a as usize], self.only[b as usize]];
        if self.weight == 0.0 {
            Form::default()
        } else if only[0] != SEVERAL && only[1] != SEVERAL {
            self.reduced(&only[..1], &only[1..], edge)
        } else {
            let groups = self.groups(around, a, b);
            let forms = groups.iter().map(|group| self.reduced(&group.kept, &group.gone, edge));
            forms.fold(Form::default(), |sum, form| sum + form)
        }
    }

    /// The cost of one value for some wedges of both ends of an edge, where it is the best for the place.
    #[inline]
    fn reduced(&self, kept: &[u32], gone: &[u32], edge: DVec3) -> Form {
        let Wedge { area, mut squares } = self.wedge(kept, gone, edge);
        let share = if area > 0.0 { -self.weight / area } else { 0.0 };
        for i in 0..self.width {
            let Linear { slope, value } = self.sum(kept, gone, edge, i);
            squares = squares + Form::square(slope, value, share);
        }
        squares
    }

    #[inline]
    fn wedge(&self, kept: &[u32], gone: &[u32], edge: DVec3) -> Wedge {
        let mut sum = Wedge::default();
        for &wedge in kept {
            let Wedge { area, squares } = self.wedges[wedge as usize];
            sum = Wedge { area: sum.area + area, squares: sum.squares + squares };
        }
        for &wedge in gone {
            let Wedge { area, squares } = self.wedges[wedge as usize];
            sum = Wedge { area: sum.area + area, squares: sum.squares + squares.seen_from(-edge) };
        }
        sum
    }

    #[inline]
    fn sum(&self, kept: &[u32], gone: &[u32], edge: DVec3, i: usize) -> Linear {
        let of = |&wedge: &u32| self.sums[wedge as usize * self.width + i];
        let kept = kept.iter().map(of).fold(Linear::default(), Linear::plus);
        gone.iter().map(|wedge| of(wedge).seen_from(-edge)).fold(kept, Linear::plus)
    }

    /// The wedges of both ends, those together that meet in a triangle at the edge.
    fn groups(&self, around: Around, kept: u32, gone: u32) -> Vec<Group> {
        let mut groups: Vec<Group> = Vec::new();
        for triangle in around.edge(kept, gone) {
            let [k, g] = [kept, gone].map(|v| self.at(around, triangle, v));
            let (meeting, mut apart): (Vec<Group>, Vec<Group>) =
                groups.into_iter().partition(|group| group.kept.contains(&k) || group.gone.contains(&g));
            let mut all = Group::default();
            for group in meeting {
                all.kept.extend(group.kept);
                all.gone.extend(group.gone);
            }
            add(&mut all.kept, k);
            add(&mut all.gone, g);
            apart.push(all);
            groups = apart;
        }
        for &triangle in around.fans.of(kept) {
            let wedge = self.at(around, triangle as usize, kept);
            if !groups.iter().any(|group| group.kept.contains(&wedge)) {
                groups.push(Group { kept: vec![wedge], ..Group::default() });
            }
        }
        for &triangle in around.fans.of(gone) {
            let wedge = self.at(around, triangle as usize, gone);
            if !groups.iter().any(|group| group.gone.contains(&wedge)) {
                groups.push(Group { gone: vec![wedge], ..Group::default() });
            }
        }
        groups
    }

    /// Follows a contraction, before the triangles and fans do.
    pub(super) fn contract(&mut self, around: Around, step: &Move) {
        let groups = self.groups(around, step.kept, step.gone);
        let heirs: Vec<u32> = groups.iter().map(|group| self.merge(group, step)).collect();
        for (vertex, side) in [(step.kept, 0), (step.gone, 1)] {
            for &triangle in around.fans.of(vertex) {
                let wedge = &mut self.corners[triangle as usize][around.corner(triangle as usize, vertex)];
                let of = |group: &Group| [&group.kept, &group.gone][side].contains(wedge);
                if let Some(group) = groups.iter().position(of) {
                    *wedge = heirs[group];
                }
            }
        }
        self.only[step.kept as usize] = if let [heir] = heirs[..] { heir } else { SEVERAL };
    }

    /// Makes one wedge of a group; returns which.
    fn merge(&mut self, group: &Group, step: &Move) -> u32 {
        let Group { kept, gone } = group;
        let heir = kept.first().or(gone.first()).copied().unwrap_or_default();
        let Wedge { area, squares } = self.wedge(kept, gone, step.edge);
        for i in 0..self.width {
            let sum = self.sum(kept, gone, step.edge, i).seen_from(step.to);
            let old = |wedges: &[u32]| wedges.first().map(|&w| self.values[w as usize * self.width + i]);
            let exactly = if step.to == DVec3::ZERO { old(kept) } else { None };
            let exactly = exactly.or_else(|| if step.to == step.edge { old(gone) } else { None });
            let mean = (sum.value / area) as f32;
            let value = exactly.or(mean.is_finite().then_some(mean)).or(old(kept)).or(old(gone));
            let at = heir as usize * self.width + i;
            self.values[at] = value.unwrap_or_default();
            self.sums[at] = sum;
        }
        self.wedges[heir as usize] = Wedge { area, squares: squares.seen_from(step.to) };
        heir
    }
}

/// Adds to a set.
fn add(set: &mut Vec<u32>, member: u32) {
    if !set.contains(&member) {
        set.push(member);
    }
}

/// A triangle as a plane in which functions are linear.
struct Flat {
    area: f64,
    /// By how much a function rises towards the second and the third corner gives its slope.
    duals: [DVec3; 2],
}

impl Flat {
    fn new([a, b, c]: [DVec3; 3]) -> Self {
        let (p, q) = (b - a, c - a);
        let across = p.cross(q);
        let squared = across.length_squared();
        let dual = |v: DVec3| if squared > 0.0 { v / squared } else { DVec3::ZERO };
        Self { area: 0.5 * across.length(), duals: [dual(q.cross(across)), dual(across.cross(p))] }
    }

    /// The slope of the linear function of such values at the corners; none for a triangle without area.
    fn slope(&self, [a, b, c]: [f64; 3]) -> DVec3 {
        let slope = (b - a) * self.duals[0] + (c - a) * self.duals[1];
        if slope.is_finite() { slope } else { DVec3::ZERO }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec2;
    use proptest::prelude::*;

    use super::*;

    fn point() -> impl Strategy<Value = DVec3> {
        [-1.0..1.0f64, -1.0..1.0, -1.0..1.0].prop_map(DVec3::from_array)
    }

    proptest! {
        #[test]
        fn a_slope_leads_from_corner_to_corner(corners in [point(), point(), point()], values in [0.0..1.0f64, 0.0..1.0, 0.0..1.0]) {
            let flat = Flat::new(corners);
            prop_assume!(flat.area > 1e-3);
            let slope = flat.slope(values);
            for (corner, value) in corners.into_iter().zip(values) {
                prop_assert!((values[0] + slope.dot(corner - corners[0]) - value).abs() < 1e-9);
            }
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            prop_assert!(slope.dot(normal).abs() < 1e-9);
        }

        /// Two triangles at an edge: the form is the sum over both ends of the squared differences from the best value.
        #[test]
        fn the_error_is_that_of_the_best_value(
            corners in [point(), point(), point(), point()],
            values in prop::array::uniform4(0.0..1.0f32),
            at in point(),
        ) {
            let triangles = [[0, 1, 2], [1, 0, 3]];
            let mut layer = Layer::new(1, 4.0, triangles.to_vec(), values.to_vec());
            layer.sum_up(&triangles, &corners, &[1.0, 1.0]);
            let fans = Fans::new(4, &triangles);
            let around = Around { triangles: &triangles, fans: &fans };
            let edge = corners[1] - corners[0];
            let form = layer.error(around, 0, 1, edge);

            let functions: Vec<(f64, f64)> = triangles.iter().flat_map(|t| {
                let t = t.map(|v| v as usize);
                let flat = Flat::new(t.map(|v| corners[v]));
                let slope = flat.slope(t.map(|v| f64::from(values[v])));
                let value = f64::from(values[t[0]]) + slope.dot(corners[0] + at - corners[t[0]]);
                [(flat.area, value); 2]
            }).collect();
            let area: f64 = functions.iter().map(|f| f.0).sum();
            let best = functions.iter().map(|f| f.0 * f.1).sum::<f64>() / area;
            let cost: f64 = functions.iter().map(|f| 4.0 * f.0 * (f.1 - best).powi(2)).sum();
            prop_assert!((form.at(at) - cost).abs() < 1e-6 * (1.0 + cost), "{} {cost}", form.at(at));
        }
    }

    /// A square of eight triangles around its centre, cut into two charts along its horizontal middle: the texture of
    /// the upper half is shifted.
    #[test]
    fn a_seam_stays_a_seam_and_a_linear_texture_stays_linear() {
        let places: Vec<DVec3> = [[0, 0], [1, 0], [2, 0], [0, 1], [1, 1], [2, 1], [0, 2], [1, 2], [2, 2]]
            .map(|[x, y]| DVec3::new(x.into(), y.into(), 0.0))
            .to_vec();
        let triangles: Vec<[u32; 3]> = (0..4u32)
            .map(|cell| cell % 2 + 3 * (cell / 2))
            .flat_map(|c| [[c, c + 1, c + 4], [c, c + 4, c + 3]])
            .collect();
        let upper = |t: usize| u32::from(t >= 4);
        let corners = triangles.iter().enumerate().map(|(t, c)| c.map(|v| v + 9 * upper(t))).collect();
        let texture = |half: f64| places.iter().map(move |p| DVec2::new(p.x + half, p.y - half));
        let values: Vec<f32> =
            texture(0.0).chain(texture(10.0)).flat_map(|uv| uv.as_vec2().to_array()).collect();
        let mut layer = Layer::new(2, 1.0, corners, values);
        layer.sum_up(&triangles, &places, &[1.0; 8]);
        let fans = Fans::new(9, &triangles);
        let around = Around { triangles: &triangles, fans: &fans };
        assert!(layer.error(around, 4, 5, DVec3::X).at(0.5 * DVec3::X).abs() < 1e-12);
        layer.contract(around, &Move { kept: 4, gone: 5, edge: DVec3::X, to: 0.5 * DVec3::X });
        let [lower, upper] = [0, 7].map(|t| {
            let corner = triangles[t].iter().position(|&v| v == 4).expect("it is at the centre");
            layer.values(layer.corner(t, corner)).to_vec()
        });
        assert_eq!((lower, upper), (vec![1.5, 1.0], vec![11.5, -9.0]));
        assert_eq!(layer.only[4], SEVERAL);
    }
}
