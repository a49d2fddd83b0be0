//! A safe wrapper: whatever a caller does, memory stays sound. What the library promises to C by
//! comment, the compiler holds callers to here:
//!
//! - a [`Model`] is immutable and may be shared by threads (`Sync`);
//! - a [`Workspace`] belongs to one call at a time (`&mut self`) and goes before its model;
//! - the pairs that a query returns live until the next query of that workspace.
//!
//! ```
//! use starcontour::{Model, Options, Scene, StepOptions, WORKSPACE_NEAR};
//!
//! let rest = [[0., 0., 0.], [4., 0., 0.], [0., 4., 0.], [1., 1., 1.], [2., 1., 1.], [1., 2., 1.]];
//! let model = Model::build(&rest, &[[0, 1, 2], [3, 4, 5]])?;
//! let mut workspace = model.workspace_for(WORKSPACE_NEAR)?;
//! let mut next = rest;
//! next[3][2] = -1.; // a corner of one triangle is pulled through the other
//! for pair in workspace.query(&next, &Options::default())? {
//!     assert_eq!((pair.a, pair.b), (0, 1));
//! }
//! let free = workspace.step(&rest, &next, &StepOptions::default())?.earliest;
//! assert!(free > 0.49 && free <= 0.5);
//! assert_eq!(workspace.near(&rest, 1.)?.vertex_faces.len(), 3);
//! let traced = workspace.trace(&next)?; // from one edge of the triangle to the other
//! assert_eq!((traced.contours.len(), traced.nodes[0].point), (1, [1.5, 1., 0.]));
//!
//! let mut scene = Scene::new(WORKSPACE_NEAR); // two objects of one model
//! let (one, other) = (scene.add(&model)?, scene.add(&model)?);
//! scene.object(one).set_pose(&rest);
//! scene.object(other).set_pose(&rest.map(|[x, y, z]| [x, y, z + 9.]));
//! assert!(scene.query(&Options::default())?.is_empty());
//! # Ok::<(), starcontour::Error>(())
//! ```
//!
//! SPDX-License-Identifier: MIT

pub mod raw;
mod scene;

pub use raw::sc_group as Group;
pub use raw::sc_pair as Pair;
pub use raw::sc_trace_contour as Contour;
pub use raw::sc_trace_node as ContourNode;
pub use scene::{FeatureMeetings, Meeting, Object, Scene};
use std::ffi::CStr;
use std::{fmt, mem, ptr};

