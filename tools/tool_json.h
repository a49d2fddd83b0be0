/*
 * What the command-line programs print as JSON (JavaScript Object Notation), by cJSON.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_TOOL_JSON_H
#define TOOLS_TOOL_JSON_H

#include <cjson/cJSON.h>

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

/* The number of the form that objects have, as starcontour.schema.json describes it: another one
   where a reader of this one would be misled. More members do not change it. */
enum { TOOL_JSON_SCHEMA = 1 };

/* A new object of a type, with that number and the library's version; NULL, on which cJSON does
   nothing, if there is no memory. */
cJSON *tool_json_object(const char *type);

/* The object of a type that says why a file could not be done. */
cJSON *tool_json_refusal(const char *type, const char *path, const char *error);

/* An object as a line, with its end and a 0 behind it, of *size bytes, to be freed by free; the
   object is freed. NULL, with a message, if there is no memory. JSON is UTF-8: bytes of names and
   paths that are not are taken for Latin-1. */
char *tool_json_line(cJSON *object, size_t *size);

/* Prints such a line; false, with a message, if there is no memory. */
bool tool_json_print(cJSON *object);

/* The same within a page of HTML, to a file and without a line end: no text ends a script. */
bool tool_json_write(cJSON *object, FILE *file);

#endif /* TOOLS_TOOL_JSON_H */
