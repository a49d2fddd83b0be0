/* All that lib/ takes from <inttypes.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef TESTS_LIBC_INTTYPES_H
#define TESTS_LIBC_INTTYPES_H

#include <stdint.h>
#define PRIu32 "u"
#define PRIu64 "llu"
#define PRIx64 "llx"

#endif /* TESTS_LIBC_INTTYPES_H */
