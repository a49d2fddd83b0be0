/*
 * The end of a run of sc-query; see query_summary.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "query_summary.h"

#include "tool_json.h"

void query_summary_add(query_summary *summary, int status, bool collides, const char *start,
                       const char *end, uint64_t pairs)
{
    const query_moment here = {summary->all, pairs, start, end};
    summary->all++;
    summary->clean += status == TOOL_CLEAN;
    summary->colliding += status == TOOL_COLLIDES;
    summary->incomplete += status == TOOL_INCOMPLETE;
    summary->refused += status == TOOL_FAILED;
    if (status == TOOL_FAILED || !collides) return;
    if (!summary->first.start) summary->first = here;
    if (pairs > summary->worst.pairs) summary->worst = here;
}

static void print_moment(const char *what, const query_moment *moment)
{
    if (!moment->start) return;
    printf("%s %s%s%s", what, moment->start, moment->end ? " to " : "",
           moment->end ? moment->end : "");
}

static void print_line(const query_summary *s, bool is_step)
{
    printf("%.0f %s: %.0f clean, %.0f colliding", (double)s->all, is_step ? "steps" : "files",
           (double)s->clean, (double)s->colliding);
    if (s->incomplete) printf(", %.0f incomplete", (double)s->incomplete);
    printf(", %.0f refused", (double)s->refused);
    print_moment("; first", &s->first);
    print_moment("; worst", &s->worst);
    if (s->worst.start) printf(" (%.0f pairs)", (double)s->worst.pairs);
    puts("");
}

static void add_moment(cJSON *object, const char *name, const query_moment *moment)
{
    if (!moment->start) {
        cJSON_AddNullToObject(object, name);
        return;
    }
    object = cJSON_AddObjectToObject(object, name);
    cJSON_AddNumberToObject(object, "index", (double)moment->index);
    cJSON_AddStringToObject(object, moment->end ? "start" : "file", moment->start);
    if (moment->end) cJSON_AddStringToObject(object, "end", moment->end);
    if (moment->pairs)
        cJSON_AddNumberToObject(object, "pairs", (double)moment->pairs);
    else
        cJSON_AddNullToObject(object, "pairs");
}

bool query_summary_print(const query_summary *s, bool is_step, bool json)
{
    if (s->all < 2) return true;
    if (!json) {
        print_line(s, is_step);
        return true;
    }
    cJSON *object = tool_json_object("summary");
    cJSON_AddNumberToObject(object, is_step ? "steps" : "files", (double)s->all);
    cJSON_AddNumberToObject(object, "clean", (double)s->clean);
    cJSON_AddNumberToObject(object, "colliding", (double)s->colliding);
    cJSON_AddNumberToObject(object, "incomplete", (double)s->incomplete);
    cJSON_AddNumberToObject(object, "refused", (double)s->refused);
    add_moment(object, "first", &s->first);
    add_moment(object, "worst", &s->worst);
    return tool_json_print(object);
}
