/*
 * What the command-line programs print as JSON (JavaScript Object Notation), by cJSON.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_TOOL_JSON_H
#define TOOLS_TOOL_JSON_H

#include <cjson/cJSON.h>

#include <stdbool.h>

/* Prints an object on a line of its own and frees it; false, with a message, if there is no
   memory. */
bool tool_json_print(cJSON *object);

#endif /* TOOLS_TOOL_JSON_H */
