//! The contract of selection, held against every policy over random scenes, cameras, budgets and options.

mod plain;
mod scenes;

use lod_budget::check::{self, Promise, Replay};
use lod_budget::frame::GroupId;
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions};
use lod_budget::scene::Objects;
use lod_budget::select::{Reactive, ReactiveOptions, ScreenSize, Selector};
use plain::{Checked, size_options};
use proptest::prelude::*;
use scenes::{
    BudgetOf, Cameras, POLICIES, Policy, Record, Scene, budget, film, inputs, measured, options, reorder,
    shuffled,
};

/// Everything a run depends on.
#[derive(Clone, Debug)]
struct Trial {
    scene: Scene,
    film: Vec<Cameras>,
    options: RuntimeOptions,
    budget: BudgetOf,
    /// Frames that measurements come late by, and how much slower the machine is than predicted.
    late: u64,
    ratio: f64,
    /// What the world does to an object before each frame.
    edits: Vec<(prop::sample::Index, Edit)>,
}

#[derive(Clone, Debug)]
enum Edit {
    None,
    Remove,
    /// Takes it out and puts it back, in another slot perhaps.
    Reinsert,
    /// As its neighbour in the scene.
    Become(prop::sample::Index),
}

fn edit() -> impl Strategy<Value = Edit> {
    prop_oneof![
        2 => Just(Edit::None),
        1 => Just(Edit::Remove),
        1 => Just(Edit::Reinsert),
        6 => any::<prop::sample::Index>().prop_map(Edit::Become),
    ]
}

impl Edit {
    fn apply(&self, scene: &Scene, object: usize, objects: &mut Objects) {
        let old = scene.objects[object];
        match self {
            Self::None => {}
            Self::Remove => drop(objects.remove(old.id)),
            Self::Reinsert => {
                objects.remove(old.id);
                objects.insert(old).expect("a good object");
            }
            Self::Become(other) if objects.get(old.id).is_some() => {
                let other = scene.objects[other.index(scene.objects.len())];
                objects.set_table(old.id, other.table).expect("a good table");
                objects.set_settings(old.id, other.settings).expect("good settings");
                objects.set_bounds(old.id, other.bounds).expect("a known object");
            }
            Self::Become(_) => {}
        }
    }
}

fn trial() -> impl Strategy<Value = Trial> {
    let edits = prop::collection::vec((any::<prop::sample::Index>(), edit()), 0..12);
    (scenes::scene(), film(1..7), options(), budget(), (0u64..4, 0.6f64..1.6), edits).prop_map(
        |(scene, film, options, budget, (late, ratio), edits)| Trial {
            scene,
            film,
            options,
            budget,
            late,
            ratio,
            edits,
        },
    )
}

impl Trial {
    fn runtime(&self, policy: Policy) -> Runtime {
        Runtime::new(self.options, policy.selector()).expect("good options")
    }

    /// What the cheapest choice of the first frame costs.
    fn minimum_us(&self) -> f64 {
        let mut runtime = self.runtime(Policy::Coarsest);
        let views = self.film.first().map(inputs).unwrap_or_default();
        runtime.frame(&mut self.scene.store(), &FrameInput::new(&views, 0.0)).select.cost_us
    }

