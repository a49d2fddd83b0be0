/*
 * What sc-query was asked, and what it found: what its parts share.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_SETTINGS_H
#define TOOLS_QUERY_SETTINGS_H

#include "apart.h"
#include "filter_file.h"
#include "near_settings.h"
#include "step_query.h"
#include "tool.h"

/* Of --jsonl: the most meshes at a time, and seconds of processor time for one, unless told. */
enum { BATCH_JOBS_MAX = 1024, BATCH_SECONDS = 600 };

/* What the command line says. */
typedef struct query_settings {
    step_settings step;          /* what --step alone asks */
    bool is_step, is_step_asked; /* --step; an option that only it takes */
    near_settings near;          /* what --near alone asks */
    bool is_near, is_near_asked;
    bool is_trace;
    const char *not_of_trace; /* an option that --trace does not take, if one was given */
    const char *not_of_near;  /* an option that --near does not take, if one was given */
    const char *method_name;  /* as given, or NULL */
    const char *not_of_steps; /* an option that --step does not take, if one was given */
    uint32_t pairs;           /* a value of query_pair_choices; 2: none */
    uint32_t method, contour, partition, weld;
    uint32_t content; /* of the models that are built: SC_MODEL_... */
    bool proper, any, json, stats, no_rest_cache;
    bool is_asked, is_built; /* some option said what to ask or how, or how to build */
    const char *rest_path, *out_path, *ply_path, *model_path, *record_path, *replay_path;
    uint32_t ignore_rings; /* 0: none */
    uint64_t budget;       /* 0: none */
    uint32_t simd;         /* SC_SIMD_... */
    const char *ignore_path, *groups_path;
    bool contacts;
    bool only_collisions;             /* --only: no places, no defects */
    const char *html_path, *png_path; /* the page, and a picture of it */
    uint32_t threads;
    const char *jsonl_path, *manifest_path; /* many meshes: see batch.h */
    uint32_t shard, shard_count, jobs;
    apart_limits limits;
    bool resume, timings;
    bool is_batch; /* an option was given that only --jsonl takes */
    char **paths;  /* path_count: the meshes, or frames */
    int path_count;
    filter_file *filters;         /* what the two files say */
    const sc_filter *given;       /* in place of these: what a record says */
    struct record_file *replayed; /* of --replay */
} query_settings;

struct query_checks;

/* What there is to know about one file. Index SC_PAIRS_TRIANGLE and SC_PAIRS_EDGE. */
typedef struct query_answer {
    const char *path;
    const mesh_file *mesh; /* whose faces and objects pairs are told by; NULL: not known */
    sc_model_info info;
    double build_ms;
    double query_ms[2];
    uint64_t counts[2];
    bool known[2]; /* whether counts and query_ms are there */
    bool collides;
    bool incomplete;                   /* a budget ended a query */
    bool rounded, has_animation;       /* as in mesh_file */
    uint32_t position_type;            /* of the pose */
    const struct query_checks *checks; /* see query_checks.h; NULL: none are asked for */
    sc_stats stats;
} query_answer;

/* Pairs of one query; grows and is kept. */
typedef struct query_list {
    sc_pair *pairs;
    uint64_t count, capacity;
    sc_contact *contacts; /* count, with --contacts */
} query_list;

/* The kind of pair that decides. */
static inline uint32_t query_chosen_pairs(const query_settings *set)
{
    return set->pairs == SC_PAIRS_EDGE ? SC_PAIRS_EDGE : SC_PAIRS_TRIANGLE;
}

/* Whether pairs are wanted, and not only their number. */
static inline bool query_wants_list(const query_settings *set)
{
    return set->out_path || set->ply_path || set->contacts || set->html_path || set->png_path;
}

/* Whether the mesh is looked at for what is listed besides its pairs. */
static inline bool query_wants_checks(const query_settings *set, const mesh_file *mesh)
{
    const bool draws = set->ply_path || set->html_path || set->png_path;
    return mesh && !set->any && (!set->only_collisions || draws);
}

/* Whether pairs are joined into places. */
static inline bool query_wants_places(const query_settings *set, const mesh_file *mesh)
{
    return query_wants_checks(set, mesh) && set->pairs != 2;
}

/* Whether the pairs between each two objects are counted: for that they are listed, too. */
static inline bool query_names_objects(const query_settings *set, const mesh_file *mesh)
{
    return mesh && mesh->object_count > 1 && !set->any && set->pairs != 2;
}

#endif /* TOOLS_QUERY_SETTINGS_H */
