//! From the level that is chosen to what is shown: hard switches, cross-fades and geomorphs.
//!
//! At most one transition is in flight per object and group. It runs by time, so it ends with a still camera as well.
//! When the choice returns to the outgoing level it is *aborted*: it runs back from where it is. When the choice moves
//! on to a third level it is *retargeted*: it starts anew from whichever of its two levels shows more, so that
//! transitions never queue up.

use crate::frame::OptionsError;
use crate::table::Level;

/// How one level gives way to another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TransitionKind {
    /// At once.
    #[default]
    Hard,
    /// Both levels are drawn, one fading out and one in; costs both.
    CrossFade,
    /// The finer mesh is drawn and its vertices move, as [`Shown::morph`] says; costs the finer one.
    Geomorph,
}

/// Options of the transition stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransitionOptions {
    /// How one level gives way to another.
    pub kind: TransitionKind,
    /// How long that takes, > 0.
    pub duration_ms: f32,
    /// Share of the frame's target that outgoing levels may cost, in 0…1. Beyond it refinements wait and coarsenings
    /// switch hard. It is kept free whether fades are in flight or not: a budget that came and went with them would
    /// make the selection change, that would start fades, and a still camera would never come to rest.
    pub reserve: f32,
}

impl Default for TransitionOptions {
    fn default() -> Self {
        Self { kind: TransitionKind::Hard, duration_ms: 200.0, reserve: 0.05 }
    }
}

impl TransitionOptions {
    /// Checks the ranges.
    ///
    /// # Errors
    /// Names the option that is out of its range.
    pub fn check(&self) -> Result<(), OptionsError> {
        let lasts = self.duration_ms.is_finite() && self.duration_ms > 0.0;
        OptionsError::unless(lasts, "duration_ms", "must be finite and positive")?;
        OptionsError::unless((0.0..=1.0).contains(&self.reserve), "reserve", "must be from 0 to 1")
    }

    /// What is kept free for outgoing levels; nothing where there are no transitions.
    pub fn reserve_us(&self, target_us: f64) -> f64 {
        if self.kind == TransitionKind::Hard { 0.0 } else { f64::from(self.reserve) * target_us }
    }

    /// What a transition costs beyond the level it leads to.
    pub fn outgoing_us(&self, from_us: f64, to_us: f64) -> f64 {
        match self.kind {
            TransitionKind::Hard => 0.0,
            TransitionKind::CrossFade => from_us,
            TransitionKind::Geomorph => (from_us - to_us).max(0.0),
        }
    }
}

/// What is shown of an object.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    /// The level that is shown, or that the transition leads to.
    pub level: Level,
    /// The level that the transition comes from; `level` when none is in flight.
    pub from: Level,
    /// Weight of `level` against `from`, 0 to 1; 1 when no transition is in flight.
    pub weight: f32,
}

impl Shown {
    /// Nothing.
    pub const NOTHING: Self = Self::steady(Level::NOT_DRAWN);

    /// A level without transition.
    pub const fn steady(level: Level) -> Self {
        Self { level, from: level, weight: 1.0 }
    }

    /// Whether a transition is in flight.
    pub fn is_in_flight(&self) -> bool {
        self.weight < 1.0
    }

    /// The transition after `dt_ms` more.
    pub fn advanced(self, dt_ms: f32, options: &TransitionOptions) -> Self {
        let weight = self.weight + dt_ms / options.duration_ms;
        if weight < 1.0 { Self { weight, ..self } } else { Self::steady(self.level) }
    }

    /// The transition that leads from here to `to`, starting now.
    pub fn towards(self, to: Level) -> Self {
        if to == self.level {
            self
        } else if to == self.from {
            Self { level: to, from: self.level, weight: 1.0 - self.weight }
        } else {
            let from = if self.weight < 0.5 { self.from } else { self.level };
            Self { level: to, from, weight: 0.0 }
        }
    }
}

