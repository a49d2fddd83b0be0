/*
 * See filter_rules.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "filter_rules.h"

#include <string.h>

#include "harness.h"

uint8_t *filter_rules_measure(const soup *mesh, const uint32_t *weld)
{
    const uint32_t n = mesh->vertex_count;
    uint8_t *apart = (uint8_t *)test_allocate((size_t)n * n);
    int changed = 1;
    memset(apart, 255, (size_t)n * n);
    for (uint32_t v = 0; v < n; ++v) apart[(size_t)v * n + v] = 0;
    for (uint32_t i = 0; i < 3 * mesh->triangle_count; ++i) {
        uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
        uint32_t a = weld[mesh->triangles[i]], b = weld[mesh->triangles[next]];
        if (a != b) apart[(size_t)a * n + b] = apart[(size_t)b * n + a] = 1;
    }
    for (uint8_t d = 1; changed && d < 254; ++d) { /* one edge more at a time */
        changed = 0;
        for (uint32_t i = 0; i < 3 * mesh->triangle_count; ++i) {
            uint32_t next = i % 3 == 2 ? i - 2 : i + 1;
            uint32_t a = weld[mesh->triangles[i]], b = weld[mesh->triangles[next]];
            for (uint32_t v = 0; v < n; ++v)
                for (int side = 0; side < 2; ++side) {
                    uint32_t from = side ? a : b, to = side ? b : a;
                    if (apart[(size_t)v * n + from] != d || apart[(size_t)v * n + to] <= d + 1)
                        continue;
                    apart[(size_t)v * n + to] = (uint8_t)(d + 1);
                    changed = 1;
                }
        }
    }
    return apart;
}

sc_group filter_rules_group_of(const sc_group *groups, const uint32_t *v, uint32_t count)
{
    sc_group g = {0, 0};
    for (uint32_t i = 0; i < count; ++i) {
        g.category |= groups[v[i]].category;
        g.mask |= groups[v[i]].mask;
    }
    return g;
}

int filter_rules_collide(sc_group a, sc_group b)
{
    return (a.category & b.mask) && (b.category & a.mask);
}

int32_t filter_rules_is_liked(uint32_t salt, uint32_t a, uint32_t b)
{
    return salt == 0 || ((a * 2654435761u + b * 40503u + salt) >> 7 & 3) != 0;
}

int filter_rules_compare(const void *left, const void *right)
{
    const sc_pair *x = (const sc_pair *)left, *y = (const sc_pair *)right;
    if (x->a != y->a) return x->a < y->a ? -1 : 1;
    return x->b < y->b ? -1 : x->b > y->b;
}

sc_group *filter_rules_groups(uint32_t count)
{
    sc_group *groups = (sc_group *)test_allocate(count * sizeof(sc_group));
    uint32_t bits = test_random_below(2) ? 3 : 0x80000101u;
    for (uint32_t i = 0; i < count; ++i) {
        groups[i].category = (uint32_t)test_random() & bits;
        groups[i].mask = (uint32_t)test_random() & bits;
    }
    return groups;
}
