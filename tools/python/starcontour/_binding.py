"""The shared library by ctypes: structures and functions as in starcontour.h, no more.

The library is the one that the environment's STARCONTOUR_LIBRARY names, else the package's own.
Pointers to arrays are c_void_p, so that numpy's addresses go in as they are.

SPDX-License-Identifier: MIT
"""

import ctypes
import os
import sys
from ctypes import CFUNCTYPE, POINTER, c_char_p, c_double, c_int32, c_uint32, c_uint64, c_void_p

# The enumerators that the package and its tests use.
SC_ERROR_NULL = 1
SC_ERROR_OPTION = 3
SC_ERROR_EMPTY = 4
SC_ERROR_INDEX = 7
SC_ERROR_NOT_FINITE = 8
SC_ERROR_VERTEX_COUNT = 9
SC_ERROR_SHORT_BUFFER = 11
SC_ERROR_WORKSPACE = 12
SC_ERROR_WELD_MAP = 13
SC_ERROR_TREE = 14
SC_ERROR_LEVEL = 18
SC_ERROR_NOT_SAVED = 19
SC_ERROR_TRUNCATED = 20
SC_ERROR_CHECKSUM = 24
SC_ERROR_TOPOLOGY = 26
SC_ERROR_PAIRS = 27
SC_ERROR_INCOMPLETE = 28
SC_ERROR_BOXES_ONLY = 29
SC_LOG_ERROR = 2
SC_FLOAT, SC_DOUBLE = 0, 1
SC_UINT32, SC_UINT16 = 0, 1
SC_WELD_REST, SC_WELD_MAP, SC_WELD_NONE = 0, 1, 2
SC_PARTITION_FAST, SC_PARTITION_ORDER = 0, 1
SC_MODEL_FULL, SC_MODEL_BOXES = 0, 1
SC_LOAD_COPY, SC_LOAD_IN_PLACE = 0, 1
SC_OUTPUT_PAIRS, SC_OUTPUT_COUNT, SC_OUTPUT_ANY = 0, 1, 2
SC_PAIRS_TRIANGLE, SC_PAIRS_EDGE = 0, 1
SC_CONTACT_TOUCHING, SC_CONTACT_PROPER = 0, 1
SC_METHOD_DEFAULT, SC_METHOD_SCTT, SC_METHOD_AABB_SCTT, SC_METHOD_AABB = 0, 1, 2, 3
SC_REST_CACHE_ON, SC_REST_CACHE_OFF = 0, 1
SC_WORKSPACE_STEP, SC_WORKSPACE_NEAR, SC_WORKSPACE_ROOM = 1, 2, 4
SC_WORKERS_MAX = 256
SC_RINGS_MAX = 32
SC_STEP_METHOD_DEFAULT, SC_STEP_METHOD_SCTT, SC_STEP_METHOD_TWO_BOXES, SC_STEP_METHOD_SWEPT = 0, 1, 2, 3
SC_STEP_COLLISIONS, SC_STEP_CANDIDATES = 0, 1
SC_STEP_TIMES_NONE, SC_STEP_TIMES_EARLIEST, SC_STEP_TIMES_EACH = 0, 1, 2
SC_NEAR_BOTH, SC_NEAR_VERTEX_FACE, SC_NEAR_EDGE_EDGE = 0, 1, 2
SC_NEAR_METHOD_DEFAULT, SC_NEAR_METHOD_SCTT, SC_NEAR_METHOD_BOXES = 0, 1, 2
SC_FEATURE_VERTEX_VERTEX, SC_FEATURE_VERTEX_EDGE, SC_FEATURE_EDGE_EDGE, SC_FEATURE_VERTEX_FACE = 1, 2, 3, 4
SC_STENCIL_PARALLEL = 1
SC_STEP_BEGUN_ALL, SC_STEP_BEGUN_NEARER = 0, 1


# The type of the member log of sc_hooks.
sc_hooks_log = CFUNCTYPE(None, c_void_p, c_uint32, c_char_p)

# What a job of a query calls for each part, and the members of sc_tasks.
sc_tasks_run = CFUNCTYPE(None, c_void_p, c_uint32, c_uint32)
sc_tasks_enqueue = CFUNCTYPE(c_void_p, c_void_p, sc_tasks_run, c_void_p, c_uint32)
sc_tasks_finish = CFUNCTYPE(None, c_void_p, c_void_p)


class sc_tasks(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("workers", c_uint32),
        ("enqueue", sc_tasks_enqueue),
        ("finish", sc_tasks_finish),
        ("user", c_void_p),
    ]


class sc_hooks(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("log", sc_hooks_log),
        ("failed", c_void_p),
        ("user", c_void_p),
    ]


