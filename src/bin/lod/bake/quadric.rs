//! The knobs of the method `quadric`.

use clap::ValueEnum;
use lod_budget::bake::simplify::{GarlandHeckbert, Placement, Topology};

/// What is not said is as the preset has it, or as it is by default.
#[derive(clap::Args)]
#[command(next_help_heading = "Method quadric")]
pub struct QuadricArgs {
    /// Whether holes may close, and handles and small parts go [default: preserved, or as the preset says]
    #[arg(long, value_enum)]
    topology: Option<TopologyKind>,
    /// Where contracted vertices go [default: balanced]
    #[arg(long, value_enum)]
    placement: Option<PlacementKind>,
    /// How much moving away from a border counts [default: 10, or as the preset says]
    #[arg(long, value_name = "WEIGHT", value_parser = weight)]
    border: Option<f32>,
    /// Contract vertices that are closer than this without an edge, too, in object units; needs --topology free
    #[arg(long, value_name = "DISTANCE", value_parser = weight)]
    pairs: Option<f32>,
}

#[derive(Clone, Copy, ValueEnum)]
enum TopologyKind {
    /// Closed stays closed, and every part stays
    Preserved,
    /// Holes may close, parts may go
    Free,
}

#[derive(Clone, Copy, ValueEnum)]
enum PlacementKind {
    /// Where the error is least, and a little further to the outside of what bulges
    Balanced,
    /// Where the error is least
    Optimal,
    /// At the better end of the edge
    Endpoint,
    /// At its middle
    Midpoint,
    /// At the mean of what was contracted
    Average,
}

impl QuadricArgs {
    /// `quadric`, changed by what was asked for.
    pub fn over(&self, quadric: GarlandHeckbert) -> GarlandHeckbert {
        GarlandHeckbert {
            topology: self.topology.map_or(quadric.topology, TopologyKind::topology),
            placement: self.placement.map_or(quadric.placement, PlacementKind::placement),
            border: self.border.unwrap_or(quadric.border),
            pairs: self.pairs.unwrap_or(quadric.pairs),
            ..quadric
        }
    }
}

impl TopologyKind {
    fn topology(self) -> Topology {
        match self {
            Self::Preserved => Topology::Preserved,
            Self::Free => Topology::Free,
        }
    }
}

impl PlacementKind {
    fn placement(self) -> Placement {
        match self {
            Self::Balanced => Placement::Balanced,
            Self::Optimal => Placement::Optimal,
            Self::Endpoint => Placement::Endpoint,
            Self::Midpoint => Placement::Midpoint,
            Self::Average => Placement::Average,
        }
    }
}

fn weight(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|x: &f32| x.is_finite() && *x >= 0.0);
    number.ok_or_else(|| "must be a number that is not negative".to_owned())
}
