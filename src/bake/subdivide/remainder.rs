//! How far the limit surface can be from a level: a bound that is proved.
//!
//! Let Fₖ be the surface of the faces after k subdivisions: triangles, or bilinear patches. All of them have the same
//! parameters, since faces are cut and never joined. Fₖ₊₁ − Fₖ is linear, or bilinear, on the faces of the finer one; so
//! it is greatest at a vertex, and is what the smoothing there *moves* a vertex, the middle of an edge or a centroid
//! (not at all) by. Hence |F − Fₖ| ≤ Σ moveⱼ over j ≥ k.
//!
//! What moves are second differences. Their norm Sₖ is the largest of
//!
//! - over an edge a b between triangles a b c and a b d, of |c + d − a − b|; between quads, at either end v with
//!   neighbours p, q in the two quads, of |p + q − 2v|;
//! - at a vertex v of a crease through a and b, of g · |a + b − 2v|; g is 1 for triangles and 3/2 for quads.
//!
//! Edges that are sharp for ever and end at no smooth vertex do not count: nothing depends on them. Then moveₖ ≤ c · Sₖ,
//! c being 1/8 for edges and creases (1/8 / g), and for a smooth vertex of valence n Loop's [pull](super::loops::pull),
//! since n times its way to the mean of its neighbours is the sum of its n differences, or 1/n in Catmull and Clark's
//! scheme, whose vertices move by Σ(7/8 own + 1/8 its neighbour's differences across the same edge) / n².
//!
//! Finer differences are linear in these, and Sₖ₊₁ ≤ r · Sₖ with r < 1: write down a new difference as that of Fₖ, which is
//! 0 within a face, half the old one at an old edge or vertex and a quarter of it across quads, and what its vertices
//! are moved by; r is the sum of the factors ([`shrink`]). For smooth vertices it is what F. Cheng, J. Yong, "Subdivision
//! depth computation for Catmull-Clark subdivision surfaces", 2006, find: 2/3 for n = 3, 18/25 for 5, 3/4 + (8n − 46)/4n²
//! from 6 on. So Σ moveⱼ ≤ c · Sₖ / (1 − r). That is the tail. Before it, some subdivisions are made and compared as they are.
//!
//! Points are compared by their parameters. Where all vertices are regular that costs little: the bound is two to four
//! times the distance. Around irregular vertices points also move along the surface, which counts here and is no
//! distance: there the bound may be fifteen times what it bounds, and falls by half with a subdivision rather than to a
//! quarter.

use glam::{DVec3, Vec3};

use super::Scheme;
use super::level::Level;
use super::loops::{across, pull};
use super::net::{Edge, Net, Rule};

/// The most subdivisions that are made and compared as they are, in front of the tail. Each makes the tail a quarter
/// where vertices are regular, and half or so where they are not.
const DEPTH: usize = 3;

/// No level of more faces than this is subdivided for that, unless it is the first: it would take as long as all else.
const MANY_FACES: usize = 1 << 18;

/// More than rounding in double precision comes to, as a share of the bound and of the largest coordinate.
const SLACK: f64 = 1e-12;

/// No point of the limit surface is farther than this from the level drawn with its vertices at `places`, nor the other
/// way round. The level must be of triangles for Loop's scheme and of quads for the other, which are drawn as two triangles
/// each. O(n), some 10 µs per face.
pub(super) fn limit_distance(level: &Level, scheme: Scheme, places: &[Vec3]) -> f64 {
    let drawn: Vec<DVec3> = places.iter().map(|p| p.as_dvec3()).collect();
    let size = drawn.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
    let fold = folds(&level.net, &drawn);
    let (mut net, mut points, mut flat) = (level.net.clone(), level.positions.clone(), drawn);
    for step in 0..DEPTH {
        if step > 0 && net.face_count() > MANY_FACES {
            break;
        }
        (points, flat) = (scheme.points(&net, &points), scheme.flat_points(&net, &flat));
        net = scheme.refine(&net);
    }
    let used = points.iter().zip(&flat).zip(&net.valence).filter(|&(_, &valence)| valence > 0);
    let apart = used.map(|((p, q), _)| p.distance(*q)).fold(0.0, f64::max);
    (fold + apart + tail(&net, scheme, &points)) * (1.0 + SLACK) + SLACK * size
}

