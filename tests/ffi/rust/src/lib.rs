//! A safe wrapper: whatever a caller does, memory stays sound. What the library promises to C by
//! comment, the compiler holds callers to here:
//!
//! - a [`Model`] is immutable and may be shared by threads (`Sync`);
//! - a [`Workspace`] belongs to one call at a time (`&mut self`) and goes before its model;
//! - the pairs that a query returns live until the next query of that workspace.
//!
//! ```ignore
//! let model = Model::build(&rest, &triangles)?;
//! let mut workspace = model.workspace()?;
//! for pair in workspace.query(&pose, &Options::default())? { ... }
//! ```
//!
//! SPDX-License-Identifier: MIT

pub mod raw;

pub use raw::sc_pair as Pair;
use std::ffi::CStr;
use std::{fmt, mem, ptr};

/// What the library refused: an SC_ERROR_... of the header.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Error(pub i32);

pub const ERROR_EMPTY: Error = Error(4);
pub const ERROR_COUNT: Error = Error(5);
pub const ERROR_INDEX: Error = Error(7);
pub const ERROR_NOT_FINITE: Error = Error(8);
pub const ERROR_VERTEX_COUNT: Error = Error(9);
pub const ERROR_SHORT_BUFFER: Error = Error(11);

impl fmt::Display for Error {
    fn fmt(&self, formatter: &mut fmt::Formatter) -> fmt::Result {
        // SAFETY: the text is the library's, never NULL, and static.
        let text = unsafe { CStr::from_ptr(raw::sc_status_string(self.0)) };
        formatter.write_str(&text.to_string_lossy())
    }
}

impl std::error::Error for Error {}

fn check(status: i32) -> Result<(), Error> {
    if status == 0 { Ok(()) } else { Err(Error(status)) }
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
pub trait Scalar: sealed::Sealed {
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
            vertex_count: positions.len().try_into().map_err(|_| ERROR_COUNT)?,
            triangle_count: triangles.len().try_into().map_err(|_| ERROR_COUNT)?,
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

    /// Makes a workspace for this model.
    pub fn workspace(&self) -> Result<Workspace<'_>, Error> {
        let mut handle = ptr::null_mut();
        // SAFETY: the model is alive.
        check(unsafe { raw::sc_workspace_create(self.0.as_ptr(), ptr::null(), &mut handle) })?;
        let handle = ptr::NonNull::new(handle).expect("a workspace that was made");
        Ok(Workspace { model: self, handle, pairs: vec![Pair::default(); 16] })
    }
}

impl Drop for Model {
    fn drop(&mut self) {
        // SAFETY: workspaces borrow the model, so there is none left.
        unsafe { raw::sc_model_free(self.0.as_ptr()) }
    }
}

/// What queries write to.
#[derive(Debug)]
pub struct Workspace<'model> {
    model: &'model Model,
    handle: ptr::NonNull<raw::sc_workspace>,
    pairs: Vec<Pair>,
}

// SAFETY: a workspace is memory of its own; only one thread at a time has it.
unsafe impl Send for Workspace<'_> {}

impl Workspace<'_> {
    /// All pairs in a pose, sorted.
    pub fn query<T: Scalar>(&mut self, pose: &[[T; 3]], options: &Options) -> Result<&[Pair], Error> {
        let pose = raw::sc_pose {
            struct_size: size_of::<raw::sc_pose>(),
            vertex_count: pose.len().try_into().map_err(|_| ERROR_VERTEX_COUNT)?,
            position_type: T::TYPE,
            position_stride: 0,
            positions: pose.as_ptr().cast(),
        };
        let options = raw::sc_query_options {
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
        };
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
            if Error(status) == ERROR_SHORT_BUFFER {
                self.pairs.resize(result.count as usize, Pair::default());
                continue;
            }
            check(status)?;
            return Ok(&self.pairs[..result.count as usize]);
        }
    }
}

impl Drop for Workspace<'_> {
    fn drop(&mut self) {
        // SAFETY: it is freed once, here.
        unsafe { raw::sc_workspace_free(self.handle.as_ptr()) }
    }
}
