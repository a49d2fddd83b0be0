/*
 * Writes what fuzzing starts from: OBJ files as bytes that the targets read as these meshes, and some
 * choices.
 *
 *     make-seeds DIRECTORY FILE.obj...
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdio.h>

#include "fuzz_support.h"

int main(int argc, char **argv)
{
    for (int i = 2; i < argc; ++i) {
        for (uint32_t variant = 0; variant < FUZZ_SEED_VARIANTS; ++variant) {
            static uint8_t bytes[FUZZ_SEED_ROOM];
            char path[4096];
            size_t size = fuzz_seed(argv[i], variant, bytes);
            FILE *file;
            int is_good;
            snprintf(path, sizeof(path), "%s/mesh_%d_%u", argv[1], i - 1, (unsigned)variant);
            file = size == 0 ? NULL : fopen(path, "wb");
            is_good = file != NULL && fwrite(bytes, 1, size, file) == size;
            if (file != NULL) is_good = fclose(file) == 0 && is_good;
            if (!is_good) {
                fprintf(stderr, "make-seeds: cannot make %s of %s\n", path, argv[i]);
                return 1;
            }
        }
    }
    return argc < 3;
}