/// Declares [`Error`] and both ways between it and the header's numbers.
macro_rules! errors {
    ($($(#[$text:meta])* $name:ident = $code:literal,)*) => {
        /// What the library refused: the SC_ERROR_... of the header.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[non_exhaustive]
        pub enum Error {
            $($(#[$text])* $name,)*
            /// A status that this version of the binding does not know.
            Other(i32),
        }

        impl Error {
            /// The header's number.
            pub fn code(self) -> i32 {
                match self {
                    $(Error::$name => $code,)*
                    Error::Other(code) => code,
                }
            }

            /// The error of a number of the header, which is not 0.
            pub fn from_code(code: i32) -> Error {
                match code {
                    $($code => Error::$name,)*
                    _ => Error::Other(code),
                }
            }

            /// Names and numbers of all but `Other`, for the test that compares them with the
            /// header.
            #[doc(hidden)]
            pub const NAMES: &'static [(&'static str, i32)] = &[$((stringify!($name), $code)),*];
        }
    };
}

errors! {
    /// A pointer that the call needs is NULL.
    Null = 1,
    /// A struct_size this library cannot read.
    StructSize = 2,
    /// A member has a value that it cannot have.
    Option = 3,
    /// A mesh without triangles or without vertices.
    Empty = 4,
    /// More vertices or triangles than can be indexed or addressed.
    Count = 5,
    /// A stride smaller than what it steps over.
    Stride = 6,
    /// A triangle names a vertex that does not exist.
    Index = 7,
    /// NaN or infinity at a vertex that a triangle uses.
    NotFinite = 8,
    /// The pose's number of vertices is not the model's.
    VertexCount = 9,
    /// An allocation failed.
    Memory = 10,
    /// The caller's array is too short; the count needed is reported.
    ShortBuffer = 11,
    /// The workspace was made for another model or fewer workers, or is too small.
    Workspace = 12,
    /// A weld map entry out of range or not a representative.
    WeldMap = 13,
    /// The caller's leaf order or tree is not one, or is too deep.
    Tree = 14,
    /// The caller's bisection function failed or broke its contract.
    Partition = 15,
    /// Not part of this build of the library.
    Unsupported = 16,
    /// Memory that must be aligned to SC_ALIGNMENT is not.
    Alignment = 17,
    /// The model has no such level.
    Level = 18,
    /// The data are no saved model, or no record.
    NotSaved = 19,
    /// Saved data that end too early.
    Truncated = 20,
    /// Saved data of a machine with the other byte order.
    ByteOrder = 21,
    /// Saved data in a later format than this library reads.
    TooNew = 22,
    /// Saved data in an earlier format than this library reads.
    TooOld = 23,
    /// Saved data that were changed since.
    Checksum = 24,
    /// Saved data that nobody saved: whole, but contradictory.
    Inconsistent = 25,
    /// The saved model is not the one that was asked for.
    Topology = 26,
    /// A list of pairs is not sorted or names what does not exist.
    Pairs = 27,
    /// A query was cancelled or ran out of budget: see its verdict.
    Incomplete = 28,
    /// Asks for culling on a model without what it needs: SC_MODEL_BOXES.
    BoxesOnly = 29,
}

/// What a workspace is for, besides queries: steps; or steps and what is near.
pub const WORKSPACE_STEP: u32 = 1;
pub const WORKSPACE_NEAR: u32 = 2;

/// Where a contour begins and ends: nowhere, at an edge of one triangle, at an edge of three or
/// more triangles, or at a vertex that both triangles share.
pub const TRACE_CLOSED: u32 = 0;
pub const TRACE_BORDER: u32 = 1;
pub const TRACE_BRANCH: u32 = 2;
pub const TRACE_VERTEX: u32 = 3;

/// In `flags` of a contour: its two sheets are one.
pub const TRACE_ONE_SHEET: u32 = 1;

/// Instead of an edge, where a node is a vertex; instead of `sheets`, where a contour ends.
pub const TRACE_NO_EDGE: u32 = 0xffff_ffff;

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        // SAFETY: the text is the library's, never NULL, and static.
        let text = unsafe { CStr::from_ptr(raw::sc_status_string(self.code())) };
        formatter.write_str(&text.to_string_lossy())
    }
}

impl std::error::Error for Error {}

fn check(status: i32) -> Result<(), Error> {
    if status == 0 { Ok(()) } else { Err(Error::from_code(status)) }
}

fn size_of<T>() -> u32 {
    mem::size_of::<T>() as u32
}

mod sealed {
    pub trait Sealed {}
    impl Sealed for f32 {}
    impl Sealed for f64 {}
}

/// A coordinate: `f32` or `f64`.
pub trait Scalar: sealed::Sealed + Copy + Into<f64> {
    #[doc(hidden)]
    const TYPE: u32;
}

impl Scalar for f32 {
    const TYPE: u32 = 0;
}

impl Scalar for f64 {
    const TYPE: u32 = 1;
}

/// How to query; the default is triangle pairs, touching.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Pairs of an edge and a triangle, not of two triangles.
    pub edges: bool,
    /// Proper crossings only.
    pub proper: bool,
}

/// How a step is asked about; the default is what touches on the way.
#[derive(Clone, Copy, Debug, Default)]
pub struct StepOptions {
    /// How near is a collision, in units of the coordinates.
    pub separation: f64,
    /// How exactly distances are told, the same units; 0: a millionth of the size.
    pub tolerance: f64,
}

/// What collides in a step: a vertex and a triangle, or two edges 3 t + k; and when.
#[derive(Clone, Copy, Debug)]
pub struct Step<'workspace> {
    pub vertex_faces: &'workspace [Pair],
    pub edge_edges: &'workspace [Pair],
    pub vertex_face_times: &'workspace [f64],
    pub edge_edge_times: &'workspace [f64],
    /// Nothing collides before; 1 if nothing does at all.
    pub earliest: f64,
}

/// What is within a distance: pairs as in a step.
#[derive(Clone, Copy, Debug)]
pub struct Near<'workspace> {
    pub vertex_faces: &'workspace [Pair],
    pub edge_edges: &'workspace [Pair],
}

/// Contours of the intersections in a pose; each names its first node and how many it has.
#[derive(Clone, Copy, Debug)]
pub struct Contours<'workspace> {
    pub nodes: &'workspace [ContourNode],
    pub contours: &'workspace [Contour],
}

