//! What is wrong with a mesh: put right where that changes no surface, and reported in any case.
//!
//! Put right are faces that use positions which are no numbers, faces with two corners in one place, faces that repeat
//! another, positions without a face, attributes that are no numbers. Everything else stays as it is, because each
//! remedy has a price: flat faces hold their neighbours together; edges of more than two faces, backs and borders are
//! often meant; T-junctions need vertices that nobody asked for. [`Defect`] says for each which it is.
//!
//! Weld first: two positions in one place are two vertices here.

mod edges;
mod t_junctions;

use glam::{Vec2, Vec3, Vec4};

use super::finding::{Defect, Finding, Findings};
use super::mesh::{Mesh, Skin};
use super::read::Origins;
use super::weld::classes;

/// Repairs the mesh and reports. `origins` has an entry per triangle and loses those of triangles that are left out.
/// O(n log n), T-junctions within a limit on work ([`Finding::is_complete`]).
///
/// # Panics
/// Where the mesh does not pass [`Mesh::check`] or `origins` is that of another.
pub fn repair(mesh: &mut Mesh, origins: &mut Origins) -> Vec<Finding> {
    let mut findings = Findings::default();
    neutralise(mesh, &mut findings);
    drop_faces(mesh, origins, &mut findings);
    for position in drop_isolated(mesh) {
        findings.add(Defect::IsolatedVertex, || place_of(position));
    }
    find_flat(mesh, origins, &mut findings);
    let borders = edges::find(mesh, origins, &mut findings);
    let junctions = t_junctions::find(&mesh.positions, &borders);
    findings.0.extend(Some(junctions).filter(|found| found.count > 0 || !found.is_complete));
    findings.0
}

/// What to call the place of a position.
fn place_of(p: Vec3) -> String {
    format!("({}, {}, {})", p.x, p.y, p.z)
}

/// Makes every attribute a number.
fn neutralise(mesh: &mut Mesh, findings: &mut Findings) {
    let mut found = |wedge: usize, what: &str| {
        findings.add(Defect::NotFiniteAttribute, || format!("{what} of wedge {wedge}"));
    };
    for (i, normal) in mesh.normals.iter_mut().enumerate().filter(|(_, n)| !n.is_finite()) {
        *normal = Vec3::ZERO;
        found(i, "normal");
    }
    for (i, uv) in
        mesh.uvs.iter_mut().flat_map(|set| set.iter_mut().enumerate()).filter(|(_, uv)| !uv.is_finite())
    {
        *uv = Vec2::ZERO;
        found(i, "texture coordinate");
    }
    for (i, colour) in mesh.colours.iter_mut().enumerate().filter(|(_, c)| !c.is_finite()) {
        *colour = Vec4::from_array(colour.to_array().map(|part| if part.is_finite() { part } else { 1.0 }));
        found(i, "colour");
    }
    for (i, tangent) in mesh.tangents.iter_mut().enumerate().filter(|(_, t)| !t.is_finite()) {
        *tangent = Vec4::ZERO;
        found(i, "tangent");
    }
    let is_broken = |skin: &Skin| !skin.weights.iter().all(|w| w.is_finite());
    for (i, skin) in mesh.skins.iter_mut().enumerate().filter(|(_, skin)| is_broken(skin)) {
        skin.weights = [1.0, 0.0, 0.0, 0.0];
        found(i, "weight");
    }
}

