/*
 * Many meshes; see batch.h.
 *
 * SPDX-License-Identifier: MIT
 */
#define _POSIX_C_SOURCE 200809L

#include "batch.h"

#include "manifest.h"
#include "batch_progress.h"
#include "query_summary.h"
#include "query_text.h"
#include "result_file.h"
#include "tool_json.h"

#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>

/* How many meshes are begun before the line that is written next, for each that runs at a time. */
enum { AHEAD = 16 };

/* A mesh that was begun and whose line is not written. */
typedef struct batch_slot {
    apart worker;
    bool is_done;   /* the worker has ended; its answer, or why there is none, waits */
    bool was_ended; /* by SIGKILL from outside, once */
} batch_slot;

typedef struct batch {
    const query_settings *set;
    const batch_lines *lines;
    batch_work work;
    void *user;
    char **paths;   /* of this part */
    uint64_t count; /* of these */
    uint64_t begun, written;
    batch_slot *slots;      /* slot_count: mesh i has number i modulo that */
    struct pollfd *polled;  /* slot_count */
    uint64_t *polled_slots; /* slot_count: of which mesh */
    uint32_t slot_count, running;
    char *start; /* see line_start */
    result_file file;
    query_summary summary;
    batch_progress shown;
    int status; /* so far */
} batch;

/* What the line of a mesh begins with: all up to "status". */
static const char *line_start(void *user, uint64_t index)
{
    batch *self = (batch *)user;
    size_t size;
    free(self->start);
    self->start = NULL;
    if (index >= self->count) return NULL;
    cJSON *object = tool_json_object(self->lines->type);
    cJSON_AddStringToObject(object, "file", self->paths[index]);
    self->start = tool_json_line(object, &size);
    if (self->start) self->start[size - 2] = '\0'; /* without the brace */
    return self->start;
}

/* Adds a line that is in the file to the summary; false if it is no line of results. */
static bool add_line(batch *self, uint64_t index, const cJSON *line)
{
    const batch_lines *lines = self->lines;
    const char *const names[] = {"clean", lines->found, "error", "incomplete"};
    const char *name = cJSON_GetStringValue(cJSON_GetObjectItem(line, "status"));
    int status = 0;
    while (name && status < 4 && strcmp(names[status], name) != 0) status++;
    if (!name || status == 4) return false;
    uint64_t pairs = 0;
    for (int i = 0; i < 2 && lines->counts[i]; i++) {
        const cJSON *count = cJSON_GetObjectItem(line, lines->counts[i]);
        pairs += cJSON_IsNumber(count) ? (uint64_t)count->valuedouble : 0;
    }
    query_summary_add(&self->summary, status, cJSON_IsTrue(cJSON_GetObjectItem(line, lines->found)),
                      self->paths[index], NULL, pairs);
    self->status = query_text_worse(self->status, status);
    return true;
}

/* Whether a line has what this run asks, and nothing that it does not ask. */
static bool has_settings(const batch *self, const cJSON *line)
{
    const batch_lines *lines = self->lines;
    for (const cJSON *asked = lines->settings->child; asked; asked = asked->next) {
        if (!cJSON_Compare(asked, cJSON_GetObjectItem(line, asked->string), true)) return false;
    }
    for (int i = 0; lines->optional[i]; i++) {
        if (cJSON_HasObjectItem(line, lines->optional[i]) !=
            cJSON_HasObjectItem(lines->settings, lines->optional[i]))
            return false;
    }
    for (int i = 0; lines->members[i]; i++) {
        if (cJSON_HasObjectItem(line, lines->members[i]) != (int)lines->wants[i]) return false;
    }
    return true;
}

static bool look_at_line(void *user, uint64_t index, const char *text,
                         char error[MESH_FILE_ERROR_SIZE])
{
    batch *self = (batch *)user;
    const char *start = line_start(self, index);
    cJSON *line = NULL;
    const char *wrong = NULL;
    if (index >= self->count) {
        wrong = "the list ends before it";
    } else if (!start || strncmp(text, start, strlen(start)) != 0) {
        wrong = "it is no line of this version for that file of the list";
    } else {
        line = cJSON_Parse(text);
        const char *status = cJSON_GetStringValue(cJSON_GetObjectItem(line, "status"));
        if (!status)
            wrong = "it is no line of results";
        else if (strcmp(status, "error") != 0 && !has_settings(self, line))
            wrong = "it is of a run with other options";
        else if (!add_line(self, index, line))
            wrong = "it is no line of results";
    }
    cJSON_Delete(line);
    if (wrong)
        snprintf(error, MESH_FILE_ERROR_SIZE, "%s: line %.0f: %s; the file is left as it is",
                 self->set->jsonl_path, (double)index + 1, wrong);
    else
        self->written = index + 1;
    return !wrong;
}

