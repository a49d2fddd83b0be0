/*
 * Meshes far from the origin, where floats are too coarse: for files of each format and byte order
 * sc-query and sc-partition answer what the oracle says of the file's decimals, rounded to doubles;
 * and of floats where the file has floats.
 *
 * The programs are those of SC_BIN (build/bin by hand). Without them nothing is checked but that.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "oracle.h"
#include "starcontour.h"

enum { VERTICES = 30, TRIANGLES = 60, NUMBERS = 3 * VERTICES, CORNERS = 3 * TRIANGLES };

/* A mesh as decimals, and what they are as doubles. */
typedef struct far_mesh {
    char text[NUMBERS][32];
    double positions[NUMBERS];
    uint32_t triangles[CORNERS];
} far_mesh;

typedef enum far_format {
    OBJ,
    OFF,
    STL_TEXT,
    PLY_TEXT,
    PLY_TEXT_FLOAT, /* the header says float, the decimals say more */
    PLY_LITTLE,
    PLY_BIG,
    FIRST_OF_FLOATS,
    PLY_LITTLE_FLOAT = FIRST_OF_FLOATS,
    PLY_BIG_FLOAT,
    STL_BINARY,
    FORMATS
} far_format;

static const char *const format_names[FORMATS] = {"far.obj",
                                                  "far.off",
                                                  "far_text.stl",
                                                  "far_text.ply",
                                                  "far_text_float.ply",
                                                  "far_little.ply",
                                                  "far_big.ply",
                                                  "far_little_float.ply",
                                                  "far_big_float.ply",
                                                  "far_binary.stl"};

/* Where meshes are, how large, and how many digits follow the point. */
static const struct place {
    const char *name;
    double origin[3], size;
    int digits;
} places[] = {{"UTM", {500000, 5400000, 100}, 0.5, 3},
              {"a planet", {6.4e6, -6.4e6, 6.4e6}, 4, 2},
              {"a part of 10 cm at 1e7", {1e7, 1e7, 1e7}, 0.1, 4},
              {"near", {0, 0, 0}, 1, 6}};

enum { PLACES = 4, NEAR = 3 };

static void set_numbers(far_mesh *mesh, const struct place *place)
{
    for (int i = 0; i < NUMBERS; ++i) {
        const double at = place->origin[i % 3] + test_random_range(0, place->size);
        snprintf(mesh->text[i], sizeof(mesh->text[i]), "%.*f", place->digits, at);
        mesh->positions[i] = strtod(mesh->text[i], NULL);
    }
}

static void make_mesh(far_mesh *mesh, const struct place *place)
{
    for (int t = 0; t < TRIANGLES; ++t) {
        uint32_t *v = mesh->triangles + 3 * t;
        v[0] = test_random_below(VERTICES);
        do v[1] = test_random_below(VERTICES);
        while (v[1] == v[0]);
        do v[2] = test_random_below(VERTICES);
        while (v[2] == v[0] || v[2] == v[1]);
    }
    set_numbers(mesh, place);
}

/* ---- files ---- */

static char folder[64];

static const char *in_folder(const char *name)
{
    static char paths[8][128];
    static int next;
    char *path = paths[next++ % 8];
    snprintf(path, sizeof(paths[0]), "%s/%s", folder, name);
    return path;
}

static void put(FILE *file, uint64_t bits, int size, int big)
{
    for (int i = 0; i < size; ++i) fputc((int)(bits >> 8 * (big ? size - 1 - i : i) & 0xff), file);
}

static void put_number(FILE *file, double value, int single, int big)
{
    const float narrow = (float)value;
    uint32_t low;
    uint64_t bits;
    memcpy(&low, &narrow, sizeof(low));
    memcpy(&bits, &value, sizeof(bits));
    put(file, single ? low : bits, single ? 4 : 8, big);
}

