//! Tables that are replaced while a runtime runs, held against objects that are given another table, and against a
//! runtime that has known no other.

mod scenes;

use lod_budget::bounds::Sphere;
use lod_budget::check::{Promise, Replay, Violation};
use lod_budget::runtime::{FrameInput, Runtime, RuntimeOptions};
use lod_budget::scene::{Objects, TableId};
use lod_budget::table::{LevelRecord, LodTable};
use proptest::prelude::*;
use scenes::{
    BudgetOf, Cameras, POLICIES, Policy, Record, Scene, budget, film, inputs, measured, options, reorder,
};

/// Everything a run depends on.
#[derive(Clone, Debug)]
struct Trial {
    scene: Scene,
    /// Triangles and accuracies of levels to come.
    news: Vec<(u32, f32)>,
    /// Bit per frame: tables are replaced before it.
    when: u8,
    film: Vec<Cameras>,
    options: RuntimeOptions,
    budget: BudgetOf,
    late: u64,
    ratio: f64,
}

fn trial() -> impl Strategy<Value = Trial> {
    let news = prop::collection::vec((0u32..200_000, 0.0f32..=1.0), 1..40);
    let world = (scenes::scene(), film(2..7), options(), budget());
    (world, news, any::<u8>(), 0u64..4, 0.6f64..1.6).prop_map(
        |((scene, film, options, budget), news, when, late, ratio)| Trial {
            scene,
            news,
            when: when | 2,
            film,
            options,
            budget,
            late,
            ratio,
        },
    )
}

/// How a table comes to be another.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Way {
    Replaced,
    /// Objects are given a table that has been there from the start.
    Given,
}

impl Trial {
    /// The levels of a table after so many replacements; 0 for those at the start.
    fn levels(&self, table: usize, round: usize) -> Vec<LevelRecord> {
        let news = self.news.iter().cycle().skip(table + 5 * round);
        let new = |(&(triangles, accuracy), &old): (&(u32, f32), &LevelRecord)| LevelRecord {
            accuracy,
            ..LevelRecord { triangles, vertices: triangles / 2, ..old }
        };
        let old = &self.scene.tables[table];
        if round == 0 { old.clone() } else { news.zip(old).map(new).collect() }
    }

    fn table(&self, table: usize, round: usize) -> LodTable {
        let bounds = Sphere::new(glam::Vec3::ZERO, 1.0);
        LodTable::new(format!("{table} of {round}"), bounds, self.levels(table, round)).expect("a good table")
    }

    fn rounds(&self) -> usize {
        self.film.len()
    }

    /// The scene, behind the tables of which lie those of all rounds: so the dearest level of any is always the same,
    /// which sets how fine costs are counted.
    fn store(&self) -> Objects {
        let mut objects = self.scene.store();
        for round in 0..self.rounds() {
            for table in 0..self.scene.tables.len() {
                objects.add_table(self.table(table, round)).expect("room for tables");
            }
        }
        objects
    }

    /// Every second table becomes that of a round.
    fn renew(&self, objects: &mut Objects, round: usize, way: Way) {
        let tables = self.scene.tables.len();
        for table in (0..tables).step_by(2) {
            match way {
                Way::Replaced => {
                    let id = TableId(table as u16);
                    objects.replace_table(id, self.table(table, round)).expect("as many levels");
                }
                Way::Given => {
                    let id = TableId((tables * (1 + round) + table) as u16);
                    let has = |o: &&lod_budget::scene::Object| usize::from(o.table.0) == table;
                    for object in self.scene.objects.iter().filter(has) {
                        objects.set_table(object.id, id).expect("known objects and tables");
                    }
                }
            }
        }
    }

    fn budget_us(&self) -> f64 {
        let mut runtime = Runtime::new(self.options, Policy::Coarsest.selector()).expect("good options");
        let views = self.film.first().map(inputs).unwrap_or_default();
        let least_us = runtime.frame(&mut self.store(), &FrameInput::new(&views, 0.0)).select.cost_us;
        self.budget.us(least_us)
    }

