//! starcontour.h as Rust sees it: same names, same layout, nothing added.
//!
//! SPDX-License-Identifier: MIT
#![allow(non_camel_case_types)]

use std::mem::{size_of, MaybeUninit};
use std::os::raw::{c_char, c_int, c_void};
use std::ptr::addr_of;

pub type sc_status = i32;

#[repr(C)]
pub struct sc_mesh {
    pub struct_size: u32,
    pub vertex_count: u32,
    pub triangle_count: u32,
    pub position_type: u32,
    pub position_stride: u32,
    pub index_type: u32,
    pub index_stride: u32,
    pub reserved: u32,
    pub positions: *const c_void,
    pub indices: *const c_void,
}

#[repr(C)]
pub struct sc_pose {
    pub struct_size: u32,
    pub vertex_count: u32,
    pub position_type: u32,
    pub position_stride: u32,
    pub positions: *const c_void,
}

#[repr(C)]
pub struct sc_query_options {
    pub struct_size: u32,
    pub output: u32,
    pub pairs: u32,
    pub contact: u32,
    pub method: u32,
    pub contour: u32,
    pub rest_cache: u32,
    pub simd: u32,
    pub filter: *const c_void,
    pub cancel: *const u32,
    pub budget: u64,
    pub tasks: *const c_void,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct sc_pair {
    pub a: u32,
    pub b: u32,
}

#[repr(C)]
pub struct sc_result {
    pub struct_size: u32,
    pub collides: u32,
    pub count: u64,
    pub capacity: u64,
    pub pairs: *mut sc_pair,
    pub stats: *mut c_void,
    pub verdict: u32,
    pub reserved: u32,
}

#[repr(C)]
pub struct sc_workspace_options {
    pub struct_size: u32,
    pub flags: u32,
    pub workers: u32,
    pub reserved: u32,
    pub allocator: *const c_void,
    pub room: *mut sc_workspace,
}

#[repr(C)]
pub struct sc_step_options {
    pub struct_size: u32,
    pub output: u32,
    pub pairs: u32,
    pub times: u32,
    pub method: u32,
    pub contour: u32,
    pub simd: u32,
    pub reserved: u32,
    pub separation: f64,
    pub tolerance: f64,
    pub tasks: *const c_void,
    pub cancel: *const u32,
    pub budget: u64,
    pub vertex_face_filter: *const c_void,
    pub edge_edge_filter: *const c_void,
    pub rest: *const sc_pose,
    pub rest_distance: f64,
    pub begun: u32,
    pub reserved2: u32,
}

#[repr(C)]
pub struct sc_step_result {
    pub struct_size: u32,
    pub collides: u32,
    pub verdict: u32,
    pub reserved: u32,
    pub vertex_face_count: u64,
    pub vertex_face_capacity: u64,
    pub vertex_faces: *mut sc_pair,
    pub vertex_face_times: *mut f64,
    pub edge_edge_count: u64,
    pub edge_edge_capacity: u64,
    pub edge_edges: *mut sc_pair,
    pub edge_edge_times: *mut f64,
    pub earliest: f64,
    pub stats: *mut c_void,
}

#[repr(C)]
pub struct sc_near_options {
    pub struct_size: u32,
    pub output: u32,
    pub kinds: u32,
    pub method: u32,
    pub simd: u32,
    pub reserved: u32,
    pub distance: f64,
    pub vertex_face_filter: *const c_void,
    pub edge_edge_filter: *const c_void,
    pub rest: *const sc_pose,
    pub rest_distance: f64,
    pub tasks: *const c_void,
    pub cancel: *const u32,
    pub budget: u64,
    pub masks: *const c_void,
}

#[repr(C)]
pub struct sc_near_result {
    pub struct_size: u32,
    pub found: u32,
    pub verdict: u32,
    pub reserved: u32,
    pub vertex_face_count: u64,
    pub vertex_face_capacity: u64,
    pub vertex_faces: *mut sc_pair,
    pub edge_edge_count: u64,
    pub edge_edge_capacity: u64,
    pub edge_edges: *mut sc_pair,
    pub stats: *mut c_void,
    pub vertex_bounds: *mut f64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct sc_trace_node {
    pub edge: u32,
    pub triangle: u32,
    pub sheet: u32,
    pub sheets: [u32; 2],
    pub reserved: u32,
    pub along: f64,
    pub weights: [f64; 3],
    pub point: [f64; 3],
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct sc_trace_contour {
    pub first: u64,
    pub count: u64,
    pub begin: u32,
    pub end: u32,
    pub flags: u32,
    pub reserved: u32,
    pub length: f64,
}

#[repr(C)]
pub struct sc_trace_options {
    pub struct_size: u32,
    pub simd: u32,
    pub allocator: *const c_void,
    pub hooks: *const c_void,
    pub tasks: *const c_void,
    pub cancel: *const u32,
}

#[repr(C)]
pub struct sc_trace_result {
    pub struct_size: u32,
    pub reserved: u32,
    pub node_count: u64,
    pub node_capacity: u64,
    pub nodes: *mut sc_trace_node,
    pub contour_count: u64,
    pub contour_capacity: u64,
    pub contours: *mut sc_trace_contour,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct sc_group {
    pub category: u32,
    pub mask: u32,
}

#[repr(C)]
pub struct sc_object {
    pub model: *const sc_model,
    pub workspace: *mut sc_workspace,
    pub pose: *const sc_pose,
    pub end: *const sc_pose,
    pub pose_version: u64,
    pub group: sc_group,
    pub itself: u32,
    pub reserved: u32,
    pub filter: *const c_void,
    pub vertex_face_filter: *const c_void,
    pub edge_edge_filter: *const c_void,
    pub rest: *const sc_pose,
    pub rest_distance: f64,
    pub masks: *const c_void,
}

#[repr(C)]
pub struct sc_objects {
    pub struct_size: u32,
    pub count: u32,
    pub objects: *const sc_object,
    pub stride: u64,
    pub accept: Option<extern "C" fn(*mut c_void, u32, u32, u32, u32) -> c_int>,
    pub accept_user: *mut c_void,
    pub accept_near: Option<extern "C" fn(*mut c_void, u32, u32, u32, u32, u32) -> c_int>,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct sc_object_pairs {
    pub object_a: u32,
    pub object_b: u32,
    pub first: u64,
    pub count: u64,
}

#[repr(C)]
pub struct sc_objects_result {
    pub struct_size: u32,
    pub collides: u32,
    pub count: u64,
    pub capacity: u64,
    pub pairs: *mut sc_pair,
    pub range_count: u64,
    pub range_capacity: u64,
    pub ranges: *mut sc_object_pairs,
    pub stats: *mut c_void,
    pub verdict: u32,
    pub reserved: u32,
}

#[repr(C)]
pub struct sc_object_list {
    pub count: u64,
    pub capacity: u64,
    pub pairs: *mut sc_pair,
    pub times: *mut f64,
    pub range_count: u64,
    pub range_capacity: u64,
    pub ranges: *mut sc_object_pairs,
}

#[repr(C)]
pub struct sc_objects_lists {
    pub struct_size: u32,
    pub collides: u32,
    pub vertex_faces: sc_object_list,
    pub edge_edges: sc_object_list,
    pub stats: *mut c_void,
    pub earliest: f64,
    pub verdict: u32,
    pub reserved: u32,
}

#[repr(C)]
pub struct sc_model {
    _opaque: [u8; 0],
}

#[repr(C)]
pub struct sc_workspace {
    _opaque: [u8; 0],
}

extern "C" {
    pub fn sc_status_string(status: sc_status) -> *const c_char;
    pub fn sc_build(
        mesh: *const sc_mesh,
        options: *const c_void,
        model: *mut *mut sc_model,
    ) -> sc_status;
    pub fn sc_model_free(model: *mut sc_model);
    pub fn sc_workspace_create_for(
        model: *const sc_model,
        options: *const sc_workspace_options,
        workspace: *mut *mut sc_workspace,
    ) -> sc_status;
    pub fn sc_workspace_free(workspace: *mut sc_workspace);
    pub fn sc_query(
        model: *const sc_model,
        workspace: *mut sc_workspace,
        pose: *const sc_pose,
        options: *const sc_query_options,
        result: *mut sc_result,
    ) -> sc_status;
    pub fn sc_query_step(
        model: *const sc_model,
        workspace: *mut sc_workspace,
        start: *const sc_pose,
        end: *const sc_pose,
        options: *const sc_step_options,
        result: *mut sc_step_result,
    ) -> sc_status;
    pub fn sc_query_near(
        model: *const sc_model,
        workspace: *mut sc_workspace,
        pose: *const sc_pose,
        options: *const sc_near_options,
        result: *mut sc_near_result,
    ) -> sc_status;
    pub fn sc_trace(
        model: *const sc_model,
        pose: *const sc_pose,
        pairs: *const sc_pair,
        count: u64,
        options: *const sc_trace_options,
        result: *mut sc_trace_result,
    ) -> sc_status;
    pub fn sc_query_objects(
        objects: *const sc_objects,
        options: *const sc_query_options,
        result: *mut sc_objects_result,
    ) -> sc_status;
    pub fn sc_query_objects_near(
        objects: *const sc_objects,
        options: *const sc_near_options,
        lists: *mut sc_objects_lists,
    ) -> sc_status;
    pub fn sc_query_objects_step(
        objects: *const sc_objects,
        options: *const sc_step_options,
        lists: *mut sc_objects_lists,
    ) -> sc_status;
}

/// Name, size in bytes, and the names and offsets of the members.
pub type Layout = (&'static str, usize, Vec<(&'static str, usize)>);

/// The layout of each structure above.
pub fn layouts() -> Vec<Layout> {
    macro_rules! layout {
        ($type:ident: $($member:ident)*) => {{
            let nothing = MaybeUninit::<$type>::uninit();
            let start = nothing.as_ptr();
            // SAFETY: addresses are taken, nothing is read.
            let offsets = vec![$((stringify!($member),
                unsafe { addr_of!((*start).$member) as usize - start as usize })),*];
            (stringify!($type), size_of::<$type>(), offsets)
        }};
    }
    vec![
        layout!(sc_mesh: struct_size vertex_count triangle_count position_type position_stride
            index_type index_stride reserved positions indices),
        layout!(sc_pose: struct_size vertex_count position_type position_stride positions),
        layout!(sc_query_options: struct_size output pairs contact method contour rest_cache
            simd filter cancel budget tasks),
        layout!(sc_pair: a b),
        layout!(sc_result: struct_size collides count capacity pairs stats verdict reserved),
        layout!(sc_workspace_options: struct_size flags workers reserved allocator room),
        layout!(sc_step_options: struct_size output pairs times method contour simd reserved
            separation tolerance tasks cancel budget vertex_face_filter edge_edge_filter rest
            rest_distance begun reserved2),
        layout!(sc_step_result: struct_size collides verdict reserved vertex_face_count
            vertex_face_capacity vertex_faces vertex_face_times edge_edge_count
            edge_edge_capacity edge_edges edge_edge_times earliest stats),
        layout!(sc_near_options: struct_size output kinds method simd reserved distance
            vertex_face_filter edge_edge_filter rest rest_distance tasks cancel budget
            masks),
        layout!(sc_near_result: struct_size found verdict reserved vertex_face_count
            vertex_face_capacity vertex_faces edge_edge_count edge_edge_capacity edge_edges stats
            vertex_bounds),
        layout!(sc_trace_node: edge triangle sheet sheets reserved along weights point),
        layout!(sc_trace_contour: first count begin end flags reserved length),
        layout!(sc_trace_options: struct_size simd allocator hooks tasks cancel),
        layout!(sc_trace_result: struct_size reserved node_count node_capacity nodes
            contour_count contour_capacity contours),
        layout!(sc_group: category mask),
        layout!(sc_object: model workspace pose end pose_version group itself reserved filter
            vertex_face_filter edge_edge_filter rest rest_distance masks),
        layout!(sc_objects: struct_size count objects stride accept accept_user accept_near),
        layout!(sc_object_pairs: object_a object_b first count),
        layout!(sc_objects_result: struct_size collides count capacity pairs range_count
            range_capacity ranges stats verdict reserved),
        layout!(sc_object_list: count capacity pairs times range_count range_capacity ranges),
        layout!(sc_objects_lists: struct_size collides vertex_faces edge_edges stats earliest
            verdict reserved),
    ]
}
