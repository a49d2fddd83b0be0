/*
 * tools/page/page.html, as it is compiled into the programs that write pages; the Makefile makes
 * page_bytes.c of it.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TOOLS_PAGE_BYTES_H
#define TOOLS_PAGE_BYTES_H

#include <stddef.h>

extern const unsigned char page_bytes[];
extern const size_t page_bytes_size;

#endif /* TOOLS_PAGE_BYTES_H */