static int run_mesh(void *user, uint64_t index)
{
    const batch *self = (const batch *)user;
    return self->work(self->user, self->paths[index]);
}

static batch_slot *slot_of(batch *self, uint64_t index)
{
    return &self->slots[index % self->slot_count];
}

static bool start_mesh(batch *self, uint64_t index)
{
    batch_slot *slot = slot_of(self, index);
    slot->is_done = false;
    if (!apart_start(&slot->worker, run_mesh, self, index, &self->set->limits)) return false;
    self->running++;
    return true;
}

/* Starts as many as may run. */
static bool start_meshes(batch *self)
{
    while (self->running < self->set->jobs && self->begun < self->count &&
           self->begun < self->written + self->slot_count) {
        slot_of(self, self->begun)->was_ended = false;
        if (start_mesh(self, self->begun)) {
            self->begun++;
        } else if (self->running && (errno == EAGAIN || errno == EMFILE || errno == ENFILE)) {
            return true; /* once others have ended */
        } else {
            tool_error("no process can be started: %s", strerror(errno));
            return false;
        }
    }
    return true;
}

/* Whether what ended a process asks the run to end, rather than being the mesh's fault. */
static bool is_told_to_end(const apart *worker)
{
    if (!WIFSIGNALED(worker->status)) return false;
    const int number = WTERMSIG(worker->status);
    return number == SIGINT || number == SIGTERM || number == SIGHUP || number == SIGQUIT;
}

/* A mesh's process has ended. */
static bool end_mesh(batch *self, uint64_t index)
{
    batch_slot *slot = slot_of(self, index);
    const apart *worker = &slot->worker;
    self->running--;
    slot->is_done = true;
    if (is_told_to_end(worker)) {
        tool_error("ended by signal %d; --resume goes on", WTERMSIG(worker->status));
        return false;
    }
    if (WIFSIGNALED(worker->status) && WTERMSIG(worker->status) == SIGKILL && !worker->is_late &&
        !worker->is_full && !slot->was_ended) {
        const struct timespec second = {1, 0};
        nanosleep(&second, NULL);
        slot->was_ended = true;
        if (start_mesh(self, index)) return true;
        tool_error("no process can be started: %s", strerror(errno));
        return false;
    }
    return true;
}

/* Waits a little for what the processes print. */
static bool wait_for_meshes(batch *self)
{
    nfds_t count = 0;
    for (uint64_t i = self->written; i < self->begun; i++) {
        if (slot_of(self, i)->is_done) continue;
        self->polled[count].fd = slot_of(self, i)->worker.pipe;
        self->polled[count].events = POLLIN;
        self->polled[count].revents = 0;
        self->polled_slots[count++] = i;
    }
    if (poll(self->polled, count, 200) < 0 && errno != EINTR) {
        tool_error("cannot wait for processes: %s", strerror(errno));
        return false;
    }
    for (nfds_t k = 0; k < count; k++) {
        const uint64_t index = self->polled_slots[k];
        if (apart_take(&slot_of(self, index)->worker, self->polled[k].revents != 0) &&
            !end_mesh(self, index))
            return false;
    }
    return true;
}

/* The answer that a process printed, if it is one whole line and the process ended well. */
static cJSON *read_answer(apart *worker)
{
    if (worker->is_late || worker->is_full || !WIFEXITED(worker->status) ||
        WEXITSTATUS(worker->status) > TOOL_INCOMPLETE || worker->size < 2)
        return NULL;
    char *end = worker->text + worker->size - 1;
    if (memchr(worker->text, '\n', worker->size) != end) return NULL;
    *end = '\0';
    cJSON *line = cJSON_Parse(worker->text);
    *end = '\n';
    return line;
}

