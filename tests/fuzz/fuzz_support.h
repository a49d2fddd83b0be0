/*
 * What the fuzz targets share: numbers out of a fuzzer's bytes, meshes out of them and back, an
 * allocator that runs dry, and the comparison of an answer with the oracle's.
 *
 * SPDX-License-Identifier: MIT
 *
 * A target is a function of bytes: whatever they are, it must return. It ends the program by
 * fuzz_fail, which prints where and why, or by a sanitizer. The same bytes always do the same.
 */
#ifndef SC_TESTS_FUZZ_SUPPORT_H
#define SC_TESTS_FUZZ_SUPPORT_H

#include <stddef.h>
#include <stdint.h>

#include "inputs.h"
#include "oracle.h"
#include "soups.h"
#include "starcontour.h"

/* The targets. Each returns 0. */
int fuzz_build(const uint8_t *data, size_t size);   /* meshes and build options, right and wrong */
int fuzz_query(const uint8_t *data, size_t size);   /* poses and query options, one workspace */
int fuzz_near(const uint8_t *data, size_t size);    /* poses and distances, what is near */
int fuzz_options(const uint8_t *data, size_t size); /* structures of every size and content */
int fuzz_load(const uint8_t *data, size_t size);    /* saved models and records, right and wrong */
int fuzz_trace(const uint8_t *data, size_t size);   /* contours, their gradients, and regions */

/* Ends the program unless cond holds; the rest as for printf. */
#define FUZZ_CHECK(cond, ...)                                                                      \
  do {                                                                                             \
    if (!(cond)) fuzz_fail(__FILE__, __LINE__, #cond, __VA_ARGS__);                                \
  } while (0)

void fuzz_fail(const char *file, int line, const char *condition, const char *format, ...);

/* Bytes are taken from the front; behind the last there are zeros. */
typedef struct fuzz_bytes {
    const uint8_t *at;
    size_t left;
} fuzz_bytes;

uint32_t fuzz_byte(fuzz_bytes *bytes);
uint64_t fuzz_number(fuzz_bytes *bytes, uint32_t size); /* size bytes, the lowest first */

/* A coordinate of one of FUZZ_KINDS kinds: small integers, tenths, float and double bits, a table
   of extremes, integers off by a few units in the last place. */
enum { FUZZ_KINDS = 6, FUZZ_KIND_FLOAT = 2, FUZZ_KIND_DOUBLE = 3 };
double fuzz_coordinate(fuzz_bytes *bytes, uint32_t kind);

/* A mesh: listed in the bytes or made by tests/shapes.h from a number in them. At most 256
   vertices and triangles. With wild set, indices and coordinates may be wrong. */
soup fuzz_mesh(fuzz_bytes *bytes, int wild);

/* Writes bytes for fuzz_build and fuzz_query that read as the first triangles of an OBJ file,
   followed by choices that depend on the variant; at most FUZZ_SEED_ROOM. Returns their number, 0
   if the file cannot be read. */
enum { FUZZ_SEED_VARIANTS = 4, FUZZ_SEED_ROOM = 8192 };
size_t fuzz_seed(const char *path, uint32_t variant, uint8_t *bytes);

/* Writes bytes for fuzz_load: a saved model or record of the first triangles of an OBJ file; at
   most FUZZ_SAVED_ROOM. Returns their number, 0 if there is no such file or they are more. */
enum { FUZZ_SAVED_ROOM = 16384 };
size_t fuzz_saved_seed(const char *path, uint32_t variant, uint8_t *bytes);

/* Copies of size bytes in a block of exactly that size; never NULL. To be freed. */
void *fuzz_copy(const void *from, size_t size);

/* What is wrong with a mesh, a bit FUZZ_BIT(status) for each cause. weld_map may be NULL. Arrays
   are read if nothing else is wrong. */
#define FUZZ_BIT(status) (UINT32_C(1) << (status))
uint32_t fuzz_mesh_faults(const sc_mesh *mesh, const uint32_t *weld_map);

/* An allocator that refuses once countdown calls were served, and counts. */
typedef struct fuzz_memory {
    uint32_t countdown;
    uint32_t refused;
    uint32_t live;
} fuzz_memory;

sc_allocator fuzz_allocator(fuzz_memory *memory, uint32_t countdown);

/*
 * Up to FUZZ_ORACLE triangles the expected lists are the oracle's; of larger meshes they are those
 * of SC_METHOD_AABB, so that at least the methods are compared. Freed by oracle_free.
 */
enum { FUZZ_ORACLE = 40 };
oracle_answer fuzz_expect(const soup *s, const double *positions, const uint32_t *weld,
                          const sc_model *model, sc_workspace *workspace);

/* Queries as options say (valid ones), into an array of exactly capacity pairs, and compares. */
void fuzz_check_query(const sc_model *model, sc_workspace *workspace, const sc_pose *pose,
                      const sc_query_options *options, uint64_t capacity,
                      const oracle_answer *expected);

#endif /* SC_TESTS_FUZZ_SUPPORT_H */
