// Java, by JNA: pairs of two poses, the structures' layout, errors, one model in two threads.
//
//     java -cp /usr/share/java/jna.jar:. FfiJava MESH GOLDEN LAYOUT
//
// SPDX-License-Identifier: MIT

import com.sun.jna.Library;
import com.sun.jna.Native;
import com.sun.jna.Pointer;
import com.sun.jna.Structure;
import com.sun.jna.ptr.PointerByReference;
import java.lang.ref.Cleaner;
import java.lang.ref.Reference;
import java.nio.ByteBuffer;
import java.nio.ByteOrder;
import java.nio.file.Files;
import java.nio.file.Path;
import java.util.ArrayList;
import java.util.Arrays;
import java.util.HashMap;
import java.util.List;
import java.util.Map;
import java.util.Set;
import java.util.stream.Collectors;
import java.util.stream.Stream;

public final class FfiJava {
    /** The library's functions, as in starcontour.h. */
    public interface Starcontour extends Library {
        Starcontour C = Native.load("starcontour", Starcontour.class);

        String sc_status_string(int status);
        int sc_build(sc_mesh mesh, Pointer options, PointerByReference model);
        void sc_model_free(Pointer model);
        int sc_workspace_create_for(Pointer model, sc_workspace_options options,
            PointerByReference workspace);
        void sc_workspace_free(Pointer workspace);
        int sc_query(Pointer model, Pointer workspace, sc_pose pose, sc_query_options options,
            sc_result result);
        int sc_query_step(Pointer model, Pointer workspace, sc_pose start, sc_pose end,
            sc_step_options options, sc_step_result result);
        int sc_query_near(Pointer model, Pointer workspace, sc_pose pose, sc_near_options options,
            sc_near_result result);
        int sc_trace(Pointer model, sc_pose pose, Pointer pairs, long count, sc_trace_options options,
            sc_trace_result result);
        int sc_query_objects(sc_objects objects, Pointer options, sc_objects_result result);
        int sc_query_objects_near(sc_objects objects, sc_near_options options, sc_objects_lists lists);
        int sc_query_objects_step(sc_objects objects, sc_step_options options, sc_objects_lists lists);
    }

    // Positions, indices and pairs are direct buffers: memory outside Java's heap, read in place.

