//! Plans for kinds of objects: what engines call LOD groups.

use super::{Length, Limits, Plan, Stops};
use crate::bake::simplify::{Attributes, GarlandHeckbert, Topology};

/// A kind of object, and what its levels should be like.
///
/// | | each level has | levels | least triangles | most error | topology | border | attributes |
/// |---|---|---|---|---|---|---|---|
/// | [`SmallProp`](Self::SmallProp) | ⅓ | 5 | 8 | 15 % | free | 3 | ½ |
/// | [`LargeProp`](Self::LargeProp) | ½ | 8 | 24 | 8 % | preserved | 10 | 1 |
/// | [`Foliage`](Self::Foliage) | ½ | 5 | 16 | 10 % | preserved | 30 | 1 |
/// | [`LevelArchitecture`](Self::LevelArchitecture) | ½ | 6 | 16 | 3 % | preserved | 100 | 1 |
/// | [`Vista`](Self::Vista) | ¼ | 5 | 12 | 20 % | free | 3 | ¼ |
/// | [`Character`](Self::Character) | ½ | 7 | 150 | 4 % | preserved | 10 | 2 |
///
/// The error is a share of the diagonal, the border a weight ([`GarlandHeckbert::border`]); attributes count so many
/// times their usual weights ([`Attributes`]). A level that saves less than a fifth of the triangles is left out. Presets
/// are for the method `quadric`; what they say of weights and topology means nothing to others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preset {
    /// Crates, lamps, dishes: many, mostly small in the image. Few levels in large steps, as each costs memory for every
    /// kind of prop; holes and handles may close, nobody sees them from where they do.
    SmallProp,
    /// Cars, statues, furniture to walk around: looked at from all distances, so steps are small enough not to pop.
    LargeProp,
    /// Plants: mostly borders, which hold the outline of leaves. Parts stay, as crowns get thin when leaves go.
    Foliage,
    /// Walls, floors, roofs: their borders meet those of neighbours and have to stay where they are; large and close, so
    /// that only a small error will do.
    LevelArchitecture,
    /// Hills, skylines: never close, so that coarse levels in large steps will do.
    Vista,
    /// People and animals: looked at closely, and bent by skeletons, which takes triangles at joints.
    Character,
}

impl Preset {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::SmallProp,
        Self::LargeProp,
        Self::Foliage,
        Self::LevelArchitecture,
        Self::Vista,
        Self::Character,
    ];

    /// As the command line has it.
    pub fn name(self) -> &'static str {
        match self {
            Self::SmallProp => "small-prop",
            Self::LargeProp => "large-prop",
            Self::Foliage => "foliage",
            Self::LevelArchitecture => "level-architecture",
            Self::Vista => "vista",
            Self::Character => "character",
        }
    }

    /// By its name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|preset| preset.name() == name)
    }

    /// What to do with such objects.
    pub fn plan(self) -> Plan {
        use Topology::{Free, Preserved};
        let third = 1.0 / 3.0;
        match self {
            Self::SmallProp => plan(third, 5, 8, 0.15, held(Free, 3.0, 0.5)),
            Self::LargeProp => plan(0.5, 8, 24, 0.08, held(Preserved, 10.0, 1.0)),
            Self::Foliage => plan(0.5, 5, 16, 0.1, held(Preserved, 30.0, 1.0)),
            Self::LevelArchitecture => plan(0.5, 6, 16, 0.03, held(Preserved, 100.0, 1.0)),
            Self::Vista => plan(0.25, 5, 12, 0.2, held(Free, 3.0, 0.25)),
            Self::Character => plan(0.5, 7, 150, 0.04, held(Preserved, 10.0, 2.0)),
        }
    }
}

/// The first half of a row, and what the second half makes.
fn plan(
    ratio: f64,
    levels: usize,
    least_triangles: usize,
    most_error: f64,
    quadric: GarlandHeckbert,
) -> Plan {
    let most_error = Some(Length::OfDiagonal(most_error));
    Plan {
        quadric,
        stops: Stops::Ratio(ratio),
        limits: Limits { levels, least_triangles, most_error, ..Limits::default() },
        ..Plan::default()
    }
}

/// The second half of a row: what is held how strongly.
fn held(topology: Topology, border: f32, attributes: f32) -> GarlandHeckbert {
    let Attributes { normals, uvs, colours } = Attributes::default();
    let attributes =
        Attributes { normals: attributes * normals, uvs: attributes * uvs, colours: attributes * colours };
    GarlandHeckbert { topology, border, attributes, ..GarlandHeckbert::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_have_names_and_plans_that_keep_the_rules() {
        for preset in Preset::ALL {
            assert_eq!(Preset::named(preset.name()), Some(preset));
            let plan = preset.plan();
            assert_eq!((plan.stops.check(), plan.limits.check()), (Ok(()), Ok(())));
        }
        assert_eq!(Preset::named("castle"), None);
    }
}