/* Writes the line of a mesh. */
static bool write_line(batch *self, uint64_t index)
{
    apart *worker = &slot_of(self, index)->worker;
    char error[MESH_FILE_ERROR_SIZE], *refusal = NULL;
    const char *text = worker->text;
    size_t size = worker->size;
    cJSON *line = read_answer(worker);
    if (!line) {
        char why[128];
        apart_why(worker, &self->set->limits, why, sizeof why);
        snprintf(error, sizeof error, "%s: %s", self->paths[index], why);
        text = refusal =
            tool_json_line(tool_json_refusal(self->lines->type, self->paths[index], error), &size);
        line = refusal ? cJSON_Parse(refusal) : NULL;
    }
    bool is_written = line != NULL;
    if (is_written && !result_file_append(&self->file, text, size, error)) {
        tool_error("%s", error);
        is_written = false;
    }
    is_written = is_written && add_line(self, index, line);
    cJSON_Delete(line);
    free(refusal);
    return is_written;
}

/* All meshes that are left. */
static bool do_meshes(batch *self)
{
    while (self->written < self->count) {
        if (!start_meshes(self) || !wait_for_meshes(self)) return false;
        while (self->written < self->begun && slot_of(self, self->written)->is_done) {
            if (!write_line(self, self->written)) return false;
            self->written++;
        }
        batch_progress_show(&self->shown, self->written, self->summary.colliding,
                            self->summary.refused);
    }
    return true;
}

static void end_meshes(batch *self)
{
    for (uint64_t i = self->written; i < self->begun; i++) {
        if (!slot_of(self, i)->is_done) apart_kill(&slot_of(self, i)->worker);
    }
}

static bool allocate(batch *self)
{
    self->slot_count = AHEAD * self->set->jobs;
    self->slots = (batch_slot *)calloc(self->slot_count, sizeof *self->slots);
    self->polled = (struct pollfd *)calloc(self->slot_count, sizeof *self->polled);
    self->polled_slots = (uint64_t *)calloc(self->slot_count, sizeof *self->polled_slots);
    if (self->slots && self->polled && self->polled_slots && self->lines->settings) return true;
    tool_error("out of memory");
    return false;
}

static void release(batch *self)
{
    for (uint32_t i = 0; self->slots && i < self->slot_count; i++) free(self->slots[i].worker.text);
    free(self->slots);
    free(self->polled);
    free(self->polled_slots);
    free(self->start);
}

/* The part of the list that is to be done. */
static bool take_list(batch *self, manifest *list)
{
    char error[MESH_FILE_ERROR_SIZE];
    uint64_t first, end;
    memset(list, 0, sizeof *list);
    if (!self->set->manifest_path) {
        list->paths = self->set->paths;
        list->count = (uint64_t)self->set->path_count;
    } else if (!manifest_read(list, self->set->manifest_path, error)) {
        tool_error("%s", error);
        return false;
    }
    manifest_part(list->count, self->set->shard, self->set->shard_count, &first, &end);
    self->paths = list->paths + first;
    self->count = end - first;
    return true;
}

int batch_run(const query_settings *set, const batch_lines *lines, batch_work work, void *user)
{
    batch self;
    manifest list;
    char error[MESH_FILE_ERROR_SIZE];
    memset(&self, 0, sizeof self);
    self.set = set;
    self.lines = lines;
    self.work = work;
    self.user = user;
    if (!take_list(&self, &list)) return TOOL_FAILED;
    bool is_done = allocate(&self);
    if (is_done && !result_file_open(&self.file, set->jsonl_path, set->resume, line_start,
                                     look_at_line, &self, error)) {
        tool_error("%s", error);
        is_done = false;
    } else if (is_done) {
        self.begun = self.written;
        batch_progress_begin(&self.shown, self.written, self.count);
        is_done = do_meshes(&self);
        end_meshes(&self);
        batch_progress_end(&self.shown);
        if (!result_file_close(&self.file, error)) {
            tool_error("%s", error);
            is_done = false;
        }
    }
    if (is_done) is_done = query_summary_print(&self.summary, false, set->json);
    release(&self);
    manifest_free(&list);
    return is_done ? self.status : TOOL_FAILED;
}
