/*
 * What the command-line programs share: messages, a clock, option values, building a model.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_TOOL_H
#define TOOLS_TOOL_H

#include "mesh_file.h"

#include "starcontour.h"

#include <stdio.h>

/* Exit statuses of sc-query; the other programs use TOOL_CLEAN and TOOL_FAILED. */
enum { TOOL_CLEAN = 0, TOOL_COLLIDES = 1, TOOL_FAILED = 2, TOOL_INCOMPLETE = 3 };

/* Lets compilers check format strings. */
#if defined(__GNUC__)
#  define TOOL_PRINTF __attribute__((format(printf, 1, 2)))
#else
#  define TOOL_PRINTF
#endif

/* The name that begins every message; set by main. */
void tool_set_name(const char *name);

/* Prints "name: message" and a line end to stderr, after what stands in stdout. */
void tool_error(const char *format, ...) TOOL_PRINTF;

/* Hooks that keep the last error that the library says more of than a status. */
const sc_hooks *tool_hooks(void);

/* What is wrong: the error that tool_hooks kept, which is forgotten then, or the status in words.
   Valid until the next call. */
const char *tool_why(sc_status status);

/* Whether writing to out leaves alone a file that is to be read; otherwise says that it does not.
   Each may be NULL. */
bool tool_spares(const char *out, const char *in);

/* Closes a file that was written. Otherwise says that not all could be written. out may be NULL. */
bool tool_close(FILE *out, const char *path);

/* Milliseconds on a clock that never goes back. */
double tool_clock(void);

/* A word and what it stands for. Lists of these end with a NULL name. */
typedef struct tool_choice {
    const char *name;
    uint32_t value;
} tool_choice;

/* Looks text up among choices; if it is not there, says so and which there are. */
bool tool_choose(const char *option, const char *text, const tool_choice *choices, uint32_t *value);

/* The name of a value. */
const char *tool_choice_name(const tool_choice *choices, uint32_t value);

/* Reads a whole number from low to high; otherwise says what is wrong. */
bool tool_parse_number(const char *option, const char *text, uint32_t low, uint32_t high,
                       uint32_t *value);

/* Reads a finite number that is not negative; otherwise says what is wrong. */
bool tool_parse_real(const char *option, const char *text, double *value);

/* Values of --partition. */
enum { TOOL_PARTITION_FAST = 0, TOOL_PARTITION_METIS = 1 };
extern const tool_choice tool_partitions[];

/* Values of --format: MESH_FORMAT_.... */
extern const tool_choice tool_formats[];

/* Values of --weld. */
extern const tool_choice tool_welds[];

/* Builds a model with a partition of the list above; rest: SC_REST_..., content: SC_MODEL_...;
   tasks: threads to build with, or NULL; *milliseconds is how long it took. */
sc_status tool_build(const mesh_file *mesh, uint32_t weld, uint32_t partition, uint32_t rest,
                     uint32_t content, const sc_tasks *tasks, sc_model **model,
                     double *milliseconds);

/* A pose of packed positions. */
sc_pose tool_pose(const void *positions, uint32_t position_type, uint32_t vertex_count);

/* What coordinates a file gave: "float", "double", or "rounded" where a reader may have cost it
   digits. */
const char *tool_coordinates(bool rounded, uint32_t position_type);

/* What the table says behind the name of a file that is not answered for as it stands; or "". */
const char *tool_reading_note(bool rounded, bool has_animation);

/* Closes stdout and returns status, or, if not all could be written, says so and TOOL_FAILED. */
int tool_finish(int status);

#endif /* TOOLS_TOOL_H */
