/*
 * What sc-query prints of any question: statistics and fields of tables; and how statuses add up.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_TEXT_H
#define TOOLS_QUERY_TEXT_H

#include "mesh_faces.h"
#include "tool.h"

#include <cjson/cJSON.h>

/* Names of SC_CONTOUR_... */
extern const tool_choice query_text_contours[];

/* The worse of two exit statuses: failures first, then what is not known, then collisions. */
int query_text_worse(int a, int b);

/* Milliseconds to a tenth of a microsecond. */
double query_text_rounded(double milliseconds);

/* Writes a field of comma-separated values (RFC 4180): quoted where it must be. */
void query_text_field(FILE *out, const char *text);

/* What follows tells which of the file's faces a triangle is a part of, and of which object it is
   (MESH_NO_OBJECT: of none). A triangle that is SC_NONE has no face, as a vertex has none. */

/* As two such fields: the name of the object, and the number of the face. */
void query_text_owner(FILE *out, const mesh_file *mesh, uint32_t triangle, uint32_t object);

/* The same of two triangles, as the end of a line. */
void query_text_owners(const mesh_file *mesh, uint32_t one, uint32_t other);

/* As members face_a and object_a, or face_b and object_b. */
void query_text_add_owner(cJSON *to, char which, const mesh_file *mesh, uint32_t triangle,
                          uint32_t object);

/* Pairs between each two objects, as "object_pairs". */
void query_text_add_tally(cJSON *object, const mesh_tally *tally, const mesh_file *mesh);

/* The tasks of a query and what became of the test tree, as lines of text, or as "stats" of an
   object. */
void query_text_stats(const sc_stats *stats);
void query_text_add_stats(cJSON *object, const sc_stats *stats);

#endif /* TOOLS_QUERY_TEXT_H */
