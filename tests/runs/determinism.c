/*
 * Prints one hash of all sorted lists of pairs of a set of meshes and poses, by all methods and
 * partitions, which must be the same for every compiler, optimisation and kind of instructions.
 * `make test-determinism` compares. Exit status 1 if a query fails or methods differ.
 *
 *     determinism FILE.obj...
 *
 * SPDX-License-Identifier: MIT
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"
#include "shapes.h"
#include "starcontour.h"

enum { POSES = 6, CAPACITY = 1 << 20, MADE = 30 };

static uint64_t hash = 1, pairs_seen, queries;

static uint64_t mix(uint64_t into, uint64_t number)
{
    into = (into ^ number) * UINT64_C(0x9e3779b97f4a7c15);
    return into ^ into >> 29;
}

static uint64_t hash_of(const sc_pair *pairs, uint64_t count)
{
    uint64_t of = count;
    for (uint64_t i = 0; i < count; ++i) of = mix(of, pairs[i].a ^ (uint64_t)pairs[i].b << 32);
    return of;
}

/* One pose: four lists, each by three methods. */
static void ask(const sc_model *model, sc_workspace *workspace, const sc_pose *pose)
{
    static sc_pair pairs[CAPACITY];
    for (uint32_t kind = 0; kind < 4; ++kind) {
        uint64_t first = 0;
        for (uint32_t way = 0; way < 12; ++way) {
            static const uint32_t contours[4] = {0, SC_CONTOUR_EXACT, 0, 0};
            uint32_t method = way % 4 ? way % 4 : SC_METHOD_SCTT;
            sc_query_options o;
            sc_result r;
            sc_status status;
            memset(&o, 0, sizeof(o));
            o.struct_size = sizeof(o);
            o.pairs = kind / 2;
            o.contact = kind % 2;
            o.method = method;
            o.contour = way % 4 ? contours[way % 4] : SC_CONTOUR_STAR;
            o.simd = SC_SIMD_BASE + way / 4;
            memset(&r, 0, sizeof(r));
            r.struct_size = sizeof(r);
            r.capacity = CAPACITY;
            r.pairs = pairs;
            status = sc_query(model, workspace, pose, &o, &r);
            if (way >= 4 && status == SC_ERROR_UNSUPPORTED) continue; /* not on this machine */
            if (way == 0) first = hash_of(pairs, r.count);
            if (status != SC_OK || hash_of(pairs, r.count) != first) {
                printf("status %d, methods differ or have failed\n", (int)status);
                exit(1);
            }
            pairs_seen += r.count;
            ++queries;
        }
        hash = mix(hash, first);
    }
}

static void ask_all(const soup *rest, uint32_t partition)
{
    size_t size = 3 * (size_t)rest->vertex_count * sizeof(double);
    double *positions = (double *)test_allocate(size);
    sc_mesh mesh = input_plain_mesh(rest);
    sc_pose pose = input_plain_pose(positions, rest->vertex_count);
    input_choices choices = input_choose(rest, SC_WELD_REST, partition);
    sc_model *model;
    sc_workspace *workspace;
    if (sc_build(&mesh, &choices.options, &model) != SC_OK ||
        sc_workspace_create(model, NULL, &workspace) != SC_OK) {
        printf("a mesh cannot be built\n");
        exit(1);
    }
    for (uint32_t i = 0; i < POSES; ++i) {
        memcpy(positions, rest->positions, size);
        /* any pose of a large mesh could be one in which all pairs touch */
        if (i > 0 && rest->triangle_count < 200) soup_any_pose(positions, rest->vertex_count);
        if (i > 1) soup_smooth(positions, rest->vertex_count, 0.1 * i);
        if (i == 4) soup_fold(positions, rest->vertex_count);
        ask(model, workspace, &pose);
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    input_free_choices(&choices);
    free(positions);
}

int main(int argc, char **argv)
{
    soup s;
    test_random_reset(1);
    for (int i = 1; i < argc; ++i) {
        if (!input_read_obj(argv[i], &s)) {
            printf("cannot read %s\n", argv[i]);
            return 1;
        }
        ask_all(&s, SC_PARTITION_FAST);
        soup_free(&s);
    }
    for (uint32_t i = 0; i < MADE; ++i) {
        const char *name;
        s = shape_any(8 * (i + 1), &name);
        ask_all(&s, i % 4);
        soup_free(&s);
    }
    printf("%016" PRIx64 " of %" PRIu64 " queries with %" PRIu64 " pairs\n", hash, queries,
           pairs_seen);
    return 0;
}