impl Contours<'_> {
    /// The nodes of one of these contours.
    pub fn nodes_of(&self, contour: &Contour) -> &[ContourNode] {
        &self.nodes[contour.first as usize..][..contour.count as usize]
    }
}

/// A mesh made ready for queries.
#[derive(Debug)]
pub struct Model(ptr::NonNull<raw::sc_model>);

// SAFETY: the library never writes to a model after it is built, and frees it from any thread.
unsafe impl Send for Model {}
unsafe impl Sync for Model {}

impl Model {
    /// Builds a model of a mesh in its rest pose.
    pub fn build<T: Scalar>(positions: &[[T; 3]], triangles: &[[u32; 3]]) -> Result<Model, Error> {
        let mesh = raw::sc_mesh {
            struct_size: size_of::<raw::sc_mesh>(),
            vertex_count: positions.len().try_into().map_err(|_| Error::Count)?,
            triangle_count: triangles.len().try_into().map_err(|_| Error::Count)?,
            position_type: T::TYPE,
            position_stride: 0,
            index_type: 0,
            index_stride: 0,
            reserved: 0,
            positions: positions.as_ptr().cast(),
            indices: triangles.as_ptr().cast(),
        };
        let mut model = ptr::null_mut();
        // SAFETY: the arrays are as long as the mesh says, and outlive the call.
        check(unsafe { raw::sc_build(&mesh, ptr::null(), &mut model) })?;
        Ok(Model(ptr::NonNull::new(model).expect("a model that was built")))
    }

    /// Makes a workspace for queries.
    pub fn workspace(&self) -> Result<Workspace<'_>, Error> {
        self.workspace_for(0)
    }

    /// Makes a workspace for more than queries: `WORKSPACE_STEP` or `WORKSPACE_NEAR`.
    pub fn workspace_for(&self, flags: u32) -> Result<Workspace<'_>, Error> {
        self.workspace_in(flags, None)
    }

    /// room: a workspace that lends its room. It outlives this one, and nobody uses both at a time.
    fn workspace_in(&self, flags: u32, room: Option<&Workspace<'_>>) -> Result<Workspace<'_>, Error> {
        let options = raw::sc_workspace_options {
            struct_size: size_of::<raw::sc_workspace_options>(),
            flags,
            workers: 1,
            reserved: 0,
            allocator: ptr::null(),
            room: room.map_or(ptr::null_mut(), |lender| lender.handle.as_ptr()),
        };
        let mut handle = ptr::null_mut();
        // SAFETY: model and room are alive.
        check(unsafe { raw::sc_workspace_create_for(self.0.as_ptr(), &options, &mut handle) })?;
        let handle = ptr::NonNull::new(handle).expect("a workspace that was made");
        let list = || vec![Pair::default(); 16];
        Ok(Workspace {
            model: self,
            handle,
            pairs: list(),
            features: [list(), list()],
            times: Default::default(),
            nodes: Vec::new(),
            contours: Vec::new(),
        })
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        // SAFETY: workspaces borrow the model, so there is none left.
        unsafe { raw::sc_model_free(self.0.as_ptr()) }
    }
}

/// What queries write to. It may go to another thread, and has to go before its model:
///
/// ```
/// # use starcontour::{Error, Model, Options};
/// # let rest = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
/// let model = Model::build(&rest, &[[0, 1, 2]])?;
/// let mut workspace = model.workspace()?;
/// workspace.query(&rest, &Options::default())?;
/// drop(workspace);
/// drop(model);
/// # Ok::<(), Error>(())
/// ```
///
/// ```compile_fail
/// # use starcontour::{Error, Model, Options};
/// # let rest = [[0., 0., 0.], [1., 0., 0.], [0., 1., 0.]];
/// let model = Model::build(&rest, &[[0, 1, 2]])?;
/// let mut workspace = model.workspace()?;
/// drop(model);
/// workspace.query(&rest, &Options::default())?; // does not compile: the model is gone
/// # Ok::<(), Error>(())
/// ```
#[derive(Debug)]
pub struct Workspace<'model> {
    model: &'model Model,
    handle: ptr::NonNull<raw::sc_workspace>,
    pairs: Vec<Pair>,
    features: [Vec<Pair>; 2],
    times: [Vec<f64>; 2],
    nodes: Vec<ContourNode>,
    contours: Vec<Contour>,
}

