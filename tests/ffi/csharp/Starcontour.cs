// starcontour for C#, by P/Invoke: blittable structures, handles that free themselves, arrays pinned
// for the length of a call and not copied. As an assembly of Unity it needs "unsafe" allowed and
// the shared library among the plug-ins.
//
// SPDX-License-Identifier: MIT
using System;
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

    [StructLayout(LayoutKind.Sequential)]
    public struct Pair
    {
        public uint a, b;
        public override string ToString() { return a + " " + b; }
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

        [DllImport(Library)] public static extern IntPtr sc_status_string(Status status);
        [DllImport(Library)] public static extern IntPtr sc_version_string();
        [DllImport(Library)] public static extern Status sc_build(
            ref sc_mesh mesh, IntPtr options, out ModelHandle model);
        [DllImport(Library)] public static extern void sc_model_free(IntPtr model);
        [DllImport(Library)] public static extern Status sc_workspace_create(
            ModelHandle model, IntPtr allocator, out WorkspaceHandle workspace);
        [DllImport(Library)] public static extern void sc_workspace_free(IntPtr workspace);
        [DllImport(Library)] public static extern Status sc_query(
            ModelHandle model, WorkspaceHandle workspace, ref sc_pose pose,
            ref sc_query_options options, ref sc_result result);

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

        public Workspace CreateWorkspace() { return new Workspace(this); }
        public void Dispose() { Handle.Dispose(); }
    }

    // What queries write to; belongs to one call at a time.
    public sealed unsafe class Workspace : IDisposable
    {
        readonly Model model;
        readonly WorkspaceHandle handle;
        Pair[] pairs = new Pair[16];

        internal Workspace(Model model)
        {
            this.model = model;
            Native.Check(Native.sc_workspace_create(model.Handle, IntPtr.Zero, out handle));
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
            var pose = new Native.sc_pose {
                struct_size = (uint)sizeof(Native.sc_pose), vertex_count = (uint)count,
                position_type = type, positions = positions
            };
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

        public void Dispose() { handle.Dispose(); }
    }
}