/// How far the two triangles of a quad can be from its bilinear patch: a quarter of what it is bent by, in its middle.
fn folds(net: &Net, places: &[DVec3]) -> f64 {
    let bend = |face: usize| match *net.face(face) {
        [a, b, c, d] => {
            let [a, b, c, d] = [a, b, c, d].map(|vertex| places[vertex as usize]);
            (a - b + c - d).length() / 4.0
        }
        _ => 0.0,
    };
    (0..net.face_count()).map(bend).fold(0.0, f64::max)
}

/// How far the limit surface can be from the faces of a net that was subdivided at least once.
///
/// While something is still semi-sharp nothing is known to shrink: what counts then grows by no more than [`growth`]
/// per subdivision, and the bound is loose.
pub(super) fn tail(net: &Net, scheme: Scheme, points: &[DVec3]) -> f64 {
    let moves = moves(net, scheme);
    let (differences, growth) = (differences(net, scheme, points), growth(moves));
    let sharp_steps = net.fleeting().ceil() as i32;
    let before: f64 = (0..sharp_steps).map(|step| growth.powi(step)).sum();
    let after = growth.powi(sharp_steps) / (1.0 - shrink(net, scheme));
    moves * differences * (before + after)
}

/// The most that second differences grow to in a subdivision with semi-sharp edges, from what vertices can be moved by:
/// half of the old one, two edges' moves and twice a vertex's, or those of two vertices at the ends of a crease.
fn growth(moves: f64) -> f64 {
    (0.75 + 2.0 * moves).max(4.0 * moves)
}

/// How much a crease's differences count.
fn crease_weight(scheme: Scheme) -> f64 {
    match scheme {
        Scheme::Loop => 1.0,
        Scheme::CatmullClark => 1.5,
    }
}

/// The vertices that are smooth in the end: valence, and whether an edge there is sharp.
fn smooth_vertices(net: &Net) -> impl Iterator<Item = (f64, bool)> + '_ {
    let mut is_sharp = vec![false; net.sharpness.len()];
    for edge in net.edges.iter().filter(|edge| edge.sharpness > 0.0) {
        edge.ends.iter().for_each(|&end| is_sharp[end as usize] = true);
    }
    let rules = net.rules(f32::MAX).into_iter().enumerate();
    let smooth = rules.filter(|(_, rule)| *rule == Rule::Smooth);
    smooth.map(move |(vertex, _)| (f64::from(net.valence[vertex]), is_sharp[vertex]))
}

/// The factor c.
fn moves(net: &Net, scheme: Scheme) -> f64 {
    let vertex = |(n, _): (f64, bool)| match scheme {
        Scheme::Loop => pull(n as u32),
        Scheme::CatmullClark => 1.0 / n,
    };
    smooth_vertices(net).map(vertex).fold(0.125, f64::max)
}

/// The factor r, once nothing is semi-sharp: of the vertices and edges that the net has, and so all finer ones.
pub(super) fn shrink(net: &Net, scheme: Scheme) -> f64 {
    // A sharp edge's middle is not moved, which may take away what else cancels.
    let dart = |is_sharp: bool| if is_sharp { 0.125 } else { 0.0 };
    let smooth = |(n, is_sharp): (f64, bool)| {
        dart(is_sharp)
            + match scheme {
                Scheme::Loop => triangles_shrink(n),
                Scheme::CatmullClark => quads_shrink(n),
            }
    };
    let used = net.rules(f32::MAX).into_iter().zip(&net.valence).filter(|&(_, &valence)| valence > 0);
    let at_creases = used.map(|(rule, &valence)| match (rule, scheme) {
        (Rule::Smooth, _) => 0.0,
        (_, Scheme::Loop) | (Rule::Corner, Scheme::CatmullClark) => 0.75,
        (Rule::Crease(_), Scheme::CatmullClark) => match valence {
            // One smooth edge alone, between creases: the two differences are the same.
            ..=3 => 0.5,
            4 => 0.8,
            _ => 0.92,
        },
    });
    let along_darts = smooth_vertices(net).filter(|&(_, is_sharp)| is_sharp).map(|(n, _)| match scheme {
        Scheme::Loop => pull(n as u32) + 0.125,
        Scheme::CatmullClark => 1.5 / n + 0.125,
    });
    smooth_vertices(net).map(smooth).chain(at_creases).chain(along_darts).fold(0.5, f64::max)
}