static void write_ply(FILE *file, const far_mesh *mesh, far_format format)
{
    const int text = format == PLY_TEXT || format == PLY_TEXT_FLOAT;
    const int big = format == PLY_BIG || format == PLY_BIG_FLOAT;
    const int single =
        format == PLY_TEXT_FLOAT || format == PLY_LITTLE_FLOAT || format == PLY_BIG_FLOAT;
    const char *type = single ? "float" : "double";
    fprintf(file,
            "ply\nformat %s 1.0\nelement vertex %d\nproperty %s x\nproperty %s y\nproperty %s z\n"
            "element face %d\nproperty list uchar int vertex_indices\nend_header\n",
            text  ? "ascii"
            : big ? "binary_big_endian"
                  : "binary_little_endian",
            VERTICES, type, type, type, TRIANGLES);
    for (int i = 0; i < NUMBERS; ++i) {
        if (text)
            fprintf(file, "%s%c", mesh->text[i], i % 3 == 2 ? '\n' : ' ');
        else
            put_number(file, mesh->positions[i], single, big);
    }
    for (int t = 0; t < TRIANGLES; ++t) {
        const uint32_t *v = mesh->triangles + 3 * t;
        if (text) {
            fprintf(file, "3 %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", v[0], v[1], v[2]);
            continue;
        }
        put(file, 3, 1, big);
        for (int k = 0; k < 3; ++k) put(file, v[k], 4, big);
    }
}

static void write_stl(FILE *file, const far_mesh *mesh, int text)
{
    if (text) {
        fprintf(file, "solid far\n");
    } else {
        fprintf(file, "%-80s", "solid and yet binary");
        put(file, TRIANGLES, 4, 0);
    }
    for (int t = 0; t < TRIANGLES; ++t) {
        if (text)
            fprintf(file, "facet normal 0 0 0\nouter loop\n");
        else
            for (int k = 0; k < 3; ++k) put(file, 0, 4, 0);
        for (int c = 0; c < 3; ++c) {
            const size_t v = 3 * (size_t)mesh->triangles[3 * t + c];
            if (text)
                fprintf(file, "vertex %s %s %s\n", mesh->text[v], mesh->text[v + 1],
                        mesh->text[v + 2]);
            else
                for (size_t k = 0; k < 3; ++k) put_number(file, mesh->positions[v + k], 1, 0);
        }
        if (text)
            fprintf(file, "endloop\nendfacet\n");
        else
            put(file, 0, 2, 0);
    }
    if (text) fprintf(file, "endsolid far\n");
}

static void write_lines(FILE *file, const far_mesh *mesh, int off)
{
    if (off) fprintf(file, "OFF\n%d %d 0\n", VERTICES, TRIANGLES);
    for (int i = 0; i < NUMBERS; i += 3)
        fprintf(file, "%s%s %s %s\n", off ? "" : "v ", mesh->text[i], mesh->text[i + 1],
                mesh->text[i + 2]);
    for (int t = 0; t < TRIANGLES; ++t) {
        const uint32_t *v = mesh->triangles + 3 * t, one = off ? 0 : 1;
        fprintf(file, "%s %" PRIu32 " %" PRIu32 " %" PRIu32 "\n", off ? "3" : "f", v[0] + one,
                v[1] + one, v[2] + one);
    }
}

static void write_mesh(const far_mesh *mesh, far_format format, const char *path)
{
    FILE *file = fopen(path, "wb");
    if (!CHECK_MSG(file != NULL, "%s", path)) return;
    if (format == OBJ || format == OFF)
        write_lines(file, mesh, format == OFF);
    else if (format == STL_TEXT || format == STL_BINARY)
        write_stl(file, mesh, format == STL_TEXT);
    else
        write_ply(file, mesh, format);
    CHECK(fclose(file) == 0);
}

/* ---- answers ---- */

static const char *programs(void)
{
    const char *bin = getenv("SC_BIN");
    return bin ? bin : "build/bin";
}

static int are_there(void)
{
    char path[512];
    FILE *file;
    snprintf(path, sizeof(path), "%s/sc-query", programs());
    file = fopen(path, "rb");
    if (file) fclose(file);
    if (!file) test_note("skipped: sc-query was not built");
    return file != NULL;
}

/* Makes the folder, or removes it with what is in it. */
static void begin(void)
{
    char line[128];
    FILE *pipe = popen("mktemp -d", "r");
    folder[0] = '\0';
    if (pipe && fgets(line, sizeof(line), pipe)) sscanf(line, "%63s", folder);
    if (pipe) pclose(pipe);
    CHECK(folder[0] == '/');
}

