//! Frames of all peers in one scene, in turns, so that all see the same weather.

use std::io;

use crate::camera::{Camera, walk};
use crate::machine;
use crate::ours::{Loop, Policy};
use crate::peer::{Frames, Peer, Row};
use crate::plan::Plan;
use crate::scene::Scene;
use crate::three::Three;

/// What a scene's race comes to.
pub struct Race {
    /// The last camera of the walk: the one that every census is of.
    pub last: Camera,
    pub rows: Vec<Row>,
    /// Name and version of what ran outside.
    pub versions: Vec<(String, String)>,
}

/// Bouts, of which the first does not count for who runs in this process. In each the peers of this process take turns,
/// frame by frame; those of node follow, each with a process of its own.
pub fn race(scene: &Scene, plan: &Plan) -> io::Result<Race> {
    let walk = walk(scene, plan.frames);
    let mut three = Three::new(scene, &walk)?;
    let (mut here, absent) = peers(scene, &walk[0]);
    bout(&mut here, &walk);
    let mut times_ns = vec![Vec::new(); here.len()];
    for _ in 0..plan.bouts {
        for (all, times_ns) in times_ns.iter_mut().zip(bout(&mut here, &walk)) {
            all.extend(times_ns);
        }
        three.run();
    }
    let rows = here.iter_mut().zip(times_ns).map(|(peer, times_ns)| row(&mut **peer, times_ns, scene.len()));
    let mut rows: Vec<Row> = rows.chain(absent).collect();
    let versions = three.versions();
    rows.extend(three.rows());
    Ok(Race { last: walk[walk.len() - 1], rows, versions })
}

/// The times of each peer along the walk. In its turn a peer repeats its last frame, which brings back what the others
/// have thrown out of the caches, and then moves on.
fn bout(peers: &mut [Box<dyn Peer>], walk: &[Camera]) -> Vec<Vec<f64>> {
    let mut times_ns = vec![Vec::new(); peers.len()];
    for (frame, camera) in walk.iter().enumerate() {
        for (peer, times_ns) in peers.iter_mut().zip(&mut times_ns) {
            peer.frame(&walk[frame.saturating_sub(1)]);
            times_ns.push(peer.frame(camera).as_nanos() as f64);
        }
    }
    times_ns
}

fn row(peer: &mut dyn Peer, times_ns: Vec<f64>, objects: usize) -> Row {
    let frames = Frames { bound: peer.bound(), times_ns, census: peer.census(), spent: peer.spent() };
    Row { peer: peer.name().to_owned(), objects, outcome: Ok(frames) }
}

/// Who runs in this process, and rows for who cannot.
fn peers(scene: &Scene, start: &Camera) -> (Vec<Box<dyn Peer>>, Option<Row>) {
    let ours = Policy::ALL.map(|policy| Box::new(Loop::new(policy, scene, start)) as Box<dyn Peer>);
    let mut peers = Vec::from(ours);
    let absent = match bevy(scene, start) {
        Ok(bevy) => {
            peers.push(bevy);
            None
        }
        Err(why) => Some(Row { peer: BEVY.to_owned(), objects: scene.len(), outcome: Err(why) }),
    };
    (peers, absent)
}

const BEVY: &str = "Bevy, visibility ranges and frustum culling";

fn bevy(scene: &Scene, start: &Camera) -> Result<Box<dyn Peer>, String> {
    /// What an object takes in Bevy's world: four entities, and what tables and maps keep of them.
    const OBJECT_GIB: f64 = 3072.0 / (1u64 << 30) as f64;
    let needed_gib = scene.len() as f64 * OBJECT_GIB;
    let free_gib = machine::free_gib().unwrap_or(f64::INFINITY);
    if free_gib < needed_gib {
        return Err(format!("its entities take {needed_gib:.1} GiB, and {free_gib:.1} GiB are free"));
    }
    new_bevy(scene, start)
}

#[cfg(feature = "bevy")]
fn new_bevy(scene: &Scene, start: &Camera) -> Result<Box<dyn Peer>, String> {
    Ok(Box::new(crate::bevy::Bevy::new(scene, start)))
}

#[cfg(not(feature = "bevy"))]
fn new_bevy(_: &Scene, _: &Camera) -> Result<Box<dyn Peer>, String> {
    Err("built without the feature bevy".to_owned())
}
