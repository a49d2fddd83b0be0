//! Several objects in one query: what they have with each other, and with themselves.
//!
//! SPDX-License-Identifier: MIT

use crate::{
    check, pose_of, raw, raw_near_options, raw_options, raw_step_options, size_of, Error, Group, Model,
    Options, Pair, Scalar, StepOptions, Workspace,
};
use std::ptr;
use std::sync::atomic::{AtomicU64, Ordering};

/// A workspace that lends its room.
const WORKSPACE_ROOM: u32 = 4;

/// What two objects have with each other, or one with itself.
#[derive(Clone, Copy, Debug)]
pub struct Meeting<'scene> {
    /// Numbers of the two.
    pub a: usize,
    pub b: usize,
    /// Sorted; the first number is of what belongs to a, the second to b.
    pub pairs: &'scene [Pair],
    /// Of a step, when each collides; else none.
    pub times: &'scene [f64],
}

/// Meetings of a vertex and a triangle, and of two edges 3 t + k.
#[derive(Clone, Debug)]
pub struct FeatureMeetings<'scene> {
    pub vertex_faces: Vec<Meeting<'scene>>,
    pub edge_edges: Vec<Meeting<'scene>>,
    /// Of a step: nothing collides before; 1 if nothing does at all.
    pub earliest: f64,
}

/// An object of a scene. It keeps a copy of its positions: so none can change unseen, and what is
/// not set again is not read again.
#[derive(Debug)]
pub struct Object {
    /// Whether its pairs with itself are wanted.
    pub itself: bool,
    /// What it collides with; the default is everything.
    pub group: Group,
    pose: Vec<[f64; 3]>,
    end: Option<Vec<[f64; 3]>>,
    version: u64,
}

fn doubles<T: Scalar>(positions: &[[T; 3]]) -> Vec<[f64; 3]> {
    positions.iter().map(|p| p.map(T::into)).collect()
}

/// A number that no pose had before: so one object may take the place of another one.
fn new_version() -> u64 {
    static LAST: AtomicU64 = AtomicU64::new(0);
    LAST.fetch_add(1, Ordering::Relaxed) + 1
}

impl Object {
    /// Where it is, of a step at its start.
    pub fn set_pose<T: Scalar>(&mut self, positions: &[[T; 3]]) {
        self.pose = doubles(positions);
        self.version = new_version();
    }

    /// Of a step, where it is at its end; None, as at first: where it began.
    pub fn set_end<T: Scalar>(&mut self, positions: Option<&[[T; 3]]>) {
        self.end = positions.map(doubles);
        self.version = new_version();
    }
}

/// Arrays for one list.
#[derive(Debug)]
struct Room {
    pairs: Vec<Pair>,
    times: Vec<f64>,
    ranges: Vec<raw::sc_object_pairs>,
}

impl Room {
    fn new() -> Room {
        Room { pairs: vec![Pair::default(); 16], times: vec![0.0; 16], ranges: vec![Default::default()] }
    }

    fn list(&mut self, timed: bool) -> raw::sc_object_list {
        raw::sc_object_list {
            count: 0,
            capacity: self.pairs.len() as u64,
            pairs: self.pairs.as_mut_ptr(),
            times: if timed { self.times.as_mut_ptr() } else { ptr::null_mut() },
            range_count: 0,
            range_capacity: self.ranges.len() as u64,
            ranges: self.ranges.as_mut_ptr(),
        }
    }

    fn fit(&mut self, list: &raw::sc_object_list) {
        let count = self.pairs.len().max(list.count as usize);
        self.pairs.resize(count, Pair::default());
        self.times.resize(count, 0.0);
        self.ranges.resize(self.ranges.len().max(list.range_count as usize), Default::default());
    }

    fn meetings(&self, list: &raw::sc_object_list) -> Vec<Meeting<'_>> {
        let meeting = |range: &raw::sc_object_pairs| {
            let here = range.first as usize..(range.first + range.count) as usize;
            Meeting {
                a: range.object_a as usize,
                b: range.object_b as usize,
                pairs: &self.pairs[here.clone()],
                times: if list.times.is_null() { &[] } else { &self.times[here] },
            }
        };
        self.ranges[..list.range_count as usize].iter().map(meeting).collect()
    }
}

/// Several objects, which may share models. Each has a number, in the order in which they were
/// added.
#[derive(Debug)]
pub struct Scene<'model> {
    flags: u32,
    objects: Vec<Object>,
    rooms: [Room; 2],
    /// Of each object. Those of one model use one room, but for the first, which has its own.
    workspaces: Vec<Workspace<'model>>,
    lenders: Vec<Workspace<'model>>,
}

impl<'model> Scene<'model> {
    /// A scene without objects, for queries (0), or for more: `WORKSPACE_STEP` or `WORKSPACE_NEAR`.
    pub fn new(flags: u32) -> Self {
        Scene {
            flags,
            objects: Vec::new(),
            rooms: [Room::new(), Room::new()],
            workspaces: Vec::new(),
            lenders: Vec::new(),
        }
    }

