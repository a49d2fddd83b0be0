/* All that lib/ takes from <string.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_STRING_H
#define TESTS_LIBC_STRING_H

#include <stddef.h>
void *memcpy(void *, const void *, size_t);
void *memmove(void *, const void *, size_t);
void *memset(void *, int, size_t);
int memcmp(const void *, const void *, size_t);
void *memchr(const void *, int, size_t);
size_t strlen(const char *);

#endif /* TESTS_LIBC_STRING_H */
