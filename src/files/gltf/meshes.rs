//! What a mesh costs and where it reaches, from its accessors alone.

use std::collections::{BTreeMap, BTreeSet};

use ::gltf::json;
use ::gltf::json::accessor::{ComponentType, Type};
use ::gltf::json::mesh::Mode;
use ::gltf::json::validation::Checked;
use glam::{DMat4, DVec3};
use serde_json::Value;

use super::Refused;
use super::baked::Baked;
use super::document::Document;
use crate::bounds::Sphere;

/// Counts of a mesh, and the box around it in its own units. Wide, because files claim what they like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Measure {
    pub(super) triangles: u64,
    pub(super) vertices: u64,
    pub(super) draws: u64,
    pub(super) bytes: u64,
    pub(super) bounds: Box3,
    pub(super) baked: Baked,
}

/// A box in double precision; `min > max` when it holds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    min: DVec3,
    max: DVec3,
}

/// A box is made at least so large, in object units, so that a table always has an extent.
const LEAST_EXTENT: f64 = 1e-6;

impl Box3 {
    pub(super) const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    pub(super) fn is_empty(&self) -> bool {
        self.min.cmpgt(self.max).any()
    }

    pub(super) fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box, grown about its centre where it is hardly more than a point.
    pub(super) fn with_extent(self) -> Self {
        let grow = if (self.max - self.min).max_element() < LEAST_EXTENT { LEAST_EXTENT } else { 0.0 };
        Self { min: self.min - grow, max: self.max + grow }
    }

    fn corners(&self) -> [DVec3; 8] {
        [0, 1, 2, 3, 4, 5, 6, 7].map(|i| {
            let pick = |axis: usize| if i >> axis & 1 == 0 { self.min[axis] } else { self.max[axis] };
            DVec3::new(pick(0), pick(1), pick(2))
        })
    }

    /// The box around the transformed corners.
    pub(super) fn transformed(&self, transform: &DMat4) -> Self {
        if *transform == DMat4::IDENTITY || self.is_empty() {
            return *self;
        }
        let corners = self.corners().map(|c| transform.transform_point3(c));
        corners.iter().fold(Self::EMPTY, |b, &c| Self { min: b.min.min(c), max: b.max.max(c) })
    }

    /// The sphere about the transformed centre through the furthest transformed corner, rounded up. It holds the
    /// transformed box whatever the transform, and grows with an even scale exactly.
    pub(super) fn placed(&self, transform: DMat4) -> Sphere {
        let center = transform.transform_point3((self.min + self.max) * 0.5).as_vec3();
        let reach = |c: DVec3| (transform.transform_point3(c) - center.as_dvec3()).length();
        let radius = self.corners().map(reach).into_iter().fold(0.0, f64::max);
        Sphere::new(center, rounded_up(radius))
    }
}

fn rounded_up(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) < x { nearest.next_up() } else { nearest }
}

/// Meshes as they are measured, each once.
pub(super) struct Measured<'a> {
    document: &'a Document,
    known: BTreeMap<usize, Measure>,
}

impl<'a> Measured<'a> {
    pub(super) fn new(document: &'a Document) -> Self {
        Self { document, known: BTreeMap::new() }
    }

    pub(super) fn document(&self) -> &'a Document {
        self.document
    }

    pub(super) fn measure(&mut self, mesh: usize) -> Result<Measure, Refused> {
        if let Some(known) = self.known.get(&mesh) {
            return Ok(*known);
        }
        let measure = measure(self.document, &self.document.meshes()[mesh])
            .map_err(|rule| Refused::at(self.document.mesh_place(mesh), rule))?;
        self.known.insert(mesh, measure);
        Ok(measure)
    }
}