class sc_mesh(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("vertex_count", c_uint32),
        ("triangle_count", c_uint32),
        ("position_type", c_uint32),
        ("position_stride", c_uint32),
        ("index_type", c_uint32),
        ("index_stride", c_uint32),
        ("reserved", c_uint32),
        ("positions", c_void_p),
        ("indices", c_void_p),
    ]


class sc_pose(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("vertex_count", c_uint32),
        ("position_type", c_uint32),
        ("position_stride", c_uint32),
        ("positions", c_void_p),
    ]


class sc_build_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("weld", c_uint32),
        ("partition", c_uint32),
        ("tree_count", c_uint32),
        ("weld_map", c_void_p),
        ("order", c_void_p),
        ("tree", c_void_p),
        ("bisect", c_void_p),
        ("bisect_user", c_void_p),
        ("allocator", c_void_p),
        ("hooks", c_void_p),
        ("rest", c_uint32),
        ("content", c_uint32),
        ("tasks", c_void_p),
    ]


class sc_load_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("mode", c_uint32),
        ("topology_hash", c_uint64),
        ("allocator", c_void_p),
        ("hooks", c_void_p),
    ]


class sc_model_info(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("vertex_count", c_uint32),
        ("point_count", c_uint32),
        ("triangle_count", c_uint32),
        ("edge_count", c_uint32),
        ("component_count", c_uint32),
        ("boundary_edges", c_uint32),
        ("irregular_edges", c_uint32),
        ("leaf_count", c_uint32),
        ("level_count", c_uint32),
        ("node_count", c_uint32),
        ("segment_count", c_uint32),
        ("topology_hash", c_uint64),
        ("model_bytes", c_uint64),
        ("workspace_bytes", c_uint64),
        ("peak_bytes", c_uint64),
        ("allocations", c_uint64),
    ]


class sc_query_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("output", c_uint32),
        ("pairs", c_uint32),
        ("contact", c_uint32),
        ("method", c_uint32),
        ("contour", c_uint32),
        ("rest_cache", c_uint32),
        ("simd", c_uint32),
        ("filter", c_void_p),
        ("cancel", c_void_p),
        ("budget", c_uint64),
        ("tasks", c_void_p),
    ]


class sc_filter(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("ignore_rings", c_uint32),
        ("vertex_groups", c_void_p),
        ("triangle_groups", c_void_p),
        ("ignore", c_void_p),
        ("ignore_count", c_uint64),
        ("accept", c_void_p),
        ("accept_user", c_void_p),
    ]


class sc_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("collides", c_uint32),
        ("count", c_uint64),
        ("capacity", c_uint64),
        ("pairs", c_void_p),
        ("stats", c_void_p),
        ("verdict", c_uint32),
        ("reserved", c_uint32),
    ]


class sc_workspace_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("flags", c_uint32),
        ("workers", c_uint32),
        ("reserved", c_uint32),
        ("allocator", c_void_p),
        ("room", c_void_p),
    ]


class sc_step_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("output", c_uint32),
        ("pairs", c_uint32),
        ("times", c_uint32),
        ("method", c_uint32),
        ("contour", c_uint32),
        ("simd", c_uint32),
        ("reserved", c_uint32),
        ("separation", c_double),
        ("tolerance", c_double),
        ("tasks", c_void_p),
        ("cancel", c_void_p),
        ("budget", c_uint64),
        ("vertex_face_filter", c_void_p),
        ("edge_edge_filter", c_void_p),
        ("rest", c_void_p),
        ("rest_distance", c_double),
        ("begun", c_uint32),
        ("reserved2", c_uint32),
    ]


class sc_step_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("collides", c_uint32),
        ("verdict", c_uint32),
        ("reserved", c_uint32),
        ("vertex_face_count", c_uint64),
        ("vertex_face_capacity", c_uint64),
        ("vertex_faces", c_void_p),
        ("vertex_face_times", c_void_p),
        ("edge_edge_count", c_uint64),
        ("edge_edge_capacity", c_uint64),
        ("edge_edges", c_void_p),
        ("edge_edge_times", c_void_p),
        ("earliest", c_double),
        ("stats", c_void_p),
    ]


class sc_near_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("output", c_uint32),
        ("kinds", c_uint32),
        ("method", c_uint32),
        ("simd", c_uint32),
        ("reserved", c_uint32),
        ("distance", c_double),
        ("vertex_face_filter", c_void_p),
        ("edge_edge_filter", c_void_p),
        ("rest", c_void_p),
        ("rest_distance", c_double),
        ("tasks", c_void_p),
        ("cancel", c_void_p),
        ("budget", c_uint64),
        ("masks", c_void_p),
    ]


