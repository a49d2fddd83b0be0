/*
 * What the library saves begins with this header: what it is, whether this machine can read it, and
 * whether it is whole.
 *
 * SPDX-License-Identifier: MIT
 *
 * The first four members stay as they are in every version, so that each version can tell what it
 * cannot read. The checksum finds accidents and no malice: whatever it covers is still to be
 * checked before it is used.
 */
#ifndef SC_BASE_SAVED_H
#define SC_BASE_SAVED_H

#include "starcontour.h"

/* SC_ALIGNMENT bytes, so that what follows is aligned if the header is. */
typedef struct sc_saved_header {
    unsigned char magic[8];
    uint32_t byte_order; /* SC_SAVED_BYTE_ORDER as the saving machine writes it */
    uint32_t version;    /* of the format */
    uint64_t checksum;   /* of all bytes behind this member */
    uint64_t bytes;      /* of everything, with this header */
    uint32_t library;    /* sc_version of the library that saved it; for people to read */
    uint32_t unused[7];  /* 0 */
} sc_saved_header;

#define SC_SAVED_BYTE_ORDER 0x01020304u

/* Fills a header for `bytes - sizeof *header` bytes of content. */
void sc_saved_seal(sc_saved_header *header, const char magic[8], uint32_t version, uint64_t bytes,
                   const void *content);

/*
 * Copies the header out of size bytes at data (any alignment) and checks all but the checksum:
 * SC_ERROR_NOT_SAVED, _TRUNCATED, _BYTE_ORDER, _TOO_NEW or _TOO_OLD. Afterwards header->bytes is
 * at least that of the header and at most size.
 */
sc_status sc_saved_open(const void *data, uint64_t size, const char magic[8], uint32_t version,
                        sc_saved_header *header);

/* SC_OK, or SC_ERROR_CHECKSUM. content is of header->bytes - sizeof *header bytes, of any
   alignment. A pass over it, at about the speed of memory. */
sc_status sc_saved_verify(const sc_saved_header *header, const void *content);

#endif
