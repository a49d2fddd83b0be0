/*
 * The command line of sc-query; see query_options.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_options.h"

#include "near_report.h"
#include "query_text.h"

#include <getopt.h>
#include <string.h>

static const char usage[] =
    "Usage: sc-query [options] MESH...\n"
    "       sc-query --step [options] MESH MESH... | PATTERN\n"
    "       sc-query --near D [options] MESH... | PATTERN\n"
    "       sc-query --trace [options] MESH... | PATTERN\n"
    "       sc-query --jsonl FILE [options] --manifest LIST | MESH...\n"
    "Finds every self-collision of triangle meshes, exactly.\n"
    "\n"
    "Reads OBJ, OFF, PLY, STL and all other formats that assimp reads, packed by gzip or not; - "
    "is\n"
    "standard input. Vertices at equal positions are joined, polygons triangulated, points and "
    "lines\n"
    "left out. The answer is exact for the nearest doubles to the file's coordinates; what only "
    "assimp\n"
    "reads may be rounded to floats, and the table and --json say so. Vertices and triangles are\n"
    "numbered from 0 in the order of the file (assimp: of the scene's meshes).\n"
    "\n"
    "  --format obj|off|ply|stl    the format of -, and of files whose names tell none\n"
    "What is sought\n"
    "  --pairs triangle|edge|none  the pairs that --out and --ply show and that decide the exit\n"
    "                              status: of triangles (default), or of an edge and a triangle "
    "that\n"
    "                              share no vertex; none: only count, triangles decide\n"
    "  --proper                    only edges' interiors that pass through triangles' interiors;\n"
    "                              without it touching is enough\n"
    "  --only self-collisions      no places and no defects besides: the row alone, soonest\n"
    "  --any                       stop at the first pair: whether there is one, not how many\n"
    "  --weld rest|none            join vertices at equal positions (default), or take them as "
    "they\n"
    "                              are read, which for some formats (STL) is one a corner of a "
    "face\n"
    "  --rest MESH                 build once from MESH; the files are poses of it, with the same\n"
    "                              vertices and faces in the same order\n"
    "  --model FILE                the same, with the model that sc-partition -o wrote\n"
    "  --replay FILE               in place of meshes: the query that --record wrote, with its "
    "options,\n"
    "                              or the step or search for what is near\n"
    "What collides on the way from each MESH to the next\n"
    "  --step                      the files are frames, two or more, in which every vertex moves "
    "on "
    "a\n"
    "                              straight line: vertex-face and edge-edge pairs that meet, when "
    "the\n"
    "                              first does, and how many candidates there were, but not what\n"
    "                              is through itself from start to end. One pattern such as\n"
    "                              f%04d.obj is all files with numbers from 0 or 1\n"
    "  --separation D              that come as near as D, in units of the coordinates (0)\n"
    "  --tolerance T               of distances (a millionth of the size); pairs up to D + T apart "
    "may\n"
    "                              be among those reported, and none up to D is missing\n"
    "  --times                     each pair with its time, from 0 to 1\n";

static const char usage_near[] =
    "What is near in each MESH\n"
    "  --near D                    vertex-face and edge-edge pairs that share no vertex and are D "
    "or\n"
    "                              less apart, exactly; D in units of the coordinates, 0: that "
    "touch.\n"
    "                              One pattern such as f%04d.obj is all frames, poses of the "
    "first\n"
    "  --kinds both|vertex-face|edge-edge  which pairs are sought (both)\n"
    "  --list                      each pair with its distance\n"
    "  --stencils                  each with its closest points, too: the kind of feature, "
    "VERTEX:WEIGHT\n"
    "                              and the vector from one to the other; with --step at the start "
    "of\n"
    "                              the step and at the pair's time, with the normal there\n"
    "  --thickness                 of each face the least distance, up to D, to what no path of "
    "edges\n"
    "                              shorter than 2 D joins it with: a histogram and percentiles, "
    "with\n"
    "                              --json of all faces, with --ply in colours\n"
    "Along which curves each MESH intersects itself\n"
    "  --trace                     its contours, the longest first: length, nodes, whether closed "
    "or how\n"
    "                              it begins and ends; with --list all, not five; with --json all "
    "nodes;\n"
    "                              --ply writes them as lines, and --html and --png show them "
    "with\n"
    "                              the parts of the surface between them. A pattern as with "
    "--near\n";

/* In four: C99 has strings of up to 4095 characters. */
static const char usage_continued[] =
    "Which pairs are left out\n"
    "  --ignore-rings N            those less than N edges of the mesh apart; 1: that share a "
    "vertex\n"
    "  --ignore FILE               those in FILE, as --out writes them; only --pairs are sought "
    "then\n"
    "  --ignore-rest R             of --step and --near: those within R of each other in the mesh "
    "of\n"
    "                              --rest, else in the first frame\n"
    "  --groups FILE               those whose groups do not collide. Lines: triangle|vertex\n"
    "                              FIRST[-LAST] CATEGORY MASK; a category has to be in the other's "
    "mask\n"
    "Output\n"
    "  --json                      a JSON object a line for each file, in place of the table;\n"
    "                              starcontour.schema.json describes them\n"
    "  --out FILE                  write the pairs as comma-separated values, with the faces and\n"
    "                              objects of the file that they belong to. An edge is a number\n"
    "                              3 t + k: from vertex k to vertex k + 1 (mod 3) of triangle t\n"
    "  --ply FILE                  write the mesh with colliding triangles coloured by the places\n"
    "                              they are of, with --near by distance; one MESH only\n"
    "  --html FILE                 write a page to look at: the mesh turns, places are listed, "
    "and\n"
    "                              files with the same faces are frames of an animation; also "
    "with\n"
    "                              --trace\n"
    "  --png FILE                  write three views as a picture, by a Chromium that is there; "
    "one\n"
    "                              MESH only\n"
    "  --contacts                  where each pair meets, and how: a point, a segment, or an area\n"
    "  --stats                     time and count of the nine tasks of the query\n"
    "  --record FILE               write the query, with model, pose, options and filter, to "
    "report\n"
    "                              a bug; one MESH only, with --step two\n"
    "Many meshes, also with --near: each read by a process of its own, whose end is a line, not "
    "the run's\n"
    "  --jsonl FILE                append a JSON object a line, whole, in the order of the meshes; "
    "no\n"
    "                              times, so that every run writes the same bytes\n"
    "  --manifest LIST             the meshes, or poses of --rest or --model: a file a line\n"
    "  --shard I/N                 only part I of N, from 1 on; the files of all parts, in order, "
    "are\n"
    "                              together that of a run over all\n"
    "  --resume                    go on where a run that was ended stopped\n"
    "  --jobs N                    meshes at a time (1)\n"
    "  --limit-seconds S           processor time for a mesh (600), and ten times as long by the "
    "clock;\n"
    "                              0: no limit\n"
    "  --limit-memory MB           address space for a mesh (0: no limit)\n"
    "  --timings                   with build_ms and query_ms, and --stats if asked for\n";

