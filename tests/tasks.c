/*
 * Hosts that run the parts of a query, and what they are asked; see tasks.h.
 *
 * SPDX-License-Identifier: MIT
 */
#include "tasks.h"

#include <stdlib.h>
#include <string.h>

#include "harness.h"
#include "inputs.h"

struct host_worker {
    host *its;
    uint32_t worker;
};

static void *host_work(void *argument)
{
    const host_worker *me = (const host_worker *)argument;
    host *h = me->its;
    for (;;) {
        uint32_t part;
        pthread_mutex_lock(&h->mutex);
        part = h->next++;
        pthread_mutex_unlock(&h->mutex);
        if (part >= h->count) return NULL;
        h->run(h->context, part, me->worker);
    }
}

static void *host_enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                          void *context, uint32_t count)
{
    host *h = (host *)user;
    if (h->is_busy || !count) ++h->mistakes;
    h->is_busy = 1;
    ++h->jobs;
    h->parts += count;
    h->run = run;
    h->context = context;
    h->count = count;
    h->next = 0;
    if (h->way == HOST_AT_ONCE)
        for (uint32_t part = 0; part < count; ++part) run(context, part, 0);
    if (h->way == HOST_THREADS)
        for (uint32_t t = 0; t < h->tasks.workers; ++t)
            if (pthread_create(&h->threads[t], NULL, host_work, &h->workers[t]) != 0) abort();
    return h->way == HOST_AT_ONCE ? NULL : h;
}

static void host_finish(void *user, void *task)
{
    host *h = (host *)user;
    if (!h->is_busy || task != (h->way == HOST_AT_ONCE ? NULL : h)) ++h->mistakes;
    h->is_busy = 0;
    if (h->way == HOST_FORWARDS)
        for (uint32_t part = 0; part < h->count; ++part)
            h->run(h->context, part, test_random_below(h->tasks.workers));
    if (h->way == HOST_BACKWARDS)
        while (h->count > 0) h->run(h->context, --h->count, test_random_below(h->tasks.workers));
    if (h->way == HOST_THREADS)
        for (uint32_t t = 0; t < h->tasks.workers; ++t) pthread_join(h->threads[t], NULL);
}

void host_start(host *h, int way, uint32_t workers)
{
    memset(h, 0, sizeof(*h));
    h->way = way < HOST_FIRST ? HOST_FIRST : way;
    h->tasks.struct_size = sizeof(h->tasks);
    h->tasks.workers = h->way == HOST_THREADS && workers > THREADS_MAX ? THREADS_MAX : workers;
    h->tasks.enqueue = host_enqueue;
    h->tasks.finish = host_finish;
    h->tasks.user = h;
    pthread_mutex_init(&h->mutex, NULL);
    h->workers = (host_worker *)test_allocate(THREADS_MAX * sizeof(host_worker));
    for (uint32_t t = 0; t < THREADS_MAX; ++t) {
        h->workers[t].its = h;
        h->workers[t].worker = t;
    }
}

void host_stop(host *h)
{
    pthread_mutex_destroy(&h->mutex);
    free(h->workers);
}

int trial_is_left_out(int scene, uint32_t number)
{
    const uint32_t percent = test_iterations(100), step = percent < 100 ? 100 / percent : 1;
    return (number + 3 * (uint32_t)scene) % step != 0;
}

/* ---- what queries are asked ---- */