    /// A new object, which needs a pose before anything is asked; and its number.
    pub fn add(&mut self, model: &'model Model) -> Result<usize, Error> {
        let is_of = |workspace: &Workspace| ptr::eq(workspace.model, model);
        let is_copy = self.workspaces.iter().any(is_of);
        if is_copy && !self.lenders.iter().any(is_of) {
            self.lenders.push(model.workspace_for(self.flags | WORKSPACE_ROOM)?);
        }
        let lender = self.lenders.iter().find(|one| is_of(one));
        self.workspaces.push(model.workspace_in(self.flags, lender)?);
        self.objects.push(Object {
            itself: true,
            group: Group::default(),
            pose: Vec::new(),
            end: None,
            version: 0,
        });
        Ok(self.objects.len() - 1)
    }

    /// The object of a number.
    pub fn object(&mut self, number: usize) -> &mut Object {
        &mut self.objects[number]
    }

    /// What intersects.
    pub fn query(&mut self, options: &Options) -> Result<Vec<Meeting<'_>>, Error> {
        let options = raw_options(options);
        let found = self.ask(false, |objects, lists| {
            let list = &mut lists.vertex_faces;
            let mut result = raw::sc_objects_result {
                struct_size: size_of::<raw::sc_objects_result>(),
                collides: 0,
                count: 0,
                capacity: list.capacity,
                pairs: list.pairs,
                range_count: 0,
                range_capacity: list.range_capacity,
                ranges: list.ranges,
                stats: ptr::null_mut(),
                verdict: 0,
                reserved: 0,
            };
            // SAFETY: see ask.
            let status = unsafe { raw::sc_query_objects(objects, &options, &mut result) };
            list.count = result.count;
            list.range_count = result.range_count;
            status
        })?;
        Ok(found.vertex_faces)
    }

    /// What is within a distance, in units of the coordinates.
    pub fn near(&mut self, distance: f64) -> Result<FeatureMeetings<'_>, Error> {
        let options = raw_near_options(distance);
        // SAFETY: see ask.
        self.ask(false, |objects, lists| unsafe {
            raw::sc_query_objects_near(objects, &options, lists)
        })
    }

    /// What collides while every vertex moves on a straight line from its object's pose to its end.
    pub fn step(&mut self, options: &StepOptions) -> Result<FeatureMeetings<'_>, Error> {
        let options = raw_step_options(options);
        // SAFETY: see ask.
        self.ask(true, |objects, lists| unsafe {
            raw::sc_query_objects_step(objects, &options, lists)
        })
    }

    /// Asks until all arrays are long enough. What a question is given is sound: models and
    /// workspaces are alive, workspaces are ours alone and each in one object, arrays are as long
    /// as stated, and none changes as long as its version does not.
    fn ask(
        &mut self,
        moves: bool,
        question: impl Fn(&raw::sc_objects, &mut raw::sc_objects_lists) -> raw::sc_status,
    ) -> Result<FeatureMeetings<'_>, Error> {
        let mut poses = Vec::new();
        for object in &self.objects {
            poses.push((pose_of(&object.pose)?, object.end.as_deref().map(pose_of).transpose()?));
        }
        let with_pose = |(i, (pose, end)): (usize, &(raw::sc_pose, Option<raw::sc_pose>))| {
            let (object, workspace) = (&self.objects[i], &self.workspaces[i]);
            raw::sc_object {
                model: workspace.model.0.as_ptr(),
                workspace: workspace.handle.as_ptr(),
                pose,
                end: end.as_ref().filter(|_| moves).map_or(ptr::null(), |end| end),
                pose_version: object.version,
                group: object.group,
                itself: object.itself.into(),
                reserved: 0,
                filter: ptr::null(),
                vertex_face_filter: ptr::null(),
                edge_edge_filter: ptr::null(),
                rest: ptr::null(),
                rest_distance: 0.0,
                masks: ptr::null(),
            }
        };
        let array: Vec<_> = poses.iter().enumerate().map(with_pose).collect();
        let objects = raw::sc_objects {
            struct_size: size_of::<raw::sc_objects>(),
            count: array.len().try_into().map_err(|_| Error::Count)?,
            objects: array.as_ptr(),
            stride: 0,
            accept: None,
            accept_user: ptr::null_mut(),
            accept_near: None,
        };
        loop {
            let [faces, edges] = &mut self.rooms;
            let mut lists = raw::sc_objects_lists {
                struct_size: size_of::<raw::sc_objects_lists>(),
                collides: 0,
                vertex_faces: faces.list(moves),
                edge_edges: edges.list(moves),
                stats: ptr::null_mut(),
                earliest: 0.0,
                verdict: 0,
                reserved: 0,
            };
            let status = question(&objects, &mut lists);
            if Error::from_code(status) == Error::ShortBuffer {
                faces.fit(&lists.vertex_faces);
                edges.fit(&lists.edge_edges);
                continue;
            }
            check(status)?;
            return Ok(FeatureMeetings {
                vertex_faces: self.rooms[0].meetings(&lists.vertex_faces),
                edge_edges: self.rooms[1].meetings(&lists.edge_edges),
                earliest: lists.earliest,
            });
        }
    }
}
