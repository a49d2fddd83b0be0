/*
 * The header of what is saved. See saved.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "base/saved.h"

#include <stddef.h>
#include <string.h>

/* A compiler stops here if the header is of another size. */
typedef char header_is_one_unit[sizeof(sc_saved_header) == SC_ALIGNMENT ? 1 : -1];

enum { LANES = 4 };

/* Any odd number keeps the steps below one to one; this one's bits are well mixed. */
static const uint64_t FACTOR = 0x9fb21c651e98df25u;

static uint64_t mix_word(uint64_t hash, uint64_t word)
{
    hash = (hash ^ word) * FACTOR;
    return hash ^ (hash >> 29);
}

/*
 * Four independent chains, so that the machine need not wait for one product before it starts the
 * next. Each step is one to one in the word and in the chain: so any change within eight bytes
 * changes the checksum, and any other one misses with a chance of 2^-64 or so.
 */
static uint64_t sum(uint64_t hash, const void *data, uint64_t bytes)
{
    const unsigned char *at = (const unsigned char *)data;
    uint64_t lane[LANES], word[LANES], left = bytes;
    int k;
    for (k = 0; k < LANES; k++) lane[k] = hash + (uint64_t)k;
    for (; left >= sizeof word; left -= sizeof word, at += sizeof word) {
        memcpy(word, at, sizeof word);
        for (k = 0; k < LANES; k++) {
            lane[k] = (lane[k] ^ word[k]) * FACTOR;
            lane[k] ^= lane[k] >> 32;
        }
    }
    memset(word, 0, sizeof word);
    if (left) memcpy(word, at, (size_t)left);
    hash = mix_word(hash, bytes);
    for (k = 0; k < LANES; k++) hash = mix_word(mix_word(hash, lane[k]), word[k]);
    return hash;
}

static uint64_t checksum(const sc_saved_header *header, const void *content)
{
    const size_t from = offsetof(sc_saved_header, bytes);
    uint64_t hash = sum(0, (const unsigned char *)header + from, sizeof *header - from);
    return sum(hash, content, header->bytes - sizeof *header);
}

void sc_saved_seal(sc_saved_header *header, const char magic[8], uint32_t version, uint64_t bytes,
                   const void *content)
{
    memset(header, 0, sizeof *header);
    memcpy(header->magic, magic, sizeof header->magic);
    header->byte_order = SC_SAVED_BYTE_ORDER;
    header->version = version;
    header->bytes = bytes;
    header->library = SC_VERSION_NUMBER;
    header->checksum = checksum(header, content);
}

static uint32_t swapped(uint32_t x)
{
    return x >> 24 | (x >> 8 & 0xff00u) | (x << 8 & 0xff0000u) | x << 24;
}

sc_status sc_saved_open(const void *data, uint64_t size, const char magic[8], uint32_t version,
                        sc_saved_header *header)
{
    const uint64_t known = offsetof(sc_saved_header, checksum);
    memset(header, 0, sizeof *header);
    memcpy(header, data, (size_t)(size < sizeof *header ? size : sizeof *header));
    if (memcmp(header->magic, magic, (size_t)(size < 8 ? size : 8)) != 0) return SC_ERROR_NOT_SAVED;
    if (size < known) return SC_ERROR_TRUNCATED;
    if (header->byte_order == swapped(SC_SAVED_BYTE_ORDER)) return SC_ERROR_BYTE_ORDER;
    if (header->byte_order != SC_SAVED_BYTE_ORDER) return SC_ERROR_NOT_SAVED;
    if (header->version > version) return SC_ERROR_TOO_NEW;
    if (header->version < version) return SC_ERROR_TOO_OLD;
    if (size < sizeof *header || header->bytes > size) return SC_ERROR_TRUNCATED;
    return header->bytes < sizeof *header ? SC_ERROR_CHECKSUM : SC_OK;
}

sc_status sc_saved_verify(const sc_saved_header *header, const void *content)
{
    return checksum(header, content) == header->checksum ? SC_OK : SC_ERROR_CHECKSUM;
}
