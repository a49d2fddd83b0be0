/*
 * What filters mean, by brute force: for test_filters.c, test_step_filters.c and
 * test_near_filters.c.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_FILTER_RULES_H
#define TESTS_FILTER_RULES_H

#include "soups.h"
#include "starcontour.h"

/* vertex_count^2: how many edges lead from one vertex to another, of those that represent others;
   255: none do. The caller frees it. */
uint8_t *filter_rules_measure(const soup *mesh, const uint32_t *weld);

/* The group of some vertices together. */
sc_group filter_rules_group_of(const sc_group *groups, const uint32_t *v, uint32_t count);

int filter_rules_collide(sc_group a, sc_group b);

/* What accept is to say of a pair: always yes with salt 0, else three times of four. */
int32_t filter_rules_is_liked(uint32_t salt, uint32_t a, uint32_t b);

/* For qsort and bsearch. */
int filter_rules_compare(const void *left, const void *right);

/* Random groups of few categories. The caller frees them. */
sc_group *filter_rules_groups(uint32_t count);

#endif