fn measure(document: &Document, mesh: &json::Mesh) -> Result<Measure, String> {
    if mesh.primitives.is_empty() {
        return Err("it must have a primitive".to_owned());
    }
    let mut accessors = BTreeSet::new();
    let mut positions = BTreeSet::new();
    let mut total = Measure {
        triangles: 0,
        vertices: 0,
        draws: 0,
        bytes: 0,
        bounds: Box3::EMPTY,
        baked: Baked::of(mesh)?,
    };
    for (i, primitive) in mesh.primitives.iter().enumerate() {
        let within = |rule: String| format!("primitive {i}: {rule}");
        let position = position_of(primitive).map_err(|rule| within(rule.to_owned()))?;
        total.triangles += triangles(document, primitive, position).map_err(within)?;
        let reach = match total.baked.is_geomorph() {
            true => position_box(document, position),
            false => reach(document, primitive, position),
        };
        total.bounds = total.bounds.union(reach.map_err(within)?);
        total.draws += 1;
        positions.insert(position);
        accessors.extend(used_accessors(primitive));
    }
    for &position in &positions {
        total.vertices += count(document, position)?;
    }
    for &accessor in &accessors {
        total.bytes += bytes(document, accessor)?;
    }
    Ok(total)
}

fn position_of(primitive: &json::mesh::Primitive) -> Result<usize, &'static str> {
    let position = primitive.attributes.get(&Checked::Valid(json::mesh::Semantic::Positions));
    position.map(|p| p.value()).ok_or("it must have a POSITION")
}

/// Every accessor that a primitive names: attributes, indices, morph targets.
fn used_accessors(primitive: &json::mesh::Primitive) -> impl Iterator<Item = usize> {
    let targets = primitive.targets.iter().flatten();
    let targets = targets.flat_map(|t| [t.positions, t.normals, t.tangents]).flatten();
    let all = primitive.attributes.values().copied().chain(primitive.indices).chain(targets);
    all.map(|accessor| accessor.value())
}

fn triangles(document: &Document, primitive: &json::mesh::Primitive, position: usize) -> Result<u64, String> {
    let corners = count(document, primitive.indices.map_or(position, |i| i.value()))?;
    match primitive.mode {
        Checked::Valid(Mode::Triangles) => Ok(corners / 3),
        Checked::Valid(Mode::TriangleStrip | Mode::TriangleFan) => Ok(corners.saturating_sub(2)),
        Checked::Valid(Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip) => Ok(0),
        Checked::Invalid => Err("its mode must be one of 0 to 6".to_owned()),
    }
}

fn accessor(document: &Document, index: usize) -> Result<&json::Accessor, String> {
    document.accessor(index).ok_or_else(|| format!("accessor {index} is unknown"))
}

/// The elements of an accessor: at most 2³² − 1, and no more than its buffer view holds.
fn count(document: &Document, index: usize) -> Result<u64, String> {
    let accessor = accessor(document, index)?;
    let count = accessor.count.0;
    if count == 0 || count > u64::from(u32::MAX) {
        return Err(format!("the count of accessor {index} must be between 1 and 4294967295, not {count}"));
    }
    let size = element_bytes(accessor).ok_or_else(|| bad_type(index))?;
    let Some(view) = accessor.buffer_view else { return Ok(count) };
    let view = document
        .buffer_view(view.value())
        .ok_or_else(|| format!("the buffer view {} of accessor {index} is unknown", view.value()))?;
    let stride = view.byte_stride.map_or(size, |stride| stride.0 as u64);
    let start = accessor.byte_offset.map_or(0, |offset| offset.0);
    let end = (count - 1).checked_mul(stride).and_then(|b| b.checked_add(size)?.checked_add(start));
    if end.is_none_or(|end| end > view.byte_length.0) {
        return Err(format!("accessor {index} must fit its buffer view of {} bytes", view.byte_length.0));
    }
    Ok(count)
}

/// What an accessor takes unpacked: sparse ones in full, padding between elements left out.
fn bytes(document: &Document, index: usize) -> Result<u64, String> {
    let size = element_bytes(accessor(document, index)?).ok_or_else(|| bad_type(index))?;
    Ok(count(document, index)? * size)
}

fn bad_type(index: usize) -> String {
    format!("the type of accessor {index} is unknown")
}

