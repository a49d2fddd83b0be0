/*
 * Soak: a great many queries on changing poses of one model, on one workspace.
 *
 *     soak [QUERIES]
 *
 * A pose that comes again must get the same answer, by whatever method, and after queries that were
 * cut short or refused; memory must stay where it was after the first round. The model and
 * workspace are in memory of a counting allocator. Exit status 1 if something is wrong.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200112L /* getrusage */

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>

#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

enum { POSES = 250, SIDE = 24, CAPACITY = 1 << 16, SLACK_KILOBYTES = 1024 };

typedef struct answer {
    uint64_t count, hash;
} answer;

static uint64_t allocations;

static void *allocate(void *user, uint64_t size, uint64_t alignment)
{
    void *memory;
    (void)user;
    ++allocations;
    if (alignment < sizeof(void *)) alignment = sizeof(void *);
    return posix_memalign(&memory, (size_t)alignment, (size_t)size) == 0 ? memory : NULL;
}

static void release(void *user, void *memory, uint64_t size)
{
    (void)user;
    (void)size;
    free(memory);
}

static void fail(const char *what, uint64_t query)
{
    printf("soak: query %" PRIu64 ": %s\n", query, what);
    exit(1);
}

static long peak_kilobytes(void)
{
    struct rusage usage;
    return getrusage(RUSAGE_SELF, &usage) == 0 ? usage.ru_maxrss : 0;
}

/* Cloths that twist, wave, are folded flat or crumpled; some are not finite. None is crushed to a
   line: then all pairs touch. */
static void set_pose(const soup *rest, uint32_t pose, double *positions)
{
    size_t size = 3 * (size_t)rest->vertex_count * sizeof(double);
    memcpy(positions, rest->positions, size);
    test_random_reset(pose);
    switch (pose % 5) {
    case 0:
        soup_twist(positions, rest->vertex_count, pose * 0.02);
        break;
    case 1:
        soup_fold(positions, rest->vertex_count);
        break;
    case 2:
        soup_noise(positions, rest->vertex_count, pose * 0.0004);
        break;
    default:
        soup_smooth(positions, rest->vertex_count, pose * 0.002);
        break;
    }
    if (pose % 16 == 15) positions[pose] = pose % 32 == 31 ? HUGE_VAL : (double)NAN;
}

static uint64_t hash_pairs(const sc_pair *pairs, uint64_t count)
{
    uint64_t hash = count;
    for (uint64_t i = 0; i < count; ++i)
        hash = (hash ^ pairs[i].a ^ (uint64_t)pairs[i].b << 32) * UINT64_C(0x9e3779b97f4a7c15);
    return hash;
}

int main(int argc, char **argv)
{
    static sc_pair pairs[CAPACITY];
    static answer answers[POSES][4]; /* by pairs and contact */
    uint64_t queries = argc > 1 ? strtoull(argv[1], NULL, 10) : 100000, compared = 0, after_build;
    long warm = 0, end;
    soup rest = soup_cloth(SIDE, SIDE);
    double *positions = (double *)test_allocate(3 * (size_t)rest.vertex_count * sizeof(double));
    sc_allocator allocator = {allocate, release, NULL};
    sc_build_options build;
    sc_mesh mesh = input_plain_mesh(&rest);
    sc_pose pose = input_plain_pose(positions, rest.vertex_count);
    sc_model *model;
    sc_workspace *workspace;
    memset(&build, 0, sizeof(build));
    build.struct_size = sizeof(build);
    build.allocator = &allocator;
    if (sc_build(&mesh, &build, &model) != SC_OK ||
        sc_workspace_create(model, &allocator, &workspace) != SC_OK)
        fail("no model or workspace", 0);
    after_build = allocations;

    for (uint64_t i = 0; i < queries; ++i) {
        uint32_t number = (uint32_t)(i % POSES), round = (uint32_t)(i / POSES);
        uint32_t kind = (number + round) % 4;
        answer *known = &answers[number][kind];
        sc_query_options o;
        sc_result r;
        sc_status status, expected = SC_OK;
        set_pose(&rest, number, positions);
        memset(&o, 0, sizeof(o));
        o.struct_size = sizeof(o);
        o.pairs = kind / 2;
        o.contact = kind % 2;
        o.method = round / 4 % 4;
        o.rest_cache = round / 16 % 2;
        o.output = round > 4 && round % 7 == 0 ? SC_OUTPUT_ANY : SC_OUTPUT_PAIRS;
        memset(&r, 0, sizeof(r));
        r.struct_size = sizeof(r);
        r.pairs = pairs;
        r.capacity = round < 4 || number % 3 ? CAPACITY : known->count / 2;
        status = sc_query(model, workspace, &pose, &o, &r);
        if (number % 16 == 15) {
            expected = SC_ERROR_NOT_FINITE;
        } else if (o.output == SC_OUTPUT_PAIRS && r.count > r.capacity) {
            expected = SC_ERROR_SHORT_BUFFER;
        }
        if (status != expected || (expected == SC_ERROR_SHORT_BUFFER && r.capacity == CAPACITY))
            fail(sc_status_string(status), i);
        if (round < 4) {
            known->count = r.count;
            known->hash = hash_pairs(pairs, r.count);
        } else {
            if (o.output == SC_OUTPUT_ANY ? r.collides != (known->count > 0)
                                          : r.count != known->count)
                fail("another number of pairs than before", i);
            if (o.output == SC_OUTPUT_PAIRS && status == SC_OK &&
                hash_pairs(pairs, r.count) != known->hash)
                fail("other pairs than before", i);
            ++compared;
        }
        if (i + 1 == 4 * POSES) warm = peak_kilobytes();
    }

    end = peak_kilobytes();
    if (allocations != after_build) fail("queries have allocated", queries);
    if (warm != 0 && end - warm > SLACK_KILOBYTES) fail("memory has grown", queries);
    printf(
        "soak: %" PRIu64 " queries on %d poses of %" PRIu32 " triangles, %" PRIu64
        " compared with earlier answers; peak memory %ld KB after %d queries, %ld KB at the end\n",
        queries, (int)POSES, rest.triangle_count, compared, warm, 4 * (int)POSES, end);
    sc_workspace_free(workspace);
    sc_model_free(model);
    free(positions);
    soup_free(&rest);
    return 0;
}
