/* All that lib/ takes from <stdlib.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stddef.h>
void *malloc(size_t);
void free(void *);