static void end(void)
{
    char command[128];
    snprintf(command, sizeof(command), "rm -rf '%s'", folder);
    if (folder[0] == '/') CHECK(system(command) == 0);
}

/* Runs a program; its exit status, or -1. */
static int run(const char *program, const char *arguments)
{
    char command[2048];
    int status;
    snprintf(command, sizeof(command), "timeout 60 '%s/%s' %s >'%s/out' 2>&1", programs(), program,
             arguments, folder);
    status = system(command);
    return status < 0 ? -1 : status >> 8;
}

/* The last two numbers of each line but the first, or the two before the time. */
static uint64_t read_pairs(int is_step, sc_pair *pairs, uint64_t capacity)
{
    char line[512];
    uint64_t count = 0;
    FILE *file = fopen(in_folder("pairs.csv"), "r");
    if (!file || !fgets(line, sizeof(line), file)) line[0] = '\0';
    while (file && fgets(line, sizeof(line), file)) {
        char *at = strrchr(line, ',');
        if (is_step && at) *at = '\0', at = strrchr(line, ',');
        while (at && at > line && *--at != ',') continue;
        if (count < capacity && at &&
            sscanf(at, ",%" SCNu32 ",%" SCNu32, &pairs[count].a, &pairs[count].b) == 2)
            ++count;
    }
    if (file) fclose(file);
    return count;
}

enum { PAIRS_MOST = TRIANGLES * TRIANGLES };

static uint64_t checked, told_apart; /* queries, and of these such that floats would answer else */

/* The oracle's pairs of a mesh whose vertices are joined by the rest pose. */
static void solve(const far_mesh *mesh, const double *rest, int single, oracle_answer *answer)
{
    double positions[NUMBERS], rested[NUMBERS];
    uint32_t weld[VERTICES];
    for (int i = 0; i < NUMBERS; ++i) {
        positions[i] = single ? (double)(float)mesh->positions[i] : mesh->positions[i];
        rested[i] = rest ? rest[i] : positions[i];
    }
    oracle_weld(rested, VERTICES, mesh->triangles, TRIANGLES, weld);
    oracle_solve(positions, VERTICES, mesh->triangles, TRIANGLES, weld, answer);
}

/* Asks sc-query with these arguments, which write pairs.csv, about a mesh. */
static void check_query(const far_mesh *mesh, const double *rest, int single, const char *arguments)
{
    static sc_pair pairs[PAIRS_MOST];
    oracle_answer answer, other;
    solve(mesh, rest, single, &answer);
    solve(mesh, rest, 1, &other);
    const oracle_list *list = &answer.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    const oracle_list *floats = &other.lists[SC_PAIRS_TRIANGLE][SC_CONTACT_TOUCHING];
    remove(in_folder("pairs.csv"));
    const int status = run("sc-query", arguments);
    const uint64_t count = read_pairs(0, pairs, PAIRS_MOST);
    CHECK_MSG(status == (list->count ? 1 : 0), "%s: status %d", arguments, status);
    CHECK_MSG(count == list->count &&
                  (!count || memcmp(pairs, list->pairs, (size_t)count * sizeof(*pairs)) == 0),
              "%s: %" PRIu64 " pairs, the oracle has %" PRIu64, arguments, count, list->count);
    ++checked;
    told_apart += list->count != floats->count ||
                  (list->count &&
                   memcmp(list->pairs, floats->pairs, (size_t)list->count * sizeof(*pairs)) != 0);
    oracle_free(&answer);
    oracle_free(&other);
}

/* Floats at which different vertices may be one are no pose of a mesh that has them apart. */
static int stays_apart(const far_mesh *mesh)
{
    for (int a = 0; a < NUMBERS; a += 3)
        for (int b = 0; b < a; b += 3)
            if (memcmp(mesh->positions + a, mesh->positions + b, 3 * sizeof(double)) == 0) return 0;
    return 1;
}

