/*
 * subdivide: reads a mesh, joins vertices at equal positions, cuts every triangle into four at the
 * midpoints of its sides any number of times (none: only converts), and writes the result.
 *
 * SPDX-License-Identifier: MIT
 *
 * Midpoints are rounded to float. Files written read back as the same floats: nine digits in OBJ
 * and OFF, the numbers themselves in PLY.
 */
#include "mesh_file.h"
#include "ply_write.h"
#include "shape.h"
#include "tool.h"

#include <errno.h>
#include <string.h>

static const char usage[] = "Usage: subdivide MESH TIMES OUTPUT\n"
                            "Joins vertices at equal positions, cuts each triangle into four TIMES "
                            "times, and writes OUTPUT,\n"
                            "an .obj, .off or .ply file.\n";

/* OBJ and OFF differ in little when there is nothing but vertices and triangles. */
static bool write_text(const char *path, const mesh_file *mesh, bool off)
{
    FILE *file = fopen(path, "w");
    if (!file) return false;
    if (off) {
        fprintf(file, "OFF\n%lu %lu 0\n", (unsigned long)mesh->vertex_count,
                (unsigned long)mesh->triangle_count);
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double p[3];
        mesh_file_position(mesh->positions, mesh->position_type, v, p);
        fprintf(file, "%s%.17g %.17g %.17g\n", off ? "" : "v ", p[0], p[1], p[2]);
    }
    const unsigned long base = off ? 0 : 1;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *v = mesh->indices + 3 * t;
        fprintf(file, "%s %lu %lu %lu\n", off ? "3" : "f", v[0] + base, v[1] + base, v[2] + base);
    }
    const bool written = !ferror(file);
    return fclose(file) == 0 && written;
}

static bool write_mesh(const char *path, const mesh_file *mesh)
{
    const char *dot = strrchr(path, '.');
    const char *type = dot ? dot : "";
    errno = 0;
    bool written = false;
    if (strcmp(type, ".ply") == 0) {
        written = ply_write(path, mesh->positions, mesh->position_type, mesh->vertex_count,
                            mesh->indices, mesh->triangle_count, NULL);
    } else if (strcmp(type, ".obj") == 0 || strcmp(type, ".off") == 0) {
        written = write_text(path, mesh, strcmp(type, ".off") == 0);
    } else {
        tool_error("%s: not an .obj, .off or .ply file", path);
        return false;
    }
    if (!written) tool_error("%s: cannot be written: %s", path, strerror(errno));
    return written;
}

int main(int argc, char **argv)
{
    tool_set_name("subdivide");
    uint32_t times;
    const char *first = argc == 2 ? argv[1] : "";
    if (strcmp(first, "-V") == 0 || strcmp(first, "--version") == 0) {
        printf("subdivide (starcontour) %s\n", sc_version_string());
        return tool_finish(TOOL_CLEAN);
    }
    if (argc != 4) {
        const bool is_asked = strcmp(first, "-h") == 0 || strcmp(first, "--help") == 0;
        fputs(usage, is_asked ? stdout : stderr);
        return is_asked ? tool_finish(TOOL_CLEAN) : TOOL_FAILED;
    }
    if (!tool_parse_number("TIMES", argv[2], 0, 10, &times)) return TOOL_FAILED;

    mesh_file mesh;
    char error[MESH_FILE_ERROR_SIZE];
    if (!mesh_file_read(&mesh, argv[1], error)) {
        tool_error("%s", error);
        return TOOL_FAILED;
    }
    bool done = mesh_file_join(&mesh);
    for (uint32_t i = 0; i < times && done; i++) done = shape_subdivide(&mesh);
    if (!done)
        tool_error("%s: out of memory, or too many triangles", argv[1]);
    else
        done = write_mesh(argv[3], &mesh);
    mesh_file_free(&mesh);
    return done ? TOOL_CLEAN : TOOL_FAILED;
}