/// At a smooth vertex of n triangles: the larger of the difference over half an edge there and over the edge opposite.
fn triangles_shrink(n: f64) -> f64 {
    let share = pull(n as u32) / n;
    let opposite = 2.0 * (0.125 - share).abs() + (n - 2.0) * share + 0.125;
    let half = if n < 3.0 {
        // Both neighbours are across.
        (0.375 - share).abs() + (0.25 - share).abs()
    } else {
        (0.375 - share).abs() + 2.0 * (0.125 - share).abs() + (n - 3.0) * share
    };
    half.max(opposite)
}

/// At a smooth vertex of n quads, all its neighbours being of four quads or on a crease: the larger of the difference
/// at the vertex and of that along an edge from it.
fn quads_shrink(n: f64) -> f64 {
    let (own, far) = (7.0 / (4.0 * n * n), 1.0 / (4.0 * n * n));
    let at_vertex = if n == 4.0 {
        // Across opposite edges the differences are the same.
        0.5
    } else if n < 3.0 {
        (0.5 - own).abs() + (0.125 - own).abs() + (0.125 - far).abs() + far
    } else {
        (0.5 - own)
            + 2.0 * (0.0625 - own).abs()
            + (n - 3.0) * own
            + 2.0 * (0.0625 - far).abs()
            + (n - 2.0) * far
    };
    let along = (n - 1.0) / (n * n)
        + 3.0 / 16.0
        + (own / 2.0 + 1.0 / 128.0 - 0.125).abs()
        + (7.0 / 128.0 + far / 2.0 - 0.125).abs();
    at_vertex.max(along)
}

/// The norm S.
pub(super) fn differences(net: &Net, scheme: Scheme, points: &[DVec3]) -> f64 {
    let rules = net.rules(f32::MAX);
    let is_smooth = |end: u32| rules[end as usize] == Rule::Smooth;
    let counts = |edge: &&Edge| {
        edge.sides == 2 && (edge.sharpness.is_finite() || edge.ends.iter().any(|&end| is_smooth(end)))
    };
    let over_edge = |edge: &Edge| match scheme {
        Scheme::Loop => over_triangles(net, points, edge),
        Scheme::CatmullClark => {
            edge.ends.map(|end| over_quads(net, points, edge, end)).into_iter().fold(0.0, f64::max)
        }
    };
    let smooth = net.edges.iter().filter(counts).map(over_edge).fold(0.0, f64::max);
    smooth.max(crease_weight(scheme) * along_creases(net, &rules, points))
}

fn over_triangles(net: &Net, points: &[DVec3], edge: &Edge) -> f64 {
    let [a, b] = edge.ends.map(|end| points[end as usize]);
    let [c, d] = across(net, edge).map(|corner| points[corner as usize]);
    (c + d - a - b).length()
}

/// At one end of the edge.
fn over_quads(net: &Net, points: &[DVec3], edge: &Edge, end: u32) -> f64 {
    let beside = |face: u32| {
        let corners = net.face(face as usize);
        let at = corners.iter().position(|&corner| corner == end).unwrap_or(0);
        let (next, before) =
            (corners[(at + 1) % corners.len()], corners[(at + corners.len() - 1) % corners.len()]);
        points[if next == edge.other(end) { before } else { next } as usize]
    };
    (beside(edge.faces[0]) + beside(edge.faces[1]) - 2.0 * points[end as usize]).length()
}

/// Along what is sharp for ever by its two neighbours; where semi-sharp edges meet others any two of them may be the
/// crease in between, so that twice the longest counts.
fn along_creases(net: &Net, rules: &[Rule], points: &[DVec3]) -> f64 {
    let crease = |(vertex, rule): (usize, &Rule)| match *rule {
        Rule::Crease([a, b]) => (points[a as usize] + points[b as usize] - 2.0 * points[vertex]).length(),
        _ => 0.0,
    };
    let forever = rules.iter().enumerate().map(crease).fold(0.0, f64::max);
    if net.fleeting() == 0.0 {
        return forever;
    }
    let sharp = net.edges.iter().filter(|edge| edge.sharpness > 0.0);
    let length = |edge: &Edge| points[edge.ends[0] as usize].distance(points[edge.ends[1] as usize]);
    forever.max(2.0 * sharp.map(length).fold(0.0, f64::max))
}