static void files_of_each_format(void)
{
    char arguments[1024];
    if (!are_there()) return;
    begin();
    checked = told_apart = 0;
    for (int place = 0; place < PLACES; ++place) {
        for (int format = 0; format < FORMATS; ++format) {
            far_mesh mesh;
            const char *path = in_folder(format_names[format]);
            make_mesh(&mesh, &places[place]);
            write_mesh(&mesh, (far_format)format, path);
            snprintf(arguments, sizeof(arguments), "--out '%s' '%s'", in_folder("pairs.csv"), path);
            check_query(&mesh, NULL, format >= FIRST_OF_FLOATS, arguments);
        }
    }
    CHECK_MSG(told_apart >= FIRST_OF_FLOATS, "only %" PRIu64 " of %" PRIu64 " differ", told_apart,
              checked);
    end();
}

/* A mesh is built near the origin and asked about far from it, and the other way round. */
static void rest_meshes_and_models(void)
{
    char arguments[1024];
    if (!are_there()) return;
    begin();
    checked = told_apart = 0;
    for (int place = 0; place < PLACES; ++place) {
        for (int format = 0; format < FORMATS; ++format) {
            const int other = (format + 1 + place) % FORMATS;
            const int is_stl = format == STL_TEXT || format == STL_BINARY;
            const far_format rest_format = is_stl ? STL_BINARY
                                           : other == STL_TEXT || other == STL_BINARY
                                               ? PLY_BIG_FLOAT
                                               : (far_format)other;
            far_mesh rest, pose;
            make_mesh(&rest, &places[place % 2 ? place : NEAR]);
            pose = rest;
            set_numbers(&pose, &places[place % 2 ? NEAR : place]);
            if (!stays_apart(&rest)) continue;
            const char *rest_path = in_folder(is_stl ? "rest.stl" : format_names[rest_format]);
            char rest_copy[160];
            snprintf(rest_copy, sizeof(rest_copy), "%s/rest%s", folder, strrchr(rest_path, '.'));
            write_mesh(&rest, rest_format, rest_copy);
            const char *path = in_folder(format_names[format]);
            write_mesh(&pose, (far_format)format, path);
            double rested[NUMBERS];
            for (int i = 0; i < NUMBERS; ++i)
                rested[i] = rest_format >= FIRST_OF_FLOATS ? (double)(float)rest.positions[i]
                                                           : rest.positions[i];
            far_mesh shown = rest;
            memcpy(shown.positions, rested, sizeof(rested));
            if (!stays_apart(&shown)) continue; /* its floats weld what the pose has apart */
            snprintf(arguments, sizeof(arguments), "--rest '%s' --out '%s' '%s'", rest_copy,
                     in_folder("pairs.csv"), path);
            check_query(&pose, rested, format >= FIRST_OF_FLOATS, arguments);
            snprintf(arguments, sizeof(arguments), "-o '%s' '%s'", in_folder("model.scm"),
                     rest_copy);
            CHECK_MSG(run("sc-partition", arguments) == 0, "%s", arguments);
            snprintf(arguments, sizeof(arguments), "--model '%s' --out '%s' '%s'",
                     in_folder("model.scm"), in_folder("pairs.csv"), path);
            check_query(&pose, rested, format >= FIRST_OF_FLOATS, arguments);
        }
    }
    CHECK_MSG(checked >= 40 && told_apart >= 8, "%" PRIu64 " of %" PRIu64 " differ", told_apart,
              checked);
    end();
}

/* What the library says of a step between these doubles. */
static uint64_t ask_step(const far_mesh *from, const far_mesh *to)
{
    uint64_t count = UINT64_MAX;
    sc_mesh mesh;
    sc_pose start, stop;
    sc_workspace_options how;
    sc_step_options options;
    sc_step_result result;
    sc_model *model = NULL;
    sc_workspace *workspace = NULL;
    memset(&mesh, 0, sizeof(mesh));
    memset(&start, 0, sizeof(start));
    memset(&how, 0, sizeof(how));
    memset(&options, 0, sizeof(options));
    memset(&result, 0, sizeof(result));
    mesh.struct_size = sizeof(mesh);
    mesh.vertex_count = start.vertex_count = VERTICES;
    mesh.triangle_count = TRIANGLES;
    mesh.position_type = start.position_type = SC_DOUBLE;
    mesh.index_type = SC_UINT32;
    mesh.positions = start.positions = from->positions;
    mesh.indices = from->triangles;
    start.struct_size = sizeof(start);
    stop = start;
    stop.positions = to->positions;
    how.struct_size = sizeof(how);
    how.flags = SC_WORKSPACE_STEP;
    options.struct_size = sizeof(options);
    options.output = SC_OUTPUT_COUNT;
    result.struct_size = sizeof(result);
    if (sc_build(&mesh, NULL, &model) == SC_OK &&
        sc_workspace_create_for(model, &how, &workspace) == SC_OK &&
        sc_query_step(model, workspace, &start, &stop, &options, &result) == SC_OK)
        count = result.vertex_face_count + result.edge_edge_count;
    sc_workspace_free(workspace);
    sc_model_free(model);
    return count;
}