    /// Runs frames from number `first` on, and tells `each` about every one.
    fn run(
        &self,
        runtime: &mut Runtime,
        objects: &mut Objects,
        budget_us: f64,
        film: &[Cameras],
        mut each: impl FnMut(&Runtime, &mut Objects, &FrameInput<'_>) -> Result<(), TestCaseError>,
    ) -> Result<(), TestCaseError> {
        let mut predicted_us = Vec::new();
        for (n, cameras) in film.iter().enumerate() {
            for (object, edit) in self.edits.iter().skip(n * 2).take(2) {
                if n > 0 && !self.scene.objects.is_empty() {
                    edit.apply(&self.scene, object.index(self.scene.objects.len()), objects);
                }
            }
            let views = inputs(cameras);
            let measured = measured(n as u64 + 1, &predicted_us, self.late, self.ratio);
            let input = FrameInput { measured: &measured, ..FrameInput::new(&views, budget_us) };
            predicted_us.push(runtime.frame(objects, &input).predicted_us);
            each(runtime, objects, &input)?;
        }
        Ok(())
    }

    fn records(&self, runtime: &mut Runtime, objects: &mut Objects, reordering: Option<u64>) -> Vec<Record> {
        let mut records = Vec::new();
        let budget_us = self.budget.us(self.minimum_us());
        let run = self.run(runtime, objects, budget_us, &self.film, |runtime, objects, _| {
            records.push(Record::of(runtime, objects));
            if let Some(seed) = reordering {
                reorder(objects, seed + records.len() as u64);
            }
            Ok(())
        });
        assert!(run.is_ok(), "recording does not fail");
        records
    }
}

fn fail(violation: check::Violation) -> TestCaseError {
    TestCaseError::fail(violation.to_string())
}

/// Exhaustive search is affordable.
fn is_small(runtime: &Runtime, objects: &Objects) -> bool {
    let frame = runtime.last_frame(objects);
    frame.candidates.len() <= 8
}

proptest! {
    #[test]
    fn every_policy_keeps_the_contract(trial in trial()) {
        let budget_us = trial.budget.us(trial.minimum_us());
        for policy in POLICIES {
            let mut replay = Replay::new(trial.options);
            let (mut runtime, mut objects) = (trial.runtime(policy), trial.scene.store());
            trial.run(&mut runtime, &mut objects, budget_us, &trial.film, |runtime, objects, input| {
                replay.frame(runtime, objects, input, policy.promise()).map_err(fail)?;
                if policy.promise() == Promise::Budget && is_small(runtime, objects) {
                    check::bound(&runtime.last_frame(objects), &runtime.report().select).map_err(fail)?;
                }
                for object in &trial.scene.objects {
                    for group in (0..3).map(GroupId) {
                        if let Some(explained) = runtime.explain(objects, group, object.id) {
                            prop_assert_eq!(explained.shown, runtime.shown(objects, group, object.id));
                        }
                    }
                }
                Ok(())
            })?;
        }
    }

    #[test]
    fn policies_by_size_decide_as_object_by_object(trial in trial(), size in size_options()) {
        let fixed = ScreenSize::new(size).expect("good options");
        let steered = Reactive::new(ReactiveOptions { size, ..Default::default() }).expect("good options");
        let checked: [Box<dyn Selector>; 2] =
            [Box::new(Checked::new(fixed, size)), Box::new(Checked::new(steered, size))];
        let budget_us = trial.budget.us(trial.minimum_us());
        for selector in checked {
            let mut runtime = Runtime::new(trial.options, selector).expect("good options");
            let film = [&trial.film[..], &trial.film[..]].concat();
            trial.run(&mut runtime, &mut trial.scene.store(), budget_us, &film, |_, _, _| Ok(()))?;
        }
    }

    #[test]
    fn neither_insertion_nor_slots_change_a_decision(trial in trial(), seed in any::<u64>()) {
        let order = shuffled(trial.scene.objects.len(), seed);
        for policy in POLICIES {
            let plain = trial.records(&mut trial.runtime(policy), &mut trial.scene.store(), None);
            let mut shuffled = trial.scene.store_in(order.iter().copied());
            let other = trial.records(&mut trial.runtime(policy), &mut shuffled, Some(seed >> 1));
            prop_assert_eq!(plain, other, "{:?}", policy);
        }
    }

    #[test]
    fn a_clone_continues_alike_and_a_reset_starts_afresh(trial in trial()) {
        for policy in POLICIES {
            let (mut runtime, mut objects) = (trial.runtime(policy), trial.scene.store());
            let first = trial.records(&mut runtime, &mut objects, None);
            let (mut twin, mut twins) = (runtime.clone(), objects.clone());
            let on = trial.records(&mut runtime, &mut objects, None);
            let too = trial.records(&mut twin, &mut twins, None);
            prop_assert_eq!(on, too, "{:?}", policy);
            runtime.reset();
            let again = trial.records(&mut runtime, &mut trial.scene.store(), None);
            prop_assert_eq!(first, again, "{:?}", policy);
        }
    }
}
