/*
 * What sc-query --near prints and writes of a pose: a row of the table or an object of JSON, pairs
 * as comma-separated values, and the mesh coloured by distance.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_NEAR_REPORT_H
#define TOOLS_NEAR_REPORT_H

#include "feature_pairs.h"
#include "near_settings.h"
#include "thickness.h"
#include "tool.h"

/* Values of --kinds, and of --method with --near. */
extern const tool_choice near_kinds[], near_methods[];

/* What there is to know about a pose. */
typedef struct near_answer {
    const char *path;
    const mesh_file *mesh;          /* whose faces and objects pairs are told by */
    const uint32_t *vertex_objects; /* where they are told, else NULL */
    const uint32_t *weld_map;       /* the vertex that represents each, or NULL: itself */
    const sc_model *model;
    const sc_pose *pose;
    sc_model_info info;
    double build_ms, query_ms;
    uint64_t counts[KINDS];
    const sc_pair *pairs[KINDS]; /* where they are listed */
    bool near, incomplete;
    bool unrecorded;   /* --record failed, which was told */
    double nearest;    /* the smallest distance; HUGE_VAL: not known, or none */
    double *thickness; /* of each face, with --thickness; HUGE_VAL: more than the distance */
    thickness_spread spread;
    sc_stats stats;
    mesh_tally tally;            /* pairs by their objects, if there are several */
    bool rounded, has_animation; /* as in mesh_file */
    uint32_t position_type;      /* of the pose */
} near_answer;

/* Whether the distances of all pairs are told, or shown, or the smallest is. */
static inline bool near_tells_distances(const near_settings *set)
{
    return set->list || set->stencils || set->out_path || (set->ply_path && !set->thickness) ||
           (set->is_line && !set->any);
}

/* Whether pairs are wanted, and not only their number. */
static inline bool near_wants_list(const near_settings *set)
{
    return set->thickness || near_tells_distances(set);
}

/* Whether the pairs between each two objects are counted: for that they are listed, too. */
static inline bool near_names_objects(const near_settings *set, const mesh_file *mesh)
{
    return mesh->object_count > 1 && !set->any;
}

/* Finds the smallest distance among the pairs. */
sc_status near_report_nearest(near_answer *answer);

/* The head of the table, and of the file of pairs. */
void near_report_head(const near_settings *set);
void near_report_pairs_head(FILE *out, const near_settings *set);

/* Prints what came of a query, and writes its pairs to out unless that is NULL. Returns the exit
   status. */
int near_report(const near_answer *answer, const near_settings *set, FILE *out);

/* Says why a file could not be done: as a message, and as an object if there is JSON. Returns
   TOOL_FAILED. */
int near_report_failure(const char *path, const near_settings *set, const char *error);

/* Adds what was asked, as the objects of files have it. */
void near_report_add_settings(cJSON *object, const near_settings *set);

/* Writes the file of --ply; otherwise says why not. */
bool near_report_ply(const near_answer *answer, const near_settings *set);

#endif /* TOOLS_NEAR_REPORT_H */
