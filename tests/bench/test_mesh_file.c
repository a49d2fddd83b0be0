/*
 * What tools/mesh_file.h takes from files: numbers, faces, objects.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "harness.h"
#include "mesh_file.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* Reads a mesh from text, as a file of that name. */
static bool read_text(mesh_file *mesh, const char *ending, const char *text)
{
    char folder[] = "/tmp/test_mesh_file_XXXXXX", path[64], error[MESH_FILE_ERROR_SIZE];
    memset(mesh, 0, sizeof *mesh);
    if (!CHECK(mkdtemp(folder) != NULL)) return false;
    snprintf(path, sizeof path, "%s/mesh.%s", folder, ending);
    FILE *file = fopen(path, "w");
    if (file) {
        fputs(text, file);
        fclose(file);
    }
    const bool done = mesh_file_read(mesh, path, error);
    CHECK_MSG(done, "%s", error);
    unlink(path);
    rmdir(folder);
    return done;
}

static const char corners[] = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n";

/* corners and what follows, as OBJ */
static bool read_obj(mesh_file *mesh, const char *faces)
{
    char text[1024];
    snprintf(text, sizeof text, "%s%s", corners, faces);
    return read_text(mesh, "obj", text);
}

static void numbers_are_the_files(void)
{
    mesh_file mesh;
    double p[3];
    if (read_text(&mesh, "obj", "v 0 1 2\nv 0.5 -1e10 3\nv 16777217 0 0\nf 1 2 3\n")) {
        CHECK(mesh.position_type == SC_DOUBLE); /* the third, 2^24 + 1, is no float */
        mesh_file_position(mesh.positions, mesh.position_type, 2, p);
        CHECK(p[0] == 16777217.0);
        const float *floats = mesh_file_floats(&mesh);
        CHECK(mesh.position_type == SC_FLOAT && floats[6] == 16777216.0f && floats[3] == 0.5f);
    }
    mesh_file_free(&mesh);
    if (read_text(&mesh, "obj", "v 0 1 2\nv 0.5 -1e10 3\nv 16777216 0 0\nf 1 2 3\n")) {
        CHECK(mesh.position_type == SC_FLOAT && !mesh.rounded && !mesh.has_animation);
        CHECK(((const float *)mesh.positions)[4] == -1e10f);
    }
    mesh_file_free(&mesh);
    /* the tie between two doubles goes to the even one, and a last digit decides it */
    if (read_text(&mesh, "off",
                  "OFF\n3 1 0\n9007199254740993 9007199254740993.0000000000000000001 1e308\n"
                  "0.1 5e-324 1e-400\n0 0 0\n3 0 1 2\n")) {
        CHECK(mesh.position_type == SC_DOUBLE);
        mesh_file_position(mesh.positions, mesh.position_type, 0, p);
        CHECK(p[0] == 9007199254740992.0 && p[1] == 9007199254740994.0 && p[2] == 1e308);
        mesh_file_position(mesh.positions, mesh.position_type, 1, p);
        CHECK(p[0] == 0.1 && p[1] == 5e-324 && p[2] == 0.0);
    }
    mesh_file_free(&mesh);
}

static void exact_values_are_joined(void)
{
    mesh_file mesh;
    if (read_text(&mesh, "obj",
                  "v 5400000.1 0 0\nv 5400000.2 0 0\nv 5400000.1 -0 0\nv 5400000.1000000001 0 1\n"
                  "f 1 2 3\nf 2 3 4\n")) {
        uint32_t *map = mesh_file_weld_map(&mesh);
        if (CHECK(map != NULL)) CHECK(map[0] == 0 && map[1] == 1 && map[2] == 0 && map[3] == 3);
        free(map);
        if (CHECK(mesh_file_join(&mesh))) {
            double p[3];
            CHECK(mesh.vertex_count == 3 && mesh.indices[2] == 0 && mesh.indices[5] == 2);
            mesh_file_position(mesh.positions, mesh.position_type, 2, p);
            CHECK(p[0] == 5400000.1000000001 && p[2] == 1.0);
        }
    }
    mesh_file_free(&mesh);
}

static void faces_are_the_files(void)
{
    mesh_file mesh;
    if (read_obj(&mesh, "f 1 2 3\nf 2 5 6\n")) {
        CHECK(mesh.face_count == 2 && mesh.triangle_count == 2 && !mesh.face_of_triangle);
        CHECK(mesh.object_count == 0 && !mesh.object_names && !mesh.object_of_face);
    }
    mesh_file_free(&mesh);
    if (read_obj(&mesh, "f 1 2 3 4\nf 2 5 6\nf 1 2 5 6 4\n")) {
        static const uint32_t expected[6] = {0, 0, 1, 2, 2, 2};
        CHECK(mesh.face_count == 3 && mesh.triangle_count == 6);
        if (CHECK(mesh.face_of_triangle != NULL))
            CHECK(memcmp(mesh.face_of_triangle, expected, sizeof expected) == 0);
    }
    mesh_file_free(&mesh);
    /* those of fewer than three corners keep their number, also where the counts are equal */
    if (read_text(&mesh, "off",
                  "OFF\n4 3 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n2 0 1\n4 0 1 2 3\n3 0 1 2\n")) {
        static const uint32_t expected[3] = {1, 1, 2};
        CHECK(mesh.face_count == 3 && mesh.triangle_count == 3);
        if (CHECK(mesh.face_of_triangle != NULL))
            CHECK(memcmp(mesh.face_of_triangle, expected, sizeof expected) == 0);
    }
    mesh_file_free(&mesh);
}