/// What to draw while a geomorph is in flight: one mesh, with its vertices on their way to those of a coarser level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Morph {
    /// The level whose mesh is drawn: the finer of the two. [`Level::NOT_DRAWN`] where nothing is drawn.
    pub level: Level,
    /// The coarser level that it looks like at weight 1; `level` itself where there is nothing to move.
    pub towards: Level,
    /// How far its vertices are on the way, 0 to 1: the weight of the morph target.
    pub weight: f32,
}

impl Shown {
    /// The mesh to draw, and the weight of its morph, where the transition is a [`TransitionKind::Geomorph`].
    ///
    /// Drawn is the finer mesh both ways, so its weight is [`Shown::weight`] when coarsening and 1 − that when refining.
    /// The levels may be several apart: the morph is of the finer one of them, towards the coarser one of them. When
    /// the transition ends the mesh changes, and with an exact morph nothing else does. What appears or goes has nothing
    /// to morph to: it is drawn unmoved while the transition is in flight.
    ///
    /// The weight changes by no more than time ÷ [`TransitionOptions::duration_ms`] in a frame, from the first to the
    /// last. It is not eased, on purpose: of all ways to go from 0 to 1 the straight one has the smallest largest step,
    /// and so pops least. An abort goes on from where it is. A retarget starts from an end of the morph before, so that
    /// what is in flight jumps there, by half of the way at most.
    pub fn morph(&self) -> Morph {
        let Self { level, from, weight } = *self;
        let (finer, coarser) = (level.min(from), level.max(from));
        if finer == coarser || !coarser.is_drawn() {
            return Morph { level: finer, towards: finer, weight: 0.0 };
        }
        Morph { level: finer, towards: coarser, weight: if level == coarser { weight } else { 1.0 - weight } }
    }
}

