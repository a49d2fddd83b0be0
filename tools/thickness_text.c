/*
 * The thickness of faces, as text; see thickness_text.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "thickness_text.h"

#include <math.h>
#include <stdio.h>

/* A row of a histogram, as long as its share of the longest. */
static void print_bar(uint64_t count, uint64_t most)
{
    enum { WIDTH = 40 };
    const int length = most ? (int)ceil(WIDTH * ((double)count / (double)most)) : 0;
    printf("%10.0f%s", (double)count, length ? "  " : "");
    for (int i = 0; i < length; i++) putchar('#');
    puts("");
}

void thickness_text_print(const thickness_spread *spread)
{
    uint64_t most = spread->more;
    for (int i = 0; i < THICKNESS_BINS; i++)
        most = spread->counts[i] > most ? spread->counts[i] : most;
    printf("    %26s %10s\n", "thickness", "faces");
    for (int i = 0; i < THICKNESS_BINS; i++) {
        printf("    %11.6g to %11.6g ", spread->limits[i], spread->limits[i + 1]);
        print_bar(spread->counts[i], most);
    }
    printf("    %14s %11.6g ", "more than", spread->limits[THICKNESS_BINS]);
    print_bar(spread->more, most);
    printf("    %-11s", "percent");
    for (int i = 0; i < THICKNESS_PERCENTILES; i++)
        printf(" %11lu", (unsigned long)thickness_percents[i]);
    printf("\n    %-11s", "thickness");
    for (int i = 0; i < THICKNESS_PERCENTILES; i++) {
        if (spread->percentiles[i] < HUGE_VAL)
            printf(" %11.6g", spread->percentiles[i]);
        else
            printf(" %11s", "more");
    }
    puts("");
}

/* null: more than the distance. */
static cJSON *number_or_null(double value)
{
    return value < HUGE_VAL ? cJSON_CreateNumber(value) : cJSON_CreateNull();
}

void thickness_text_add(cJSON *object, const thickness_spread *spread, const double *values,
                        size_t count)
{
    object = cJSON_AddObjectToObject(object, "thickness");
    cJSON_AddItemToObject(object, "limits",
                          cJSON_CreateDoubleArray(spread->limits, THICKNESS_BINS + 1));
    cJSON *counts = cJSON_AddArrayToObject(object, "counts");
    for (int i = 0; i < THICKNESS_BINS; i++)
        cJSON_AddItemToArray(counts, cJSON_CreateNumber((double)spread->counts[i]));
    cJSON_AddNumberToObject(object, "more", (double)spread->more);
    cJSON *percentiles = cJSON_AddObjectToObject(object, "percentiles");
    for (int i = 0; i < THICKNESS_PERCENTILES; i++) {
        char name[16];
        snprintf(name, sizeof name, "%lu", (unsigned long)thickness_percents[i]);
        cJSON_AddItemToObject(percentiles, name, number_or_null(spread->percentiles[i]));
    }
    if (!values) return;
    cJSON *faces = cJSON_AddArrayToObject(object, "faces");
    for (size_t i = 0; i < count; i++) cJSON_AddItemToArray(faces, number_or_null(values[i]));
}