    @Structure.FieldOrder({"struct_size", "vertex_count", "triangle_count", "position_type",
        "position_stride", "index_type", "index_stride", "reserved", "positions", "indices"})
    public static class sc_mesh extends Structure {
        public int struct_size = size(), vertex_count, triangle_count, position_type, position_stride,
            index_type, index_stride, reserved;
        public Pointer positions, indices;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "vertex_count", "position_type", "position_stride", "positions"})
    public static class sc_pose extends Structure {
        public int struct_size = size(), vertex_count, position_type, position_stride;
        public Pointer positions;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "output", "pairs", "contact", "method", "contour",
        "rest_cache", "simd", "filter", "cancel", "budget", "tasks"})
    public static class sc_query_options extends Structure {
        public int struct_size = size(), output, pairs, contact, method, contour, rest_cache, simd;
        public Pointer filter, cancel;
        public long budget;
        public Pointer tasks;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "collides", "count", "capacity", "pairs", "stats",
        "verdict", "reserved"})
    public static class sc_result extends Structure {
        public int struct_size = size(), collides;
        public long count, capacity;
        public Pointer pairs, stats;
        public int verdict, reserved;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "flags", "workers", "reserved", "allocator", "room"})
    public static class sc_workspace_options extends Structure {
        public int struct_size = size(), flags, workers, reserved;
        public Pointer allocator, room;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "output", "pairs", "times", "method", "contour", "simd",
        "reserved", "separation", "tolerance", "tasks", "cancel", "budget", "vertex_face_filter",
        "edge_edge_filter", "rest", "rest_distance", "begun", "reserved2"})
    public static class sc_step_options extends Structure {
        public int struct_size = size(), output, pairs, times, method, contour, simd, reserved;
        public double separation, tolerance;
        public Pointer tasks, cancel;
        public long budget;
        public Pointer vertex_face_filter, edge_edge_filter, rest;
        public double rest_distance;
        public int begun, reserved2;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "collides", "verdict", "reserved", "vertex_face_count",
        "vertex_face_capacity", "vertex_faces", "vertex_face_times", "edge_edge_count",
        "edge_edge_capacity", "edge_edges", "edge_edge_times", "earliest", "stats"})
    public static class sc_step_result extends Structure {
        public int struct_size = size(), collides, verdict, reserved;
        public long vertex_face_count, vertex_face_capacity;
        public Pointer vertex_faces, vertex_face_times;
        public long edge_edge_count, edge_edge_capacity;
        public Pointer edge_edges, edge_edge_times;
        public double earliest;
        public Pointer stats;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "output", "kinds", "method", "simd", "reserved", "distance",
        "vertex_face_filter", "edge_edge_filter", "rest", "rest_distance", "tasks", "cancel",
        "budget", "masks"})
    public static class sc_near_options extends Structure {
        public int struct_size = size(), output, kinds, method, simd, reserved;
        public double distance;
        public Pointer vertex_face_filter, edge_edge_filter, rest;
        public double rest_distance;
        public Pointer tasks, cancel;
        public long budget;
        public Pointer masks;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "found", "verdict", "reserved", "vertex_face_count",
        "vertex_face_capacity", "vertex_faces", "edge_edge_count", "edge_edge_capacity",
        "edge_edges", "stats", "vertex_bounds"})
    public static class sc_near_result extends Structure {
        public int struct_size = size(), found, verdict, reserved;
        public long vertex_face_count, vertex_face_capacity;
        public Pointer vertex_faces;
        public long edge_edge_count, edge_edge_capacity;
        public Pointer edge_edges, stats, vertex_bounds;
        int at(String member) { return fieldOffset(member); }
    }

    /** Where an edge passes through a triangle; NO_EDGE is in place of an edge or of sheets. */
    @Structure.FieldOrder({"edge", "triangle", "sheet", "sheets", "reserved", "along", "weights",
        "point"})
    public static class sc_trace_node extends Structure {
        public static final int NO_EDGE = -1;
        public int edge, triangle, sheet;
        public int[] sheets = new int[2];
        public int reserved;
        public double along;
        public double[] weights = new double[3], point = new double[3];
        int at(String member) { return fieldOffset(member); }
    }

    /** A contour's nodes, first to first + count - 1, where it begins and ends, and its length. */
    @Structure.FieldOrder({"first", "count", "begin", "end", "flags", "reserved", "length"})
    public static class sc_trace_contour extends Structure {
        public static final int CLOSED = 0, BORDER = 1, BRANCH = 2, VERTEX = 3; // begin and end
        public static final int ONE_SHEET = 1; // in flags
        public long first, count;
        public int begin, end, flags, reserved;
        public double length;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "simd", "allocator", "hooks", "tasks", "cancel"})
    public static class sc_trace_options extends Structure {
        public int struct_size = size(), simd;
        public Pointer allocator, hooks, tasks, cancel;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "reserved", "node_count", "node_capacity", "nodes",
        "contour_count", "contour_capacity", "contours"})
    public static class sc_trace_result extends Structure {
        public int struct_size = size(), reserved;
        public long node_count, node_capacity;
        public Pointer nodes;
        public long contour_count, contour_capacity;
        public Pointer contours;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"category", "mask"})
    public static class sc_group extends Structure {
        public int category, mask;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"model", "workspace", "pose", "end", "pose_version", "group", "itself",
        "reserved", "filter", "vertex_face_filter", "edge_edge_filter", "rest", "rest_distance", "masks"})
    public static class sc_object extends Structure {
        public Pointer model, workspace, pose, end;
        public long pose_version;
        public sc_group group;
        public int itself, reserved;
        public Pointer filter, vertex_face_filter, edge_edge_filter, rest;
        public double rest_distance;
        public Pointer masks;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "count", "objects", "stride", "accept", "accept_user",
        "accept_near"})
    public static class sc_objects extends Structure {
        public int struct_size = size(), count;
        public Pointer objects;
        public long stride;
        public Pointer accept, accept_user, accept_near;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"object_a", "object_b", "first", "count"})
    public static class sc_object_pairs extends Structure {
        public int object_a, object_b;
        public long first, count;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "collides", "count", "capacity", "pairs", "range_count",
        "range_capacity", "ranges", "stats", "verdict", "reserved"})
    public static class sc_objects_result extends Structure {
        public int struct_size = size(), collides;
        public long count, capacity;
        public Pointer pairs;
        public long range_count, range_capacity;
        public Pointer ranges, stats;
        public int verdict, reserved;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"count", "capacity", "pairs", "times", "range_count", "range_capacity",
        "ranges"})
    public static class sc_object_list extends Structure {
        public long count, capacity;
        public Pointer pairs, times;
        public long range_count, range_capacity;
        public Pointer ranges;
        int at(String member) { return fieldOffset(member); }
    }

    @Structure.FieldOrder({"struct_size", "collides", "vertex_faces", "edge_edges", "stats", "earliest",
        "verdict", "reserved"})
    public static class sc_objects_lists extends Structure {
        public int struct_size = size(), collides;
        public sc_object_list vertex_faces, edge_edges;
        public Pointer stats;
        public double earliest;
        public int verdict, reserved;
        int at(String member) { return fieldOffset(member); }
    }

    /** What the library refused. */
    public static final class Refused extends RuntimeException {
        final int status;
        Refused(int status) {
            super(Starcontour.C.sc_status_string(status));
            this.status = status;
        }
    }

    static void check(int status) {
        if (status != 0) throw new Refused(status);
    }

    static ByteBuffer direct(int bytes) {
        return ByteBuffer.allocateDirect(bytes).order(ByteOrder.nativeOrder());
    }

    static Pointer address(ByteBuffer buffer) {
        return Native.getDirectBufferPointer(buffer);
    }

    static final Cleaner cleaner = Cleaner.create();

    /** A mesh made ready for queries: immutable, shared by threads, freed once nothing refers to it. */
    static final class Model {
        final Pointer handle;

        Model(ByteBuffer positions, ByteBuffer triangles) {
            sc_mesh mesh = new sc_mesh();
            mesh.vertex_count = positions.capacity() / 12;
            mesh.triangle_count = triangles.capacity() / 12;
            mesh.positions = address(positions);
            mesh.indices = address(triangles);
            PointerByReference out = new PointerByReference();
            check(Starcontour.C.sc_build(mesh, null, out));
            Pointer made = out.getValue();
            handle = made;
            cleaner.register(this, () -> Starcontour.C.sc_model_free(made));
        }
    }

    /** What queries write to; belongs to one call at a time. */
    static final class Workspace {
        final Model model;
        final Pointer handle;
        static final int FOR_STEPS = 1, FOR_NEAR = 2;
        private static final int LENDS_ROOM = 4;
        ByteBuffer pairs = direct(8 * 16);
        ByteBuffer faces = direct(8 * 16), edges = direct(8 * 16);
        private int nodeRoom = 16, contourRoom = 4;

        Workspace(Model model) {
            this(model, 0);
        }

        /** For more than queries: FOR_STEPS, or FOR_NEAR, which is for both. */
        Workspace(Model model, int flags) {
            this(model, flags, null);
        }

        /** room: null, or a workspace that lends its room. */
        private Workspace(Model model, int flags, Workspace room) {
            this.model = model;
            sc_workspace_options options = new sc_workspace_options();
            options.flags = flags;
            options.room = room == null ? null : room.handle;
            PointerByReference out = new PointerByReference();
            check(Starcontour.C.sc_workspace_create_for(model.handle, options, out));
            Pointer made = out.getValue();
            handle = made;
            cleaner.register(this, () -> Starcontour.C.sc_workspace_free(made));
        }

        List<String> query(ByteBuffer positions) {
            long count = find(positions, null);
            return listOf(pairs, count);
        }

        /** Fills pairs, and returns how many there are. */
        private long find(ByteBuffer positions, sc_query_options options) {
            sc_pose pose = poseOf(positions);
            sc_result result = new sc_result();
            for (;;) {
                result.capacity = pairs.capacity() / 8;
                result.pairs = address(pairs);
                int status = Starcontour.C.sc_query(model.handle, handle, pose, options, result);
                if (status != 11) {
                    check(status);
                    return result.count;
                }
                pairs = direct(8 * Math.toIntExact(result.count));
            }
        }

        /** What collides on the way from one pose to another, coming as near as separation. */
        Features step(ByteBuffer start, ByteBuffer end, double separation) {
            sc_step_options options = new sc_step_options();
            options.separation = separation;
            options.times = 2;
            sc_pose from = poseOf(start), to = poseOf(end);
            sc_step_result result = new sc_step_result();
            for (;;) {
                ByteBuffer faceTimes = direct(faces.capacity()), edgeTimes = direct(edges.capacity());
                result.vertex_face_capacity = faces.capacity() / 8;
                result.vertex_faces = address(faces);
                result.vertex_face_times = address(faceTimes);
                result.edge_edge_capacity = edges.capacity() / 8;
                result.edge_edges = address(edges);
                result.edge_edge_times = address(edgeTimes);
                int status = Starcontour.C.sc_query_step(
                    model.handle, handle, from, to, options, result);
                if (status != 11) {
                    check(status);
                    Features found = new Features(faces, result.vertex_face_count, edges,
                        result.edge_edge_count);
                    for (int i = 0; i < result.vertex_face_count; ++i) {
                        found.times.add(faceTimes.getDouble(8 * i));
                    }
                    for (int i = 0; i < result.edge_edge_count; ++i) {
                        found.times.add(edgeTimes.getDouble(8 * i));
                    }
                    found.earliest = result.earliest;
                    return found;
                }
                makeRoom(result.vertex_face_count, result.edge_edge_count);
            }
        }

        /** What is within a distance in a pose, in units of the coordinates. */
        Features near(ByteBuffer positions, double distance) {
            sc_near_options options = new sc_near_options();
            options.distance = distance;
            sc_pose pose = poseOf(positions);
            sc_near_result result = new sc_near_result();
            for (;;) {
                result.vertex_face_capacity = faces.capacity() / 8;
                result.vertex_faces = address(faces);
                result.edge_edge_capacity = edges.capacity() / 8;
                result.edge_edges = address(edges);
                int status = Starcontour.C.sc_query_near(model.handle, handle, pose, options, result);
                if (status != 11) {
                    check(status);
                    return new Features(faces, result.vertex_face_count, edges, result.edge_edge_count);
                }
                makeRoom(result.vertex_face_count, result.edge_edge_count);
            }
        }

        /** Contours of the intersections in a pose; its pairs of edges and triangles are found first. */
        Contours trace(ByteBuffer positions) {
            sc_query_options edgePairs = new sc_query_options();
            edgePairs.pairs = 1;
            long count = find(positions, edgePairs);
            sc_pose pose = poseOf(positions);
            sc_trace_options options = new sc_trace_options();
            sc_trace_result result = new sc_trace_result();
            for (;;) {
                sc_trace_node[] nodes = (sc_trace_node[]) new sc_trace_node().toArray(nodeRoom);
                sc_trace_contour[] contours =
                    (sc_trace_contour[]) new sc_trace_contour().toArray(contourRoom);
                result.node_capacity = nodeRoom;
                result.nodes = nodes[0].getPointer();
                result.contour_capacity = contourRoom;
                result.contours = contours[0].getPointer();
                int status = Starcontour.C.sc_trace(
                    model.handle, pose, address(pairs), count, options, result);
                if (status != 11) {
                    check(status);
                    return new Contours(nodes, result.node_count, contours, result.contour_count);
                }
                nodeRoom = Math.max(nodeRoom, Math.toIntExact(result.node_count));
                contourRoom = Math.max(contourRoom, Math.toIntExact(result.contour_count));
            }
        }

        private void makeRoom(long faceCount, long edgeCount) {
            faces = direct(Math.max(faces.capacity(), Math.toIntExact(8 * faceCount)));
            edges = direct(Math.max(edges.capacity(), Math.toIntExact(8 * edgeCount)));
        }
    }

    /** Pairs of a vertex and a triangle, and of two edges 3 t + k; of a step their times. */
    static final class Features {
        final List<String> faces, edges;
        final List<Double> times = new ArrayList<>();
        double earliest;

        Features(ByteBuffer faces, long faceCount, ByteBuffer edges, long edgeCount) {
            this.faces = listOf(faces, faceCount);
            this.edges = listOf(edges, edgeCount);
        }
    }

    /** Contours of a pose; each names its first node and how many it has. */
    static final class Contours {
        final List<sc_trace_node> nodes;
        final List<sc_trace_contour> contours;

        Contours(sc_trace_node[] nodes, long nodeCount, sc_trace_contour[] contours,
            long contourCount) {
            this.nodes = read(nodes, nodeCount);
            this.contours = read(contours, contourCount);
        }

        private static <T extends Structure> List<T> read(T[] array, long count) {
            List<T> all = Arrays.asList(array).subList(0, (int) count);
            all.forEach(Structure::read);
            return all;
        }
    }

    /** Several objects, which may share models; belongs to one call at a time. */
    static final class Scene {
        /** An object. Buffers are read in place and stay as they are until they are set again. */
        static final class Placed {
            final Workspace workspace;
            boolean itself = true;
            int category, mask; // its group; 0 and 0: it collides with all
            private ByteBuffer pose, end;
            private long version;

            private Placed(Model model, int flags, Workspace room) {
                workspace = new Workspace(model, flags, room);
            }

            /** Where it is, of a step at its start. */
            void setPose(ByteBuffer positions) {
                pose = positions;
                ++version;
            }

            /** Of a step, where it is at its end; null, as at first: where it began. */
            void setEnd(ByteBuffer positions) {
                end = positions;
                ++version;
            }
        }

        /** Arrays for one list. */
        private static final class Room {
            ByteBuffer pairs = direct(8 * 16), times = direct(8 * 16), ranges = direct(24);

            void give(sc_object_list list, boolean timed) {
                list.capacity = pairs.capacity() / 8;
                list.pairs = address(pairs);
                list.times = timed ? address(times) : null;
                list.range_capacity = ranges.capacity() / 24;
                list.ranges = address(ranges);
            }

            void fit(sc_object_list list) {
                int bytes = Math.max(pairs.capacity(), Math.toIntExact(8 * list.count));
                pairs = direct(bytes);
                times = direct(bytes);
                ranges = direct(Math.max(ranges.capacity(), Math.toIntExact(24 * list.range_count)));
            }

            List<Meeting> meetings(sc_object_list list, boolean timed) {
                List<Meeting> found = new ArrayList<>();
                for (int i = 0; i < list.range_count; ++i) {
                    Meeting one = new Meeting(ranges.getInt(24 * i), ranges.getInt(24 * i + 4));
                    int first = Math.toIntExact(ranges.getLong(24 * i + 8));
                    for (int k = first; k < first + ranges.getLong(24 * i + 16); ++k) {
                        one.pairs.add(new int[] {pairs.getInt(8 * k), pairs.getInt(8 * k + 4)});
                        if (timed) one.times.add(times.getDouble(8 * k));
                    }
                    found.add(one);
                }
                return found;
            }
        }

        private interface Question {
            int ask(sc_objects objects, sc_objects_lists lists);
        }

        private final int flags;
        private final List<Placed> objects = new ArrayList<>();
        private final Room faces = new Room(), edges = new Room();
        /** Of models that several objects have: whose room all but the first of them use. */
        private final Map<Model, Workspace> lenders = new HashMap<>();

        /** For queries (0), or for more: Workspace.FOR_STEPS, or FOR_NEAR, which is for both. */
        Scene(int flags) {
            this.flags = flags;
        }

        /** A new object, which needs a pose before anything is asked. */
        Placed add(Model model) {
            objects.add(new Placed(model, flags, lenderFor(model)));
            return objects.get(objects.size() - 1);
        }

        private Workspace lenderFor(Model model) {
            if (objects.stream().noneMatch(one -> one.workspace.model == model)) return null;
            return lenders.computeIfAbsent(model,
                it -> new Workspace(it, flags | Workspace.LENDS_ROOM, null));
        }

        /** What intersects. */
        List<Meeting> query() {
            return ask(false, (all, lists) -> {
                sc_objects_result result = new sc_objects_result();
                result.capacity = lists.vertex_faces.capacity;
                result.pairs = lists.vertex_faces.pairs;
                result.range_capacity = lists.vertex_faces.range_capacity;
                result.ranges = lists.vertex_faces.ranges;
                int status = Starcontour.C.sc_query_objects(all, null, result);
                lists.vertex_faces.count = result.count;
                lists.vertex_faces.range_count = result.range_count;
                return status;
            }).faces;
        }

        /** What is within a distance, in units of the coordinates. */
        FeatureMeetings near(double distance) {
            sc_near_options options = new sc_near_options();
            options.distance = distance;
            return ask(false, (all, lists) -> Starcontour.C.sc_query_objects_near(all, options, lists));
        }

        /** What comes as near as separation while objects move from their pose to their end. */
        FeatureMeetings step(double separation) {
            sc_step_options options = new sc_step_options();
            options.separation = separation;
            options.times = 2;
            return ask(true, (all, lists) -> Starcontour.C.sc_query_objects_step(all, options, lists));
        }

        private FeatureMeetings ask(boolean moves, Question question) {
            List<sc_pose> poses = new ArrayList<>();
            sc_objects all = new sc_objects();
            if (!objects.isEmpty()) {
                sc_object[] array = (sc_object[]) new sc_object().toArray(objects.size());
                for (int i = 0; i < array.length; ++i) {
                    Placed one = objects.get(i);
                    array[i].model = one.workspace.model.handle;
                    array[i].workspace = one.workspace.handle;
                    array[i].pose = written(one.pose, poses);
                    array[i].end = written(moves ? one.end : null, poses);
                    array[i].pose_version = one.version;
                    array[i].group.category = one.category;
                    array[i].group.mask = one.mask;
                    array[i].itself = one.itself ? 1 : 0;
                    array[i].write();
                }
                all.count = array.length;
                all.objects = array[0].getPointer();
            }
            sc_objects_lists lists = new sc_objects_lists();
            for (;;) {
                faces.give(lists.vertex_faces, moves);
                edges.give(lists.edge_edges, moves);
                int status = question.ask(all, lists);
                if (status != 11) {
                    check(status);
                    Reference.reachabilityFence(poses);
                    return new FeatureMeetings(faces.meetings(lists.vertex_faces, moves),
                        edges.meetings(lists.edge_edges, moves), lists.earliest);
                }
                faces.fit(lists.vertex_faces);
                edges.fit(lists.edge_edges);
            }
        }

        private static Pointer written(ByteBuffer positions, List<sc_pose> poses) {
            if (positions == null) return null;
            sc_pose pose = poseOf(positions);
            pose.write();
            poses.add(pose);
            return pose.getPointer();
        }
    }

    /** What two objects have with each other, or one with itself: pairs of what is a's and b's. */
    static final class Meeting {
        final int a, b;
        final List<int[]> pairs = new ArrayList<>();
        final List<Double> times = new ArrayList<>();

        Meeting(int a, int b) {
            this.a = a;
            this.b = b;
        }
    }

    /** Meetings of a vertex and a triangle, and of two edges 3 t + k. */
    static final class FeatureMeetings {
        final List<Meeting> faces, edges;
        final double earliest; // of a step: nothing collides before

        FeatureMeetings(List<Meeting> faces, List<Meeting> edges, double earliest) {
            this.faces = faces;
            this.edges = edges;
            this.earliest = earliest;
        }
    }

    static sc_pose poseOf(ByteBuffer positions) {
        sc_pose pose = new sc_pose();
        pose.vertex_count = positions.capacity() / 12;
        pose.positions = address(positions);
        return pose;
    }

    static List<String> listOf(ByteBuffer pairs, long count) {
        List<String> found = new ArrayList<>();
        for (int i = 0; i < count; ++i) {
            found.add(Integer.toUnsignedString(pairs.getInt(8 * i)) + " "
                + Integer.toUnsignedString(pairs.getInt(8 * i + 4)));
        }
        return found;
    }

    static int passed, failed;

    static void expect(String what, boolean condition) {
        if (condition) {
            ++passed;
        } else {
            ++failed;
            System.out.println("failed: " + what);
        }
    }

    static boolean refused(int status, String text, Runnable call) {
        try {
            call.run();
        } catch (Refused e) {
            return e.status == status && e.getMessage().contains(text);
        }
        return false;
    }

    static boolean close(double a, double b) {
        return Math.abs(a - b) <= 1e-12 * b;
    }

    /**
     * The contours are those of the golden file: nodes, and of contours number of nodes, begin, end
     * and length.
     */
    static boolean same(Contours found, Map<String, List<String>> golden) {
        List<String> wanted = golden.get("contour");
        boolean right = wanted.size() == found.contours.size();
        for (int i = 0; right && i < wanted.size(); ++i) {
            sc_trace_contour one = found.contours.get(i);
            int last = wanted.get(i).lastIndexOf(' ');
            right = wanted.get(i).substring(0, last).equals(one.count + " " + one.begin + " " + one.end)
                && close(one.length, Double.parseDouble(wanted.get(i).substring(last)));
        }
        return right && found.nodes.stream()
            .map(node -> Integer.toUnsignedString(node.edge) + " "
                + Integer.toUnsignedString(node.triangle))
            .collect(Collectors.toList()).equals(golden.get("node"));
    }

    /** Nodes follow each other contour after contour, and so does the length of their segments. */
    static boolean lengthsFit(Contours found) {
        int next = 0;
        for (sc_trace_contour contour : found.contours) {
            if (contour.first != next) return false;
            double length = 0;
            int segments = (int) contour.count - (contour.begin == sc_trace_contour.CLOSED ? 0 : 1);
            for (int i = 0; i < segments; ++i) {
                double[] p = found.nodes.get(next + i).point;
                double[] q = found.nodes.get(next + (i + 1) % (int) contour.count).point;
                double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
                length += Math.sqrt(x * x + y * y + z * z);
            }
            if (!close(length, contour.length)) return false;
            next += (int) contour.count;
        }
        return next == found.nodes.size();
    }

    interface Offset {
        int at(String member);
    }

    /** Each structure has the members of the header, no more and no fewer, at their places. */
    static void expectLayout(List<String> layout, String name, Structure structure, Offset offset) {
        List<String> own = new ArrayList<>();
        own.add("struct " + name + " " + structure.size());
        for (String member : structure.getClass().getAnnotation(Structure.FieldOrder.class).value()) {
            own.add("member " + name + " " + member + " " + offset.at(member));
        }
        List<String> header = layout.stream().map(line -> line.split(" "))
            .filter(words -> words[1].equals(name))
            .map(words -> String.join(" ", List.of(words).subList(0, Math.min(4, words.length))))
            .collect(Collectors.toList());
        expect(name + " is laid out as in the header", header.equals(own));
    }

    /**
     * Meetings as pairs of the one mesh of two objects, sorted; firstA, firstB: the numbers there
     * of what is the second object's first.
     */
    static List<String> joined(List<Meeting> meetings, int firstA, int firstB) {
        return meetings.stream()
            .flatMap(m -> m.pairs.stream().map(p -> new int[] {p[0] + m.a * firstA, p[1] + m.b * firstB}))
            .sorted((p, q) -> p[0] != q[0] ? p[0] - q[0] : p[1] - q[1])
            .map(p -> p[0] + " " + p[1]).collect(Collectors.toList());
    }

    /** The mesh's two cloths, halves of its arrays, have as two objects the pairs that the mesh has. */
    static void expectScene(ByteBuffer rest, ByteBuffer moved, ByteBuffer triangles,
        Map<String, List<String>> golden) {
        int vertices = rest.capacity() / 24, half = triangles.capacity() / 24;
        ByteBuffer second = direct(12 * half);
        for (int i = 0; i < 3 * half; ++i) {
            second.putInt(4 * i, triangles.getInt(12 * half + 4 * i) - vertices);
        }
        Model[] models = {new Model(rest.slice(0, 12 * vertices), triangles.slice(0, 12 * half)),
            new Model(rest.slice(12 * vertices, 12 * vertices), second)};
        Scene scene = new Scene(Workspace.FOR_NEAR);
        Scene.Placed[] objects = {scene.add(models[0]), scene.add(models[1])};
        expect("objects without a pose", refused(1, "NULL", scene::query));
        for (int i = 0; i < 2; ++i) {
            objects[i].setPose(rest.slice(i * 12 * vertices, 12 * vertices));
            objects[i].setEnd(moved.slice(i * 12 * vertices, 12 * vertices));
        }
        expect("pairs of two objects", joined(scene.query(), half, half).equals(golden.get("rest")));
        FeatureMeetings step = scene.step(0);
        expect("a step of two objects",
            joined(step.faces, vertices, half).equals(golden.get("stepfaces"))
                && joined(step.edges, 3 * half, 3 * half).equals(golden.get("stepedges")));
        double first = Stream.concat(step.faces.stream(), step.edges.stream())
            .flatMap(m -> m.times.stream()).min(Double::compare).orElse(1.0);
        expect("at their times", step.earliest > 0 && step.earliest == first);
        for (int i = 0; i < 2; ++i) {
            objects[i].setPose(moved.slice(i * 12 * vertices, 12 * vertices));
        }
        FeatureMeetings near = scene.near(0.045);
        expect("near of two objects",
            joined(near.faces, vertices, half).equals(golden.get("nearfaces"))
                && joined(near.edges, 3 * half, 3 * half).equals(golden.get("nearedges")));
        expect("pairs when they moved", joined(scene.query(), half, half).equals(golden.get("moved")));

        objects[0].category = objects[0].mask = 1;
        objects[1].category = objects[1].mask = 2;
        expect("groups of objects", scene.query().isEmpty());
        ByteBuffer flat = direct(12 * vertices);
        objects[0].setPose(flat);
        expect("an object and itself", scene.query().size() == 1
            && joined(scene.query(), 0, 0).equals(new Workspace(models[0]).query(flat)));
        objects[0].itself = false;
        expect("an object without itself", scene.query().isEmpty());

        Scene copies = new Scene(Workspace.FOR_NEAR);
        ByteBuffer away = direct(12 * vertices);
        for (int i = 0; i < 3 * vertices; ++i) away.putFloat(4 * i, rest.getFloat(4 * i) + 100);
        for (int i = 0; i < 2; ++i) {
            copies.add(models[0]).setPose(rest.slice(i * 12 * vertices, 12 * vertices));
        }
        copies.add(models[0]).setPose(away);
        expect("objects of one model, which have one room",
            joined(copies.query(), half, half).equals(golden.get("rest"))
                && copies.lenders.size() == 1);
    }

    public static void main(String[] arguments) throws Exception {
        List<float[]> vertices = new ArrayList<>();
        List<int[]> faces = new ArrayList<>();
        for (String line : Files.readAllLines(Path.of(arguments[0]))) {
            String[] w = line.split(" +");
            if (w[0].equals("v")) {
                vertices.add(new float[] {
                    Float.parseFloat(w[1]), Float.parseFloat(w[2]), Float.parseFloat(w[3])});
            } else if (w[0].equals("f")) {
                faces.add(new int[] {
                    Integer.parseInt(w[1]) - 1, Integer.parseInt(w[2]) - 1, Integer.parseInt(w[3]) - 1});
            }
        }
        int n = vertices.size();
        ByteBuffer rest = direct(12 * n), moved = direct(12 * n), triangles = direct(12 * faces.size());
        for (int i = 0; i < n; ++i) {
            float[] p = vertices.get(i);
            for (int k = 0; k < 3; ++k) {
                rest.putFloat(12 * i + 4 * k, p[k]);
                moved.putFloat(12 * i + 4 * k, p[k] + (k == 2 && i >= n / 2 ? p[0] / 4 - 0.25f : 0));
            }
        }
        for (int[] face : faces) {
            for (int v : face) triangles.putInt(v);
        }
        Map<String, List<String>> golden = new HashMap<>();
        for (String line : Files.readAllLines(Path.of(arguments[1]))) {
            if (line.startsWith("#")) continue;
            String[] w = line.split(" ", 2);
            golden.computeIfAbsent(w[0], pose -> new ArrayList<>()).add(w[1]);
        }
        expect("there is something to compare", !golden.get("rest").equals(golden.get("moved")));

        List<String> layout = Files.readAllLines(Path.of(arguments[2]));
        sc_mesh mesh = new sc_mesh();
        expectLayout(layout, "sc_mesh", mesh, mesh::at);
        sc_pose pose = new sc_pose();
        expectLayout(layout, "sc_pose", pose, pose::at);
        sc_query_options queryOptions = new sc_query_options();
        expectLayout(layout, "sc_query_options", queryOptions, queryOptions::at);
        sc_result result = new sc_result();
        expectLayout(layout, "sc_result", result, result::at);
        sc_workspace_options spaceOptions = new sc_workspace_options();
        expectLayout(layout, "sc_workspace_options", spaceOptions, spaceOptions::at);
        sc_step_options stepOptions = new sc_step_options();
        expectLayout(layout, "sc_step_options", stepOptions, stepOptions::at);
        sc_step_result stepResult = new sc_step_result();
        expectLayout(layout, "sc_step_result", stepResult, stepResult::at);
        sc_near_options nearOptions = new sc_near_options();
        expectLayout(layout, "sc_near_options", nearOptions, nearOptions::at);
        sc_near_result nearResult = new sc_near_result();
        expectLayout(layout, "sc_near_result", nearResult, nearResult::at);
        sc_trace_node node = new sc_trace_node();
        expectLayout(layout, "sc_trace_node", node, node::at);
        sc_trace_contour contour = new sc_trace_contour();
        expectLayout(layout, "sc_trace_contour", contour, contour::at);
        sc_trace_options traceOptions = new sc_trace_options();
        expectLayout(layout, "sc_trace_options", traceOptions, traceOptions::at);
        sc_trace_result traceResult = new sc_trace_result();
        expectLayout(layout, "sc_trace_result", traceResult, traceResult::at);
        expect("constants of contours are the header's", layout.stream()
            .filter(line -> line.startsWith("value SC_TRACE_")).collect(Collectors.toSet())
            .equals(Set.of("value SC_TRACE_CLOSED " + sc_trace_contour.CLOSED,
                "value SC_TRACE_BORDER " + sc_trace_contour.BORDER,
                "value SC_TRACE_BRANCH " + sc_trace_contour.BRANCH,
                "value SC_TRACE_VERTEX " + sc_trace_contour.VERTEX,
                "value SC_TRACE_ONE_SHEET " + sc_trace_contour.ONE_SHEET,
                "value SC_TRACE_NO_EDGE " + Integer.toUnsignedString(sc_trace_node.NO_EDGE))));

        sc_group group = new sc_group();
        expectLayout(layout, "sc_group", group, group::at);
        sc_object object = new sc_object();
        expectLayout(layout, "sc_object", object, object::at);
        sc_objects objects = new sc_objects();
        expectLayout(layout, "sc_objects", objects, objects::at);
        sc_object_pairs ranges = new sc_object_pairs();
        expectLayout(layout, "sc_object_pairs", ranges, ranges::at);
        sc_objects_result objectsResult = new sc_objects_result();
        expectLayout(layout, "sc_objects_result", objectsResult, objectsResult::at);
        sc_object_list list = new sc_object_list();
        expectLayout(layout, "sc_object_list", list, list::at);
        sc_objects_lists lists = new sc_objects_lists();
        expectLayout(layout, "sc_objects_lists", lists, lists::at);

        Model model = new Model(rest, triangles);
        Workspace workspace = new Workspace(model);
        expect("pairs at rest", workspace.query(rest).equals(golden.get("rest")));
        expect("pairs when moved", workspace.query(moved).equals(golden.get("moved")));

        Contours traced = workspace.trace(rest);
        expect("contours at rest", same(traced, golden) && !traced.contours.isEmpty());
        expect("lengths of contours", lengthsFit(traced));
        traced = workspace.trace(moved);
        expect("contours when moved", !same(traced, golden) && lengthsFit(traced));

        boolean[] right = {true, true};
        Thread[] threads = new Thread[2];
        for (int i = 0; i < 2; ++i) {
            int own = i;
            threads[i] = new Thread(() -> {
                Workspace mine = new Workspace(model);
                for (int k = 0; k < 100; ++k) {
                    right[own] &= mine.query(own == 0 ? rest : moved)
                        .equals(golden.get(own == 0 ? "rest" : "moved"));
                }
            });
            threads[i].start();
        }
        for (Thread thread : threads) thread.join();
        expect("two threads, one model", right[0] && right[1]);

        Workspace larger = new Workspace(model, Workspace.FOR_NEAR);
        Features near = larger.near(moved, 0.045);
        expect("pairs that are near", near.faces.equals(golden.get("nearfaces"))
            && near.edges.equals(golden.get("nearedges")));
        Features step = larger.step(rest, moved, 0);
        expect("pairs of a step", step.faces.equals(golden.get("stepfaces"))
            && step.edges.equals(golden.get("stepedges")));
        expect("at their times", step.earliest > 0
            && step.times.size() == step.faces.size() + step.edges.size()
            && step.times.stream().allMatch(time -> time >= step.earliest));
        expect("a step that is free", larger.step(moved, moved, 0).earliest == 1);
        expect("a distance below 0", refused(3, "option", () -> larger.near(moved, -1)));
        expect("no room for steps", refused(12, "workspace", () -> workspace.step(rest, moved, 0)));

        expectScene(rest, moved, triangles, golden);

        moved.putFloat(4, Float.NaN);
        expect("NaN", refused(8, "NaN", () -> workspace.query(moved)));
        expect("contours of NaN", refused(8, "NaN", () -> workspace.trace(moved)));
        expect("number of vertices", refused(9, "vert", () -> workspace.query(direct(12 * (n - 1)))));
        expect("no triangles", refused(4, "triangle", () -> new Model(rest, direct(0))));
        triangles.putInt(0, n);
        expect("vertex out of range", refused(7, "vertex", () -> new Model(rest, triangles)));
        expect("usable after errors", workspace.query(rest).equals(golden.get("rest")));

        System.out.println("java: " + passed + " passed, " + failed + " failed");
        System.exit(failed == 0 ? 0 : 1);
    }
}
