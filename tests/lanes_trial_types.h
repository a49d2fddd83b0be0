/*
 * What test_lanes.c tries sixteen lanes on, and what comes out; and who tries.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef SC_TESTS_LANES_TRIAL_TYPES_H
#define SC_TESTS_LANES_TRIAL_TYPES_H

#include <stdint.h>

/* Floats from one row of points to the next: the last ends within lanes_input.row. */
enum { LANES_STRIDE = 12 };

typedef struct lanes_input {
    float a[16], b[16];  /* anything */
    float plain[64];     /* finite numbers, whose sums are */
    float row[16][16];   /* such, mostly negative */
    double c[8], d[8];   /* anything */
    double exact[20];    /* as plain */
    uint8_t number[48];  /* below 16 */
    uint8_t through[16]; /* the same */
    uint8_t other[48];   /* the same */
    uint32_t names[32];  /* of which some are the same */
    uint16_t words[16];  /* any */
    uint32_t apart[16];  /* all different, about names[0] */
    unsigned mask;       /* of 16 bits */
    unsigned split;      /* up to 16 */
    uint32_t first[4];   /* any */
    unsigned bits[12];   /* any */
    uint8_t cell[4][16]; /* 1 to 254: two rows of x, two of y */
} lanes_input;

typedef struct lanes_outcome {
    float row[77][16], one[3];
    double eight[16][8];
    unsigned bits[29];
    uint32_t numbers[16], pairs[32], from[16], among[16];
    uint16_t wide[16];
    uint8_t list[16], bytes[15][16];
    uint32_t kept[3][16], cells[5][16];
} lanes_outcome;

/* As kernels_base.c, kernels_avx2.c and kernels_avx512.c have them; the latter two do nothing where
   these are not compiled. */
void lanes_try_base(const lanes_input *in, lanes_outcome *out);
void lanes_try_avx2(const lanes_input *in, lanes_outcome *out);
void lanes_try_avx512(const lanes_input *in, lanes_outcome *out);
/* As on other machines: by the compiler's vector types, where it has them, and one by one. */
void lanes_try_vectors(const lanes_input *in, lanes_outcome *out);
void lanes_try_plain(const lanes_input *in, lanes_outcome *out);

#endif
