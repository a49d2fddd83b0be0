/*
 * The command line of sc-query.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_QUERY_OPTIONS_H
#define TOOLS_QUERY_OPTIONS_H

#include "query_settings.h"

/* Values of --pairs, and of --method without --step. */
extern const tool_choice query_pair_choices[];
extern const tool_choice query_method_choices[];

/* There is something to do, and no exit status yet. */
enum { QUERY_OPTIONS_READ = -1 };

/* Sets what the arguments say; what they leave open is chosen. Returns QUERY_OPTIONS_READ, or the
   exit status, after --help, --version or a message that says what is wrong. */
int query_options_read(int argc, char **argv, query_settings *set);

#endif /* TOOLS_QUERY_OPTIONS_H */
