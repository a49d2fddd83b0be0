//! Rust: pairs of two poses, the structures' layout, errors, one model in two threads.
//!
//!     ffi_rust MESH GOLDEN LAYOUT
//!
//! SPDX-License-Identifier: MIT

use starcontour::{
    raw, Contours, Error, Group, Meeting, Model, Options, Pair, Scene, StepOptions, TRACE_CLOSED,
};
use std::collections::HashMap;
use std::{env, fs, process, thread};

struct Checks {
    passed: u32,
    failed: u32,
}

impl Checks {
    fn check(&mut self, what: &str, condition: bool) {
        if condition {
            self.passed += 1;
        } else {
            self.failed += 1;
            println!("failed: {what}");
        }
    }
}

fn refused<T>(result: Result<T, Error>, error: Error, text: &str) -> bool {
    matches!(result, Err(found) if found == error && found.to_string().contains(text))
}

/// A contour of the golden file: number of nodes, begin, end; and its length.
type GoldenContour = ([u32; 3], f64);

fn close(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-12 * b
}

/// The contours are the golden ones, with these nodes: edges and triangles.
fn same_contours(found: &Contours, golden: &[GoldenContour], nodes: &[Pair]) -> bool {
    found.nodes.iter().map(|n| Pair { a: n.edge, b: n.triangle }).eq(nodes.iter().copied())
        && found.contours.len() == golden.len()
        && found.contours.iter().zip(golden).all(|(c, (numbers, length))| {
            [c.count as u32, c.begin, c.end] == *numbers && close(c.length, *length)
        })
}

/// Nodes follow each other contour after contour, and so does the length of their segments.
fn lengths_fit(found: &Contours) -> bool {
    let mut next = 0;
    let fits = found.contours.iter().all(|contour| {
        let nodes = found.nodes_of(contour);
        let behind = nodes[1..].iter().chain(&nodes[..(contour.begin == TRACE_CLOSED).into()]);
        let distance = |p: &[f64; 3], q: &[f64; 3]| {
            (0..3).map(|k| (p[k] - q[k]).powi(2)).sum::<f64>().sqrt()
        };
        let length = nodes.iter().zip(behind).map(|(p, q)| distance(&p.point, &q.point)).sum();
        let begins = contour.first == next;
        next += contour.count;
        begins && close(length, contour.length)
    });
    fits && next == found.nodes.len() as u64
}

/// Meetings as pairs of the one mesh of two objects, sorted; firsts: the numbers there of what is
/// the second object's first a and first b.
fn joined(meetings: &[Meeting], firsts: [usize; 2]) -> Vec<Pair> {
    let of_one = |m: &Meeting| {
        let add = [m.a * firsts[0], m.b * firsts[1]].map(|n| n as u32);
        m.pairs.iter().map(move |p| Pair { a: p.a + add[0], b: p.b + add[1] }).collect::<Vec<_>>()
    };
    let mut pairs: Vec<Pair> = meetings.iter().flat_map(of_one).collect();
    pairs.sort_by_key(|pair| (pair.a, pair.b));
    pairs
}