static const char usage_end[] =
    "How it is sought (the answer is the same, but for --contour none)\n"
    "  --method auto|sctt|aabb-sctt|aabb  self-collision test tree, boxes from that tree on, or "
    "the\n"
    "                              plain tree of boxes. auto (default): for a mesh asked about "
    "once\n"
    "                              the plain tree alone, which is built fastest; sctt with "
    "--rest,\n"
    "                              --model, --record, --stats, --budget or what follows\n"
    "                              With --step: sctt (default), two-boxes or swept, plain trees "
    "of\n"
    "                              boxes at both ends, or round the motion. With --near: auto, "
    "sctt\n"
    "                              or boxes\n"
    "  --contour exact|star|none   contour test of method sctt: is the contour simple (default), "
    "the\n"
    "                              star test, or none, which MISSES PAIRS and is for measuring\n"
    "  --partition fast|metis      where the patches come from\n"
    "  --no-rest-cache             test again what failed in the rest pose\n"
    "  --budget N                  stop each query after N tests; what was found so far is "
    "shown\n"
    "  --threads K                 threads that building and a query use (1)\n"
    "\n"
    "  -V, --version, -h, --help\n"
    "\n"
    "Exit status: 0 no self-collision, 1 at least one, 2 something could not be done; the reason "
    "is\n"
    "on standard error. 3: a --budget ended a query, whether it had found any or not.\n";

