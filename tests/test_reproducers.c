/*
 * The fuzz targets without a fuzzer: inputs that once found a bug (tests/fuzz/reproducers/, their
 * names begin with the target's), seeds made of meshes/, and random bytes. A target that finds
 * something ends the program; the input's name is printed before.
 *
 * SPDX-License-Identifier: MIT
 */
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fuzz/fuzz_support.h"
#include "harness.h"

typedef struct target {
    const char *name;
    int (*run)(const uint8_t *data, size_t size);
} target;

static const target targets[] = {{"fuzz_build", fuzz_build},     {"fuzz_query", fuzz_query},
                                 {"fuzz_options", fuzz_options}, {"fuzz_load", fuzz_load},
                                 {"fuzz_near", fuzz_near},       {"fuzz_trace", fuzz_trace}};
enum { TARGETS = sizeof(targets) / sizeof(targets[0]) };

/* Runs a target on a copy that ends where it ends. */
static void replay(const target *t, const char *name, const uint8_t *bytes, size_t size)
{
    uint8_t *copy = (uint8_t *)fuzz_copy(bytes, size);
    printf("    %s on %s\n", t->name, name);
    fflush(stdout);
    CHECK(t->run(copy, size) == 0);
    free(copy);
}

/* Each file is of a target, and described in the folder's README.md; each target has one at least.
   */
static void reproducers(void)
{
    static uint8_t bytes[1 << 20];
    static char described[1 << 16];
    static const char folder[] = "tests/fuzz/reproducers";
    uint32_t replayed[TARGETS] = {0};
    FILE *file = fopen("tests/fuzz/reproducers/README.md", "rb");
    DIR *directory = opendir(folder);
    struct dirent *entry;
    if (CHECK(file != NULL)) {
        described[fread(described, 1, sizeof(described) - 1, file)] = '\0';
        fclose(file);
    }
    CHECK_MSG(directory != NULL, "%s cannot be read from here", folder);
    while (directory != NULL && (entry = readdir(directory)) != NULL) {
        int is_known = entry->d_name[0] == '.' || strcmp(entry->d_name, "README.md") == 0;
        for (size_t i = 0; i < TARGETS; ++i) {
            char path[1024];
            if (strncmp(entry->d_name, targets[i].name, strlen(targets[i].name)) != 0) continue;
            is_known = strstr(described, entry->d_name) != NULL;
            snprintf(path, sizeof(path), "%s/%s", folder, entry->d_name);
            file = fopen(path, "rb");
            if (!CHECK(file != NULL)) continue;
            replay(&targets[i], path, bytes, fread(bytes, 1, sizeof(bytes), file));
            fclose(file);
            ++replayed[i];
        }
        CHECK_MSG(is_known, "%s: say in README.md what it reproduces", entry->d_name);
    }
    if (directory != NULL) closedir(directory);
    for (size_t i = 0; i < TARGETS; ++i) CHECK_MSG(replayed[i] > 0, "none of %s", targets[i].name);
}

static void seeds_of_meshes(void)
{
    static const char *const meshes[] = {
        "crossing_tetrahedra", "corner_on_face", "degenerate_soup", "duplicates",     "fan",
        "folded_sheet",        "hourglass",      "touching_cubes",  "crossing_cloths"};
    static uint8_t bytes[FUZZ_SAVED_ROOM];
    for (size_t i = 0; i < sizeof(meshes) / sizeof(meshes[0]); ++i) {
        char path[64];
        snprintf(path, sizeof(path), "meshes/%s.obj", meshes[i]);
        for (uint32_t variant = 0; variant < FUZZ_SEED_VARIANTS; ++variant) {
            size_t size = fuzz_seed(path, variant, bytes);
            if (!CHECK_MSG(size > 0, "%s cannot be read", path)) continue;
            replay(&targets[0], path, bytes, size);
            replay(&targets[1], path, bytes, size);
            replay(&targets[4], path, bytes, size);
            size = fuzz_saved_seed(path, variant, bytes);
            if (size > 0) replay(&targets[3], path, bytes, size);
        }
    }
}

static void random_bytes(void)
{
    uint8_t bytes[512];
    for (uint32_t round = test_iterations(200); round > 0; --round) {
        size_t size = test_random_below(sizeof(bytes) + 1);
        char name[64];
        uint64_t state = test_random_state();
        for (size_t i = 0; i < size; ++i) bytes[i] = (uint8_t)test_random();
        snprintf(name, sizeof(name), "random state %llu", (unsigned long long)state);
        for (size_t i = 0; i < TARGETS; ++i) {
            uint64_t after = test_random_state();
            replay(&targets[i], name, bytes, size);
            test_random_reset(after); /* targets have random numbers of their own */
        }
    }
}

SC_TEST_MAIN(SC_TEST(reproducers), SC_TEST(seeds_of_meshes), SC_TEST(random_bytes))