/// The mesh's two cloths as two objects have the pairs that the mesh has.
fn check_scene(
    checks: &mut Checks,
    rest: &[[f32; 3]],
    moved: &[[f64; 3]],
    triangles: &[[u32; 3]],
    golden: &HashMap<String, Vec<Pair>>,
) {
    let (vertices, half) = (rest.len() / 2, triangles.len() / 2);
    let rests = [&rest[..vertices], &rest[vertices..]];
    let ends = [&moved[..vertices], &moved[vertices..]];
    let second: Vec<_> = triangles[half..].iter().map(|t| t.map(|v| v - vertices as u32)).collect();
    let one = Model::build(rests[0], &triangles[..half]).expect("a model");
    let other = Model::build(rests[1], &second).expect("a model");
    let (of_faces, of_edges) = ([vertices, half], [3 * half; 2]);
    let options = Options::default();

    let mut scene = Scene::new(starcontour::WORKSPACE_NEAR);
    let objects = [scene.add(&one).unwrap(), scene.add(&other).unwrap()];
    let without = scene.query(&options).err();
    checks.check("objects without a pose", without == Some(Error::VertexCount));
    for i in objects {
        scene.object(i).set_pose(rests[i]);
        scene.object(i).set_end(Some(ends[i]));
    }
    let found = joined(&scene.query(&options).unwrap(), [half; 2]);
    checks.check("pairs of two objects", found == golden["rest"]);
    let step = scene.step(&StepOptions::default()).unwrap();
    let right = joined(&step.vertex_faces, of_faces) == golden["stepfaces"]
        && joined(&step.edge_edges, of_edges) == golden["stepedges"];
    checks.check("a step of two objects", right);
    let meetings = step.vertex_faces.iter().chain(&step.edge_edges);
    let first = meetings.flat_map(|m| m.times).fold(1.0, |a: f64, b| a.min(*b));
    checks.check("at their times", step.earliest > 0.0 && first == step.earliest);
    for i in objects {
        scene.object(i).set_pose(ends[i]);
    }
    let near = scene.near(0.045).unwrap();
    let right = joined(&near.vertex_faces, of_faces) == golden["nearfaces"]
        && joined(&near.edge_edges, of_edges) == golden["nearedges"];
    checks.check("near of two objects", right && near.edge_edges[0].times.is_empty());
    let found = joined(&scene.query(&options).unwrap(), [half; 2]);
    checks.check("pairs when they moved", found == golden["moved"]);

    scene.object(0).group = Group { category: 1, mask: 1 };
    scene.object(1).group = Group { category: 2, mask: 2 };
    checks.check("groups of objects", scene.query(&options).unwrap().is_empty());
    let flat = vec![[0.0; 3]; vertices];
    scene.object(0).set_pose(&flat);
    let mut workspace = one.workspace().unwrap();
    let alone = workspace.query(&flat, &options).unwrap();
    let found = scene.query(&options).unwrap();
    checks.check("an object and itself", found.len() == 1 && found[0].pairs == alone);
    scene.object(0).itself = false;
    checks.check("an object without itself", scene.query(&options).unwrap().is_empty());

    let mut copies = Scene::new(starcontour::WORKSPACE_NEAR);
    let mut elsewhere = Scene::new(0);
    let away = |far| rests[0].iter().map(|[x, y, z]| [x + far, *y, *z]).collect::<Vec<_>>();
    for pose in [&away(100.0), rests[1], &away(200.0)] {
        let number = copies.add(&one).unwrap();
        copies.object(number).set_pose(pose);
    }
    elsewhere.add(&one).unwrap();
    elsewhere.object(0).set_pose(rests[0]);
    checks.check("objects of one model", copies.query(&options).unwrap().is_empty());
    std::mem::swap(copies.object(0), elsewhere.object(0));
    let found = joined(&copies.query(&options).unwrap(), [half; 2]);
    checks.check("an object of another scene", found == golden["rest"]);
}