/// Leaves out the faces that say nothing.
fn drop_faces(mesh: &mut Mesh, origins: &mut Origins, findings: &mut Findings) {
    let corners: Vec<[u32; 3]> = (0..mesh.triangles.len()).map(|t| mesh.corners(t)).collect();
    let same = classes(corners.iter().map(|&c| sorted(c)));
    let mut seen = vec![Seen::default(); same.firsts.len()];
    let mut keep = vec![true; corners.len()];
    for (t, &[a, b, c]) in corners.iter().enumerate() {
        let seen = &mut seen[same.of[t] as usize];
        let defect = if [a, b, c].iter().any(|&p| !mesh.positions[p as usize].is_finite()) {
            Some(Defect::NotFinitePosition)
        } else if a == b || b == c || c == a {
            Some(Defect::DegenerateFace)
        } else {
            seen.defect([a, b, c])
        };
        keep[t] = defect.is_none_or(|defect| !defect.is_repaired());
        if let Some(defect) = defect {
            findings.add(defect, || origins.place(t));
        }
    }
    mesh.retain_triangles(&keep);
    let mut kept = keep.iter();
    origins.numbers.retain(|_| kept.next() == Some(&true));
}

/// From which sides three positions were seen as a face.
#[derive(Clone, Copy, Default)]
struct Seen {
    even: bool,
    odd: bool,
}

impl Seen {
    fn defect(&mut self, corners: [u32; 3]) -> Option<Defect> {
        let (this, other) =
            if is_even(corners) { (&mut self.even, self.odd) } else { (&mut self.odd, self.even) };
        let again = std::mem::replace(this, true);
        if again { Some(Defect::DuplicateFace) } else { other.then_some(Defect::OppositeFace) }
    }
}

/// Whether the corners come in ascending order once turned.
fn is_even([a, b, c]: [u32; 3]) -> bool {
    [a < b, b < c, c < a].into_iter().filter(|&rises| rises).count() == 2
}

fn sorted(mut corners: [u32; 3]) -> [u32; 3] {
    corners.sort_unstable();
    corners
}

/// Leaves out the positions and wedges that no face uses, and gives those positions.
pub(super) fn drop_isolated(mesh: &mut Mesh) -> Vec<Vec3> {
    let mut used = vec![false; mesh.wedges.len()];
    mesh.triangles.as_flattened().iter().for_each(|&wedge| used[wedge as usize] = true);
    let kept: Vec<u32> = (0..used.len() as u32).filter(|&wedge| used[wedge as usize]).collect();
    let new_wedges = renumbered(&used);
    mesh.keep_wedges(&kept);
    mesh.triangles.as_flattened_mut().iter_mut().for_each(|wedge| *wedge = new_wedges[*wedge as usize]);

    let mut used = vec![false; mesh.positions.len()];
    mesh.wedges.iter().for_each(|&position| used[position as usize] = true);
    let unused = mesh.positions.iter().zip(&used).filter(|&(_, &used)| !used);
    let isolated = unused.map(|(&position, _)| position).collect();
    let new_positions = renumbered(&used);
    mesh.wedges.iter_mut().for_each(|position| *position = new_positions[*position as usize]);
    let mut kept = used.iter();
    mesh.positions.retain(|_| kept.next() == Some(&true));
    isolated
}

/// For what is used, how many before it are.
fn renumbered(used: &[bool]) -> Vec<u32> {
    let count = used.iter().scan(0, |next, &used| {
        let number = *next;
        *next += u32::from(used);
        Some(number)
    });
    count.collect()
}

/// A face whose height is less than this part of its longest edge has no normal worth the name: about the resolution
/// of its coordinates.
const FLAT: f64 = 1e-7;

