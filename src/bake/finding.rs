//! What is odd about a mesh, counted by kind, with the first places where it is so.

use std::fmt;

/// A kind of oddity, and what is done about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Defect {
    /// A face of fewer than three corners. Left out.
    ShortFace,
    /// A corner names a normal or texture coordinate that the file does not have. It gets none.
    UnknownAttribute,
    /// Something that is no triangle or that nobody here can use: lines, points, curves, unknown statements. Passed
    /// over.
    Unread(&'static str),
    /// A corner's position is infinite or no number. The face is left out.
    NotFinitePosition,
    /// A normal, texture coordinate, colour, tangent or weight is infinite or no number. It becomes neutral: 0, or 1 in
    /// colours.
    NotFiniteAttribute,
    /// Two corners of a face have the same position. Left out: it has no area, and its neighbours meet without it.
    DegenerateFace,
    /// A face with the same positions in the same order as one before. Left out.
    DuplicateFace,
    /// A position that no face uses. Left out.
    IsolatedVertex,
    /// A face with the same positions as one before, seen from the other side: thin things are often drawn so. Kept.
    OppositeFace,
    /// A face of three positions in a line, or as good as: no normal can be told. Kept, since leaving it out would open
    /// a T-junction.
    FlatFace,
    /// An edge of one face alone. Kept: it is the border of an open surface.
    BorderEdge,
    /// An edge of more than two faces. Kept.
    NonManifoldEdge,
    /// An edge of two faces that run the same way along it: one of them is inside out. Kept.
    MisorientedEdge,
    /// A position whose faces form more than one fan: surfaces that touch in a point. Kept.
    NonManifoldVertex,
    /// A vertex of a border within another border edge: a crack may show there. Kept.
    TJunction,
}

impl Defect {
    /// Whether the mesh is without it afterwards.
    pub fn is_repaired(self) -> bool {
        use Defect::*;
        match self {
            ShortFace | UnknownAttribute | Unread(_) | NotFinitePosition | NotFiniteAttribute => true,
            DegenerateFace | DuplicateFace | IsolatedVertex => true,
            OppositeFace | FlatFace | BorderEdge | NonManifoldEdge => false,
            MisorientedEdge | NonManifoldVertex | TJunction => false,
        }
    }

    fn words(self) -> (&'static str, &'static str) {
        use Defect::*;
        match self {
            ShortFace => ("faces of fewer than 3 corners", "left out"),
            UnknownAttribute => ("corners with an unknown normal or texture coordinate", "taken as without"),
            Unread(what) => (what, "passed over"),
            NotFinitePosition => ("faces with a position that is not finite", "left out"),
            NotFiniteAttribute => ("attributes that are not finite", "made neutral"),
            DegenerateFace => ("faces with two corners in one place", "left out"),
            DuplicateFace => ("faces that repeat another", "left out"),
            IsolatedVertex => ("positions without a face", "left out"),
            OppositeFace => ("faces that are another's back", "kept"),
            FlatFace => ("faces without area", "kept"),
            BorderEdge => ("border edges", "kept"),
            NonManifoldEdge => ("edges of more than two faces", "kept"),
            MisorientedEdge => ("edges whose two faces run the same way", "kept"),
            NonManifoldVertex => ("vertices where surfaces touch", "kept"),
            TJunction => ("T-junctions", "kept"),
        }
    }
}

/// All oddities of one kind.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Finding {
    /// The kind.
    pub defect: Defect,
    /// How many; at least so many where [`Finding::is_complete`] is false.
    pub count: usize,
    /// Where the first few of them are: line, face or vertex.
    pub first: Vec<String>,
    /// Whether the search ended before its limit on work.
    pub is_complete: bool,
}

/// How many places a finding names.
const PLACES: usize = 3;

impl Finding {
    /// Of a kind that was found nowhere yet.
    pub(super) fn none(defect: Defect) -> Self {
        Self { defect, count: 0, first: Vec::new(), is_complete: true }
    }

    /// One more. The place is asked for only while places are still kept, and kept if it is not the last one again.
    pub(super) fn add(&mut self, place: impl FnOnce() -> String) {
        self.count += 1;
        if self.first.len() < PLACES {
            let place = place();
            if self.first.last() != Some(&place) {
                self.first.push(place);
            }
        }
    }
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (what, remedy) = self.defect.words();
        let least = if self.is_complete { "" } else { "at least " };
        write!(f, "{least}{} {what}, {remedy}", self.count)?;
        match self.first.as_slice() {
            [] => Ok(()),
            places => {
                write!(f, ": {}{}", places.join(", "), if self.count > places.len() { " …" } else { "" })
            }
        }
    }
}

/// Findings in the order in which their kinds were met first.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings(pub(super) Vec<Finding>);

impl Findings {
    pub(super) fn add(&mut self, defect: Defect, place: impl FnOnce() -> String) {
        let known = self.0.iter().position(|f| f.defect == defect).unwrap_or_else(|| {
            self.0.push(Finding::none(defect));
            self.0.len() - 1
        });
        self.0[known].add(place);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_finding_counts_all_and_names_the_first() {
        let mut findings = Findings::default();
        (0..5).for_each(|line| findings.add(Defect::ShortFace, || format!("line {line}")));
        findings.add(Defect::Unread("lines"), || "line 9".into());
        let said: Vec<String> = findings.0.iter().map(Finding::to_string).collect();
        assert_eq!(said[0], "5 faces of fewer than 3 corners, left out: line 0, line 1, line 2 …");
        assert_eq!(said[1], "1 lines, passed over: line 9");
    }
}
