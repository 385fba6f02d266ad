//! What an update is given, and what it says.

/// What a cut may be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// The most triangles. Below [`Hierarchy::base_triangles`](super::super::Hierarchy::base_triangles) the base is shown
    /// all the same.
    pub triangles: usize,
    /// What is off by less on the screen, in px, is not split, and contracted where it is less by the hysteresis as well;
    /// 0 to use all triangles.
    pub enough_px: f32,
    /// The most splits and contractions in one update, those apart that the number of triangles asks for. Fewer spread
    /// the work of a sudden turn over several frames.
    pub changes: usize,
    /// By how much the error of a split has to be above that of the contraction that makes room for it, as a share, ≥ 0.
    /// Less follows the camera closer, more is steadier; below a quarter, what is known of errors is too vague to be
    /// steady while the camera moves.
    pub hysteresis: f32,
}

impl Budget {
    /// So many triangles, all of them used; as many changes as it takes; a hysteresis of a quarter.
    pub const fn triangles(triangles: usize) -> Self {
        Self { triangles, enough_px: 0.0, changes: usize::MAX, hysteresis: 0.25 }
    }
}

/// What an update did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Report {
    /// Operations undone.
    pub splits: usize,
    /// Those among them that stood in the way of another.
    pub forced: usize,
    /// Operations done.
    pub merges: usize,
    /// Operations whose error on the screen was worked out.
    pub evaluated: usize,
    /// Triangles now.
    pub triangles: usize,
    /// What is off farthest in view is off by at most this, in px of the first view, 0 without a view: by its distance
    /// as [`Lens::unit_px`](crate::view::Lens::unit_px) has it. Towards the corners of a wide window the projection
    /// stretches that further.
    pub max_error_px: f32,
    /// Whether nothing more would change if the camera stood still.
    pub is_settled: bool,
    /// Views that were left out because they cannot be used.
    pub broken_views: usize,
}
