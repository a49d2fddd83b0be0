// C#: pairs of two poses, the structures' layout, errors, one model in two threads.
//
//     mono ffi_csharp.exe MESH GOLDEN LAYOUT
//
// SPDX-License-Identifier: MIT
using System;
using System.Collections.Generic;
using System.Globalization;
using System.IO;
using System.Linq;
using System.Runtime.InteropServices;
using System.Threading;
using Starcontour;

static class FfiCsharp
{
    static int passed, failed;

    static void Check(string what, bool condition)
    {
        if (condition) ++passed;
        else { ++failed; Console.WriteLine("failed: " + what); }
    }

    static bool Refused(Status status, string text, Action call)
    {
        try { call(); }
        catch (StarcontourException e) { return e.Status == status && e.Message.Contains(text); }
        return false;
    }

    // Each structure has the members of the header, no more and no fewer, where the header has
    // them.
    static void CheckLayout(string path)
    {
        var lines = File.ReadAllLines(path).Select(line => line.Split(' ')).ToList();
        foreach (var type in new[] { typeof(Native.sc_mesh), typeof(Native.sc_pose),
            typeof(Native.sc_query_options), typeof(Native.sc_result), typeof(Pair),
            typeof(Native.sc_workspace_options), typeof(Native.sc_step_options),
            typeof(Native.sc_step_result), typeof(Native.sc_near_options),
            typeof(Native.sc_near_result), typeof(ContourNode), typeof(Contour),
            typeof(Native.sc_trace_options), typeof(Native.sc_trace_result),
            typeof(Native.sc_group), typeof(Native.sc_object),
            typeof(Native.sc_objects), typeof(Native.sc_object_pairs),
            typeof(Native.sc_objects_result), typeof(Native.sc_object_list),
            typeof(Native.sc_objects_lists) })
        {
            var name = type == typeof(Pair) ? "sc_pair"
                : type == typeof(ContourNode) ? "sc_trace_node"
                : type == typeof(Contour) ? "sc_trace_contour" : type.Name;
            var size = lines.Single(w => w[0] == "struct" && w[1] == name)[2];
            var header = lines.Where(w => w[0] == "member" && w[1] == name).Select(w => w[2] + " " + w[3]);
            var own = type.GetFields().Where(f => !f.IsLiteral)
                .Select(f => f.Name + " " + Marshal.OffsetOf(type, f.Name));
            Check(name + " is laid out as in the header",
                Marshal.SizeOf(type).ToString() == size && header.SequenceEqual(own));
        }
        var statuses = lines.Where(w => w[0] == "value" && (w[1] == "SC_OK" || w[1].StartsWith("SC_ERROR_")));
        Check("status values are the header's", statuses.Select(w => int.Parse(w[2])).SequenceEqual(
            Enum.GetValues(typeof(Status)).Cast<int>()));
        var ends = Enum.GetValues(typeof(ContourEnd)).Cast<ContourEnd>().Select(
            end => "SC_TRACE_" + end.ToString().ToUpperInvariant() + " " + (uint)end);
        var others = new[] {
            "SC_TRACE_ONE_SHEET " + Contour.OneSheet, "SC_TRACE_NO_EDGE " + ContourNode.NoEdge
        };
        Check("constants of contours are the header's", new HashSet<string>(ends.Concat(others)).SetEquals(
            lines.Where(w => w[0] == "value" && w[1].StartsWith("SC_TRACE_")).Select(w => w[1] + " " + w[2])));
    }

    static bool Close(double a, double b) { return Math.Abs(a - b) <= 1e-12 * b; }

    // The contours are those of the golden file: nodes, and of contours number of nodes, begin, end
    // and length.
    static bool Same(TracedContours found, ILookup<string, string> golden)
    {
        var wanted = golden["contour"].Select(line => line.Split(' ')).ToList();
        return wanted.Count == found.Contours.Count && found.Nodes.Select(
                node => node.edge + " " + node.triangle).SequenceEqual(golden["node"])
            && found.Contours.Zip(wanted, (contour, w) =>
                contour.count + " " + (uint)contour.begin + " " + (uint)contour.end
                    == string.Join(" ", w.Take(3))
                && Close(contour.length, double.Parse(w[3], CultureInfo.InvariantCulture))).All(x => x);
    }

