//! A policy of one's own: what `Selector` asks for, and what a plausible rule loses to the optimum.
//!
//! ```text
//! cargo run --example custom_selector --no-default-features
//! ```
//!
//! The rule: largest object first, each as fine as still fits. It keeps the budget, and spends it badly: near objects
//! take refinements that hardly show, far ones get nothing.

use std::error::Error;

use glam::{Quat, Vec2, Vec3};
use lod_budget::bounds::Sphere;
use lod_budget::frame::{FrameReport, FrameTime, SelectReport};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
use lod_budget::scene::{Object, Objects};
use lod_budget::select::{Coarsest, Frame, Predictive, Selector};
use lod_budget::table::{Level, LevelRecord, LodTable};
use lod_budget::view::View;

/// Largest first. The only state is scratch, so that nothing is allocated once it is warm.
#[derive(Clone, Default)]
struct LargestFirst {
    order: Vec<usize>,
}

impl Selector for LargestFirst {
    fn select(&mut self, frame: &Frame<'_>, levels: &mut [Level]) -> SelectReport {
        // Everyone gets the cheapest choice; what remains of the budget goes round by size.
        for (i, level) in levels.iter_mut().enumerate() {
            *level = frame.minimum(i);
        }
        let least_us: f64 = levels.iter().enumerate().map(|(i, &level)| frame.cost_us(i, level)).sum();
        let mut spare_us = frame.budget.select_us - least_us;

        // Ties go by the object's id, never by the order of candidates, which is that of slots and may change.
        let size_px = &frame.candidates.size_px;
        self.order.clear();
        self.order.extend(0..levels.len());
        self.order.sort_unstable_by(|&a, &b| {
            size_px[b].total_cmp(&size_px[a]).then_with(|| frame.key(a).cmp(&frame.key(b)))
        });
        for &i in &self.order {
            let extra_us = |level: Level| frame.cost_us(i, level) - frame.cost_us(i, levels[i]);
            // `allowed` heeds residency, forced levels and clamps: a policy has to stay in it.
            let allowed = frame.candidates.allowed[i];
            let mut choices = frame.rates.drawn(frame.candidates.table[i], allowed).map(|(level, _)| level);
            if let Some(level) = choices.find(|&level| extra_us(level) <= spare_us) {
                spare_us -= extra_us(level);
                levels[i] = level;
            }
        }
        frame.report(levels)
    }

    fn boxed_clone(&self) -> Box<dyn Selector> {
        Box::new(self.clone())
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let policies: [(&str, Box<dyn Selector>); 3] = [
        ("coarsest", Box::new(Coarsest)),
        ("largest first", Box::new(LargestFirst::default())),
        ("predictive", Box::new(Predictive::default())),
    ];
    println!("policy         in view  predicted_us  target_us  gain_px2  switches");
    let mut gains = Vec::new();
    let mut least = None;
    for (name, policy) in policies {
        let (report, switches) = fly(policy)?;
        // Benefit counts from nothing drawn; what a policy achieves is what it adds to the cheapest picture.
        let least = *least.get_or_insert(report.select.benefit);
        let gain = report.select.benefit - least;
        println!(
            "{name:<14} {:>7} {:>13.0} {:>10.0} {gain:>9.0} {switches:>9}",
            report.candidates, report.predicted_us, report.budget.target_us,
        );
        if let Some(certificate) = report.select.certificate {
            println!("No policy could have gained more than {:.0} px².", certificate.upper_bound - least);
        }
        gains.push(gain);
    }
    assert!(gains[1] < gains[2]);
    Ok(())
}

/// A hundred and twenty frames through an avenue of statues; the last report, and the switches of all frames.
fn fly(policy: Box<dyn Selector>) -> Result<(FrameReport, usize), Box<dyn Error>> {
    let mut objects = avenue()?;
    let mut runtime = Runtime::new(RuntimeOptions::default(), policy)?;
    let mut timers: Vec<FrameTime> = Vec::new();
    let mut switches = 0;
    for frame in 0..120 {
        let eye = Vec3::new(0.0, 2.0, -0.25 * frame as f32);
        let view = View::perspective(1.0, Vec2::new(1920.0, 1080.0)).at(eye, Quat::IDENTITY);
        let views = [ViewInput::new(view, 0)];
        let measured = timers.iter().rev().nth(1).copied();
        let input = FrameInput { measured: measured.as_slice(), ..FrameInput::new(&views, 1_500.0) };
        let report = runtime.frame(&mut objects, &input);
        switches += report.switches;
        // The machine is exactly as fast as the model says.
        timers.push(FrameTime::busy(report.frame, report.select.cost_us as f32));
    }
    Ok((*runtime.report(), switches))
}

/// Two rows of three hundred statues, with six levels each.
fn avenue() -> Result<Objects, Box<dyn Error>> {
    let levels = (0..6).map(|l| LevelRecord::new(200_000 >> (2 * l), 100_000 >> (2 * l))).collect();
    let mut objects = Objects::new();
    let statue = objects.add_table(LodTable::new("statue", Sphere::new(Vec3::ZERO, 2.0), levels)?)?;
    for i in 0..600_u64 {
        let side = if i % 2 == 0 { -6.0 } else { 6.0 };
        let place = Vec3::new(side, 2.0, (i / 2) as f32 * -3.0 - 4.0);
        objects.insert(Object::new(i, Sphere::new(place, 2.0), statue))?;
    }
    Ok(objects)
}
