/*
 * The methods that are measured: those of the library, and a spatial hash to compare with.
 *
 * SPDX-License-Identifier: MIT
 *
 * All answer the same question about the same pose, and all but those called unsound must give the
 * same sorted pairs. A method to be measured gets a runner of its own: whatever it keeps from pose
 * to pose is not shared.
 */
#ifndef BENCH_METHODS_H
#define BENCH_METHODS_H

#include "near_method.h"
#include "spatial_hash.h"
#include "step_method.h"

#include "starcontour.h"

#include <stdbool.h>
#include <stddef.h>

typedef struct method_kind {
    const char *name, *about;
    const char *missing; /* why it cannot be run, or NULL */
    bool unsound;        /* misses pairs, and is measured for that */
    bool is_hash;        /* else a query of the library with the next two */
    uint32_t method, contour;
    bool is_step;  /* of a step from one pose to another, see step_method.h */
    uint32_t simd; /* SC_SIMD_... */
    bool serial;   /* one thread, however many the others have */
    uint32_t near; /* of what is near in a pose: NEAR_... of near_method.h; else 0 */
} method_kind;

/* All methods, in the order in which they are listed. */
extern const method_kind method_kinds[];
extern const size_t method_count;

/* What it is asked about: METHOD_..., or SC_PAIRS_TRIANGLE for all that find pairs that meet. */
uint32_t method_asks(const method_kind *kind);

/* The method of a name, or NULL. */
const method_kind *method_find(const char *name);

/* A method by name, or a query of the library with something changed: NAME@HOW. */
typedef struct method_variant {
    method_kind kind; /* its name is the next: do not copy */
    char name[32];
} method_variant;

/* Reads NAME or NAME@HOW; HOW is base, avx2 or avx512 (the instructions that queries use) or
   serial. False, with a message in *reason, if there is no such method. */
bool method_read(const char *text, method_variant *variant, const char **reason);

/* A mesh with its model. Poses are floats where the mesh has floats, else doubles. */
typedef struct method_mesh {
    const sc_model *model;
    const uint32_t *triangles; /* 3 * triangle_count */
    uint32_t triangle_count, vertex_count;
    uint32_t position_type;
} method_mesh;

/* A method at work on a mesh. */
typedef struct method_runner {
    const method_kind *kind;
    const method_mesh *mesh;
    sc_workspace *workspace;
    spatial_hash *hash;
    step_method step;
    near_method near;
    sc_pair *pairs; /* of the last query, sorted */
    uint64_t count, room;
} method_runner;

/* In place of a kind of pairs: the collisions of steps, and what is within a distance. */
enum { METHOD_STEPS = 2, METHOD_NEAR = 3 };

/* What is asked: SC_PAIRS_... or METHOD_..., SC_CONTACT_...; of METHOD_NEAR alone the others. */
typedef struct method_question {
    uint32_t pairs, contact;
    double distance;       /* in units of the coordinates */
    uint32_t ignore_rings; /* see sc_filter */
} method_question;

/* What a query is about: a pose in the mesh's type, and as doubles for the hash. Of a step, end is
   where it leads. */
typedef struct method_pose {
    const void *positions, *end;
    const double *doubles;
} method_pose;

/* rest: the first frame as doubles. On failure false, a message in *reason and nothing to close. */
bool method_open(method_runner *runner, const method_kind *kind, const method_mesh *mesh,
                 const double *rest, const char **reason);

void method_close(method_runner *runner);

/* Makes room for count pairs; false if there is no memory. */
bool method_reserve(method_runner *runner, uint64_t count);

/*
 * One query; its pairs are in the runner afterwards, its duration in *milliseconds. stats may be
 * NULL; asking for it costs time. Where the room for pairs is too small it is enlarged and the
 * query repeated: only the last counts. On failure false, and a message in *reason.
 *
 * Steps, and what is near: pairs of both kinds are found, and with pairs_wanted also listed: those
 * of edges last, with 2^31 added to their numbers. Of steps another query counts the candidates;
 * runner->step has what it found. A method that only counts lists in a query of its own, whose list
 * must be as long.
 */
bool method_query(method_runner *runner, const method_pose *pose, const method_question *question,
                  bool pairs_wanted, sc_stats *stats, double *milliseconds, const char **reason);

#endif /* BENCH_METHODS_H */