    // Nodes follow each other contour after contour, and so does the length of their segments.
    static bool LengthsFit(TracedContours found)
    {
        ulong next = 0;
        foreach (var contour in found.Contours)
        {
            var points = found.Nodes.Skip((int)contour.first).Take((int)contour.count).Select(
                node => node.point).ToList();
            if (contour.begin == ContourEnd.Closed) points.Add(points[0]);
            var length = points.Zip(points.Skip(1), (p, q) => Math.Sqrt((p.x - q.x) * (p.x - q.x)
                + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z))).Sum();
            if (contour.first != next || !Close(length, contour.length)) return false;
            next += contour.count;
        }
        return next == (ulong)found.Nodes.Count;
    }

    // Meetings as pairs of the one mesh of two objects, sorted; firstA and firstB: the numbers of
    // what is the second one's first there.
    static IEnumerable<string> Joined(Meeting[] meetings, int firstA, int firstB)
    {
        return meetings.SelectMany(m => m.Pairs.Select(pair =>
            new[] { pair.a + m.A * firstA, pair.b + m.B * firstB }))
            .OrderBy(pair => pair[0]).ThenBy(pair => pair[1]).Select(pair => pair[0] + " " + pair[1]);
    }

    // The mesh's two cloths as two objects have the pairs that the mesh has.
    static void CheckScene(double[] rest, double[] moved, uint[] triangles, ILookup<string, string> golden)
    {
        int vertices = rest.Length / 6, half = triangles.Length / 6;
        Func<double[], int, double[]> part = (all, which) =>
            all.Skip(which * 3 * vertices).Take(3 * vertices).ToArray();
        using (var one = new Model(part(rest, 0).Select(x => (float)x).ToArray(),
            triangles.Take(3 * half).ToArray()))
        using (var two = new Model(part(rest, 1).Select(x => (float)x).ToArray(),
            triangles.Skip(3 * half).Select(v => v - (uint)vertices).ToArray()))
        using (var scene = new Scene(WorkspaceKind.Near))
        {
            var objects = new[] { scene.Add(one), scene.Add(two) };
            Check("an object without a pose", Refused(Status.Null, "", () => scene.Query()));
            for (var i = 0; i < 2; ++i) objects[i].SetPose(part(rest, i));
            Check("pairs of two objects", Joined(scene.Query(), half, half).SequenceEqual(golden["rest"]));
            for (var i = 0; i < 2; ++i) objects[i].SetEnd(part(moved, i));
            var step = scene.Step();
            Check("a step of two objects",
                Joined(step.VertexFaces, vertices, half).SequenceEqual(golden["stepfaces"])
                && Joined(step.EdgeEdges, 3 * half, 3 * half).SequenceEqual(golden["stepedges"])
                && step.VertexFaces.Concat(step.EdgeEdges).SelectMany(m => m.Times).Min() == step.Earliest);
            for (var i = 0; i < 2; ++i) objects[i].SetPose(part(moved, i));
            var near = scene.Near(0.045);
            Check("near of two objects",
                Joined(near.VertexFaces, vertices, half).SequenceEqual(golden["nearfaces"])
                && Joined(near.EdgeEdges, 3 * half, 3 * half).SequenceEqual(golden["nearedges"])
                && near.EdgeEdges.All(m => m.Times.Count == 0));
            Check("pairs when they moved", Joined(scene.Query(), half, half).SequenceEqual(golden["moved"]));
            objects[0].Category = objects[0].Mask = 1;
            objects[1].Category = objects[1].Mask = 2;
            Check("groups of objects", scene.Query().Length == 0);
            objects[0].SetPose(new double[3 * vertices]);
            using (var workspace = one.CreateWorkspace())
                Check("an object and itself", scene.Query().Single().Pairs.SequenceEqual(
                    workspace.Query(new double[3 * vertices])));
            objects[0].Itself = false;
            Check("an object without itself", scene.Query().Length == 0);
            using (var copies = new Scene(WorkspaceKind.Near))
            {
                for (var i = 0; i < 3; ++i)
                    copies.Add(one).SetPose(i < 2 ? part(rest, i)
                        : part(rest, 0).Select(x => x + 100).ToArray());
                Check("objects of one model, which have one room",
                    Joined(copies.Query(), half, half).SequenceEqual(golden["rest"])
                    && copies.Lenders.Count == 1);
            }
            one.Dispose();
            var disposed = false;
            try { scene.Query(); }
            catch (ObjectDisposedException) { disposed = true; }
            Check("a model that is gone", disposed);
        }
    }

    static int Main(string[] arguments)
    {
        var invariant = CultureInfo.InvariantCulture;
        var lines = File.ReadAllLines(arguments[0]).Select(
            line => line.Split(new[] { ' ' }, StringSplitOptions.RemoveEmptyEntries)).ToList();
        var rest = lines.Where(w => w[0] == "v").SelectMany(
            w => w.Skip(1).Take(3).Select(x => float.Parse(x, invariant))).ToArray();
        var triangles = lines.Where(w => w[0] == "f").SelectMany(
            w => w.Skip(1).Take(3).Select(x => uint.Parse(x.Split('/')[0]) - 1)).ToArray();
        var moved = rest.Select(x => (double)x).ToArray();
        for (var i = rest.Length / 3 / 2; i < rest.Length / 3; ++i)
            moved[3 * i + 2] += moved[3 * i] / 4 - 0.25;

        var golden = File.ReadAllLines(arguments[1]).Where(line => !line.StartsWith("#"))
            .Select(line => line.Split(new[] { ' ' }, 2)).ToLookup(w => w[0], w => w[1]);
        Func<ArraySegment<Pair>, string, bool> same = (pairs, pose) =>
            pairs.Select(pair => pair.ToString()).SequenceEqual(golden[pose]);
        Check("there is something to compare", golden["rest"].Any() && golden["moved"].Any());

        CheckLayout(arguments[2]);

        using (var model = new Model(rest, triangles))
        {
            using (var workspace = model.CreateWorkspace())
            {
                Check("pairs at rest", same(workspace.Query(rest), "rest"));
                Check("pairs when moved", same(workspace.Query(moved), "moved"));
                Check("edges, proper", workspace.Query(rest, PairKind.Edge, Contact.Proper).Count > 0);

                var traced = workspace.Trace(rest);
                Check("contours at rest", Same(traced, golden) && traced.Contours.Count > 0);
                Check("lengths of contours", LengthsFit(traced));
                traced = workspace.Trace(moved);
                Check("contours when moved", !Same(traced, golden) && LengthsFit(traced));

                var spoilt = (double[])moved.Clone();
                spoilt[5] = double.NaN;
                Check("NaN", Refused(Status.NotFinite, "NaN", () => workspace.Query(spoilt)));
                Check("contours of NaN", Refused(Status.NotFinite, "NaN", () => workspace.Trace(spoilt)));
                Check("number of vertices", Refused(Status.VertexCount, "vert",
                    () => workspace.Query(rest.Take(rest.Length - 3).ToArray())));
                Check("vertex out of range", Refused(Status.Index, "vertex",
                    () => new Model(rest, new uint[] { 0, 1, (uint)rest.Length })));
                Check("no triangles", Refused(Status.Empty, "triangle", () => new Model(rest, new uint[3 * 0])));
                Check("usable after errors", same(workspace.Query(rest), "rest"));
                Check("no room for steps", Refused(Status.Workspace, "workspace",
                    () => workspace.Step(rest, rest)));
            }
            using (var larger = model.CreateWorkspace(WorkspaceKind.Near))
            {
                var near = larger.Near(moved, 0.045);
                Check("pairs that are near", same(near.VertexFaces, "nearfaces") && same(near.EdgeEdges, "nearedges"));
                var step = larger.Step(rest.Select(x => (double)x).ToArray(), moved);
                Check("pairs of a step", same(step.VertexFaces, "stepfaces") && same(step.EdgeEdges, "stepedges"));
                Check("at their times", step.Earliest > 0 && step.VertexFaceTimes.Concat(
                    step.EdgeEdgeTimes).Min() == step.Earliest);
                Check("a step that is free", larger.Step(rest, rest).Earliest == 1);
                Check("a distance below 0", Refused(Status.Option, "option", () => larger.Near(rest, -1)));
            }

            var right = 0;
            var threads = new List<Thread>();
            foreach (var pose in new[] { "rest", "moved" })
            {
                threads.Add(new Thread(() => {
                    using (var own = model.CreateWorkspace())
                        for (var i = 0; i < 100; ++i)
                            if (same(pose == "rest" ? own.Query(rest) : own.Query(moved), pose))
                                Interlocked.Increment(ref right);
                }));
            }
            threads.ForEach(thread => thread.Start());
            threads.ForEach(thread => thread.Join());
            Check("two threads, one model", right == 200);
        }

        CheckScene(rest.Select(x => (double)x).ToArray(), moved, triangles, golden);

        Console.WriteLine("c#: {0} passed, {1} failed", passed, failed);
        return failed == 0 ? 0 : 1;
    }
}
