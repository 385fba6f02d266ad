//! Simulated machines: how long a frame really takes, which the runtime's model does not know.

use rand::SeedableRng;
use rand_distr::Distribution;
use rand_pcg::Pcg64Mcg;

use crate::frame::Candidates;
use crate::knapsack::FixedSum;
use crate::rate::{CostModel, TableRates, cost_us};
use crate::table::{Level, LodTable};

/// A machine whose true costs differ from the runtime's prior.
#[derive(Clone, Debug)]
pub struct Machine {
    name: &'static str,
    model: CostModel,
    rates: TableRates,
    assets: Vec<f32>,
    noise: f64,
    latency: usize,
    seed: u64,
}

/// Spread of the default machine's coefficients around the prior, as exp(spread · z) held to `COEFFICIENT_RANGE`.
const COEFFICIENT_SPREAD: f64 = 0.2;
const COEFFICIENT_RANGE: (f64, f64) = (0.7, 1.4);
/// Spread of the assets, as exp(spread · z): what no model of counts can know. The best published frame-time model is
/// wrong by 9.5 % (GAMORRA).
const ASSET_SPREAD: f64 = 0.1;
/// Standard deviation of the factor on each frame's time.
const NOISE: f64 = 0.03;
/// Frames until a measurement is known.
const LATENCY: usize = 2;

impl Machine {
    /// The default machine: each coefficient is the prior's times exp(0.2·z) held to 0.7…1.4, each table costs
    /// exp(0.1·z) of what its counts say, each frame N(1, 0.03) of what it should; measured 2 frames late. All from
    /// `seed`.
    pub fn default_for(tables: &[LodTable], prior: &CostModel, seed: u64) -> Self {
        let mut random = Pcg64Mcg::seed_from_u64(seed);
        let mut factor = |spread: f64| (spread * standard_normal(&mut random)).exp();
        let (least, most) = COEFFICIENT_RANGE;
        let coefficients = prior.coefficients().map(|c| c * factor(COEFFICIENT_SPREAD).clamp(least, most));
        let model = prior.with_coefficients(coefficients);
        let assets = tables.iter().map(|_| factor(ASSET_SPREAD) as f32).collect();
        Self { name: "default", noise: NOISE, ..Self::exact(tables, &model, assets, seed) }
    }

    /// A machine that costs exactly what the prior says, without noise; still measured 2 frames late.
    pub fn ideal_for(tables: &[LodTable], prior: &CostModel) -> Self {
        Self::exact(tables, prior, vec![1.0; tables.len()], 0)
    }

    fn exact(tables: &[LodTable], model: &CostModel, assets: Vec<f32>, seed: u64) -> Self {
        let mut rates = TableRates::default();
        rates.renew(tables, model);
        Self { name: "ideal", model: *model, rates, assets, noise: 0.0, latency: LATENCY, seed }
    }

    /// Name, for reports.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// The true coefficients.
    pub fn model(&self) -> &CostModel {
        &self.model
    }

    /// The true rates of the tables, before each asset's factor.
    pub fn rates(&self) -> &TableRates {
        &self.rates
    }

    /// After how many frames a measurement is known.
    pub fn latency(&self) -> usize {
        self.latency
    }

    /// Rewrites candidates as this machine sees them: each asset's factor on its cost.
    pub fn see(&self, candidates: &mut Candidates) {
        candidates.revise(|candidate| {
            let factor = self.assets[usize::from(candidate.table)];
            candidate.cost_scale *= factor;
            candidate.area_px2 *= factor;
        });
    }

    /// Time of a frame without noise. `candidates` are as the machine sees them.
    pub fn time_us(&self, candidates: &Candidates, levels: impl IntoIterator<Item = Level>) -> f64 {
        let mut sum = FixedSum::default();
        for (i, level) in levels.into_iter().enumerate() {
            sum.add(cost_us(&self.model, &self.rates, &candidates.get(i), level));
        }
        sum.value()
    }

    /// The factors of noise on the frames' times, the same for every policy.
    pub fn noise(&self) -> impl Iterator<Item = f64> + use<> {
        let mut random = Pcg64Mcg::seed_from_u64(self.seed ^ NOISE_STREAM);
        let deviation = self.noise;
        std::iter::repeat_with(move || (1.0 + deviation * standard_normal(&mut random)).max(LEAST_NOISE))
    }
}

/// Sets the stream of frame noise apart from that of the machine's own factors.
const NOISE_STREAM: u64 = 0x6e6f_6973_6500;
/// No frame takes less than this share of what it should.
const LEAST_NOISE: f64 = 0.1;

fn standard_normal(random: &mut Pcg64Mcg) -> f64 {
    rand_distr::StandardNormal.sample(random)
}
