/* All that lib/ takes from <stdlib.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_STDLIB_H
#define TESTS_LIBC_STDLIB_H

#include <stddef.h>
void *malloc(size_t);
void free(void *);

#endif /* TESTS_LIBC_STDLIB_H */
