//! The methods by name.

use std::fmt;
use std::str::FromStr;

use super::{AdaptiveCluster, Cluster, GarlandHeckbert, Melax, Simplifier};

/// A method of simplification; all with their defaults.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Method {
    /// [`GarlandHeckbert`]
    #[default]
    Quadric,
    /// [`Melax`]
    Melax,
    /// [`Cluster`]
    Cluster,
    /// [`AdaptiveCluster`]
    AdaptiveCluster,
}

impl Method {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Quadric, Self::Melax, Self::Cluster, Self::AdaptiveCluster];

    /// What the command line calls it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Quadric => "quadric",
            Self::Melax => "melax",
            Self::Cluster => "cluster",
            Self::AdaptiveCluster => "adaptive-cluster",
        }
    }

    /// The method, as it is by default.
    pub fn simplifier(self) -> Box<dyn Simplifier + Send + Sync> {
        match self {
            Self::Quadric => Box::new(GarlandHeckbert::default()),
            Self::Melax => Box::new(Melax::default()),
            Self::Cluster => Box::new(Cluster::default()),
            Self::AdaptiveCluster => Box::new(AdaptiveCluster::default()),
        }
    }
}

impl fmt::Display for Method {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        out.pad(self.name())
    }
}

impl FromStr for Method {
    type Err = UnknownMethod;

    fn from_str(name: &str) -> Result<Self, UnknownMethod> {
        let is_meant = |method: &Self| method.name() == name;
        Self::ALL.into_iter().find(is_meant).ok_or_else(|| UnknownMethod { name: name.into() })
    }
}

/// A name that no method has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownMethod {
    /// The name.
    pub name: String,
}

impl fmt::Display for UnknownMethod {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = Method::ALL.map(Method::name).join(", ");
        write!(out, "there is no method `{}`; the methods are {names}", self.name)
    }
}

impl std::error::Error for UnknownMethod {}
