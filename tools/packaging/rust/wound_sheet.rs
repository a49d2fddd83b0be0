//! The sheet of tests/packages/consumer.c, flat and wound up: the same pairs, which are
//! written as there to the file that SC_PRINTED names, from one thread and from several.
//!
//! SPDX-License-Identifier: MIT

use starcontour::{Error, Model, Options, Pair, Scene, Workspace};

const SIDE: u32 = 24;

type Sheet = (Vec<[f32; 3]>, Vec<[f32; 3]>, Vec<[u32; 3]>);

fn sheet() -> Sheet {
    let (mut rest, mut wound, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    for row in 0..SIDE {
        for column in 0..SIDE {
            let part = |n: u32, of: u32| (n % of) as f32;
            rest.push([column as f32, row as f32, 0.0]);
            let z = part(column, 3) - 0.5 * part(column, 5);
            wound.push([part(column, 4) + 0.5 * part(row, 3), row as f32, z]);
            let v = row * SIDE + column;
            if row + 1 < SIDE && column + 1 < SIDE {
                triangles.push([v, v + 1, v + SIDE]);
                triangles.push([v + SIDE, v + 1, v + SIDE + 1]);
            }
        }
    }
    (rest, wound, triangles)
}

#[test]
fn pairs_are_those_of_c() {
    let (rest, wound, triangles) = sheet();
    let model = Model::build(&rest, &triangles).unwrap();
    let mut workspace = model.workspace().unwrap();
    let mut text = String::new();
    for (name, pose) in [("flat", &rest), ("wound", &wound)] {
        let pairs = workspace.query(pose, &Options::default()).unwrap();
        text += &format!("{name}: {} pairs\n", pairs.len());
        for pair in pairs {
            text += &format!("{} {}\n", pair.a, pair.b);
        }
    }
    if let Ok(file) = std::env::var("SC_PRINTED") {
        std::fs::write(file, &text).unwrap();
    }
    assert!(text.starts_with("flat: 0 pairs\nwound: ") && text.lines().count() > 100);
}

#[test]
fn threads_share_a_model() {
    let (_, wound, triangles) = sheet();
    let model = Model::build(&wound, &triangles).unwrap();
    let ask = || -> Vec<Pair> {
        model.workspace().unwrap().query(&wound, &Options::default()).unwrap().to_vec()
    };
    let alone = ask();
    std::thread::scope(|scope| {
        let others = [scope.spawn(ask), scope.spawn(ask)];
        for other in others {
            assert_eq!(other.join().unwrap(), alone);
        }
    });
}

#[test]
fn errors_have_names() {
    let (mut rest, wound, triangles) = sheet();
    let model = Model::build(&rest, &triangles).unwrap();
    let mut workspace = model.workspace().unwrap();
    assert_eq!(Model::build(&rest, &[]).unwrap_err(), Error::Empty);
    assert_eq!(Model::build(&rest, &[[0, 1, 9999]]).unwrap_err(), Error::Index);
    assert_eq!(workspace.query(&rest[1..], &Options::default()), Err(Error::VertexCount));
    assert_eq!(workspace.near(&wound, 0.1).unwrap_err(), Error::Workspace);
    rest[0][0] = f32::NAN;
    assert_eq!(workspace.query(&rest, &Options::default()), Err(Error::NotFinite));
    assert_eq!(Error::from_code(8), Error::NotFinite);
    assert_eq!(Error::from_code(999).code(), 999);
    assert!(workspace.query(&wound, &Options::default()).is_ok());
}

/// What the header says of threads: a model may be shared, a workspace handed on.
#[test]
fn threads_may_have_them() {
    fn shared<T: Sync>() {}
    fn handed_on<T: Send>() {}
    shared::<Model>();
    handed_on::<Model>();
    handed_on::<Workspace>();
    handed_on::<Scene>();
}
