/*
 * What users of the library compile to see whether it is there and works: all pairs of a small
 * sheet, flat and then wound up, in text. C and C++; nothing but the public header and the C
 * library. tests/test_packages.sh and tests/packages/ compare what it prints.
 *
 * SPDX-License-Identifier: MIT
 */
#include <starcontour.h>

#include <stdio.h>
#include <string.h>

enum {
    SIDE = 24,
    VERTICES = SIDE * SIDE,
    TRIANGLES = 2 * (SIDE - 1) * (SIDE - 1),
    CAPACITY = 1 << 16
};

static float rest[VERTICES][3], wound[VERTICES][3];
static uint16_t triangles[TRIANGLES][3];
static sc_pair pairs[CAPACITY];

static void make_sheet(void)
{
    unsigned row, column, t = 0;
    for (row = 0; row < SIDE; row++) {
        for (column = 0; column < SIDE; column++) {
            /* whole numbers and halves, so that every machine has the same; the sheet zigzags
               through itself */
            unsigned v = row * SIDE + column;
            rest[v][0] = (float)column;
            rest[v][1] = (float)row;
            rest[v][2] = 0;
            wound[v][0] = (float)(column % 4) + 0.5f * (float)(row % 3);
            wound[v][1] = (float)row;
            wound[v][2] = (float)(column % 3) - 0.5f * (float)(column % 5);
        }
    }
    for (row = 0; row + 1 < SIDE; row++) {
        for (column = 0; column + 1 < SIDE; column++, t += 2) {
            unsigned v = row * SIDE + column;
            triangles[t][0] = (uint16_t)v;
            triangles[t][1] = (uint16_t)(v + 1);
            triangles[t][2] = (uint16_t)(v + SIDE);
            triangles[t + 1][0] = (uint16_t)(v + SIDE);
            triangles[t + 1][1] = (uint16_t)(v + 1);
            triangles[t + 1][2] = (uint16_t)(v + SIDE + 1);
        }
    }
}

int main(void)
{
    sc_mesh mesh;
    sc_pose pose;
    sc_result result;
    sc_model *model;
    sc_workspace *workspace;
    sc_status status;
    int turn;
    make_sheet();
    memset(&mesh, 0, sizeof mesh);
    mesh.struct_size = (uint32_t)sizeof mesh;
    mesh.vertex_count = VERTICES;
    mesh.triangle_count = TRIANGLES;
    mesh.index_type = SC_UINT16;
    mesh.positions = rest;
    mesh.indices = triangles;
    status = sc_build(&mesh, NULL, &model);
    if (status == SC_OK) status = sc_workspace_create(model, NULL, &workspace);
    for (turn = 0; turn < 2 && status == SC_OK; turn++) {
        uint64_t i;
        memset(&pose, 0, sizeof pose);
        pose.struct_size = (uint32_t)sizeof pose;
        pose.vertex_count = VERTICES;
        pose.positions = turn ? wound : rest;
        memset(&result, 0, sizeof result);
        result.struct_size = (uint32_t)sizeof result;
        result.capacity = CAPACITY;
        result.pairs = pairs;
        status = sc_query(model, workspace, &pose, NULL, &result);
        printf("%s: %u pairs\n", turn ? "wound" : "flat", (unsigned)result.count);
        for (i = 0; i < result.count && i < CAPACITY; i++)
            printf("%u %u\n", (unsigned)pairs[i].a, (unsigned)pairs[i].b);
    }
    if (status != SC_OK || sc_version() != SC_VERSION_NUMBER) {
        fprintf(stderr, "%s\n", sc_status_string(status));
        return 1;
    }
    sc_workspace_free(workspace);
    sc_model_free(model);
    return 0;
}
