/*
 * A small simulator of square cloth; see cloth_simulation.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "scenes/cloth_simulation.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

int cloth_simulation_init(cloth_simulation *cloth, uint32_t cells)
{
    memset(cloth, 0, sizeof *cloth);
    cloth->cells = cells;
    cloth->count = ((size_t)cells + 1) * ((size_t)cells + 1);
    cloth->duration = 1.0;
    cloth->positions = (double *)calloc(14 * cloth->count, sizeof(double));
    if (!cloth->positions) return -1;
    cloth->before = cloth->positions + 3 * cloth->count;
    cloth->push = cloth->before + 3 * cloth->count;
    cloth->shown = cloth->push + 3 * cloth->count;
    cloth->inverse_mass = cloth->shown + 3 * cloth->count;
    cloth->lift = cloth->inverse_mass + cloth->count;
    for (size_t i = 0; i < cloth->count; i++) cloth->inverse_mass[i] = 1.0;
    return 0;
}

void cloth_simulation_free(cloth_simulation *cloth)
{
    free(cloth->positions);
    memset(cloth, 0, sizeof *cloth);
}

/* Moves two particles towards their distance at rest. softness: compliance over the squared
   step. */
static void restore_distance(cloth_simulation *cloth, size_t a, size_t b, double rest,
                             double softness)
{
    double *p = cloth->positions + 3 * a, *q = cloth->positions + 3 * b;
    const double x = q[0] - p[0], y = q[1] - p[1], z = q[2] - p[2];
    const double wa = cloth->inverse_mass[a], wb = cloth->inverse_mass[b];
    const double length = sqrt(x * x + y * y + z * z) + 1e-300;
    const double weight = wa + wb;
    if (weight == 0.0) return;
    const double move = (length - rest) / (length * (weight + softness));
    const double ma = move * wa, mb = move * wb;
    p[0] += ma * x;
    p[1] += ma * y;
    p[2] += ma * z;
    q[0] -= mb * x;
    q[1] -= mb * y;
    q[2] -= mb * z;
}

/*
 * All distances between a particle and the one that lies rows and columns further. Those that share
 * no particle with each other come in one sweep, so that they do not wait for one another: for a
 * distance of n rows (or else columns) first n rows of every 2 n, then the others.
 */
static void restore_all(cloth_simulation *cloth, uint32_t rows, int columns, double softness)
{
    const uint32_t side = cloth->cells + 1;
    const uint32_t wide = (uint32_t)(columns < 0 ? -columns : columns);
    const uint32_t begin = columns < 0 ? wide : 0, end = columns > 0 ? side - wide : side;
    const double rest = cloth->spacing * sqrt((double)(rows * rows + wide * wide));
    for (uint32_t sweep = 0; sweep < 2; sweep++) {
        for (uint32_t row = 0; row + rows < side; row++) {
            if (rows > 0 && row / rows % 2 != sweep) continue;
            for (uint32_t column = begin; column < end; column++) {
                if (rows == 0 && column / wide % 2 != sweep) continue;
                const size_t a = (size_t)row * side + column;
                const size_t b = (size_t)(row + rows) * side + column + (size_t)columns;
                restore_distance(cloth, a, b, rest, softness);
            }
        }
    }
}

static void step(cloth_simulation *cloth)
{
    const double h = cloth->duration / (double)cloth->steps;
    const double kept = exp(-cloth->drag * h);
    for (size_t i = 0; i < cloth->count; i++) {
        for (size_t k = 0; k < 3; k++) {
            double *at = &cloth->positions[3 * i + k], *before = &cloth->before[3 * i + k];
            const double pull = cloth->push[3 * i + k] - (k == 2 ? cloth->gravity : 0.0);
            const double next = *at + kept * (*at - *before) + h * h * pull;
            *before = *at;
            if (cloth->inverse_mass[i] > 0.0) *at = next;
        }
    }
    cloth->done++;
    const double time = (double)cloth->done / (double)cloth->steps;
    if (cloth->hold) cloth->hold(cloth, time);
    restore_all(cloth, 0, 2, cloth->bending / (h * h));
    restore_all(cloth, 2, 0, cloth->bending / (h * h));
    restore_all(cloth, 1, 1, cloth->shear / (h * h));
    restore_all(cloth, 1, -1, cloth->shear / (h * h));
    restore_all(cloth, 0, 1, 0.0);
    restore_all(cloth, 1, 0, 0.0);
    if (cloth->hold) cloth->hold(cloth, time);
}

const double *cloth_simulation_run(cloth_simulation *cloth, double time)
{
    if (cloth->done == 0) {
        memcpy(cloth->before, cloth->positions, 3 * cloth->count * sizeof(double));
    }
    const double wanted = time * (double)cloth->steps;
    while ((double)cloth->done < wanted && cloth->done < cloth->steps) step(cloth);
    /* The wanted moment lies in the last step. */
    const double back = fmax((double)cloth->done - wanted, 0.0);
    for (size_t i = 0; i < 3 * cloth->count; i++) {
        cloth->shown[i] = cloth->positions[i] + back * (cloth->before[i] - cloth->positions[i]);
    }
    return cloth->shown;
}