// SAFETY: a workspace is memory of its own; only one thread at a time has it.
unsafe impl Send for Workspace<'_> {}

fn pose_of<T: Scalar>(positions: &[[T; 3]]) -> Result<raw::sc_pose, Error> {
    Ok(raw::sc_pose {
        struct_size: size_of::<raw::sc_pose>(),
        vertex_count: positions.len().try_into().map_err(|_| Error::VertexCount)?,
        position_type: T::TYPE,
        position_stride: 0,
        positions: positions.as_ptr().cast(),
    })
}

fn raw_options(options: &Options) -> raw::sc_query_options {
    raw::sc_query_options {
        struct_size: size_of::<raw::sc_query_options>(),
        output: 0,
        pairs: options.edges.into(),
        contact: options.proper.into(),
        method: 0,
        contour: 0,
        rest_cache: 0,
        simd: 0,
        filter: ptr::null(),
        cancel: ptr::null(),
        budget: 0,
        tasks: ptr::null(),
    }
}

fn raw_step_options(options: &StepOptions) -> raw::sc_step_options {
    raw::sc_step_options {
        struct_size: size_of::<raw::sc_step_options>(),
        output: 0,
        pairs: 0,
        times: 2,
        method: 0,
        contour: 0,
        simd: 0,
        reserved: 0,
        separation: options.separation,
        tolerance: options.tolerance,
        tasks: ptr::null(),
        cancel: ptr::null(),
        budget: 0,
        vertex_face_filter: ptr::null(),
        edge_edge_filter: ptr::null(),
        rest: ptr::null(),
        rest_distance: 0.0,
        begun: 0,
        reserved2: 0,
    }
}

fn raw_near_options(distance: f64) -> raw::sc_near_options {
    raw::sc_near_options {
        struct_size: size_of::<raw::sc_near_options>(),
        output: 0,
        kinds: 0,
        method: 0,
        simd: 0,
        reserved: 0,
        distance,
        vertex_face_filter: ptr::null(),
        edge_edge_filter: ptr::null(),
        rest: ptr::null(),
        rest_distance: 0.0,
        tasks: ptr::null(),
        cancel: ptr::null(),
        budget: 0,
        masks: ptr::null(),
    }
}

impl Workspace<'_> {
    /// All pairs in a pose, sorted.
    pub fn query<T: Scalar>(&mut self, pose: &[[T; 3]], options: &Options) -> Result<&[Pair], Error> {
        let pose = pose_of(pose)?;
        let options = raw_options(options);
        loop {
            let mut result = raw::sc_result {
                struct_size: size_of::<raw::sc_result>(),
                collides: 0,
                count: 0,
                capacity: self.pairs.len() as u64,
                pairs: self.pairs.as_mut_ptr(),
                stats: ptr::null_mut(),
                verdict: 0,
                reserved: 0,
            };
            // SAFETY: model and workspace are alive, the workspace is ours alone, the arrays are as
            // long as stated.
            let status = unsafe {
                raw::sc_query(self.model.0.as_ptr(), self.handle.as_ptr(), &pose, &options, &mut result)
            };
            if Error::from_code(status) == Error::ShortBuffer {
                self.pairs.resize(result.count as usize, Pair::default());
                continue;
            }
            check(status)?;
            return Ok(&self.pairs[..result.count as usize]);
        }
    }
}

