// starcontour for C#, by P/Invoke: blittable structures, handles that free themselves, arrays
// pinned for the length of a call and not copied. As an assembly of Unity it needs "unsafe" allowed
// and the shared library among the plug-ins.
//
// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Runtime.InteropServices;

namespace Starcontour
{
    public enum Status
    {
        Ok = 0, Null = 1, StructSize = 2, Option = 3, Empty = 4, Count = 5, Stride = 6, Index = 7,
        NotFinite = 8, VertexCount = 9, Memory = 10, ShortBuffer = 11, Workspace = 12, WeldMap = 13,
        Tree = 14, Partition = 15, Unsupported = 16, Alignment = 17, Level = 18, NotSaved = 19,
        Truncated = 20, ByteOrder = 21, TooNew = 22, TooOld = 23, Checksum = 24, Inconsistent = 25,
        Topology = 26, Pairs = 27, Incomplete = 28, BoxesOnly = 29
    }

    public enum PairKind : uint { Triangle = 0, Edge = 1 }
    public enum Contact : uint { Touching = 0, Proper = 1 }

    // What a workspace is for, besides queries; Near is for steps, too.
    public enum WorkspaceKind : uint { Queries = 0, Steps = 1, Near = 2 }

    [StructLayout(LayoutKind.Sequential)]
    public struct Pair
    {
        public uint a, b;
        public override string ToString() { return a + " " + b; }
    }

    // Where a contour begins and ends: nowhere, at an edge of one triangle, at an edge of three or
    // more, or at a vertex that both triangles share.
    public enum ContourEnd : uint { Closed = 0, Border = 1, Branch = 2, Vertex = 3 }

    [StructLayout(LayoutKind.Sequential)]
    public struct Vector { public double x, y, z; }

    // Where an edge passes through a triangle: a sc_trace_node of the header. weights are those of
    // the triangle's corners; sheets are the triangles in which the contour goes on to the next
    // node.
    [StructLayout(LayoutKind.Sequential)]
    public struct ContourNode
    {
        public const uint NoEdge = 0xffffffff; // instead of an edge or sheets
        public uint edge, triangle, sheet;
        public Pair sheets;
        public uint reserved;
        public double along;
        public Vector weights, point;
    }

    // A contour: nodes first to first + count - 1; a sc_trace_contour of the header.
    [StructLayout(LayoutKind.Sequential)]
    public struct Contour
    {
        public const uint OneSheet = 1; // in flags: its two sheets are one
        public ulong first, count;
        public ContourEnd begin, end;
        public uint flags, reserved;
        public double length;
    }

