/* All that lib/ takes from <stdio.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_STDIO_H
#define TESTS_LIBC_STDIO_H

#include <stdarg.h>
#include <stddef.h>
int vsnprintf(char *, size_t, const char *, va_list);

#endif /* TESTS_LIBC_STDIO_H */