int fixture_start_plain(fixture *f, soup mesh)
{
    sc_mesh input = input_plain_mesh(&mesh);
    memset(f, 0, sizeof(*f));
    f->mesh = mesh;
    f->posed = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
    memcpy(f->posed, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    f->pose = input_plain_pose(f->posed, mesh.vertex_count);
    return CHECK(sc_build(&input, NULL, &f->model) == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}

int fixture_start(fixture *f, soup mesh, double turns, double noise)
{
    if (!fixture_start_plain(f, mesh)) return 0;
    soup_smooth(f->posed, mesh.vertex_count, 0.1);
    if (turns > 1) soup_fold(f->posed, mesh.vertex_count);
    soup_twist(f->posed, mesh.vertex_count, turns);
    soup_noise(f->posed, mesh.vertex_count, noise);
    return 1;
}

void fixture_stop(fixture *f)
{
    sc_workspace_free(f->workspace);
    sc_model_free(f->model);
    soup_free(&f->mesh);
    free(f->posed);
}

sc_workspace_options options_for_workers(uint32_t workers)
{
    sc_workspace_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.workers = workers;
    return options;
}

sc_query_options no_options(void)
{
    sc_query_options options;
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    return options;
}

answer fixture_ask_with(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                        uint64_t capacity, int has_stats)
{
    answer a;
    memset(&a, 0, sizeof(a));
    a.pairs = (sc_pair *)test_allocate((capacity + 1) * sizeof(sc_pair));
    memset(a.pairs, 0xab, (capacity + 1) * sizeof(sc_pair));
    a.stats.struct_size = sizeof(a.stats);
    a.result.struct_size = sizeof(a.result);
    a.result.capacity = capacity;
    a.result.pairs = a.pairs;
    if (has_stats) a.result.stats = &a.stats;
    a.status = sc_query(f->model, workspace, &f->pose, options, &a.result);
    CHECK(a.pairs[capacity].a == 0xabababab && a.pairs[capacity].b == 0xabababab);
    return a;
}

answer fixture_ask(const fixture *f, sc_workspace *workspace, const sc_query_options *options,
                   uint64_t capacity)
{
    return fixture_ask_with(f, workspace, options, capacity, 1);
}

int answer_counts_same(const answer *a, const answer *b)
{
    return memcmp(a->stats.counts, b->stats.counts, sizeof(a->stats.counts)) == 0 &&
           a->stats.nodes_visited == b->stats.nodes_visited &&
           a->stats.nodes_oriented == b->stats.nodes_oriented &&
           a->stats.nodes_culled == b->stats.nodes_culled &&
           a->stats.leaf_pairs == b->stats.leaf_pairs &&
           a->stats.exact_fallbacks == b->stats.exact_fallbacks;
}

int answer_other_counts_same(const answer *a, const answer *b)
{
    answer c = *b;
    c.stats.counts[SC_TASK_BOXES_ORIENTATION] = a->stats.counts[SC_TASK_BOXES_ORIENTATION];
    c.stats.counts[SC_TASK_BOXES_CONTOUR] = a->stats.counts[SC_TASK_BOXES_CONTOUR];
    return answer_counts_same(a, &c);
}

int answer_is_same(const answer *a, answer b)
{
    uint64_t filled = a->result.count < a->result.capacity ? a->result.count : a->result.capacity;
    int same = a->status == b.status && a->result.count == b.result.count &&
               a->result.collides == b.result.collides && a->result.verdict == b.result.verdict &&
               memcmp(a->pairs, b.pairs, (size_t)filled * sizeof(sc_pair)) == 0;
    free(b.pairs);
    return same;
}

static void *breaker_enqueue(void *user, void (*run)(void *context, uint32_t part, uint32_t worker),
                             void *context, uint32_t count)
{
    breaker *b = (breaker *)user;
    for (uint32_t part = 0; part < count; ++part) {
        if (b->left > 0 && --b->left == 0) b->flag = 1;
        run(context, part, part % b->tasks.workers);
    }
    return NULL;
}

static void breaker_finish(void *user, void *task)
{
    (void)user;
    (void)task;
}

void breaker_start(breaker *b, uint32_t workers, uint32_t left)
{
    memset(b, 0, sizeof(*b));
    b->tasks.struct_size = sizeof(b->tasks);
    b->tasks.workers = workers;
    b->tasks.enqueue = breaker_enqueue;
    b->tasks.finish = breaker_finish;
    b->tasks.user = b;
    b->left = left;
}

int pair_is_among(sc_pair pair, const sc_pair *pairs, uint64_t count)
{
    uint64_t low = 0, high = count;
    while (low < high) {
        uint64_t middle = low + (high - low) / 2;
        if (pairs[middle].a < pair.a || (pairs[middle].a == pair.a && pairs[middle].b < pair.b))
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && pairs[low].a == pair.a && pairs[low].b == pair.b;
}

/* ---- trees that are not balanced ---- */

/* A leaf for each triangle: halves of halves, whose nodes are added behind others. */
static uint32_t add_balanced(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end)
{
    const uint32_t node = (*count)++, middle = first + (end - first) / 2;
    const sc_tree_node leaf = {SC_NONE, SC_NONE, first, 1};
    tree[node] = leaf;
    if (end - first > 1) {
        tree[node].left = add_balanced(tree, count, first, middle);
        tree[node].right = add_balanced(tree, count, middle, end);
    }
    return node;
}

/* One that loses a leaf at each of so many nodes, and then is balanced. */
static uint32_t add_chain(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end,
                          uint32_t length)
{
    uint32_t node;
    if (!length) return add_balanced(tree, count, first, end);
    node = (*count)++;
    tree[node].left = add_balanced(tree, count, first, first + 1);
    tree[node].right = add_chain(tree, count, first + 1, end, length - 1);
    return node;
}

/* So many equal parts, each with its first triangles in a chain and the others balanced. */
static uint32_t add_parts(sc_tree_node *tree, uint32_t *count, uint32_t first, uint32_t end,
                          uint32_t parts, uint32_t chained, uint32_t length)
{
    const uint32_t node = (*count)++, middle = first + (end - first) / 2;
    if (parts == 1) {
        tree[node].left = add_chain(tree, count, first, first + chained, length);
        tree[node].right = add_balanced(tree, count, first + chained, end);
    } else {
        tree[node].left = add_parts(tree, count, first, middle, parts / 2, chained, length);
        tree[node].right = add_parts(tree, count, middle, end, parts / 2, chained, length);
    }
    return node;
}

int fixture_start_tree(fixture *f, soup mesh, uint32_t parts, uint32_t chained, uint32_t length)
{
    const uint32_t count = mesh.triangle_count;
    sc_tree_node *tree = (sc_tree_node *)test_allocate(2 * count * sizeof(sc_tree_node));
    uint32_t *order = (uint32_t *)test_allocate(count * sizeof(uint32_t)), used = 0;
    sc_mesh input = input_plain_mesh(&mesh);
    sc_build_options options;
    sc_status status;
    for (uint32_t t = 0; t < count; ++t) order[t] = t;
    if (chained)
        add_parts(tree, &used, 0, count, parts, chained, length);
    else
        add_balanced(tree, &used, 0, count);
    memset(&options, 0, sizeof(options));
    options.struct_size = sizeof(options);
    options.partition = SC_PARTITION_TREE;
    options.order = order;
    options.tree = tree;
    options.tree_count = used;
    memset(f, 0, sizeof(*f));
    f->mesh = mesh;
    f->posed = (double *)test_allocate(3 * (size_t)mesh.vertex_count * sizeof(double));
    memcpy(f->posed, mesh.positions, 3 * (size_t)mesh.vertex_count * sizeof(double));
    f->pose = input_plain_pose(f->posed, mesh.vertex_count);
    status = sc_build(&input, &options, &f->model);
    free(tree);
    free(order);
    return CHECK(status == SC_OK) &&
           CHECK(sc_workspace_create(f->model, NULL, &f->workspace) == SC_OK);
}
