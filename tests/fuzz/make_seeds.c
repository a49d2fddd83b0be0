/*
 * Writes what fuzzing starts from: OBJ files as bytes that the targets read as these meshes, and
 * some choices.
 *
 *     make-seeds DIRECTORY FILE.obj...
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "fuzz_support.h"

static int write_seed(const char *directory, const char *kind, int number, uint32_t variant,
                      const uint8_t *bytes, size_t size)
{
    char path[4096];
    FILE *file;
    int is_good;
    snprintf(path, sizeof(path), "%s/%s_%d_%u", directory, kind, number, (unsigned)variant);
    file = size == 0 ? NULL : fopen(path, "wb");
    is_good = file != NULL && fwrite(bytes, 1, size, file) == size;
    if (file != NULL) is_good = fclose(file) == 0 && is_good;
    if (!is_good) fprintf(stderr, "make-seeds: cannot make %s\n", path);
    return is_good;
}

int main(int argc, char **argv)
{
    for (int i = 2; i < argc; ++i) {
        for (uint32_t variant = 0; variant < FUZZ_SEED_VARIANTS; ++variant) {
            static uint8_t bytes[FUZZ_SAVED_ROOM];
            size_t size = fuzz_seed(argv[i], variant, bytes);
            if (!write_seed(argv[1], "mesh", i - 1, variant, bytes, size)) return 1;
            size = fuzz_saved_seed(argv[i], variant, bytes);
            if (size > 0 && !write_seed(argv[1], "saved", i - 1, variant, bytes, size)) return 1;
        }
    }
    return argc < 3;
}