const tool_choice query_pair_choices[] = {
    {"triangle", SC_PAIRS_TRIANGLE}, {"edge", SC_PAIRS_EDGE}, {"none", 2}, {NULL, 0}};
const tool_choice query_method_choices[] = {{"auto", SC_METHOD_DEFAULT},
                                            {"sctt", SC_METHOD_SCTT},
                                            {"aabb-sctt", SC_METHOD_AABB_SCTT},
                                            {"aabb", SC_METHOD_AABB},
                                            {NULL, 0}};
/* What --only leaves. */
static const tool_choice only_choices[] = {{"self-collisions", 1}, {NULL, 0}};

/* What --method auto is, where models are built: boxes alone pay for one query. */
static void choose_method(query_settings *set)
{
    const bool is_once = !set->rest_path && !set->model_path && !set->replay_path;
    const bool is_plain = set->contour == SC_CONTOUR_DEFAULT && !set->no_rest_cache &&
                          set->partition == TOOL_PARTITION_FAST && !set->record_path &&
                          !set->stats && !set->budget;
    if (set->method == SC_METHOD_DEFAULT && is_once && is_plain) {
        set->content = SC_MODEL_BOXES;
        set->method = SC_METHOD_AABB;
    } else if (set->method == SC_METHOD_DEFAULT && (is_once || set->rest_path)) {
        set->method = SC_METHOD_SCTT;
    }
    if (set->contour != SC_CONTOUR_DEFAULT && set->method == SC_METHOD_DEFAULT)
        set->method = SC_METHOD_SCTT;
    if (set->contour == SC_CONTOUR_DEFAULT) set->contour = SC_CONTOUR_EXACT;
}

/* --method, which has other values with --step and --near. */
static bool choose_method_named(query_settings *set)
{
    if (set->is_step)
        return tool_choose("--method", set->method_name, step_methods, &set->step.method);
    if (set->is_near)
        return tool_choose("--method", set->method_name, near_methods, &set->near.method);
    return tool_choose("--method", set->method_name, query_method_choices, &set->method);
}

/* Reads i/n, the part of a list that is to be done. */
static bool read_shard(const char *text, uint32_t *part, uint32_t *count)
{
    const char *slash = strchr(text, '/');
    char number[16] = "";
    if (slash && (size_t)(slash - text) < sizeof number)
        memcpy(number, text, (size_t)(slash - text));
    if (!tool_parse_number("--shard i/n", slash ? slash + 1 : "", 1, UINT32_MAX, count))
        return false;
    return tool_parse_number("--shard i/n", number, 1, *count, part);
}

/* Of many meshes, what cannot be asked for. */
static const char *check_batch(const query_settings *set)
{
    if (!set->jsonl_path)
        return set->is_batch ? "--manifest, --shard, --resume, --jobs, --timings and limits are of "
                               "--jsonl"
                             : NULL;
    if (set->manifest_path && set->path_count > 0)
        return "--manifest is in place of meshes on the command line";
    if (set->is_step || set->out_path || set->ply_path || set->html_path || set->png_path ||
        set->record_path || set->replay_path)
        return "--jsonl does not go with --step, --out, --ply, --html, --png, --record or --replay";
    if (set->near.list || set->near.stencils)
        return "--list and --stencils are too long for lines of --jsonl";
    if (set->is_near && set->model_path && set->step.ignores_rest)
        return "--jsonl with --model has no rest pose for --ignore-rest; --rest has one";
    if (set->threads > 1) return "--jsonl has --jobs, meshes at a time, in place of --threads";
    if (set->stats && !set->timings) return "--stats are times, which --jsonl has with --timings";
    return NULL;
}

