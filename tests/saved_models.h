/*
 * Saved models in memory, as a test writes, reads, changes and uses them. For
 * test_saved_models.c and test_forged_models.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_SAVED_MODELS_H
#define TESTS_SAVED_MODELS_H

#include <stdint.h>

#include "build/model.h"
#include "soups.h"
#include "starcontour.h"

/* The bytes of a save, in memory that has some room round them. */
typedef struct saved_model {
    unsigned char *data;
    uint64_t size;
    void *memory;
} saved_model;

/* Room for so many bytes: aligned with offset 0, else that much off. */
saved_model saved_model_make(uint64_t size, uint32_t offset);

/* The first bytes of another. */
saved_model saved_model_copy(const saved_model *from, uint64_t size);

/* A model, saved. */
saved_model saved_model_of(const sc_model *model);

/* A model of a mesh, welded and parted as inputs.h numbers it; content: SC_MODEL_... */
sc_model *saved_model_build(const soup *mesh, uint32_t weld, uint32_t partition, uint32_t content);

/* Loads it; mode: SC_LOAD_... */
sc_status saved_model_load(const saved_model *s, uint32_t mode, sc_model **model);

/* What a query found; the caller frees the pairs. */
typedef struct saved_model_pairs {
    sc_pair *pairs;
    uint64_t count;
} saved_model_pairs;

saved_model_pairs saved_model_ask(const sc_model *model, sc_workspace *workspace, const soup *mesh,
                                  const double *positions, uint32_t method, uint32_t kind);

/* The same pairs of two models in a pose, by all methods; returns how many there are. */
uint64_t saved_model_compare_pairs(const sc_model *a, sc_workspace *of_a, const sc_model *b,
                                   sc_workspace *of_b, const soup *mesh, const double *positions);

/* The smallest model there is, two that have every array, and one for boxes. */
sc_model *saved_model_build_small(int which, soup *mesh);

enum { SAVED_MODEL_SMALL = 5 };

/* Loading it must end with a status, checked or not. */
void saved_model_refuse(const saved_model *s, sc_status expected, const char *what, uint64_t at);

/* Makes the checksum right again after a change. */
void saved_model_seal(saved_model *s);

#endif
