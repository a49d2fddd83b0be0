/*
 * Where a page goes: to a file (--html), or through a browser to a picture (--png).
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_PAGE_OUTPUT_H
#define TOOLS_PAGE_OUTPUT_H

#include "page_write.h"

/* All zero: there is no page. */
typedef struct page_output {
    page_file *page; /* NULL: none was begun */
    const char *html_path, *png_path;
    char drawn_path[1024]; /* of the page that the picture is drawn from */
} page_output;

/* Begins the page for one of the two files; if both are NULL, there is none. Otherwise says why it
   cannot be begun. */
bool page_output_begin(page_output *output, const char *html_path, const char *png_path);

/* Ends the page, and has it drawn. Otherwise says what went wrong. */
bool page_output_end(page_output *output);

#endif /* TOOLS_PAGE_OUTPUT_H */