/* What cannot be asked for together. */
static bool check_settings(const query_settings *set)
{
    const int path_count = set->path_count;
    const char *reason = NULL;
    if (set->is_step && set->not_of_steps) {
        tool_error("--step does not go with --%s; see sc-query --help", set->not_of_steps);
        return false;
    }
    if (set->is_near && set->not_of_near) {
        tool_error("--near does not go with --%s; see sc-query --help", set->not_of_near);
        return false;
    }
    if (set->is_trace && set->not_of_trace) {
        tool_error("--trace does not go with --%s; see sc-query --help", set->not_of_trace);
        return false;
    }
    if (set->replay_path &&
        (path_count > 0 || set->rest_path || set->model_path || set->record_path))
        reason = "--replay takes no mesh, rest mesh or model, and makes no record";
    else if (set->replay_path && set->is_asked)
        reason = "--replay asks what the record asks, and as it does";
    else if (set->replay_path && (set->ply_path || set->html_path || set->png_path))
        reason = "--replay has no faces for --ply, --html or --png";
    else if (set->is_step_asked && !set->is_step)
        reason = "--separation, --tolerance and --times are of --step";
    else if (set->step.ignores_rest && !set->is_step && !set->is_near)
        reason = "--ignore-rest is of --step and --near";
    else if (set->is_near_asked && !set->is_near)
        reason = "--kinds and --thickness are of --near";
    else if (set->near.list && !set->is_near && !set->is_trace)
        reason = "--list is of --near and --trace";
    else if (set->near.stencils && !set->is_near && !set->is_step)
        reason = "--stencils is of --near and --step";
    else if ((set->near.list || set->near.stencils) && set->any)
        reason = "--any finds no list";
    else if (set->near.thickness && (set->any || set->budget))
        reason = "--thickness takes all pairs: it does not go with --any or --budget";
    else if (set->near.thickness && set->near.distance == 0)
        reason = "--thickness is found up to the distance of --near, which has to be more than 0";
    else if (set->step.times && set->any)
        reason = "--any finds no times";
    else if (path_count == 0 && !set->replay_path && !set->manifest_path)
        reason = "no mesh given";
    else if (set->model_path && (set->rest_path || set->is_built))
        reason = "--model is in place of --rest, --weld and --partition";
    else if (set->record_path && path_count > (set->is_step ? 2 : 1))
        reason = "--record takes one mesh only, or the two frames of a step";
    else if (query_wants_list(set) && set->any)
        reason = "--any finds no list for --out, --ply, --html, --png or --contacts";
    else if (query_wants_list(set) && set->pairs == 2)
        reason = "--pairs none leaves no list for --out, --ply, --html, --png or --contacts";
    else if (set->ply_path && path_count > 1)
        reason = "--ply takes one mesh only";
    else if (set->png_path && set->html_path)
        reason = "--png and --html do not go together";
    else if (set->png_path && path_count > 1)
        reason = "--png takes one mesh only";
    else
        reason = check_batch(set);
    if (!reason) return true;
    tool_error("%s; see sc-query --help", reason);
    return false;
}

/* No file that is to be read is written over. */
static bool spares_files(const query_settings *set)
{
    const char *const out[] = {set->out_path,   set->ply_path,  set->record_path,
                               set->jsonl_path, set->html_path, set->png_path};
    for (int i = 0; i < 6; i++) {
        if (!tool_spares(out[i], set->rest_path) || !tool_spares(out[i], set->model_path) ||
            !tool_spares(out[i], set->replay_path) || !tool_spares(out[i], set->groups_path) ||
            !tool_spares(out[i], set->manifest_path))
            return false;
        for (int path = 0; path < set->path_count; path++) {
            if (!tool_spares(out[i], set->paths[path])) return false;
        }
    }
    return true;
}