/* Frames of different formats, of which some have floats. */
static void frames_of_steps(void)
{
    static sc_pair pairs[64 * PAIRS_MOST];
    char arguments[1024];
    if (!are_there()) return;
    begin();
    told_apart = 0;
    for (int place = 0; place < PLACES; ++place) {
        for (int format = 0; format < FORMATS; ++format) {
            if (format == STL_TEXT || format == STL_BINARY)
                continue; /* others have other vertices */
            far_mesh from, to, rounded, coarse;
            make_mesh(&from, &places[place]);
            to = from;
            for (int i = 0; i < NUMBERS; ++i) { /* a small motion */
                snprintf(to.text[i], sizeof(to.text[i]), "%.*f", places[place].digits + 1,
                         from.positions[i] + test_random_range(0, 0.02 * places[place].size));
                to.positions[i] = strtod(to.text[i], NULL);
            }
            const char *first = in_folder("first.obj"), *second = in_folder(format_names[format]);
            write_mesh(&from, OBJ, first);
            write_mesh(&to, (far_format)format, second);
            rounded = to;
            coarse = from;
            for (int i = 0; i < NUMBERS; ++i) {
                rounded.positions[i] = (double)(float)to.positions[i];
                coarse.positions[i] = (double)(float)from.positions[i];
            }
            const uint64_t wanted = ask_step(&from, format >= FIRST_OF_FLOATS ? &rounded : &to);
            told_apart += ask_step(&coarse, &rounded) != wanted;
            if (!stays_apart(&from)) continue;
            remove(in_folder("pairs.csv"));
            snprintf(arguments, sizeof(arguments), "--step --out '%s' '%s' '%s'",
                     in_folder("pairs.csv"), first, second);
            const int status = run("sc-query", arguments);
            CHECK_MSG(status == (wanted ? 1 : 0), "%s: status %d", arguments, status);
            const uint64_t count = read_pairs(1, pairs, sizeof(pairs) / sizeof(pairs[0]));
            CHECK_MSG(count == wanted, "%s: %" PRIu64 " in place of %" PRIu64, arguments, count,
                      wanted);
        }
    }
    CHECK(told_apart > 4);
    end();
}

/* What --ply writes of a mesh of doubles is the same mesh. */
static void meshes_that_are_written(void)
{
    char arguments[1024];
    if (!are_there()) return;
    begin();
    checked = told_apart = 0;
    for (int place = 0; place < PLACES; ++place) {
        for (int by_partition = 0; by_partition < 2; ++by_partition) {
            far_mesh mesh;
            const char *from = in_folder("far.obj"), *to = in_folder("written.ply");
            make_mesh(&mesh, &places[place]);
            if (!stays_apart(&mesh)) continue;
            write_mesh(&mesh, OBJ, from);
            snprintf(arguments, sizeof(arguments), "--ply '%s' %s '%s'", to,
                     by_partition ? "--level 0" : "", from);
            const int status = run(by_partition ? "sc-partition" : "sc-query", arguments);
            CHECK_MSG(status == 0 || (!by_partition && status == 1), "%s", arguments);
            snprintf(arguments, sizeof(arguments), "--out '%s' '%s'", in_folder("pairs.csv"), to);
            check_query(&mesh, NULL, 0, arguments);
        }
    }
    CHECK(checked >= 4 && told_apart >= 2);
    end();
}

SC_TEST_MAIN(SC_TEST(files_of_each_format), SC_TEST(rest_meshes_and_models),
             SC_TEST(frames_of_steps), SC_TEST(meshes_that_are_written))