class sc_near_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("found", c_uint32),
        ("verdict", c_uint32),
        ("reserved", c_uint32),
        ("vertex_face_count", c_uint64),
        ("vertex_face_capacity", c_uint64),
        ("vertex_faces", c_void_p),
        ("edge_edge_count", c_uint64),
        ("edge_edge_capacity", c_uint64),
        ("edge_edges", c_void_p),
        ("stats", c_void_p),
        ("vertex_bounds", c_void_p),
    ]


class sc_group(ctypes.Structure):
    _fields_ = [("category", c_uint32), ("mask", c_uint32)]


class sc_object(ctypes.Structure):
    _fields_ = [
        ("model", c_void_p),
        ("workspace", c_void_p),
        ("pose", c_void_p),
        ("end", c_void_p),
        ("pose_version", c_uint64),
        ("group", sc_group),
        ("itself", c_uint32),
        ("reserved", c_uint32),
        ("filter", c_void_p),
        ("vertex_face_filter", c_void_p),
        ("edge_edge_filter", c_void_p),
        ("rest", c_void_p),
        ("rest_distance", c_double),
        ("masks", c_void_p),
    ]


class sc_objects(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("count", c_uint32),
        ("objects", c_void_p),
        ("stride", c_uint64),
        ("accept", c_void_p),
        ("accept_user", c_void_p),
        ("accept_near", c_void_p),
    ]


class sc_objects_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("collides", c_uint32),
        ("count", c_uint64),
        ("capacity", c_uint64),
        ("pairs", c_void_p),
        ("range_count", c_uint64),
        ("range_capacity", c_uint64),
        ("ranges", c_void_p),
        ("stats", c_void_p),
        ("verdict", c_uint32),
        ("reserved", c_uint32),
    ]


class sc_object_list(ctypes.Structure):
    _fields_ = [
        ("count", c_uint64),
        ("capacity", c_uint64),
        ("pairs", c_void_p),
        ("times", c_void_p),
        ("range_count", c_uint64),
        ("range_capacity", c_uint64),
        ("ranges", c_void_p),
    ]


class sc_objects_lists(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("collides", c_uint32),
        ("vertex_faces", sc_object_list),
        ("edge_edges", sc_object_list),
        ("stats", c_void_p),
        ("earliest", c_double),
        ("verdict", c_uint32),
        ("reserved", c_uint32),
    ]


# An entry of a numpy array of ranges of pairs.
sc_object_pairs = [("object_a", "u4"), ("object_b", "u4"), ("first", "u8"), ("count", "u8")]

# An entry of a numpy array of contacts, and of stencils.
sc_contact = [
    ("kind", "u4"),
    ("reserved", "u4"),
    ("points", "f8", (2, 3)),
    ("weights_a", "f8", (2, 3)),
    ("weights_b", "f8", (2, 3)),
]

sc_near_stencil = [
    ("feature", "u4"),
    ("flags", "u4"),
    ("vertices", "u4", 4),
    ("weights", "f8", 4),
    ("vector", "f8", 3),
    ("distance", "f8"),
]

sc_step_stencil = [
    ("start", sc_near_stencil),
    ("impact", sc_near_stencil),
    ("time", "f8"),
    ("normal", "f8", 3),
    ("side", "i4"),
    ("flags", "u4"),
]

# An entry of a numpy array of a contour's nodes, and of contours.
sc_trace_node = [
    ("edge", "u4"),
    ("triangle", "u4"),
    ("sheet", "u4"),
    ("sheets", "u4", 2),
    ("reserved", "u4"),
    ("along", "f8"),
    ("weights", "f8", 3),
    ("point", "f8", 3),
]

sc_trace_contour = [
    ("first", "u8"),
    ("count", "u8"),
    ("begin", "u4"),
    ("end", "u4"),
    ("flags", "u4"),
    ("reserved", "u4"),
    ("length", "f8"),
]


sc_region = [
    ("component", "u4"),
    ("vertex_count", "u4"),
    ("area", "f8"),
    ("inside", "i4"),
    ("reserved", "u4"),
]

SC_REGIONS_INSIDE = 1


class sc_regions_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("flags", c_uint32),
        ("region_count", c_uint64),
        ("region_capacity", c_uint64),
        ("regions", c_void_p),
        ("vertex_regions", c_void_p),
        ("sides", c_void_p),
    ]


# A point that three triangles have in common.
sc_trace_triple = [
    ("triangles", "u4", 3),
    ("reserved", "u4"),
    ("nodes", "u8", 3),
    ("along", "f8", 3),
    ("point", "f8", 3),
]


class sc_triples_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("count", c_uint64),
        ("capacity", c_uint64),
        ("triples", c_void_p),
    ]


# The stencil of a node: the gradient of its contour's length.
sc_trace_gradient = [
    ("vertices", "u4", 5),
    ("flags", "u4"),
    ("weights", "f8", 5),
    ("vectors", "f8", (2, 3)),
]