/// Decides what happens to an object whose choice has become `to`: a transition while `reserve_us` lasts, which it
/// draws from; beyond that a coarsening switches hard and a refinement waits.
pub fn follow(
    shown: Shown,
    to: Level,
    options: &TransitionOptions,
    cost_us: impl Fn(Level) -> f64,
    reserve_us: &mut f64,
) -> Shown {
    if options.kind == TransitionKind::Hard {
        return Shown::steady(to);
    }
    let next = shown.towards(to);
    let price = |s: Shown| options.outgoing_us(cost_us(s.from), cost_us(s.level));
    let already = if shown.is_in_flight() { price(shown) } else { 0.0 };
    let more = price(next) - already;
    if more <= *reserve_us {
        *reserve_us -= more;
        next
    } else if to > shown.level {
        *reserve_us += already;
        Shown::steady(to)
    } else {
        shown
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FADE: TransitionOptions =
        TransitionOptions { kind: TransitionKind::CrossFade, duration_ms: 200.0, reserve: 0.05 };

    fn cost_us(level: Level) -> f64 {
        16.0 / f64::from(1 << level.0)
    }

    #[test]
    fn a_fade_ends_by_time_alone() {
        let mut shown = Shown::steady(Level(2)).towards(Level(1));
        for _ in 0..13 {
            shown = shown.advanced(16.0, &FADE);
        }
        assert_eq!(shown, Shown::steady(Level(1)));
    }

    #[test]
    fn an_aborted_fade_runs_back_from_where_it_is() {
        let half = Shown::steady(Level(2)).towards(Level(1)).advanced(50.0, &FADE);
        assert_eq!(half.towards(Level(2)), Shown { level: Level(2), from: Level(1), weight: 0.75 });
    }

    #[test]
    fn a_third_level_starts_from_the_one_that_shows_more() {
        let early = Shown { level: Level(1), from: Level(2), weight: 0.3 };
        let late = Shown { weight: 0.7, ..early };
        assert_eq!(early.towards(Level(0)).from, Level(2));
        assert_eq!(late.towards(Level(0)).from, Level(1));
    }

    const MORPH: TransitionOptions = TransitionOptions { kind: TransitionKind::Geomorph, ..FADE };

    /// The weights of a transition's frames at 60 Hz, until it is over.
    fn weights(mut shown: Shown) -> Vec<f32> {
        let mut weights = Vec::new();
        while shown.is_in_flight() {
            weights.push(shown.morph().weight);
            shown = shown.advanced(1000.0 / 60.0, &MORPH);
        }
        weights
    }

    #[test]
    fn the_finer_mesh_is_drawn_both_ways() {
        for (from, to, ends) in
            [(1, 2, [0.0, 1.0]), (2, 1, [1.0, 0.0]), (0, 3, [0.0, 1.0]), (3, 0, [1.0, 0.0])]
        {
            let start = Shown::steady(Level(from)).towards(Level(to));
            let Morph { level, towards, weight } = start.morph();
            assert_eq!((level, towards, weight), (Level(from.min(to)), Level(from.max(to)), ends[0]));
            // Behind the last frame is the new level: that step counts as well.
            let all: Vec<f32> = weights(start).into_iter().chain([ends[1]]).collect();
            assert!(all.len() >= 13 && all.windows(2).all(|w| (w[1] - w[0]) * (ends[1] - ends[0]) >= 0.0));
            let most = all.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f32::max);
            assert!(most <= 1.0 / 8.0, "{most}");
        }
    }

    #[test]
    fn an_aborted_morph_goes_back_from_where_it_is() {
        let there = Shown::steady(Level(2)).towards(Level(1)).advanced(50.0, &MORPH);
        let back = there.towards(Level(2));
        assert_eq!(there.morph(), back.morph());
        assert_eq!(back.morph(), Morph { level: Level(1), towards: Level(2), weight: 0.75 });
        assert!(back.advanced(10.0, &MORPH).morph().weight > 0.75);
    }

    #[test]
    fn a_retargeted_morph_starts_from_a_whole_level() {
        let early = Shown { level: Level(1), from: Level(3), weight: 0.25 };
        let finer = Morph { level: Level(0), towards: Level(3), weight: 1.0 };
        assert_eq!(early.towards(Level(0)).morph(), finer, "as level 3 looks");
        let late = Shown { weight: 0.75, ..early };
        let coarser = Morph { level: Level(1), towards: Level(4), weight: 0.0 };
        assert_eq!(late.towards(Level(4)).morph(), coarser, "as level 1 looks");
    }

    #[test]
    fn what_appears_or_goes_does_not_morph() {
        let still = |level| Morph { level, towards: level, weight: 0.0 };
        let level = Level(2);
        assert_eq!(Shown::steady(level).morph(), still(level));
        assert_eq!(Shown::NOTHING.morph(), still(Level::NOT_DRAWN));
        for weight in [0.0, 0.5] {
            assert_eq!(Shown { level, from: Level::NOT_DRAWN, weight }.morph(), still(level));
            assert_eq!(Shown { level: Level::NOT_DRAWN, from: level, weight }.morph(), still(level));
        }
    }

    #[test]
    fn beyond_the_reserve_refinements_wait_and_coarsenings_switch_hard() {
        let shown = Shown::steady(Level(1));
        let mut reserve_us = 1.0;
        assert_eq!(follow(shown, Level(0), &FADE, cost_us, &mut reserve_us), shown);
        assert_eq!(follow(shown, Level(2), &FADE, cost_us, &mut reserve_us), Shown::steady(Level(2)));
        assert_eq!(reserve_us, 1.0);
        let mut reserve_us = 10.0;
        assert!(follow(shown, Level(0), &FADE, cost_us, &mut reserve_us).is_in_flight());
        assert_eq!(reserve_us, 2.0);
    }

    #[test]
    fn a_geomorph_costs_the_finer_of_its_levels() {
        assert_eq!(MORPH.outgoing_us(16.0, 8.0), 8.0);
        assert_eq!(MORPH.outgoing_us(8.0, 16.0), 0.0);
    }
}
