/*
 * What the command-line programs share; see tool.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "tool.h"

#include "starcontour_metis.h"

#include <errno.h>
#include <float.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>

const tool_choice tool_partitions[] = {
    {"fast", TOOL_PARTITION_FAST}, {"metis", TOOL_PARTITION_METIS}, {NULL, 0}};

const tool_choice tool_welds[] = {{"rest", SC_WELD_REST}, {"none", SC_WELD_NONE}, {NULL, 0}};

const tool_choice tool_formats[] = {{"obj", MESH_FORMAT_OBJ},
                                    {"off", MESH_FORMAT_OFF},
                                    {"ply", MESH_FORMAT_PLY},
                                    {"stl", MESH_FORMAT_STL},
                                    {NULL, 0}};

static const char *tool_name = "starcontour";

void tool_set_name(const char *name)
{
    tool_name = name;
}

void tool_error(const char *format, ...)
{
    fflush(stdout);
    fprintf(stderr, "%s: ", tool_name);
    va_list arguments;
    va_start(arguments, format);
    vfprintf(stderr, format, arguments);
    va_end(arguments);
    fputc('\n', stderr);
}

bool tool_close(FILE *out, const char *path)
{
    if (!out) return true;
    const bool written = !ferror(out);
    if (fclose(out) == 0 && written) return true;
    tool_error("%s: could not be written to the end", path);
    return false;
}

double tool_clock(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return 1e3 * (double)now.tv_sec + 1e-6 * (double)now.tv_nsec;
}

bool tool_choose(const char *option, const char *text, const tool_choice *choices, uint32_t *value)
{
    char names[256] = "";
    for (const tool_choice *choice = choices; choice->name; choice++) {
        if (strcmp(choice->name, text) == 0) {
            *value = choice->value;
            return true;
        }
        const size_t used = strlen(names);
        snprintf(names + used, sizeof names - used, "%s%s", used ? ", " : "", choice->name);
    }
    tool_error("%s: '%s' is not one of: %s", option, text, names);
    return false;
}

const char *tool_choice_name(const tool_choice *choices, uint32_t value)
{
    while (choices->name && choices->value != value) choices++;
    return choices->name ? choices->name : "?";
}

bool tool_parse_number(const char *option, const char *text, uint32_t low, uint32_t high,
                       uint32_t *value)
{
    char *end;
    errno = 0;
    const unsigned long number = strtoul(text, &end, 10);
    if (errno || text[0] < '0' || text[0] > '9' || *end || number < low || number > high) {
        tool_error("%s: '%s' is not a whole number from %lu to %lu", option, text,
                   (unsigned long)low, (unsigned long)high);
        return false;
    }
    *value = (uint32_t)number;
    return true;
}

bool tool_parse_real(const char *option, const char *text, double *value)
{
    char *end;
    const double number = strtod(text, &end);
    if (((text[0] < '0' || text[0] > '9') && text[0] != '.') || *end || !(number >= 0) ||
        number > DBL_MAX) {
        tool_error("%s: '%s' is not a number from 0 on", option, text);
        return false;
    }
    *value = number;
    return true;
}

static char said[256]; /* the last error that tool_hooks heard, "" if tool_why told it */

static void hear(void *user, uint32_t level, const char *message)
{
    (void)user;
    if (level == SC_LOG_ERROR) snprintf(said, sizeof said, "%s", message);
}

const sc_hooks *tool_hooks(void)
{
    static sc_hooks hooks;
    hooks.struct_size = sizeof hooks;
    hooks.log = hear;
    return &hooks;
}

const char *tool_why(sc_status status)
{
    static char why[sizeof said];
    memcpy(why, said, sizeof why);
    said[0] = '\0';
    return why[0] ? why : sc_status_string(status);
}

bool tool_spares(const char *out, const char *in)
{
    struct stat one, other;
    if (!out || !in || stat(out, &one) != 0 || stat(in, &other) != 0 || !S_ISREG(one.st_mode) ||
        one.st_dev != other.st_dev || one.st_ino != other.st_ino)
        return true;
    tool_error("%s is to be read, and would be written over", in);
    return false;
}

sc_status tool_build(const mesh_file *mesh, uint32_t weld, uint32_t partition, uint32_t rest,
                     uint32_t content, const sc_tasks *tasks, sc_model **model,
                     double *milliseconds)
{
    sc_mesh input;
    memset(&input, 0, sizeof input);
    input.struct_size = sizeof input;
    input.vertex_count = mesh->vertex_count;
    input.triangle_count = mesh->triangle_count;
    input.position_type = mesh->position_type;
    input.index_type = SC_UINT32;
    input.positions = mesh->positions;
    input.indices = mesh->indices;

    sc_build_options options;
    memset(&options, 0, sizeof options);
    options.struct_size = sizeof options;
    options.hooks = tool_hooks();
    options.weld = weld;
    options.rest = rest;
    options.content = content;
    options.tasks = tasks;
    if (partition == TOOL_PARTITION_METIS) {
        options.partition = SC_PARTITION_BISECT;
        options.bisect = sc_metis_bisect;
    }
    const double start = tool_clock();
    const sc_status status = sc_build(&input, &options, model);
    *milliseconds = tool_clock() - start;
    return status;
}

sc_pose tool_pose(const void *positions, uint32_t position_type, uint32_t vertex_count)
{
    sc_pose pose;
    memset(&pose, 0, sizeof pose);
    pose.struct_size = sizeof pose;
    pose.vertex_count = vertex_count;
    pose.position_type = position_type;
    pose.positions = positions;
    return pose;
}

const char *tool_coordinates(bool rounded, uint32_t position_type)
{
    return rounded ? "rounded" : position_type == SC_DOUBLE ? "double" : "float";
}

const char *tool_reading_note(bool rounded, bool has_animation)
{
    if (rounded && has_animation) return " (coordinates rounded, animation not played)";
    return rounded ? " (coordinates rounded)" : has_animation ? " (animation not played)" : "";
}

int tool_finish(int status)
{
    const bool written = !ferror(stdout);
    if (fclose(stdout) == 0 && written) return status;
    fprintf(stderr, "%s: cannot write to standard output\n", tool_name);
    return TOOL_FAILED;
}