class sc_trace_options(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("simd", c_uint32),
        ("allocator", c_void_p),
        ("hooks", c_void_p),
        ("tasks", c_void_p),
        ("cancel", c_void_p),
    ]


class sc_trace_result(ctypes.Structure):
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("node_count", c_uint64),
        ("node_capacity", c_uint64),
        ("nodes", c_void_p),
        ("contour_count", c_uint64),
        ("contour_capacity", c_uint64),
        ("contours", c_void_p),
    ]


structures = (sc_hooks, sc_tasks, sc_near_options, sc_near_result, sc_mesh, sc_pose, sc_build_options, sc_load_options, sc_model_info,
              sc_query_options, sc_filter, sc_result, sc_workspace_options, sc_step_options, sc_step_result,
              sc_group, sc_object, sc_objects, sc_objects_result, sc_object_list, sc_objects_lists,
              sc_trace_options, sc_trace_result, sc_triples_result, sc_regions_result)

_suffix = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
_own = os.path.join(os.path.dirname(os.path.abspath(__file__)), "libstarcontour" + _suffix)
lib = ctypes.CDLL(os.environ.get("STARCONTOUR_LIBRARY", _own))


def _declare(name, result, *parameters):
    function = getattr(lib, name)
    function.restype = result
    function.argtypes = parameters


_status = c_int32
_declare("sc_status_string", c_char_p, _status)
_declare("sc_version_string", c_char_p)
_declare("sc_build", _status, POINTER(sc_mesh), POINTER(sc_build_options), POINTER(c_void_p))
_declare("sc_model_free", None, c_void_p)
_declare("sc_model_get_info", _status, c_void_p, POINTER(sc_model_info))
_declare("sc_model_get_patches", _status, c_void_p, c_uint32, c_void_p, c_uint64)
_declare("sc_model_save_size", _status, c_void_p, POINTER(c_uint64))
_declare("sc_model_save", _status, c_void_p, c_void_p, c_uint64, POINTER(c_uint64))
_declare("sc_model_load", _status, c_void_p, c_uint64, POINTER(sc_load_options), POINTER(c_void_p))
_declare("sc_workspace_create_for", _status, c_void_p, POINTER(sc_workspace_options), POINTER(c_void_p))
_declare("sc_workspace_set_hooks", _status, c_void_p, POINTER(sc_hooks))
_declare("sc_workspace_free", None, c_void_p)
_declare("sc_query", _status, c_void_p, c_void_p, POINTER(sc_pose), POINTER(sc_query_options),
         POINTER(sc_result))
_declare("sc_contacts", _status, c_void_p, POINTER(sc_pose), c_uint32, c_void_p, c_uint64, c_void_p)
_declare("sc_trace", _status, c_void_p, POINTER(sc_pose), c_void_p, c_uint64,
         POINTER(sc_trace_options), POINTER(sc_trace_result))
_declare("sc_trace_triples", _status, c_void_p, POINTER(sc_pose), POINTER(sc_trace_result),
         POINTER(sc_trace_options), POINTER(sc_triples_result))
_declare("sc_trace_regions", _status, c_void_p, POINTER(sc_pose), POINTER(sc_trace_result),
         POINTER(sc_trace_options), POINTER(sc_regions_result))
_declare("sc_trace_gradients", _status, c_void_p, POINTER(sc_pose), POINTER(sc_trace_result), c_void_p)
_declare("sc_query_step", _status, c_void_p, c_void_p, POINTER(sc_pose), POINTER(sc_pose),
         POINTER(sc_step_options), POINTER(sc_step_result))
_declare("sc_query_near", _status, c_void_p, c_void_p, POINTER(sc_pose), POINTER(sc_near_options),
         POINTER(sc_near_result))
_declare("sc_query_objects", _status, POINTER(sc_objects), POINTER(sc_query_options),
         POINTER(sc_objects_result))
_declare("sc_query_objects_near", _status, POINTER(sc_objects), POINTER(sc_near_options),
         POINTER(sc_objects_lists))
_declare("sc_query_objects_step", _status, POINTER(sc_objects), POINTER(sc_step_options),
         POINTER(sc_objects_lists))
_declare("sc_near_masks_create", _status, c_void_p, c_uint32, c_void_p, POINTER(c_void_p))
_declare("sc_near_masks_free", None, c_void_p)
_declare("sc_near_stencils", _status, c_void_p, POINTER(sc_pose), c_uint32, c_void_p, c_uint64, c_void_p)
_declare("sc_step_stencils", _status, c_void_p, POINTER(sc_pose), POINTER(sc_pose), c_uint32, c_void_p,
         c_void_p, c_uint64, c_void_p)
_declare("sc_near_merge", _status, c_void_p, c_uint64, POINTER(c_uint64), c_void_p)