/* Whether these are the objects, and face f belongs to the one that digits[f] says. */
static void check_objects(const char *ending, const char *text, const char *const *names,
                          const char *digits)
{
    mesh_file mesh;
    uint32_t count = 0;
    while (names[count]) count++;
    if (strcmp(ending, "obj") == 0 ? read_obj(&mesh, text) : read_text(&mesh, ending, text)) {
        CHECK_MSG(mesh.object_count == count, "%s: %u objects", text, mesh.object_count);
        for (uint32_t i = 0; i < count && i < mesh.object_count; i++)
            CHECK_MSG(strcmp(mesh.object_names[i], names[i]) == 0, "%s", mesh.object_names[i]);
        CHECK((mesh.object_of_face != NULL) == (count > 1));
        CHECK(mesh.face_count == strlen(digits));
        for (uint32_t f = 0; f < mesh.face_count && mesh.object_of_face; f++)
            CHECK_MSG(mesh.object_of_face[f] == (uint32_t)(digits[f] - '0'), "%s: face %u", text,
                      f);
    }
    mesh_file_free(&mesh);
}

static void objects_are_the_files(void)
{
    static const char *const two[] = {"a", "b c", NULL}, *const one[] = {"only", NULL},
                             *const none[] = {NULL}, *const first[] = {"", "a", NULL},
                             *const groups[] = {"g1", "g2", NULL}, *const box[] = {"box", NULL},
                             *const solids[] = {"a", "a", "", NULL};
    check_objects("obj", "o a\nf 1 2 3\no b c \nf 2 5 6\nf 1 2 3\no a\nf 1 2 6\n", two, "0110");
    check_objects("obj", "o a\nf 1 2 3\ng g1\no b c\nf 2 5 6\ng g2\nf 1 2 3\n", two, "011");
    check_objects("obj", "o only\ng g1\nf 1 2 3\ng g2\nf 2 5 6\n", groups, "01");
    check_objects("obj", "g g1\nf 1 2 3\ng g2\nf 2 5 6\ng g1\nf 1 2 3 4\n", groups, "010");
    check_objects("obj", "o only\ng\nf 1 2 3\n", one, "0");
    check_objects("obj", "o empty\no only\nf 1 2 3\nf 2 5 6\no empty\n", one, "00");
    check_objects("obj", "f 1 2 3\no a\nf 2 5 6\n", first, "01");
    check_objects("obj", "g\nf 1 2 3\n", none, "0");
    check_objects("stl",
                  "solid a\nfacet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
                  "endloop endfacet\nendsolid a\nsolid a\nfacet normal 0 0 0 outer loop\n"
                  "vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet\n"
                  "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
                  "endloop endfacet\nendsolid a\nsolid\n"
                  "facet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 "
                  "endloop endfacet\nendsolid\n",
                  solids, "0112");
    check_objects("ac",
                  "AC3Db\nMATERIAL \"\" rgb 1 1 1 amb 0 0 0 emis 0 0 0 spec 0 0 0 shi 0 trans 0\n"
                  "OBJECT world\nkids 1\nOBJECT poly\nname \"box\"\nnumvert 4\n"
                  "0 0 0\n1 0 0\n1 1 0\n0 1 0\nnumsurf 1\nSURF 0x10\nmat 0\nrefs 4\n"
                  "0 0 0\n1 0 0\n2 0 0\n3 0 0\nkids 0\n",
                  box, "0");
}

/* A pose has its own type, whatever the rest mesh has. */
static void poses_have_types(void)
{
    static const char faces[] = "f 1 2 3\nf 2 5 6\n";
    char folder[] = "/tmp/test_mesh_file_XXXXXX", path[64], error[MESH_FILE_ERROR_SIZE];
    mesh_file rest;
    mesh_pose pose;
    double p[3];
    if (!CHECK(mkdtemp(folder) != NULL)) return;
    snprintf(path, sizeof path, "%s/pose.obj", folder);
    FILE *file = fopen(path, "w");
    if (file) {
        fprintf(file, "v 0.1 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 2 0 0\nv 2 1 0\n%s", faces);
        fclose(file);
    }
    if (read_obj(&rest, faces) && CHECK(mesh_file_read_pose(&rest, path, &pose, error))) {
        CHECK(rest.position_type == SC_FLOAT && pose.position_type == SC_DOUBLE);
        mesh_file_position(pose.positions, pose.position_type, 0, p);
        CHECK(p[0] == 0.1);
        mesh_pose_free(&pose);
        CHECK(pose.positions == NULL);
    }
    mesh_file_free(&rest);
    if (read_obj(&rest, "f 1 2 3\nf 5 2 6\n")) {
        CHECK(!mesh_file_read_pose(&rest, path, &pose, error) && pose.positions == NULL);
        CHECK_MSG(strstr(error, "not a pose") != NULL, "%s", error);
    }
    mesh_file_free(&rest);
    unlink(path);
    rmdir(folder);
}

SC_TEST_MAIN(SC_TEST(numbers_are_the_files), SC_TEST(exact_values_are_joined),
             SC_TEST(faces_are_the_files), SC_TEST(objects_are_the_files),
             SC_TEST(poses_have_types))
