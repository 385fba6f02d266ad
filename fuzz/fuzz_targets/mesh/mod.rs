//! What holds for a mesh that was read, whatever the format.

use glam::{Vec2, Vec3, Vec4};
use lod_budget::bake::read::{gltf, obj};
use lod_budget::bake::repair::repair;
use lod_budget::bake::write::{self, LevelOut};
use lod_budget::bake::{Mesh, MeshFile, Skin};

/// It is whole, no larger than it may be, stays whole when it is repaired, and comes back when it is written.
pub fn holds(mut file: MeshFile, most_triangles: usize) {
    assert_eq!(file.mesh.check(), Ok(()));
    assert_eq!(file.origins.numbers.len(), file.mesh.triangles.len());
    assert!(file.mesh.triangles.len() <= most_triangles);
    repair(&mut file.mesh, &mut file.origins);
    let mesh = file.mesh;
    assert_eq!(mesh.check(), Ok(()));
    assert!(mesh.positions.iter().all(|p| p.is_finite()));
    assert!(repair(&mut mesh.clone(), &mut file.origins.clone()).iter().all(|f| !f.defect.is_repaired()));
    comes_back_from_glb(&mesh);
    comes_back_from_obj(mesh);
}

/// Attributes that glTF does not allow come back as others that it does, but those as they are.
fn comes_back_from_glb(mesh: &Mesh) {
    let again = through_glb(mesh);
    assert_eq!(again.triangles.len(), mesh.triangles.len());
    assert!(corners(&again).iter().zip(corners(mesh)).all(|(again, corner)| again.0 == corner.0));
    assert_eq!(corners(&through_glb(&again)), corners(&again));
}

fn through_glb(mesh: &Mesh) -> Mesh {
    let bytes = write::glb(&[LevelOut::new(mesh)]).expect("what was read can be written");
    gltf::read(&bytes, "again.glb", None).expect("what was written can be read").mesh
}

/// OBJ has one set of texture coordinates, no tangents and no joints.
fn comes_back_from_obj(mut mesh: Mesh) {
    mesh.uvs.truncate(1);
    mesh.tangents.clear();
    mesh.skins.clear();
    let again = obj::read(write::obj(&mesh).as_bytes(), "again.obj").expect("what was written can be read");
    assert_eq!(corners(&again.mesh), corners(&mesh));
}

type Corner = (Vec3, Option<Vec3>, Vec<Vec2>, Option<Vec4>, Option<Vec4>, Option<Skin>);

/// All that is known of the corners of triangles.
fn corners(mesh: &Mesh) -> Vec<Corner> {
    let corner = |&wedge: &u32| {
        let wedge = wedge as usize;
        (
            mesh.positions[mesh.wedges[wedge] as usize],
            mesh.normals.get(wedge).copied(),
            mesh.uvs.iter().map(|set| set[wedge]).collect(),
            mesh.colours.get(wedge).copied(),
            mesh.tangents.get(wedge).copied(),
            mesh.skins.get(wedge).copied(),
        )
    };
    mesh.triangles.as_flattened().iter().map(corner).collect()
}
