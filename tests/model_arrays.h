/*
 * The arrays of a model, and what they say of shared points, held against slow and obvious
 * rules. For test_structures.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_MODEL_ARRAYS_H
#define TESTS_MODEL_ARRAYS_H

#include "soups.h"
#include "starcontour.h"
#include "structures.h"

/* What the model reports, and each of its arrays. */
void model_arrays_check(const structures *s, const structures_patches *p, const soup *mesh,
                        const sc_build_options *options);

/* The masks of all pairs of leaf clusters that are not both crowded, and the validator on them. */
void model_arrays_check_sharing(structures *s);

#endif