impl Workspace<'_> {
    /// What collides while every vertex moves on a straight line from one pose to another.
    pub fn step<T: Scalar, U: Scalar>(
        &mut self,
        start: &[[T; 3]],
        end: &[[U; 3]],
        options: &StepOptions,
    ) -> Result<Step<'_>, Error> {
        let (start, end) = (pose_of(start)?, pose_of(end)?);
        let options = raw_step_options(options);
        loop {
            let [faces, edges] = &mut self.features;
            let [face_times, edge_times] = &mut self.times;
            face_times.resize(faces.len(), 0.0);
            edge_times.resize(edges.len(), 0.0);
            let mut result = raw::sc_step_result {
                struct_size: size_of::<raw::sc_step_result>(),
                collides: 0,
                verdict: 0,
                reserved: 0,
                vertex_face_count: 0,
                vertex_face_capacity: faces.len() as u64,
                vertex_faces: faces.as_mut_ptr(),
                vertex_face_times: face_times.as_mut_ptr(),
                edge_edge_count: 0,
                edge_edge_capacity: edges.len() as u64,
                edge_edges: edges.as_mut_ptr(),
                edge_edge_times: edge_times.as_mut_ptr(),
                earliest: 0.0,
                stats: ptr::null_mut(),
            };
            // SAFETY: as in query; the times are as long as the pairs.
            let status = unsafe {
                raw::sc_query_step(
                    self.model.0.as_ptr(), self.handle.as_ptr(), &start, &end, &options, &mut result)
            };
            let counts = [result.vertex_face_count as usize, result.edge_edge_count as usize];
            if Error::from_code(status) == Error::ShortBuffer {
                self.make_room(counts);
                continue;
            }
            check(status)?;
            return Ok(Step {
                vertex_faces: &self.features[0][..counts[0]],
                edge_edges: &self.features[1][..counts[1]],
                vertex_face_times: &self.times[0][..counts[0]],
                edge_edge_times: &self.times[1][..counts[1]],
                earliest: result.earliest,
            });
        }
    }

    /// What is within a distance in a pose, in units of the coordinates.
    pub fn near<T: Scalar>(&mut self, pose: &[[T; 3]], distance: f64) -> Result<Near<'_>, Error> {
        let pose = pose_of(pose)?;
        let options = raw_near_options(distance);
        loop {
            let [faces, edges] = &mut self.features;
            let mut result = raw::sc_near_result {
                struct_size: size_of::<raw::sc_near_result>(),
                found: 0,
                verdict: 0,
                reserved: 0,
                vertex_face_count: 0,
                vertex_face_capacity: faces.len() as u64,
                vertex_faces: faces.as_mut_ptr(),
                edge_edge_count: 0,
                edge_edge_capacity: edges.len() as u64,
                edge_edges: edges.as_mut_ptr(),
                stats: ptr::null_mut(),
                vertex_bounds: ptr::null_mut(),
            };
            // SAFETY: as in query.
            let status = unsafe {
                raw::sc_query_near(
                    self.model.0.as_ptr(), self.handle.as_ptr(), &pose, &options, &mut result)
            };
            let counts = [result.vertex_face_count as usize, result.edge_edge_count as usize];
            if Error::from_code(status) == Error::ShortBuffer {
                self.make_room(counts);
                continue;
            }
            check(status)?;
            return Ok(Near {
                vertex_faces: &self.features[0][..counts[0]],
                edge_edges: &self.features[1][..counts[1]],
            });
        }
    }

    /// Contours of the intersections in a pose. Its pairs of edges and triangles are found first.
    pub fn trace<T: Scalar>(&mut self, pose: &[[T; 3]]) -> Result<Contours<'_>, Error> {
        let count = self.query(pose, &Options { edges: true, proper: false })?.len();
        let pose = pose_of(pose)?;
        loop {
            let mut result = raw::sc_trace_result {
                struct_size: size_of::<raw::sc_trace_result>(),
                reserved: 0,
                node_count: 0,
                node_capacity: self.nodes.len() as u64,
                nodes: self.nodes.as_mut_ptr(),
                contour_count: 0,
                contour_capacity: self.contours.len() as u64,
                contours: self.contours.as_mut_ptr(),
            };
            // SAFETY: as in query; the pairs are those that it found.
            let status = unsafe {
                raw::sc_trace(
                    self.model.0.as_ptr(), &pose, self.pairs.as_ptr(), count as u64, ptr::null(),
                    &mut result)
            };
            let (nodes, contours) = (result.node_count as usize, result.contour_count as usize);
            if Error::from_code(status) == Error::ShortBuffer {
                self.nodes.resize(nodes.max(self.nodes.len()), ContourNode::default());
                self.contours.resize(contours.max(self.contours.len()), Contour::default());
                continue;
            }
            check(status)?;
            return Ok(Contours { nodes: &self.nodes[..nodes], contours: &self.contours[..contours] });
        }
    }

    fn make_room(&mut self, counts: [usize; 2]) {
        for (list, count) in self.features.iter_mut().zip(counts) {
            list.resize(count.max(list.len()), Pair::default());
        }
    }
}

impl Drop for Workspace<'_> {
    fn drop(&mut self) {
        // SAFETY: it is freed once, here.
        unsafe { raw::sc_workspace_free(self.handle.as_ptr()) }
    }
}
