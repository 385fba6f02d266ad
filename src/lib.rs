//! Level-of-detail selection under a frame-time budget.
//!
//! Each frame an engine hands over its cameras, its objects, a budget in microseconds and how long earlier frames
//! took. The runtime answers with one level for every object in view, chosen so that the frame is expected to fit the
//! budget and to look as good as that budget allows, and says how far from the best choice it can be at most.
//!
//! # Goals, in order of importance
//! 1. Frames that fit their budget, at the best image that budget allows, with a certificate.
//! 2. The same answer for the same input: any machine, any number of threads, any order of objects.
//! 3. Cheap: no allocation once warm, about one pass over the objects in view, less than that over the others.
//! 4. A small surface and few dependencies; everything but the frame loop is behind a feature.
//!
//! It is a library, not an engine: it draws nothing, starts no thread, reads no clock and owns no world. (The one
//! exception is `sim`, which is no part of the frame loop and uses as many threads as it is told to. A frame that is
//! told to use several takes them from the caller's rayon pool.)
//!
//! # A frame
//! ```text
//!  hecs World ──sync──► Objects ──cull──► blocks ──rate──► Candidates ──select──► levels ──transition──► changes
//!  (or calls of         16 to a     ▲       in               ▲ benefit and cost     ▲ policy             │
//!   your own)           block     View     view              │ of the LodTable's    │ and budget         ▼
//!                                                            │ levels               │              engine draws
//!                                                         cost model ◄─ feedback ─► budget               │
//!                                                                           ▲                            │
//!                                                                           └────── measured times ◄─────┘
//! ```
//! The loop closes only through what [`Runtime`] keeps from one frame to the next. Every stage is also a public
//! function or type of its own over borrowed slices: take [`Runtime`] to have a frame in one call, take the stages
//! where an engine culls by itself, runs them at other times, or wants only one of them.
//!
//! # Example
//! ```
//! use glam::{Vec2, Vec3};
//! use lod_budget::{FrameInput, LevelRecord, LodTable, Object, Objects, Predictive, Runtime, RuntimeOptions};
//! use lod_budget::{Sphere, View, ViewInput};
//!
//! let levels = vec![LevelRecord::new(40_000, 21_000), LevelRecord::new(5_000, 2_700), LevelRecord::new(300, 180)];
//! let mut objects = Objects::new();
//! let statue = objects.add_table(LodTable::new("statue", Sphere::new(Vec3::ZERO, 1.0), levels)?)?;
//! for id in 0..100 {
//!     let place = Vec3::new(id as f32 - 50.0, 0.0, -20.0 - id as f32);
//!     objects.insert(Object::new(id, Sphere::new(place, 1.0), statue))?;
//! }
//! let mut runtime = Runtime::new(RuntimeOptions::default(), Box::new(Predictive::default()))?;
//!
//! // Every frame:
//! let views = [ViewInput::new(View::perspective(1.0, Vec2::new(1920.0, 1080.0)), 0)];
//! let report = runtime.frame(&mut objects, &FrameInput::new(&views, 2_000.0));
//! assert!(report.predicted_us <= 2_000.0);
//! assert!(report.select.certificate.is_some_and(|c| c.gap < 0.01));
//! for change in runtime.changes() {
//!     // Draw `change.object` at `change.new` from now on.
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Measured times go into [`FrameInput::measured`] as they become known, matched by [`FrameReport::frame`]. Without
//! them the budget is kept as far as the [`CostModel`] is right.
//!
//! # When not to use it
//! - **One kind of object, one factor for all.** Where all objects share one accuracy curve, the best choice nearly is
//!   one threshold on size, and a global scale that is tuned perfectly for the scene and the machine does nearly as
//!   well. What is bought here is that nobody has to tune it, and that it holds when the scene or the machine changes.
//! - **Time that does not come from objects.** Only what follows from draw calls, vertices, triangles and projected
//!   area can be steered by levels; post-processing and simulation cannot.
//! - **One huge mesh and nothing else.** A [`hierarchy`] has a cut for it, which needs no selection but where it shares a
//!   budget. Clusters of triangles that are chosen on the graphics card are another matter.
//! - **Some dozens of objects that fit anyway.** [`ScreenSize`] alone, or nothing, will do.
//!
//! # Modules, in the order of a frame
//! | | |
//! |---|---|
//! | [`kernel`] | how loops over columns run: vector width, threads |
//! | *vocabulary* | |
//! | [`bounds`] | spheres and boxes |
//! | [`view`] | cameras, frusta, and all screen-space maths |
//! | [`table`] | levels: what they cost and how true they are |
//! | [`hierarchy`] | one huge mesh, and the cut through it that a camera asks for |
//! | [`scene`] | the hot store of objects, and what each asks of the selection |
//! | [`frame`] | what passes between the stages |
//! | [`knapsack`] | the multiple-choice knapsack, which knows no graphics |
//! | *stages* | |
//! | [`cull`] | which objects a view sees |
//! | [`rate`] | what showing them is worth, and what their levels cost |
//! | [`select`] | the policies: one level each |
//! | [`transition`] | from the level chosen to the levels shown |
//! | [`feedback`] | from measured times to the next budget and cost model |
//! | [`runtime`] | the stages in order, and what is remembered between frames |
//! | [`check`] | what must hold of any selection, knowing no policy |
//! | `ecs` | components and synchronisation with hecs (feature `hecs`) |
//! | *rooms* | |
//! | `files` | scenes, camera paths and instances from disk (feature `files`) |
//! | `bake` | from meshes to levels: files, simplification, measured chains, LOD tables (feature `bake`) |
//! | `sim` | simulated machines, trials, metrics and scenes made from a seed (feature `sim`) |
//!
//! # Features
//! `bvh` (default) arranges objects by a hierarchy that obvhs builds, instead of along a Morton curve: no answer
//! changes. `rayon` lets a frame use several threads ([`RuntimeOptions::threads`]): no answer changes either. `hecs`
//! (default), `serde`, `files`, `sim` and `cli` (the `lod` command) add what their names say.
//!
//! # Errors and panics
//! Errors come at the doors alone (tables, objects, options, files), and name the thing and the rule it breaks. A frame
//! returns no error and does not panic: a view that cannot be used and a bound that is not finite are left out
//! and counted in the [`FrameReport`].
//!
//! [`FrameReport`]: frame::FrameReport
//! [`FrameReport::frame`]: frame::FrameReport::frame
#![deny(unsafe_code)]
#![warn(missing_docs)]

// -- below everything: how loops run
pub mod kernel;

// -- vocabulary, each module after those it builds on
pub mod bounds;

pub mod view;

pub mod table;

pub mod hierarchy;

pub mod scene;

pub mod frame;

pub mod knapsack;

// -- stages, in the order of a frame
pub mod cull;

pub mod rate;

pub mod select;

pub mod transition;

pub mod feedback;

pub mod runtime;

pub mod check;

#[cfg(feature = "hecs")]
pub mod ecs;

// -- rooms, each behind a feature
#[cfg(any(feature = "files", feature = "bake"))]
mod gltf;

#[cfg(feature = "files")]
pub mod files;

#[cfg(feature = "bake")]
pub mod bake;

#[cfg(feature = "sim")]
pub mod sim;

pub use bounds::Sphere;
pub use frame::{FrameTime, GroupId};
pub use rate::CostModel;
pub use runtime::{FrameInput, Runtime, RuntimeOptions, ViewInput};
pub use scene::{Object, ObjectId, Objects, Settings};
pub use select::{Coarsest, Finest, FunkhouserSequin, Predictive, Reactive, ScreenSize, Selector};
pub use table::{Level, LevelRecord, LodTable};
pub use view::View;

/// The README's Rust blocks, run as tests.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
