//! Plans for kinds of objects: what engines call LOD groups.

use super::{Length, Limits, Plan, Stops};
use crate::bake::simplify::{GarlandHeckbert, Topology};

/// A kind of object, and what its levels should be like.
///
/// | | each level has | levels | least triangles | most error | topology | border |
/// |---|---|---|---|---|---|---|
/// | [`SmallProp`](Self::SmallProp) | ⅓ | 5 | 8 | 15 % | free | 3 |
/// | [`LargeProp`](Self::LargeProp) | ½ | 8 | 24 | 8 % | preserved | 10 |
/// | [`Foliage`](Self::Foliage) | ½ | 5 | 16 | 10 % | preserved | 30 |
/// | [`LevelArchitecture`](Self::LevelArchitecture) | ½ | 6 | 16 | 3 % | preserved | 100 |
/// | [`Vista`](Self::Vista) | ¼ | 5 | 12 | 20 % | free | 3 |
/// | [`Character`](Self::Character) | ½ | 7 | 150 | 4 % | preserved | 10 |
///
/// The error is a share of the diagonal, the border a weight ([`GarlandHeckbert::border`]). A level that saves less than
/// a fifth of the triangles is left out.
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
            Self::SmallProp => plan(third, 5, 8, 0.15, Free, 3.0),
            Self::LargeProp => plan(0.5, 8, 24, 0.08, Preserved, 10.0),
            Self::Foliage => plan(0.5, 5, 16, 0.1, Preserved, 30.0),
            Self::LevelArchitecture => plan(0.5, 6, 16, 0.03, Preserved, 100.0),
            Self::Vista => plan(0.25, 5, 12, 0.2, Free, 3.0),
            Self::Character => plan(0.5, 7, 150, 0.04, Preserved, 10.0),
        }
    }
}

/// A row of the table.
fn plan(
    ratio: f64,
    levels: usize,
    least_triangles: usize,
    most_error: f64,
    topology: Topology,
    border: f32,
) -> Plan {
    Plan {
        method: GarlandHeckbert { topology, border, ..GarlandHeckbert::default() },
        stops: Stops::Ratio(ratio),
        limits: Limits {
            levels,
            least_triangles,
            most_error: Some(Length::OfDiagonal(most_error)),
            ..Limits::default()
        },
        ..Plan::default()
    }
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
