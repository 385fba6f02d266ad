//! A control mesh, subdivided so and so often.

use std::ops::Range;

use glam::{DVec3, DVec4};

use super::limits::limits;
use super::net::Net;
use super::normals::Sides;
use super::{ControlMesh, FOREVER_SHARP, MOST_CORNERS, Scheme, SubdivideError};
use crate::bake::weld::classes;

/// Positions and attributes after so many subdivisions.
#[derive(Clone, Debug)]
pub(super) struct Level {
    pub net: Net,
    pub positions: Vec<DVec3>,
    /// Every set of texture coordinates, then colours if there are any.
    pub channels: Vec<Channel>,
    /// The faces of each group.
    pub groups: Vec<Range<usize>>,
}

/// An attribute, on a net that is torn along its seams. Its faces and corners are those of the positions.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub net: Net,
    /// Texture coordinates are x and y.
    pub values: Vec<DVec4>,
}

impl Level {
    /// The control mesh, not yet subdivided.
    pub fn base(mesh: &ControlMesh) -> Self {
        let mut net = Net::of_faces(mesh.positions.len(), mesh.ends.clone(), mesh.corner_positions());
        sharpen(&mut net, mesh);
        net.hold_non_manifold();
        let uvs =
            mesh.uvs.iter().map(|set| set.iter().map(|uv| uv.extend(0.0).extend(0.0)).collect::<Vec<_>>());
        let colours = Some(mesh.colours.clone()).filter(|colours| !colours.is_empty());
        let channels = uvs.chain(colours).map(|rows| {
            let rows: Vec<DVec4> = rows.iter().map(|row| row.as_dvec4()).collect();
            Channel::base(mesh, &net, &rows)
        });
        let channels = channels.collect();
        let positions = mesh.positions.iter().map(|p| p.as_dvec3()).collect();
        Self {
            net,
            positions,
            channels,
            groups: mesh.groups.iter().map(|group| group.faces.clone()).collect(),
        }
    }

    /// Subdivided once more.
    pub fn refined(&self, scheme: Scheme) -> Self {
        // Children are in the order of faces for Loop's scheme, and of corners for Catmull and Clark's.
        let children = |face: usize| match scheme {
            Scheme::Loop => 4 * face,
            Scheme::CatmullClark => face.checked_sub(1).map_or(0, |before| self.net.ends[before] as usize),
        };
        let refined = |channel: &Channel| Channel {
            values: scheme.points(&channel.net, &channel.values),
            net: scheme.refine(&channel.net),
        };
        Self {
            positions: scheme.points(&self.net, &self.positions),
            net: scheme.refine(&self.net),
            channels: self.channels.iter().map(refined).collect(),
            groups: self.groups.iter().map(|group| children(group.start)..children(group.end)).collect(),
        }
    }

    /// How many triangles it is drawn with.
    pub fn triangles(&self) -> usize {
        self.net.corners.len() - 2 * self.net.face_count()
    }

    /// Whether it could be refined: no more corners than [`MOST_CORNERS`] would come of it.
    pub fn has_room(&self) -> bool {
        4 * self.net.corners.len() as u64 <= MOST_CORNERS
    }
}

/// Puts the sharpness of the mesh on its net.
fn sharpen(net: &mut Net, mesh: &ControlMesh) {
    let forever = |sharpness: f32| if sharpness >= FOREVER_SHARP { f32::INFINITY } else { sharpness };
    for sharp in &mesh.sharp_edges {
        let [a, b] = sharp.ends;
        let ends = [a.min(b), a.max(b)];
        if let Ok(edge) = net.edges.binary_search_by_key(&ends, |edge| edge.ends) {
            let edge = &mut net.edges[edge];
            edge.sharpness = edge.sharpness.max(forever(sharp.sharpness));
        }
    }
    for sharp in &mesh.sharp_vertices {
        let vertex = &mut net.sharpness[sharp.position as usize];
        *vertex = vertex.max(forever(sharp.sharpness));
    }
}