int query_options_read(int argc, char **argv, query_settings *set)
{
    enum {
        OPTION_PAIRS = 256,
        OPTION_PROPER,
        OPTION_STEP,
        OPTION_SEPARATION,
        OPTION_TOLERANCE,
        OPTION_TIMES,
        OPTION_NEAR,
        OPTION_KINDS,
        OPTION_LIST,
        OPTION_STENCILS,
        OPTION_THICKNESS,
        OPTION_TRACE,
        OPTION_ANY,
        OPTION_ONLY,
        OPTION_HTML,
        OPTION_PNG,
        OPTION_WELD,
        OPTION_REST,
        OPTION_JSON,
        OPTION_OUT,
        OPTION_PLY,
        OPTION_MODEL,
        OPTION_RECORD,
        OPTION_REPLAY,
        OPTION_STATS,
        OPTION_METHOD,
        OPTION_CONTOUR,
        OPTION_PARTITION,
        OPTION_NO_REST_CACHE,
        OPTION_IGNORE_RINGS,
        OPTION_IGNORE,
        OPTION_IGNORE_REST,
        OPTION_GROUPS,
        OPTION_CONTACTS,
        OPTION_BUDGET,
        OPTION_THREADS,
        OPTION_FORMAT,
        OPTION_JSONL,
        OPTION_MANIFEST,
        OPTION_SHARD,
        OPTION_RESUME,
        OPTION_TIMINGS,
        OPTION_JOBS,
        OPTION_LIMIT_SECONDS,
        OPTION_LIMIT_MEMORY,
        OPTION_VERSION = 'V',
        OPTION_HELP = 'h'
    };
    static const struct option options[] = {
        {"pairs", required_argument, NULL, OPTION_PAIRS},
        {"proper", no_argument, NULL, OPTION_PROPER},
        {"any", no_argument, NULL, OPTION_ANY},
        {"only", required_argument, NULL, OPTION_ONLY},
        {"html", required_argument, NULL, OPTION_HTML},
        {"png", required_argument, NULL, OPTION_PNG},
        {"step", no_argument, NULL, OPTION_STEP},
        {"separation", required_argument, NULL, OPTION_SEPARATION},
        {"tolerance", required_argument, NULL, OPTION_TOLERANCE},
        {"times", no_argument, NULL, OPTION_TIMES},
        {"near", required_argument, NULL, OPTION_NEAR},
        {"kinds", required_argument, NULL, OPTION_KINDS},
        {"list", no_argument, NULL, OPTION_LIST},
        {"stencils", no_argument, NULL, OPTION_STENCILS},
        {"thickness", no_argument, NULL, OPTION_THICKNESS},
        {"trace", no_argument, NULL, OPTION_TRACE},
        {"weld", required_argument, NULL, OPTION_WELD},
        {"rest", required_argument, NULL, OPTION_REST},
        {"json", no_argument, NULL, OPTION_JSON},
        {"out", required_argument, NULL, OPTION_OUT},
        {"ply", required_argument, NULL, OPTION_PLY},
        {"model", required_argument, NULL, OPTION_MODEL},
        {"record", required_argument, NULL, OPTION_RECORD},
        {"replay", required_argument, NULL, OPTION_REPLAY},
        {"stats", no_argument, NULL, OPTION_STATS},
        {"method", required_argument, NULL, OPTION_METHOD},
        {"contour", required_argument, NULL, OPTION_CONTOUR},
        {"partition", required_argument, NULL, OPTION_PARTITION},
        {"no-rest-cache", no_argument, NULL, OPTION_NO_REST_CACHE},
        {"ignore-rings", required_argument, NULL, OPTION_IGNORE_RINGS},
        {"ignore", required_argument, NULL, OPTION_IGNORE},
        {"ignore-rest", required_argument, NULL, OPTION_IGNORE_REST},
        {"groups", required_argument, NULL, OPTION_GROUPS},
        {"contacts", no_argument, NULL, OPTION_CONTACTS},
        {"budget", required_argument, NULL, OPTION_BUDGET},
        {"threads", required_argument, NULL, OPTION_THREADS},
        {"format", required_argument, NULL, OPTION_FORMAT},
        {"jsonl", required_argument, NULL, OPTION_JSONL},
        {"manifest", required_argument, NULL, OPTION_MANIFEST},
        {"shard", required_argument, NULL, OPTION_SHARD},
        {"resume", no_argument, NULL, OPTION_RESUME},
        {"timings", no_argument, NULL, OPTION_TIMINGS},
        {"jobs", required_argument, NULL, OPTION_JOBS},
        {"limit-seconds", required_argument, NULL, OPTION_LIMIT_SECONDS},
        {"limit-memory", required_argument, NULL, OPTION_LIMIT_MEMORY},
        {"version", no_argument, NULL, OPTION_VERSION},
        {"help", no_argument, NULL, OPTION_HELP},
        {NULL, 0, NULL, 0}};

    memset(set, 0, sizeof *set);
    set->step.method = SC_STEP_METHOD_SCTT;
    bool valid = true;
    uint32_t budget = 0, only = 0, format = MESH_FORMAT_UNKNOWN;
    set->threads = set->shard = set->shard_count = set->jobs = 1;
    set->limits.seconds = BATCH_SECONDS;
    int option, which = 0;
    while ((option = getopt_long(argc, argv, "hV", options, &which)) != -1) {
        if (option == OPTION_PAIRS || option == OPTION_PROPER || option == OPTION_PLY ||
            option == OPTION_REPLAY || option == OPTION_NO_REST_CACHE ||
            option == OPTION_CONTACTS || option == OPTION_ONLY || option == OPTION_HTML ||
            option == OPTION_PNG)
            set->not_of_steps = options[which].name;
        if (option == OPTION_PAIRS || option == OPTION_PROPER || option == OPTION_REPLAY ||
            option == OPTION_NO_REST_CACHE || option == OPTION_ONLY || option == OPTION_HTML ||
            option == OPTION_PNG || option == OPTION_CONTACTS || option == OPTION_CONTOUR ||
            option == OPTION_STEP || option == OPTION_SEPARATION || option == OPTION_TOLERANCE ||
            option == OPTION_TIMES)
            set->not_of_near = options[which].name;
        if (option != OPTION_TRACE && option != OPTION_LIST && option != OPTION_WELD &&
            option != OPTION_REST && option != OPTION_JSON && option != OPTION_PLY &&
            option != OPTION_MODEL && option != OPTION_PARTITION && option != OPTION_THREADS &&
            option != OPTION_HTML && option != OPTION_PNG && option != OPTION_FORMAT &&
            option >= OPTION_PAIRS)
            set->not_of_trace = options[which].name;
        set->is_near_asked |= option == OPTION_KINDS || option == OPTION_THICKNESS;
        set->is_batch |= option >= OPTION_MANIFEST && option <= OPTION_LIMIT_MEMORY;
        set->is_built |= option == OPTION_WELD || option == OPTION_PARTITION;
        set->is_asked |= option == OPTION_PAIRS || option == OPTION_PROPER ||
                         option == OPTION_ANY || option == OPTION_WELD || option == OPTION_METHOD ||
                         option == OPTION_CONTOUR || option == OPTION_PARTITION ||
                         option == OPTION_NO_REST_CACHE || option == OPTION_BUDGET ||
                         option == OPTION_IGNORE_RINGS || option == OPTION_IGNORE ||
                         option == OPTION_GROUPS;
        switch (option) {
        case OPTION_PAIRS:
            valid &= tool_choose("--pairs", optarg, query_pair_choices, &set->pairs);
            break;
        case OPTION_PROPER:
            set->proper = true;
            break;
        case OPTION_STEP:
            set->is_step = true;
            break;
        case OPTION_SEPARATION:
            valid &= tool_parse_real("--separation", optarg, &set->step.separation);
            set->is_step_asked = true;
            break;
        case OPTION_TOLERANCE:
            valid &= tool_parse_real("--tolerance", optarg, &set->step.tolerance);
            if (set->step.tolerance == 0) {
                tool_error("--tolerance: '%s' is not more than 0", optarg);
                valid = false;
            }
            set->is_step_asked = true;
            break;
        case OPTION_TIMES:
            set->step.times = set->is_step_asked = true;
            break;
        case OPTION_NEAR:
            valid &= tool_parse_real("--near", optarg, &set->near.distance);
            set->is_near = true;
            break;
        case OPTION_KINDS:
            valid &= tool_choose("--kinds", optarg, near_kinds, &set->near.kinds);
            break;
        case OPTION_LIST:
            set->near.list = true;
            break;
        case OPTION_STENCILS:
            set->near.stencils = true;
            break;
        case OPTION_THICKNESS:
            set->near.thickness = true;
            break;
        case OPTION_TRACE:
            set->is_trace = true;
            break;
        case OPTION_ANY:
            set->any = true;
            break;
        case OPTION_ONLY:
            valid &= tool_choose("--only", optarg, only_choices, &only);
            set->only_collisions = true;
            break;
        case OPTION_HTML:
            set->html_path = optarg;
            break;
        case OPTION_PNG:
            set->png_path = optarg;
            break;
        case OPTION_WELD:
            valid &= tool_choose("--weld", optarg, tool_welds, &set->weld);
            break;
        case OPTION_REST:
            set->rest_path = optarg;
            break;
        case OPTION_JSON:
            set->json = true;
            break;
        case OPTION_OUT:
            set->out_path = optarg;
            break;
        case OPTION_PLY:
            set->ply_path = optarg;
            break;
        case OPTION_MODEL:
            set->model_path = optarg;
            break;
        case OPTION_RECORD:
            set->record_path = optarg;
            break;
        case OPTION_REPLAY:
            set->replay_path = optarg;
            break;
        case OPTION_STATS:
            set->stats = true;
            break;
        case OPTION_METHOD:
            set->method_name = optarg;
            break;
        case OPTION_CONTOUR:
            valid &= tool_choose("--contour", optarg, query_text_contours, &set->contour);
            break;
        case OPTION_PARTITION:
            valid &= tool_choose("--partition", optarg, tool_partitions, &set->partition);
            break;
        case OPTION_NO_REST_CACHE:
            set->no_rest_cache = true;
            break;
        case OPTION_IGNORE_RINGS:
            valid &=
                tool_parse_number("--ignore-rings", optarg, 0, SC_RINGS_MAX, &set->ignore_rings);
            break;
        case OPTION_IGNORE:
            set->ignore_path = optarg;
            break;
        case OPTION_IGNORE_REST:
            valid &= tool_parse_real("--ignore-rest", optarg, &set->step.ignore_rest);
            set->step.ignores_rest = true;
            break;
        case OPTION_GROUPS:
            set->groups_path = optarg;
            break;
        case OPTION_CONTACTS:
            set->contacts = true;
            break;
        case OPTION_BUDGET:
            valid &= tool_parse_number("--budget", optarg, 1, UINT32_MAX, &budget);
            set->budget = budget;
            break;
        case OPTION_THREADS:
            valid &= tool_parse_number("--threads", optarg, 1, SC_WORKERS_MAX, &set->threads);
            break;
        case OPTION_FORMAT:
            valid &= tool_choose("--format", optarg, tool_formats, &format);
            mesh_file_assume(format);
            break;
        case OPTION_JSONL:
            set->jsonl_path = optarg;
            break;
        case OPTION_MANIFEST:
            set->manifest_path = optarg;
            break;
        case OPTION_SHARD:
            valid &= read_shard(optarg, &set->shard, &set->shard_count);
            break;
        case OPTION_RESUME:
            set->resume = true;
            break;
        case OPTION_TIMINGS:
            set->timings = true;
            break;
        case OPTION_JOBS:
            valid &= tool_parse_number("--jobs", optarg, 1, BATCH_JOBS_MAX, &set->jobs);
            break;
        case OPTION_LIMIT_SECONDS:
            valid &=
                tool_parse_number("--limit-seconds", optarg, 0, 10000000, &set->limits.seconds);
            break;
        case OPTION_LIMIT_MEMORY:
            valid &=
                tool_parse_number("--limit-memory", optarg, 0, UINT32_MAX, &set->limits.megabytes);
            break;
        case OPTION_VERSION:
            printf("sc-query (starcontour) %s\n", sc_version_string());
            return TOOL_CLEAN;
        case OPTION_HELP:
            fputs(usage, stdout);
            fputs(usage_near, stdout);
            fputs(usage_continued, stdout);
            fputs(usage_end, stdout);
            return TOOL_CLEAN;
        default:
            tool_error("see sc-query --help");
            valid = false;
            break;
        }
    }
    if (set->method_name) valid &= choose_method_named(set);
    set->paths = argv + optind;
    set->path_count = argc - optind;
    if (!valid || !check_settings(set) || !spares_files(set)) return TOOL_FAILED;
    choose_method(set);
    if (set->contour == SC_CONTOUR_NONE && !set->is_near &&
        (set->is_step ? set->step.method == SC_STEP_METHOD_SCTT : set->method == SC_METHOD_SCTT)) {
        tool_error("note: --contour none can miss pairs");
    }
    return QUERY_OPTIONS_READ;
}
