/*
 * Which share of each error bound rounding can be made to use, by search: see
 * tests/rounding_search.h.
 *
 * SPDX-License-Identifier: MIT
 *
 *     search_rounding [TRIALS [WORD]]
 *
 * Makes TRIALS of each bound [100000000], of some a tenth; only of those whose name has WORD in it.
 *
 * Prints a line a bound: the largest share, the number of trials, the name; and the numbers of that
 * trial. Exit status 1 if a share is above 1: then that bound is wrong.
 */
#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "rounding_search.h"

int main(int argc, char **argv)
{
    uint64_t trials = argc > 1 ? strtoull(argv[1], NULL, 10) : 100000000;
    const char *word = argc > 2 ? argv[2] : "";
    int wrong = 0, searched = 0;
    if (trials == 0) {
        fputs("search_rounding: the number of trials must be 1 or more\n", stderr);
        return 2;
    }
    for (int i = 0; i < rounding_bound_count; ++i) {
        const rounding_bound *b = &rounding_bounds[i];
        double worst[ROUNDING_INPUTS], share;
        uint64_t some = (trials + (uint64_t)b->slowness - 1) / (uint64_t)b->slowness;
        if (!strstr(b->name, word)) continue;
        share = rounding_search(b, some, 1, worst);
        wrong += !(share <= 1);
        ++searched;
        printf("%-10.4g %11" PRIu64 " %s\n", share, some, b->name);
        for (int k = 0; k < b->inputs; ++k) printf("%s%a", k ? " " : "           ", worst[k]);
        printf("\n");
        fflush(stdout);
    }
    if (!searched) {
        fprintf(stderr, "rounding: no bound has \"%s\" in its name\n", word);
        return 2;
    }
    return wrong ? 1 : 0;
}