fn main() {
    let arguments: Vec<String> = env::args().collect();
    let read = |i: usize| fs::read_to_string(&arguments[i]).expect("a readable file");
    let mut checks = Checks { passed: 0, failed: 0 };

    let (mut rest, mut triangles) = (Vec::<[f32; 3]>::new(), Vec::<[u32; 3]>::new());
    for line in read(1).lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[0] {
            "v" => rest.push([1, 2, 3].map(|i| words[i].parse().unwrap())),
            "f" => triangles.push([1, 2, 3].map(|i| words[i].parse::<u32>().unwrap() - 1)),
            _ => {}
        }
    }
    let mut moved: Vec<[f64; 3]> = rest.iter().map(|p| p.map(f64::from)).collect();
    for p in &mut moved[rest.len() / 2..] {
        p[2] += p[0] / 4.0 - 0.25;
    }
    let mut golden = HashMap::<String, Vec<Pair>>::new();
    let mut golden_contours = Vec::<GoldenContour>::new();
    for line in read(2).lines().filter(|line| !line.starts_with('#')) {
        let words: Vec<&str> = line.split(' ').collect();
        if words[0] == "contour" {
            let numbers = [1, 2, 3].map(|i| words[i].parse().unwrap());
            golden_contours.push((numbers, words[4].parse().unwrap()));
            continue;
        }
        let pair = Pair { a: words[1].parse().unwrap(), b: words[2].parse().unwrap() };
        golden.entry(words[0].into()).or_default().push(pair);
    }
    checks.check("there is something to compare", golden["rest"] != golden["moved"]);

    // Each structure has the members of the header, no more and no fewer, at their places.
    let layout = read(3);
    for (name, size, members) in raw::layouts() {
        let mut lines = vec![format!("struct {name} {size}")];
        lines.extend(members.iter().map(|(member, at)| format!("member {name} {member} {at}")));
        let header: Vec<String> = layout
            .lines()
            .filter(|line| line.split(' ').nth(1) == Some(name))
            .map(|line| line.splitn(5, ' ').take(4).collect::<Vec<_>>().join(" "))
            .collect();
        checks.check(&format!("{name} is laid out as in the header"), header == lines);
    }

    let values = [
        ("SC_TRACE_CLOSED", TRACE_CLOSED),
        ("SC_TRACE_BORDER", starcontour::TRACE_BORDER),
        ("SC_TRACE_BRANCH", starcontour::TRACE_BRANCH),
        ("SC_TRACE_VERTEX", starcontour::TRACE_VERTEX),
        ("SC_TRACE_ONE_SHEET", starcontour::TRACE_ONE_SHEET),
        ("SC_TRACE_NO_EDGE", starcontour::TRACE_NO_EDGE),
    ];
    for (name, value) in values {
        let line = format!("value {name} {value}");
        checks.check(&format!("{name} is the header's"), layout.lines().any(|l| l == line));
    }

    // Each error has the number of its namesake in the header, and none is missing.
    let mut in_header: Vec<(String, i32)> = layout
        .lines()
        .filter_map(|line| line.strip_prefix("value SC_ERROR_"))
        .map(|line| line.split_once(' ').expect("a name and a number"))
        .map(|(name, code)| (name.replace('_', "").to_lowercase(), code.parse().unwrap()))
        .collect();
    let mut ours: Vec<_> = Error::NAMES.iter().map(|(n, code)| (n.to_lowercase(), *code)).collect();
    in_header.sort();
    ours.sort();
    checks.check("errors are those of the header", ours == in_header && !ours.is_empty());
    let right = ours.iter().all(|(_, code)| Error::from_code(*code).code() == *code);
    checks.check("errors keep their numbers", right);

    let model = Model::build(&rest, &triangles).expect("a model");
    let options = Options::default();
    let mut workspace = model.workspace().expect("a workspace");
    checks.check("pairs at rest", workspace.query(&rest, &options).unwrap() == golden["rest"]);
    checks.check("pairs when moved", workspace.query(&moved, &options).unwrap() == golden["moved"]);
    let proper_edges = Options { edges: true, proper: true };
    checks.check("edges, proper", !workspace.query(&rest, &proper_edges).unwrap().is_empty());

    let right = thread::scope(|scope| {
        let at_rest = scope.spawn(|| {
            let mut own = model.workspace().unwrap();
            (0..200).all(|_| own.query(&rest, &options).unwrap() == golden["rest"])
        });
        let when_moved = scope.spawn(|| {
            let mut own = model.workspace().unwrap();
            (0..200).all(|_| own.query(&moved, &options).unwrap() == golden["moved"])
        });
        at_rest.join().unwrap() & when_moved.join().unwrap()
    });
    checks.check("two threads, one model", right);

    let mut spoilt = moved.clone();
    spoilt[4][0] = f64::NAN;
    let answer = workspace.query(&spoilt, &options);
    checks.check("NaN", refused(answer, Error::NotFinite, "NaN"));
    let answer = workspace.query(&moved[1..], &options);
    checks.check("number of vertices", refused(answer, Error::VertexCount, "vert"));
    let model_of_none = Model::build(&rest, &[]);
    checks.check("no triangles", refused(model_of_none, Error::Empty, "triangle"));
    let out_of_range = Model::build(&rest, &[[0, 1, rest.len() as u32]]);
    checks.check("vertex out of range", refused(out_of_range, Error::Index, "vertex"));
    checks.check("usable after errors", workspace.query(&rest, &options).unwrap() == golden["rest"]);

    let traced = workspace.trace(&rest).unwrap();
    let right = same_contours(&traced, &golden_contours, &golden["node"]);
    checks.check("contours at rest", right && !golden_contours.is_empty());
    checks.check("lengths of contours", lengths_fit(&traced));
    let traced = workspace.trace(&moved).unwrap();
    let other = !same_contours(&traced, &golden_contours, &golden["node"]);
    checks.check("contours when moved", other && lengths_fit(&traced));
    checks.check("contours of NaN", refused(workspace.trace(&spoilt), Error::NotFinite, "NaN"));

    let mut larger = model.workspace_for(starcontour::WORKSPACE_NEAR).expect("a workspace");
    let near = larger.near(&moved, 0.045).unwrap();
    let right = near.vertex_faces == golden["nearfaces"] && near.edge_edges == golden["nearedges"];
    checks.check("pairs that are near", right);
    let touching = StepOptions::default();
    let step = larger.step(&rest, &moved, &touching).unwrap();
    let right = step.vertex_faces == golden["stepfaces"] && step.edge_edges == golden["stepedges"];
    checks.check("pairs of a step", right);
    let times = step.vertex_face_times.iter().chain(step.edge_edge_times);
    let first = times.fold(1.0, |a: f64, b| a.min(*b));
    checks.check("at their times", step.earliest > 0.0 && first == step.earliest);
    let free = larger.step(&moved, &moved, &touching).unwrap();
    checks.check("a step that is free", free.earliest == 1.0 && free.edge_edges.is_empty());
    let below = larger.near(&moved, -1.0);
    checks.check("a distance below 0", refused(below, Error::Option, "option"));
    let no_room = workspace.step(&rest, &moved, &touching);
    checks.check("no room for steps", refused(no_room, Error::Workspace, "workspace"));

    check_scene(&mut checks, &rest, &moved, &triangles, &golden);

    println!("rust: {} passed, {} failed", checks.passed, checks.failed);
    process::exit((checks.failed > 0).into());
}
