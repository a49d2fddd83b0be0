/*
 * Models as bytes. See saved_model.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "build/saved_model.h"

#include <inttypes.h>
#include <string.h>

#include "base/saved.h"
#include "build/model_check.h"

/* A byte that is no text, so that nothing takes it for one, and line ends that a transfer as text
   would change. */
static const char MAGIC[8] = {'\x93', 'S', 'C', 'M', '\r', '\n', '\x1a', '\n'};

/* Raised whenever the model's block changes: its counts, its arrays, or what is in them. */
enum { VERSION = 2 };

uint64_t sc_saved_model_bytes(const sc_model *model)
{
    return sizeof(sc_saved_header) + model->bytes;
}

void sc_saved_model_write(const sc_model *model, void *memory)
{
    sc_saved_header header;
    memcpy((unsigned char *)memory + sizeof header, model, (size_t)model->bytes);
    sc_saved_seal(&header, MAGIC, VERSION, sc_saved_model_bytes(model), model);
    memcpy(memory, &header, sizeof header);
}

sc_status sc_saved_model_triangles(const void *data, uint64_t size, uint32_t *count)
{
    sc_saved_header header;
    sc_model m;
    sc_status status = sc_saved_open(data, size, MAGIC, VERSION, &header);
    if (status) return status;
    if (header.bytes < sizeof header + sizeof m) return SC_ERROR_INCONSISTENT;
    memcpy(&m, (const unsigned char *)data + sizeof header, sizeof m);
    *count = m.triangle_count;
    return SC_OK;
}

/* From the checksum on. m is as long as the header says, which may be shorter than any model. */
static sc_status check(const sc_saved_header *header, const sc_model *m, uint64_t topology_hash,
                       sc_scratch *scratch, const sc_hooks *hooks)
{
    const uint64_t bytes = header->bytes - sizeof *header;
    const char *wrong = NULL;
    sc_status status = sc_saved_verify(header, m);
    if (status) return status;
    if (bytes < sizeof *m || !sc_model_check_counts(m, bytes)) {
        sc_hooks_log(hooks, SC_LOG_ERROR, "saved model: its counts do not fit its size");
        return SC_ERROR_INCONSISTENT;
    }
    if (topology_hash && topology_hash != m->topology_hash) {
        sc_hooks_log(hooks, SC_LOG_ERROR,
                     "saved model: topology hash %016" PRIx64 ", expected %016" PRIx64,
                     m->topology_hash, topology_hash);
        return SC_ERROR_TOPOLOGY;
    }
    status = sc_model_check(m, scratch, &wrong);
    if (status == SC_ERROR_INCONSISTENT)
        sc_hooks_log(hooks, SC_LOG_ERROR, "saved model: array %s is wrong", wrong);
    return status;
}

sc_status sc_saved_model_read(const void *data, uint64_t size, int in_place, uint64_t topology_hash,
                              sc_scratch *scratch, const sc_hooks *hooks, sc_model **model)
{
    const unsigned char *content = (const unsigned char *)data + sizeof(sc_saved_header);
    sc_saved_header header;
    sc_model *m;
    sc_status status = sc_saved_open(data, size, MAGIC, VERSION, &header);
    if (status) return status;
    if (in_place) {
        if ((uintptr_t)data % SC_ALIGNMENT) return SC_ERROR_ALIGNMENT;
        memcpy(&m, &content, sizeof m); /* not const, but only read: see sc_model_release */
        status = check(&header, m, topology_hash, scratch, hooks);
    } else {
        m = sc_model_allocate(header.bytes - sizeof header, scratch);
        if (!m) return SC_ERROR_MEMORY;
        memcpy(m, content,
               (size_t)(header.bytes - sizeof header)); /* what is checked is what stays */
        status = check(&header, m, topology_hash, scratch, hooks);
        if (status) sc_model_release(m);
    }
    if (!status) *model = m;
    return status;
}
