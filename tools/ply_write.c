/*
 * Writes PLY files; see ply_write.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "ply_write.h"

#include "starcontour.h"

#include <stdio.h>
#include <string.h>

static uint8_t *put_uint32(uint8_t *out, uint32_t value)
{
    for (int byte = 0; byte < 4; byte++) *out++ = (uint8_t)(value >> (8 * byte));
    return out;
}

bool ply_write(const char *path, const void *positions, uint32_t position_type,
               uint32_t vertex_count, const uint32_t *indices, uint32_t triangle_count,
               const uint8_t *colors)
{
    FILE *file = fopen(path, "wb");
    if (!file) return false;
    const char *type = position_type == SC_DOUBLE ? "double" : "float";
    fprintf(file,
            "ply\nformat binary_little_endian 1.0\ncomment written by starcontour\n"
            "element vertex %lu\nproperty %s x\nproperty %s y\nproperty %s z\n"
            "element face %lu\nproperty list uchar int vertex_indices\n%send_header\n",
            (unsigned long)vertex_count, type, type, type, (unsigned long)triangle_count,
            colors ? "property uchar red\nproperty uchar green\nproperty uchar blue\n" : "");
    for (uint32_t v = 0; v < vertex_count; v++) {
        uint8_t record[24], *out = record;
        for (size_t k = 0; k < 3; k++) {
            const size_t at = 3 * (size_t)v + k;
            if (position_type == SC_DOUBLE) {
                uint64_t bits;
                memcpy(&bits, (const double *)positions + at, sizeof bits);
                out = put_uint32(put_uint32(out, (uint32_t)bits), (uint32_t)(bits >> 32));
            } else {
                uint32_t bits;
                memcpy(&bits, (const float *)positions + at, sizeof bits);
                out = put_uint32(out, bits);
            }
        }
        fwrite(record, (size_t)(out - record), 1, file);
    }
    for (uint32_t t = 0; t < triangle_count; t++) {
        uint8_t record[16], *out = record;
        *out++ = 3;
        for (size_t k = 0; k < 3; k++) out = put_uint32(out, indices[3 * (size_t)t + k]);
        if (colors) {
            memcpy(out, colors + 3 * (size_t)t, 3);
            out += 3;
        }
        fwrite(record, (size_t)(out - record), 1, file);
    }
    const bool written = !ferror(file);
    return fclose(file) == 0 && written;
}