    // The structures, as in starcontour.h. Names are the header's.
    public static unsafe class Native
    {
        const string Library = "starcontour";

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_mesh
        {
            public uint struct_size, vertex_count, triangle_count, position_type, position_stride,
                index_type, index_stride, reserved;
            public void* positions, indices;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_pose
        {
            public uint struct_size, vertex_count, position_type, position_stride;
            public void* positions;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_query_options
        {
            public uint struct_size, output, pairs, contact, method, contour, rest_cache, simd;
            public void* filter, cancel;
            public ulong budget;
            public void* tasks;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_result
        {
            public uint struct_size, collides;
            public ulong count, capacity;
            public Pair* pairs;
            public void* stats;
            public uint verdict, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_workspace_options
        {
            public uint struct_size, flags, workers, reserved;
            public void* allocator, room;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_step_options
        {
            public uint struct_size, output, pairs, times, method, contour, simd, reserved;
            public double separation, tolerance;
            public void* tasks, cancel;
            public ulong budget;
            public void* vertex_face_filter, edge_edge_filter, rest;
            public double rest_distance;
            public uint begun, reserved2;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_step_result
        {
            public uint struct_size, collides, verdict, reserved;
            public ulong vertex_face_count, vertex_face_capacity;
            public Pair* vertex_faces;
            public double* vertex_face_times;
            public ulong edge_edge_count, edge_edge_capacity;
            public Pair* edge_edges;
            public double* edge_edge_times;
            public double earliest;
            public void* stats;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_near_options
        {
            public uint struct_size, output, kinds, method, simd, reserved;
            public double distance;
            public void* vertex_face_filter, edge_edge_filter, rest;
            public double rest_distance;
            public void* tasks, cancel;
            public ulong budget;
            public void* masks;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_near_result
        {
            public uint struct_size, found, verdict, reserved;
            public ulong vertex_face_count, vertex_face_capacity;
            public Pair* vertex_faces;
            public ulong edge_edge_count, edge_edge_capacity;
            public Pair* edge_edges;
            public void* stats;
            public double* vertex_bounds;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_trace_options
        {
            public uint struct_size, simd;
            public void* allocator, hooks, tasks, cancel;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_trace_result
        {
            public uint struct_size, reserved;
            public ulong node_count, node_capacity;
            public ContourNode* nodes;
            public ulong contour_count, contour_capacity;
            public Contour* contours;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_group
        {
            public uint category, mask;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_object
        {
            public IntPtr model, workspace;
            public sc_pose* pose, end;
            public ulong pose_version;
            public sc_group group;
            public uint itself, reserved;
            public void* filter, vertex_face_filter, edge_edge_filter, rest;
            public double rest_distance;
            public void* masks;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_objects
        {
            public uint struct_size, count;
            public sc_object* objects;
            public ulong stride;
            public void* accept, accept_user, accept_near;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_object_pairs
        {
            public uint object_a, object_b;
            public ulong first, count;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_objects_result
        {
            public uint struct_size, collides;
            public ulong count, capacity;
            public Pair* pairs;
            public ulong range_count, range_capacity;
            public sc_object_pairs* ranges;
            public void* stats;
            public uint verdict, reserved;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_object_list
        {
            public ulong count, capacity;
            public Pair* pairs;
            public double* times;
            public ulong range_count, range_capacity;
            public sc_object_pairs* ranges;
        }

        [StructLayout(LayoutKind.Sequential)]
        public struct sc_objects_lists
        {
            public uint struct_size, collides;
            public sc_object_list vertex_faces, edge_edges;
            public void* stats;
            public double earliest;
            public uint verdict, reserved;
        }

        [DllImport(Library)] public static extern IntPtr sc_status_string(Status status);
        [DllImport(Library)] public static extern IntPtr sc_version_string();
        [DllImport(Library)] public static extern Status sc_build(
            ref sc_mesh mesh, IntPtr options, out ModelHandle model);
        [DllImport(Library)] public static extern void sc_model_free(IntPtr model);
        [DllImport(Library)] public static extern Status sc_workspace_create_for(
            ModelHandle model, ref sc_workspace_options options, out WorkspaceHandle workspace);
        [DllImport(Library)] public static extern void sc_workspace_free(IntPtr workspace);
        [DllImport(Library)] public static extern Status sc_query(
            ModelHandle model, WorkspaceHandle workspace, ref sc_pose pose,
            ref sc_query_options options, ref sc_result result);
        [DllImport(Library)] public static extern Status sc_query_step(
            ModelHandle model, WorkspaceHandle workspace, ref sc_pose start, ref sc_pose end,
            ref sc_step_options options, ref sc_step_result result);
        [DllImport(Library)] public static extern Status sc_query_near(
            ModelHandle model, WorkspaceHandle workspace, ref sc_pose pose,
            ref sc_near_options options, ref sc_near_result result);
        [DllImport(Library)] public static extern Status sc_trace(
            ModelHandle model, ref sc_pose pose, Pair* pairs, ulong count,
            ref sc_trace_options options, ref sc_trace_result result);
        [DllImport(Library)] public static extern Status sc_query_objects(
            ref sc_objects objects, ref sc_query_options options, ref sc_objects_result result);
        [DllImport(Library)] public static extern Status sc_query_objects_near(
            ref sc_objects objects, ref sc_near_options options, ref sc_objects_lists lists);
        [DllImport(Library)] public static extern Status sc_query_objects_step(
            ref sc_objects objects, ref sc_step_options options, ref sc_objects_lists lists);

        public static void Check(Status status)
        {
            if (status != Status.Ok) throw new StarcontourException(status);
        }
    }

    public sealed class ModelHandle : SafeHandle
    {
        ModelHandle() : base(IntPtr.Zero, true) { }
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        protected override bool ReleaseHandle() { Native.sc_model_free(handle); return true; }
    }

    public sealed class WorkspaceHandle : SafeHandle
    {
        WorkspaceHandle() : base(IntPtr.Zero, true) { }
        public override bool IsInvalid { get { return handle == IntPtr.Zero; } }
        protected override bool ReleaseHandle() { Native.sc_workspace_free(handle); return true; }
    }

    // What the library refused.
    public sealed class StarcontourException : Exception
    {
        public readonly Status Status;

        public StarcontourException(Status status)
            : base(Marshal.PtrToStringAnsi(Native.sc_status_string(status)))
        {
            Status = status;
        }
    }

    // A mesh made ready for queries. Immutable: any number of threads may use it.
    public sealed unsafe class Model : IDisposable
    {
        internal readonly ModelHandle Handle;

        // Three coordinates a vertex, three vertex numbers a triangle.
        public Model(float[] positions, uint[] triangles)
        {
            fixed (float* p = positions)
            fixed (uint* t = triangles)
            {
                var mesh = new Native.sc_mesh {
                    struct_size = (uint)sizeof(Native.sc_mesh),
                    vertex_count = (uint)positions.Length / 3,
                    triangle_count = (uint)triangles.Length / 3,
                    positions = p, indices = t
                };
                Native.Check(Native.sc_build(ref mesh, IntPtr.Zero, out Handle));
            }
        }

        public Workspace CreateWorkspace(WorkspaceKind kind = WorkspaceKind.Queries)
        {
            return new Workspace(this, kind);
        }
        public void Dispose() { Handle.Dispose(); }
    }

    // Pairs of a vertex and a triangle, and of two edges 3 t + k: views of the workspace's own
    // arrays, overwritten by its next step or query of what is near. Of a step, when each collides.
    public struct Features
    {
        public ArraySegment<Pair> VertexFaces, EdgeEdges;
        public ArraySegment<double> VertexFaceTimes, EdgeEdgeTimes;
        public double Earliest; // of a step: nothing collides before
    }

    // Contours of a pose; each names its first node and how many it has. Views of the workspace's
    // own arrays, overwritten by its next trace.
    public struct TracedContours
    {
        public ArraySegment<ContourNode> Nodes;
        public ArraySegment<Contour> Contours;
    }

    // What queries write to; belongs to one call at a time.
    public sealed unsafe class Workspace : IDisposable
    {
        readonly Model model;
        readonly WorkspaceHandle handle;
        internal WorkspaceHandle Handle { get { return handle; } }
        Pair[] pairs = new Pair[16], faces = new Pair[16], edges = new Pair[16];
        double[] faceTimes = new double[16], edgeTimes = new double[16];
        ContourNode[] nodes = new ContourNode[16];
        Contour[] contours = new Contour[4];

        // room: null, or a workspace that lends its room.
        internal Workspace(Model model, WorkspaceKind kind, Workspace room = null, bool lends = false)
        {
            const uint lendsRoom = 4;
            var lender = room == null ? IntPtr.Zero : room.handle.DangerousGetHandle();
            this.model = model;
            var options = new Native.sc_workspace_options {
                struct_size = (uint)sizeof(Native.sc_workspace_options),
                flags = (uint)kind | (lends ? lendsRoom : 0), room = lender.ToPointer()
            };
            Native.Check(Native.sc_workspace_create_for(model.Handle, ref options, out handle));
        }

        // The pairs of a pose: a view of this workspace's own array, overwritten by the next query.
        public ArraySegment<Pair> Query(
            float[] positions, PairKind kind = PairKind.Triangle, Contact contact = Contact.Touching)
        {
            fixed (float* p = positions)
                return Query(p, positions.Length / 3, 0, kind, contact);
        }

        public ArraySegment<Pair> Query(
            double[] positions, PairKind kind = PairKind.Triangle, Contact contact = Contact.Touching)
        {
            fixed (double* p = positions)
                return Query(p, positions.Length / 3, 1, kind, contact);
        }

        ArraySegment<Pair> Query(void* positions, int count, uint type, PairKind kind, Contact contact)
        {
            var pose = PoseOf(positions, count, type);
            var options = new Native.sc_query_options {
                struct_size = (uint)sizeof(Native.sc_query_options),
                pairs = (uint)kind, contact = (uint)contact
            };
            var result = new Native.sc_result { struct_size = (uint)sizeof(Native.sc_result) };
            for (;;)
            {
                Status status;
                fixed (Pair* out_pairs = pairs)
                {
                    result.capacity = (ulong)pairs.Length;
                    result.pairs = out_pairs;
                    status = Native.sc_query(model.Handle, handle, ref pose, ref options, ref result);
                }
                if (status != Status.ShortBuffer)
                {
                    Native.Check(status);
                    return new ArraySegment<Pair>(pairs, 0, (int)result.count);
                }
                pairs = new Pair[result.count + result.count / 4];
            }
        }

        // What comes as near as separation while all vertices move from one pose to another.
        public Features Step(float[] start, float[] end, double separation = 0)
        {
            fixed (float* s = start)
            fixed (float* e = end)
                return Step(PoseOf(s, start.Length / 3, 0), PoseOf(e, end.Length / 3, 0), separation);
        }

        public Features Step(double[] start, double[] end, double separation = 0)
        {
            fixed (double* s = start)
            fixed (double* e = end)
                return Step(PoseOf(s, start.Length / 3, 1), PoseOf(e, end.Length / 3, 1), separation);
        }

        // What is within a distance in a pose, in units of the coordinates.
        public Features Near(float[] positions, double distance)
        {
            fixed (float* p = positions) return Near(PoseOf(p, positions.Length / 3, 0), distance);
        }

        public Features Near(double[] positions, double distance)
        {
            fixed (double* p = positions) return Near(PoseOf(p, positions.Length / 3, 1), distance);
        }

        // Contours of the intersections in a pose. Its pairs of edges and triangles are found
        // first, in place of those of the last query.
        public TracedContours Trace(float[] positions)
        {
            var found = Query(positions, PairKind.Edge);
            fixed (float* p = positions) return Trace(PoseOf(p, positions.Length / 3, 0), found);
        }

        public TracedContours Trace(double[] positions)
        {
            var found = Query(positions, PairKind.Edge);
            fixed (double* p = positions) return Trace(PoseOf(p, positions.Length / 3, 1), found);
        }

        static Native.sc_pose PoseOf(void* positions, int count, uint type)
        {
            return new Native.sc_pose {
                struct_size = (uint)sizeof(Native.sc_pose), vertex_count = (uint)count,
                position_type = type, positions = positions
            };
        }

        Features Step(Native.sc_pose start, Native.sc_pose end, double separation)
        {
            var options = new Native.sc_step_options {
                struct_size = (uint)sizeof(Native.sc_step_options), separation = separation, times = 2
            };
            var result = new Native.sc_step_result { struct_size = (uint)sizeof(Native.sc_step_result) };
            for (;;)
            {
                Status status;
                fixed (Pair* f = faces, e = edges)
                fixed (double* ft = faceTimes, et = edgeTimes)
                {
                    result.vertex_faces = f;
                    result.vertex_face_times = ft;
                    result.vertex_face_capacity = (ulong)faces.Length;
                    result.edge_edges = e;
                    result.edge_edge_times = et;
                    result.edge_edge_capacity = (ulong)edges.Length;
                    status = Native.sc_query_step(
                        model.Handle, handle, ref start, ref end, ref options, ref result);
                }
                if (status != Status.ShortBuffer)
                {
                    Native.Check(status);
                    var found = Found(result.vertex_face_count, result.edge_edge_count);
                    found.VertexFaceTimes = new ArraySegment<double>(faceTimes, 0, found.VertexFaces.Count);
                    found.EdgeEdgeTimes = new ArraySegment<double>(edgeTimes, 0, found.EdgeEdges.Count);
                    found.Earliest = result.earliest;
                    return found;
                }
                MakeRoom(result.vertex_face_count, result.edge_edge_count);
            }
        }

        Features Near(Native.sc_pose pose, double distance)
        {
            var options = new Native.sc_near_options {
                struct_size = (uint)sizeof(Native.sc_near_options), distance = distance
            };
            var result = new Native.sc_near_result { struct_size = (uint)sizeof(Native.sc_near_result) };
            for (;;)
            {
                Status status;
                fixed (Pair* f = faces, e = edges)
                {
                    result.vertex_faces = f;
                    result.vertex_face_capacity = (ulong)faces.Length;
                    result.edge_edges = e;
                    result.edge_edge_capacity = (ulong)edges.Length;
                    status = Native.sc_query_near(model.Handle, handle, ref pose, ref options, ref result);
                }
                if (status != Status.ShortBuffer)
                {
                    Native.Check(status);
                    return Found(result.vertex_face_count, result.edge_edge_count);
                }
                MakeRoom(result.vertex_face_count, result.edge_edge_count);
            }
        }

        TracedContours Trace(Native.sc_pose pose, ArraySegment<Pair> found)
        {
            var options = new Native.sc_trace_options {
                struct_size = (uint)sizeof(Native.sc_trace_options)
            };
            var result = new Native.sc_trace_result {
                struct_size = (uint)sizeof(Native.sc_trace_result)
            };
            for (;;)
            {
                Status status;
                fixed (Pair* p = found.Array)
                fixed (ContourNode* n = nodes)
                fixed (Contour* c = contours)
                {
                    result.nodes = n;
                    result.node_capacity = (ulong)nodes.Length;
                    result.contours = c;
                    result.contour_capacity = (ulong)contours.Length;
                    status = Native.sc_trace(
                        model.Handle, ref pose, p, (ulong)found.Count, ref options, ref result);
                }
                if (status != Status.ShortBuffer)
                {
                    Native.Check(status);
                    return new TracedContours {
                        Nodes = new ArraySegment<ContourNode>(nodes, 0, (int)result.node_count),
                        Contours = new ArraySegment<Contour>(contours, 0, (int)result.contour_count)
                    };
                }
                nodes = new ContourNode[Math.Max(result.node_count, (ulong)nodes.Length)];
                contours = new Contour[Math.Max(result.contour_count, (ulong)contours.Length)];
            }
        }

        Features Found(ulong faceCount, ulong edgeCount)
        {
            return new Features {
                VertexFaces = new ArraySegment<Pair>(faces, 0, (int)faceCount),
                EdgeEdges = new ArraySegment<Pair>(edges, 0, (int)edgeCount)
            };
        }

        void MakeRoom(ulong faceCount, ulong edgeCount)
        {
            faces = new Pair[Math.Max(faceCount, (ulong)faces.Length)];
            edges = new Pair[Math.Max(edgeCount, (ulong)edges.Length)];
            faceTimes = new double[faces.Length];
            edgeTimes = new double[edges.Length];
        }

        public void Dispose() { handle.Dispose(); }
    }

    // What two objects of a scene have with each other, or one with itself: numbers of the two,
    // pairs of what belongs to a and what belongs to b, and of a step when each collides. Views of
    // the scene's own arrays, overwritten by its next question.
    public struct Meeting
    {
        public int A, B;
        public ArraySegment<Pair> Pairs;
        public ArraySegment<double> Times;
    }

    // Meetings of a vertex and a triangle, and of two edges.
    public struct FeatureMeetings
    {
        public Meeting[] VertexFaces, EdgeEdges;
        public double Earliest; // of a step: nothing collides before
    }

    // An object of a scene. Arrays are read where they are, by the first question after each
    // Set...: set again what was changed in place.
    public sealed unsafe class SceneObject
    {
        public readonly Model Model;
        public bool Itself = true;  // whether its pairs with itself are wanted
        public uint Category, Mask; // its group, see sc_group; 0 and 0: it collides with all
        internal readonly Workspace Workspace;
        internal ulong Version;
        internal Array Pose, End;

        internal SceneObject(Model model, WorkspaceKind kind, Workspace room)
        {
            Model = model;
            Workspace = new Workspace(model, kind, room);
        }

        // Where it is, of a step at its start.
        public void SetPose(float[] positions) { Pose = positions; ++Version; }
        public void SetPose(double[] positions) { Pose = positions; ++Version; }

        // Of a step, where it is at its end; without, it stays where it is.
        public void SetEnd(float[] positions) { End = positions; ++Version; }
        public void SetEnd(double[] positions) { End = positions; ++Version; }
        public void Stay() { End = null; ++Version; }
    }

    // Several objects, which may share models. One call at a time.
    public sealed unsafe class Scene : IDisposable
    {
        // Arrays for one list of pairs.
        sealed class Room
        {
            internal Pair[] Pairs = new Pair[16];
            internal double[] Times = new double[16];
            internal Native.sc_object_pairs[] Ranges = new Native.sc_object_pairs[1];

            internal void Fit(ref Native.sc_object_list list)
            {
                if (list.count > (ulong)Pairs.Length)
                {
                    Pairs = new Pair[list.count];
                    Times = new double[list.count];
                }
                if (list.range_count > (ulong)Ranges.Length)
                    Ranges = new Native.sc_object_pairs[list.range_count];
            }

            internal Meeting[] Meetings(ulong count, bool timed)
            {
                var found = new Meeting[count];
                for (var i = 0; i < found.Length; ++i)
                {
                    int first = (int)Ranges[i].first, length = (int)Ranges[i].count;
                    found[i] = new Meeting {
                        A = (int)Ranges[i].object_a, B = (int)Ranges[i].object_b,
                        Pairs = new ArraySegment<Pair>(Pairs, first, length),
                        Times = new ArraySegment<double>(Times, first, timed ? length : 0)
                    };
                }
                return found;
            }
        }

        delegate Status Question(ref Native.sc_objects objects, ref Native.sc_objects_lists lists);

        readonly WorkspaceKind kind;
        readonly List<SceneObject> objects = new List<SceneObject>();
        readonly Room faces = new Room(), edges = new Room();
        // Of models that several objects have: whose room all but the first of them use.
        internal readonly Dictionary<Model, Workspace> Lenders = new Dictionary<Model, Workspace>();

        public Scene(WorkspaceKind kind = WorkspaceKind.Queries) { this.kind = kind; }

        // A new object, which has no pose yet. Its number is the number of those before it.
        public SceneObject Add(Model model)
        {
            objects.Add(new SceneObject(model, kind, LenderFor(model)));
            return objects[objects.Count - 1];
        }

        Workspace LenderFor(Model model)
        {
            Workspace lender = null;
            if (objects.Exists(one => one.Model == model) && !Lenders.TryGetValue(model, out lender))
                Lenders[model] = lender = new Workspace(model, kind, null, true);
            return lender;
        }

        // What intersects.
        public Meeting[] Query(
            PairKind pairs = PairKind.Triangle, Contact contact = Contact.Touching)
        {
            var options = new Native.sc_query_options {
                struct_size = (uint)sizeof(Native.sc_query_options),
                pairs = (uint)pairs, contact = (uint)contact
            };
            return Ask(false, (ref Native.sc_objects all, ref Native.sc_objects_lists lists) => {
                var result = new Native.sc_objects_result {
                    struct_size = (uint)sizeof(Native.sc_objects_result),
                    capacity = lists.vertex_faces.capacity, pairs = lists.vertex_faces.pairs,
                    range_capacity = lists.vertex_faces.range_capacity,
                    ranges = lists.vertex_faces.ranges
                };
                var status = Native.sc_query_objects(ref all, ref options, ref result);
                lists.vertex_faces.count = result.count;
                lists.vertex_faces.range_count = result.range_count;
                return status;
            }).VertexFaces;
        }

        // What is within a distance, in units of the coordinates.
        public FeatureMeetings Near(double distance)
        {
            var options = new Native.sc_near_options {
                struct_size = (uint)sizeof(Native.sc_near_options), distance = distance
            };
            return Ask(false, (ref Native.sc_objects all, ref Native.sc_objects_lists lists) =>
                Native.sc_query_objects_near(ref all, ref options, ref lists));
        }

        // What comes as near as separation while objects move from their pose to their end.
        public FeatureMeetings Step(double separation = 0)
        {
            var options = new Native.sc_step_options {
                struct_size = (uint)sizeof(Native.sc_step_options), separation = separation, times = 2
            };
            return Ask(true, (ref Native.sc_objects all, ref Native.sc_objects_lists lists) =>
                Native.sc_query_objects_step(ref all, ref options, ref lists));
        }

        // Asks until all arrays are long enough. Handles are held and arrays pinned meanwhile.
        FeatureMeetings Ask(bool moves, Question question)
        {
            var array = new Native.sc_object[objects.Count];
            var poses = new Native.sc_pose[2 * objects.Count];
            var held = new List<SafeHandle>();
            var pins = new List<GCHandle>();
            fixed (Native.sc_object* to = array)
            fixed (Native.sc_pose* pose = poses)
            try
            {
                foreach (var lender in Lenders.Values) Hold(lender.Handle, held);
                for (var i = 0; i < objects.Count; ++i)
                {
                    var one = objects[i];
                    to[i] = new Native.sc_object {
                        model = Hold(one.Model.Handle, held),
                        workspace = Hold(one.Workspace.Handle, held),
                        pose_version = one.Version, itself = one.Itself ? 1u : 0,
                        group = new Native.sc_group { category = one.Category, mask = one.Mask }
                    };
                    if (one.Pose != null)
                    {
                        pose[2 * i] = PoseOf(one.Pose, pins);
                        to[i].pose = &pose[2 * i];
                    }
                    if (moves && one.End != null)
                    {
                        pose[2 * i + 1] = PoseOf(one.End, pins);
                        to[i].end = &pose[2 * i + 1];
                    }
                }
                var all = new Native.sc_objects {
                    struct_size = (uint)sizeof(Native.sc_objects),
                    count = (uint)objects.Count, objects = to
                };
                var lists = new Native.sc_objects_lists {
                    struct_size = (uint)sizeof(Native.sc_objects_lists)
                };
                for (;;)
                {
                    Status status;
                    fixed (Pair* f = faces.Pairs, e = edges.Pairs)
                    fixed (double* ft = faces.Times, et = edges.Times)
                    fixed (Native.sc_object_pairs* fr = faces.Ranges, er = edges.Ranges)
                    {
                        lists.vertex_faces = new Native.sc_object_list {
                            capacity = (ulong)faces.Pairs.Length, pairs = f, times = moves ? ft : null,
                            range_capacity = (ulong)faces.Ranges.Length, ranges = fr
                        };
                        lists.edge_edges = new Native.sc_object_list {
                            capacity = (ulong)edges.Pairs.Length, pairs = e, times = moves ? et : null,
                            range_capacity = (ulong)edges.Ranges.Length, ranges = er
                        };
                        status = question(ref all, ref lists);
                    }
                    if (status != Status.ShortBuffer)
                    {
                        Native.Check(status);
                        return new FeatureMeetings {
                            VertexFaces = faces.Meetings(lists.vertex_faces.range_count, moves),
                            EdgeEdges = edges.Meetings(lists.edge_edges.range_count, moves),
                            Earliest = lists.earliest
                        };
                    }
                    faces.Fit(ref lists.vertex_faces);
                    edges.Fit(ref lists.edge_edges);
                }
            }
            finally
            {
                pins.ForEach(pin => pin.Free());
                held.ForEach(handle => handle.DangerousRelease());
            }
        }

        static IntPtr Hold(SafeHandle handle, List<SafeHandle> held)
        {
            var done = false;
            handle.DangerousAddRef(ref done);
            held.Add(handle);
            return handle.DangerousGetHandle();
        }

        static Native.sc_pose PoseOf(Array positions, List<GCHandle> pins)
        {
            pins.Add(GCHandle.Alloc(positions, GCHandleType.Pinned));
            return new Native.sc_pose {
                struct_size = (uint)sizeof(Native.sc_pose), vertex_count = (uint)positions.Length / 3,
                position_type = positions is double[] ? 1u : 0,
                positions = pins[pins.Count - 1].AddrOfPinnedObject().ToPointer()
            };
        }

        public void Dispose()
        {
            objects.ForEach(one => one.Workspace.Dispose());
            foreach (var lender in Lenders.Values) lender.Dispose();
        }
    }
}
