/* All that lib/ takes from <inttypes.h>, for compilers of systems whose headers are not here.
 *
 * SPDX-License-Identifier: MIT
 */
#include <stdint.h>
#define PRIu32 "u"
#define PRIu64 "llu"
#define PRIx64 "llx"