impl Channel {
    /// Wedges of one position with the same value are one vertex. What is sharp of `positions` is sharp here; borders of
    /// charts are held.
    fn base(mesh: &ControlMesh, positions: &Net, rows: &[DVec4]) -> Self {
        let bit = |x: f64| (x as f32 + 0.0).to_bits();
        let halves = classes(rows.iter().map(|row| [bit(row.x), bit(row.y), 0]));
        let others = rows.iter().zip(&halves.of);
        let wholes = classes(others.map(|(row, &class)| [class, bit(row.z), bit(row.w)]));
        let vertices =
            classes(mesh.wedges.iter().zip(&wholes.of).map(|(&position, &class)| [position, class, 0]));
        let corners = mesh.corners.iter().map(|&wedge| vertices.of[wedge as usize]).collect();
        let mut net = Net::of_faces(vertices.firsts.len(), mesh.ends.clone(), corners);
        for (&edge, &same) in net.edge_of.iter().zip(&positions.edge_of) {
            let edge = &mut net.edges[edge as usize];
            edge.sharpness = edge.sharpness.max(positions.edges[same as usize].sharpness);
        }
        for (&vertex, &same) in net.corners.iter().zip(&positions.corners) {
            net.sharpness[vertex as usize] = positions.sharpness[same as usize];
        }
        net.hold_borders();
        Self { net, values: vertices.firsts.iter().map(|&wedge| rows[wedge as usize]).collect() }
    }
}

/// The subdivisions of a control mesh, from itself on, and where all their vertices end.
pub(super) struct Stack {
    pub scheme: Scheme,
    /// Coarsest first.
    pub levels: Vec<Level>,
}

impl Stack {
    /// The control mesh and so many subdivisions.
    pub fn new(mesh: &ControlMesh, scheme: Scheme, levels: usize) -> Result<Self, SubdivideError> {
        let mut stack = Self::of_control(mesh, scheme)?;
        let corners =
            |level: usize| (mesh.corners.len() as u64).checked_mul(4_u64.checked_pow(level as u32)?);
        if let Some(level) =
            (1..=levels).find(|&level| corners(level).is_none_or(|corners| corners > MOST_CORNERS))
        {
            return Err(SubdivideError::TooLarge { level });
        }
        for _ in 0..levels {
            stack.add()?;
        }
        Ok(stack)
    }

    /// The control mesh alone.
    pub fn of_control(mesh: &ControlMesh, scheme: Scheme) -> Result<Self, SubdivideError> {
        mesh.check()?;
        let polygon = mesh.faces().map(|face| face.len()).enumerate().find(|&(_, corners)| corners != 3);
        match polygon.filter(|_| scheme == Scheme::Loop) {
            Some((face, corners)) => Err(SubdivideError::NotTriangle { face, corners }),
            None => Ok(Self { scheme, levels: vec![Level::base(mesh)] }),
        }
    }

    /// The most subdivided.
    pub fn finest(&self) -> &Level {
        // It has the control mesh at least.
        &self.levels[self.levels.len() - 1]
    }

    /// One subdivision more.
    pub fn add(&mut self) -> Result<(), SubdivideError> {
        if !self.finest().has_room() {
            return Err(SubdivideError::TooLarge { level: self.levels.len() });
        }
        self.levels.push(self.finest().refined(self.scheme));
        Ok(())
    }

    /// The sides of the finest level's vertices.
    pub fn sides(&self) -> Sides {
        let level = self.finest();
        if !self.has_polygons() {
            return Sides::of(level, self.scheme);
        }
        let mut sides = Sides::of(&level.refined(self.scheme), self.scheme);
        sides.coarsen(self.scheme);
        sides
    }

    /// Whether the finest level has faces that masks do not know.
    fn has_polygons(&self) -> bool {
        let net = &self.finest().net;
        self.scheme == Scheme::CatmullClark && net.corners.len() != 4 * net.face_count()
    }

    /// Where the vertices of the finest level end, those of all coarser ones being the first of them.
    pub fn limits(&self) -> Limits {
        let level = self.finest();
        match self.has_polygons() {
            true => Limits::of(&level.refined(self.scheme), self.scheme),
            false => Limits::of(level, self.scheme),
        }
    }
}

/// Where vertices end.
pub(super) struct Limits {
    pub positions: Vec<DVec3>,
    /// Of each channel.
    pub channels: Vec<Vec<DVec4>>,
}

impl Limits {
    fn of(level: &Level, scheme: Scheme) -> Self {
        let channel = |channel: &Channel| limits(scheme, &channel.net, &channel.values);
        Self {
            positions: limits(scheme, &level.net, &level.positions),
            channels: level.channels.iter().map(channel).collect(),
        }
    }
}
