/*
 * What sc-query lists of a mesh besides its pairs: the places where it collides, its defects and
 * its parts.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_CHECKS_H
#define TOOLS_QUERY_CHECKS_H

#include "places.h"
#include "query_settings.h"
#include "query_subject.h"

#include <cjson/cJSON.h>

/* All zero: nothing is known. */
typedef struct query_checks {
    uint32_t *weld_map; /* NULL: vertices are as they were read */
    mesh_check mesh;    /* of one mesh, for all its poses */
    bool is_made;       /* the two above are there */
    bool has_places;    /* these are, of the last pose */
    place_list places;
    uint32_t degenerate_faces; /* in that pose */
} query_checks;

/* Looks at a mesh, unless that was done before. Of the subject is the map of its vertices, if it
   has one; otherwise set->weld tells how they are joined. */
sc_status query_checks_mesh(query_checks *checks, const mesh_file *mesh,
                            const query_subject *subject, const query_settings *set);

/* Looks at a pose of it: the places of a list of pairs, if set asks for them. */
sc_status query_checks_pose(query_checks *checks, const mesh_file *mesh, const sc_model *model,
                            const sc_pose *pose, const query_settings *set, const query_list *list);

/* Frees everything. */
void query_checks_free(query_checks *checks);

/* Prints the largest places, a line each, and the defects that there are, as one line. */
void query_checks_print(const query_checks *checks, const mesh_file *mesh);

/* All of it as members of an object: "places", "defects" and "parts". */
void query_checks_add(cJSON *object, const query_checks *checks, const mesh_file *mesh);

/* Defects as "defects". */
void query_checks_add_defects(cJSON *object, const mesh_check *check, uint32_t degenerate_faces);

/* The places of a list as an array, all or so many of them; with numbers of triangles, or not. */
cJSON *query_checks_places(const place_list *list, const mesh_check *check, const mesh_file *mesh,
                           uint32_t count, bool has_triangles);

#endif /* TOOLS_QUERY_CHECKS_H */
