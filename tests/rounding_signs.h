/*
 * Bounds of exact signs (base/predicates), for the table in rounding_bounds.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_ROUNDING_SIGNS_H
#define SC_TESTS_ROUNDING_SIGNS_H

#include "rounding_search.h"

rounding_share rounding_space_tiny;
rounding_share rounding_two_doubles;
rounding_share rounding_few_bits;
rounding_share rounding_area;

#endif
