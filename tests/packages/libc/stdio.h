/* All that lib/ takes from <stdio.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdarg.h>
#include <stddef.h>
int vsnprintf(char *, size_t, const char *, va_list);