fn element_bytes(accessor: &json::Accessor) -> Option<u64> {
    let (Checked::Valid(kind), Checked::Valid(component)) = (accessor.type_, accessor.component_type) else {
        return None;
    };
    Some((kind.multiplicity() * component.0.size()) as u64)
}

/// The box around a primitive: its positions, moved by every morph target as far as full weight goes.
fn reach(document: &Document, primitive: &json::mesh::Primitive, position: usize) -> Result<Box3, String> {
    let mut all = position_box(document, position)?;
    for target in primitive.targets.iter().flatten().filter_map(|t| t.positions) {
        let moved = position_box(document, target.value())?;
        all.min += moved.min.min(DVec3::ZERO);
        all.max += moved.max.max(DVec3::ZERO);
    }
    Ok(all)
}

fn position_box(document: &Document, index: usize) -> Result<Box3, String> {
    let accessor = accessor(document, index)?;
    if accessor.type_ != Checked::Valid(Type::Vec3) {
        return Err(format!("positions (accessor {index}) must be of type VEC3"));
    }
    let corner = |bound: &Option<Value>| {
        let [x, y, z] = bound.as_ref()?.as_array()?.as_slice() else { return None };
        let value = DVec3::new(x.as_f64()?, y.as_f64()?, z.as_f64()?);
        Some(value * unit_of(accessor)).filter(|v| v.is_finite())
    };
    let bounds = corner(&accessor.min).zip(corner(&accessor.max)).map(|(min, max)| Box3 { min, max });
    bounds.filter(|b| !b.is_empty()).ok_or_else(|| {
        format!("positions (accessor {index}) must have a min and a max of 3 numbers, min ≤ max")
    })
}

/// What one step of a component is worth: bounds are stored as the integers are, before they are normalised.
fn unit_of(accessor: &json::Accessor) -> f64 {
    let Checked::Valid(component) = accessor.component_type else { return 1.0 };
    match (accessor.normalized, component.0) {
        (true, ComponentType::I8) => 1.0 / 127.0,
        (true, ComponentType::U8) => 1.0 / 255.0,
        (true, ComponentType::I16) => 1.0 / 32767.0,
        (true, ComponentType::U16) => 1.0 / 65535.0,
        _ => 1.0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_placed_sphere_holds_the_transformed_box(
            low in prop::array::uniform3(-100.0f64..100.0),
            size in prop::array::uniform3(0.0f64..50.0),
            columns in prop::array::uniform12(-4.0f64..4.0),
            inside in prop::array::uniform3(0.0f64..=1.0),
        ) {
            let b = Box3 { min: low.into(), max: DVec3::from(low) + DVec3::from(size) };
            let mut m = [0.0; 16];
            for (i, &c) in columns.iter().enumerate() {
                m[i / 3 * 4 + i % 3] = c;
            }
            m[15] = 1.0;
            let transform = DMat4::from_cols_array(&m);
            let sphere = b.placed(transform);
            let point = transform.transform_point3(b.min + (b.max - b.min) * DVec3::from(inside));
            let away = (point - sphere.center.as_dvec3()).length();
            prop_assert!(away <= f64::from(sphere.radius) * (1.0 + 1e-12), "{away} {sphere:?}");
        }
    }

    #[test]
    fn an_even_scale_scales_the_radius() {
        let b = Box3 { min: DVec3::ZERO, max: DVec3::new(2.0, 4.0, 4.0) };
        assert_eq!(b.placed(DMat4::IDENTITY), Sphere::new(glam::Vec3::new(1.0, 2.0, 2.0), 3.0));
        assert_eq!(b.placed(DMat4::from_scale(DVec3::splat(-2.0))).radius, 6.0);
    }

    #[test]
    fn a_point_gets_an_extent() {
        let point = Box3 { min: DVec3::ONE, max: DVec3::ONE }.with_extent();
        assert!(point.placed(DMat4::IDENTITY).radius > 0.0);
        assert_eq!(point.placed(DMat4::from_scale(DVec3::ZERO)).radius, 0.0);
    }
}