fn find_flat(mesh: &Mesh, origins: &Origins, findings: &mut Findings) {
    for t in 0..mesh.triangles.len() {
        let [a, b, c] = mesh.corners(t).map(|p| mesh.positions[p as usize].as_dvec3());
        let doubled_area = (b - a).cross(c - a).length();
        let longest = (b - a).length_squared().max((c - b).length_squared()).max((a - c).length_squared());
        if doubled_area <= FLAT * longest {
            findings.add(Defect::FlatFace, || origins.place(t));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::Group;
    use proptest::prelude::*;

    fn mesh(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> Mesh {
        Mesh {
            positions: positions.iter().map(|&p| p.into()).collect(),
            wedges: (0..positions.len() as u32).collect(),
            triangles: triangles.to_vec(),
            groups: vec![Group { triangles: 0..triangles.len(), ..Group::default() }],
            ..Mesh::default()
        }
    }

    fn repaired(positions: &[[f32; 3]], triangles: &[[u32; 3]]) -> (Mesh, Vec<(Defect, usize)>) {
        let mut mesh = mesh(positions, triangles);
        let mut origins = Origins::of_made(&mesh);
        let found = repair(&mut mesh, &mut origins);
        assert_eq!(mesh.check(), Ok(()));
        assert_eq!(origins.numbers.len(), mesh.triangles.len());
        (mesh, found.into_iter().map(|f| (f.defect, f.count)).collect())
    }

    fn count(found: &[(Defect, usize)], defect: Defect) -> usize {
        found.iter().find(|(d, _)| *d == defect).map_or(0, |f| f.1)
    }

    const TETRAHEDRON: [[f32; 3]; 4] = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.], [0., 0., 1.]];
    const CLOSED: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

    #[test]
    fn nothing_is_wrong_with_a_closed_surface() {
        assert_eq!(repaired(&TETRAHEDRON, &CLOSED).1, []);
        assert_eq!(repaired(&[], &[]).1, []);
    }

    #[test]
    fn faces_that_say_nothing_go() {
        let faces = [[0, 2, 1], [1, 0, 2], [3, 3, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
        let (mesh, found) = repaired(&TETRAHEDRON, &faces);
        assert_eq!(mesh.triangles, CLOSED);
        assert_eq!(found, [(Defect::DuplicateFace, 1), (Defect::DegenerateFace, 1)]);
    }

    #[test]
    fn a_back_stays_and_its_edges_are_no_borders() {
        let (mesh, found) = repaired(&TETRAHEDRON[..3], &[[0, 1, 2], [2, 1, 0]]);
        assert_eq!((mesh.triangles.len(), found), (2, vec![(Defect::OppositeFace, 1)]));
    }

    #[test]
    fn positions_that_are_no_numbers_take_their_faces_with_them() {
        let positions = [
            [0., 0., 0.],
            [1., 0., 0.],
            [0., f32::NAN, 0.],
            [0., 1., 0.],
            [9., 9., 9.],
            [f32::INFINITY, 0., 0.],
        ];
        let (mesh, found) = repaired(&positions, &[[0, 1, 2], [0, 1, 3], [1, 3, 5]]);
        assert_eq!(mesh.surface().triangles, [[0, 1, 2]]);
        assert_eq!(mesh.positions.len(), 3);
        let removed = [(Defect::NotFinitePosition, 2), (Defect::IsolatedVertex, 3), (Defect::BorderEdge, 3)];
        assert_eq!(found, removed);
    }

    #[test]
    fn attributes_that_are_no_numbers_become_neutral() {
        let mut mesh = mesh(&TETRAHEDRON, &CLOSED);
        mesh.colours = vec![Vec4::splat(0.5); 4];
        mesh.colours[2] = Vec4::new(f32::NAN, 0.25, f32::INFINITY, 1.0);
        mesh.normals = vec![Vec3::X, Vec3::NAN, Vec3::Y, Vec3::Z];
        mesh.uvs = vec![vec![Vec2::ONE; 4], vec![Vec2::NAN; 4]];
        mesh.skins = vec![Skin { joints: [1; 4], weights: [f32::NAN; 4] }; 4];
        let mut origins = Origins::of_made(&mesh);
        let found = repair(&mut mesh, &mut origins);
        assert_eq!(mesh.colours[2], Vec4::new(1.0, 0.25, 1.0, 1.0));
        assert_eq!((mesh.normals[1], mesh.uvs[1][3]), (Vec3::ZERO, Vec2::ZERO));
        assert_eq!(mesh.skins[3].weights, [1.0, 0.0, 0.0, 0.0]);
        assert_eq!((found[0].defect, found[0].count), (Defect::NotFiniteAttribute, 10));
        assert_eq!(found[0].first[0], "normal of wedge 1");
    }

    #[test]
    fn edges_tell_borders_wings_and_faces_inside_out() {
        let mut positions = TETRAHEDRON.to_vec();
        let (_, found) = repaired(&positions, &CLOSED[..3]);
        assert_eq!(found, [(Defect::BorderEdge, 3)]);
        let mut faces = CLOSED;
        faces[3] = [3, 2, 1];
        assert_eq!(repaired(&positions, &faces).1, [(Defect::MisorientedEdge, 3)]);
        positions.push([1., -1., -1.]);
        let wing = [CLOSED.as_slice(), &[[0, 1, 4]]].concat();
        let (_, found) = repaired(&positions, &wing);
        assert_eq!(found, [(Defect::NonManifoldEdge, 1), (Defect::BorderEdge, 2)]);
    }

    #[test]
    fn surfaces_that_touch_in_a_point_are_told() {
        let below = [[0., 0., 0.], [-1., 0., 0.], [0., -1., 0.], [0., 0., -1.]];
        let positions = [TETRAHEDRON.as_slice(), &below[1..]].concat();
        let other = CLOSED.map(|t| t.map(|p| if p == 0 { 0 } else { p + 3 }));
        let faces = [CLOSED, other.map(|[a, b, c]| [c, b, a])].concat();
        assert_eq!(repaired(&positions, &faces).1, [(Defect::NonManifoldVertex, 1)]);
    }

    #[test]
    fn flat_faces_stay() {
        let (mesh, found) = repaired(&[[0., 0., 0.], [2., 0., 0.], [1., 0., 0.]], &[[0, 1, 2]]);
        assert_eq!(mesh.triangles.len(), 1);
        assert_eq!(count(&found, Defect::FlatFace), 1);
    }

    #[test]
    fn a_vertex_within_a_border_edge_is_a_t_junction() {
        let positions =
            [[0., 0., 0.], [2., 0., 0.], [1., 1., 0.], [1., 0., 0.], [0., -1., 0.], [2., -1., 0.]];
        let (_, found) = repaired(&positions, &[[0, 1, 2], [0, 4, 3], [3, 5, 1], [3, 4, 5]]);
        assert_eq!(count(&found, Defect::TJunction), 1);
        let mut apart = positions;
        apart[3][1] = -0.1;
        let (_, found) = repaired(&apart, &[[0, 1, 2], [0, 4, 3], [3, 5, 1], [3, 4, 5]]);
        assert_eq!(count(&found, Defect::TJunction), 0);
    }

    proptest! {
        /// Whatever goes in, what comes out is whole, and repairing it again finds nothing more to repair.
        #[test]
        fn what_is_repaired_stays_repaired(
            positions in prop::collection::vec(prop::array::uniform3(-1i8..2), 1..12),
            faces in prop::collection::vec(prop::array::uniform3(0u32..1000), 0..40),
        ) {
            let positions: Vec<[f32; 3]> = positions.into_iter()
                .map(|p| p.map(|x| if x == 1 { f32::NAN } else { f32::from(x) })).collect();
            let faces: Vec<[u32; 3]> =
                faces.into_iter().map(|t| t.map(|i| i % positions.len() as u32)).collect();
            let (first, found) = repaired(&positions, &faces);
            let removed: usize = found.iter().filter(|(d, _)| {
                matches!(d, Defect::NotFinitePosition | Defect::DegenerateFace | Defect::DuplicateFace)
            }).map(|f| f.1).sum();
            prop_assert_eq!(first.triangles.len() + removed, faces.len());
            let (mut again, mut origins) = (first.clone(), Origins::of_made(&first));
            prop_assert!(repair(&mut again, &mut origins).iter().all(|f| !f.defect.is_repaired()));
            prop_assert_eq!(again, first);
        }
    }
}
