//! Bevy's `check_visibility_ranges` and `check_visibility_cpu_culling`, headless.
//!
//! An object is what Bevy's documentation of `VisibilityRange` shows: an entity per level, each with its mesh and the
//! range of distances in which it is drawn. The entity that would hold the levels of an object together is left out;
//! no system measured here would look at it. Transforms are final and bounds given, so that nothing is propagated or
//! computed. A frame is the schedule `PostUpdate` with the plugins that own the two systems and what these need, in
//! an app built without Bevy's feature `multi_threaded`: one thread.

use std::any::TypeId;
use std::time::Duration;

use bevy_app::{App, PostUpdate, TaskPoolPlugin};
use bevy_asset::AssetPlugin;
use bevy_camera::primitives::Aabb;
use bevy_camera::visibility::{NoAutoAabb, VisibilityRange, VisibleEntities};
use bevy_camera::{Camera3d, CameraPlugin, PerspectiveProjection, Projection};
use bevy_ecs::component::Component;
use bevy_ecs::entity::Entity;
use bevy_math::{Vec3, Vec3A};
use bevy_mesh::{Mesh3d, MeshPlugin};
use bevy_transform::components::{GlobalTransform, Transform};
use cpu_time::ThreadTime;

use crate::camera::{Bound, Camera, FOV_Y, NEAR, VIEWPORT_PX};
use crate::peer::{Census, Peer};
use crate::scene::{Instance, Kind, LEVELS, Scene};

/// Which level of its object an entity is.
#[derive(Component)]
struct LevelOf(usize);

/// An app with the scene in its world.
pub struct Bevy {
    app: App,
    camera: Entity,
}

impl Bevy {
    pub fn new(scene: &Scene, start: &Camera) -> Self {
        let mut app = App::new();
        app.add_plugins((TaskPoolPlugin::default(), AssetPlugin::default(), MeshPlugin, CameraPlugin));
        app.finish();
        app.cleanup();
        for instance in &scene.instances {
            spawn_levels(&mut app, instance, scene.kind(instance));
        }
        let camera = app.world_mut().spawn((Camera3d::default(), projection(start), place(start))).id();
        Self { app, camera }
    }
}

impl Peer for Bevy {
    fn name(&self) -> &'static str {
        "Bevy, visibility ranges and frustum culling"
    }

    fn bound(&self) -> Bound {
        Bound::Cube
    }

    fn frame(&mut self, camera: &Camera) -> Duration {
        let world = self.app.world_mut();
        world.entity_mut(self.camera).insert(place(camera));
        let start = ThreadTime::now();
        world.run_schedule(PostUpdate);
        let time = start.elapsed();
        world.clear_trackers();
        time
    }

    fn census(&mut self) -> Census {
        let world = self.app.world();
        let mut census = Census::default();
        let visible = world.get::<VisibleEntities>(self.camera).expect("a camera has them");
        for &entity in visible.get(TypeId::of::<Mesh3d>()) {
            let LevelOf(level) = world.get(entity).expect("whatever has a mesh has a level");
            census.0[*level] += 1;
        }
        census
    }
}

fn spawn_levels(app: &mut App, instance: &Instance, kind: &Kind) {
    let transform =
        Transform::from_translation(Vec3::from_array(instance.center)).with_scale(Vec3::splat(kind.radius));
    let cube = Aabb { center: Vec3A::ZERO, half_extents: Vec3A::ONE };
    let from = kind.distances();
    for level in 0..LEVELS {
        let until = from.get(level + 1).copied().unwrap_or(f32::INFINITY);
        app.world_mut().spawn((
            Mesh3d::default(),
            transform,
            GlobalTransform::from(transform),
            cube,
            NoAutoAabb,
            VisibilityRange::abrupt(from[level], until),
            LevelOf(level),
        ));
    }
}

fn projection(camera: &Camera) -> Projection {
    Projection::Perspective(PerspectiveProjection {
        fov: FOV_Y,
        aspect_ratio: VIEWPORT_PX[0] / VIEWPORT_PX[1],
        near: NEAR,
        far: camera.far,
        ..Default::default()
    })
}

fn place(camera: &Camera) -> GlobalTransform {
    let turned = Transform::from_rotation(bevy_math::Quat::from_rotation_y(camera.yaw));
    turned.with_translation(Vec3::from_array(camera.eye)).into()
}