    /// The frames of a policy, each checked.
    fn records(&self, policy: Policy, way: Way) -> Result<Vec<Record>, Violation> {
        let mut runtime = Runtime::new(self.options, policy.selector()).expect("good options");
        let (mut objects, mut replay) = (self.store(), Replay::new(self.options));
        let (mut records, mut predicted_us) = (Vec::new(), Vec::new());
        let budget_us = self.budget_us();
        for (n, cameras) in self.film.iter().enumerate() {
            if n > 0 && self.when & (1 << n) != 0 {
                self.renew(&mut objects, n, way);
            }
            let views = inputs(cameras);
            let measured = measured(n as u64 + 1, &predicted_us, self.late, self.ratio);
            let input = FrameInput { measured: &measured, ..FrameInput::new(&views, budget_us) };
            predicted_us.push(runtime.frame(&mut objects, &input).predicted_us);
            replay.frame(&runtime, &objects, &input, policy.promise())?;
            records.push(Record::of(&runtime, &objects));
            if n == 3 {
                reorder(&mut objects, u64::from(self.when));
            }
        }
        Ok(records)
    }
}

fn fail(violation: Violation) -> TestCaseError {
    TestCaseError::fail(violation.to_string())
}

/// A runtime that has run over a film without measurements, and over its last frame once more.
fn after(trial: &Trial, policy: Policy, film: &[Cameras], objects: &mut Objects) -> Runtime {
    let mut runtime = Runtime::new(trial.options, policy.selector()).expect("good options");
    film.iter().for_each(|cameras| {
        runtime.frame(objects, &FrameInput::new(&inputs(cameras), 0.0));
    });
    runtime
}

proptest! {
    #[test]
    fn replacing_a_table_is_giving_another_to_all_its_objects(trial in trial()) {
        for policy in POLICIES {
            let replaced = trial.records(policy, Way::Replaced).map_err(fail)?;
            let given = trial.records(policy, Way::Given).map_err(fail)?;
            prop_assert_eq!(replaced, given, "{:?}", policy);
        }
    }

    #[test]
    fn the_next_frame_is_that_of_a_fresh_runtime_but_for_memory(trial in trial()) {
        let budget_us = trial.budget_us();
        for policy in POLICIES {
            let (mut objects, mut fresh) = (trial.store(), trial.store());
            let mut running = after(&trial, policy, &trial.film, &mut objects);
            trial.renew(&mut objects, 1, Way::Replaced);
            trial.renew(&mut fresh, 1, Way::Replaced);
            let mut newborn = after(&trial, policy, &[], &mut fresh);
            let views = trial.film.last().map(inputs).unwrap_or_default();
            let input = FrameInput::new(&views, budget_us);
            let a = *running.frame(&mut objects, &input);
            let b = *newborn.frame(&mut fresh, &input);
            let (seen, known) = (running.last_frame(&objects), newborn.last_frame(&fresh));
            for table in 0..objects.tables().len() as u16 {
                // Not a number is not equal to itself: what a level's author did not say is compared as text.
                let [x, y] = [seen, known].map(|f| format!("{:?}", f.rates.levels(table)));
                prop_assert_eq!(x, y);
            }
            prop_assert_eq!(seen.rates.best_slopes(), known.rates.best_slopes());
            // Fades in flight are memory; without them both have the same budget, and each bound holds for both.
            if matches!(policy, Policy::Finest | Policy::Coarsest) {
                let [x, y] = [&a, &b].map(|f| (f.candidates, f.select.cost_us, f.select.benefit));
                prop_assert_eq!(x, y);
                prop_assert!(a.select == b.select || a.budget != b.budget);
            }
            if policy.promise() == Promise::Budget && a.budget == b.budget {
                let bounds = a.select.certificate.zip(b.select.certificate);
                for bound in bounds.into_iter().flat_map(|(a, b)| [a.upper_bound, b.upper_bound]) {
                    let most = a.select.benefit.max(b.select.benefit);
                    prop_assert!(most <= bound * (1.0 + 1e-9), "{} above {}", most, bound);
                }
            }
        }
    }
}

#[test]
fn what_cannot_be_replaced_is_refused_and_nothing_changes() {
    let levels = |n| scenes::halving(1000, n);
    let table = |n| LodTable::new("rock", Sphere::new(glam::Vec3::ZERO, 1.0), levels(n)).expect("good");
    let mut objects = Objects::new();
    let id = objects.add_table(table(3)).expect("room");
    let revision = objects.revision();
    let unknown = objects.replace_table(TableId(1), table(3)).expect_err("there is one table");
    assert_eq!(unknown.to_string(), "objects: the table to replace is unknown");
    let shorter = objects.replace_table(id, table(2)).expect_err("a level is gone");
    assert!(shorter.to_string().contains("as many levels"), "{shorter}");
    assert_eq!((objects.revision(), &objects.tables()[0]), (revision, &table(3)));
}
