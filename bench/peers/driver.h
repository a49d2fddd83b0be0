/*
 * What driver.cpp and objects_driver.cpp share: what was asked for on the command line, scenes that
 * are read, and contenders that take turns.
 *
 * SPDX-License-Identifier: MIT
 */
#ifndef PEERS_DRIVER_H
#define PEERS_DRIVER_H

#include "peer.h"

#include <cstdio>
#include <functional>

namespace peers
{

struct settings {
    unsigned threads = 1;
    size_t repeats = 5;
    size_t frames = SIZE_MAX;
    const char *csv = nullptr;
    std::vector<std::string> scenes;
};

/* A way to find pairs that takes turns with others. */
struct contender {
    /* Timed: all that a frame costs. The pairs go into an empty list, or stay where they are until
       listed is asked for them. */
    std::function<void(size_t frame, pair_list &found)> query;
    std::function<pair_list()> listed;
    kind finds = kind::all;
    size_t frames = 0; /* in so many of the first it has a turn */
    std::string name, version, what;
    unsigned threads = 1;
    std::vector<std::vector<double>> times;    /* of each frame: milliseconds of each repeat */
    std::vector<size_t> pairs, missing, extra; /* of each frame */
};

/* What contenders are asked about. */
struct subject {
    std::string name;
    size_t triangles = 0, frames = 0;
    /* The pairs of a frame, all and those that are apart, by starcontour. */
    std::function<void(size_t frame, pair_list &all, pair_list &apart)> reference;
};

/* Reads a folder with one mesh. Throws std::runtime_error with what is wrong. */
scene read_scene(std::string folder);

/* The last part of a path to a folder. */
std::string last_part(std::string folder);

/* Says, also in the CSV file if there is one, that a peer is not measured on a scene. */
void say_skipped(const std::string &name, const std::string &scene, const std::string &reason,
                 const settings &s, std::FILE *out);

/* Lets all take turns and writes their lines. beside: the library that is measured. Returns whether
   all pairs matched. */
bool measure(const subject &what, std::vector<contender> &contenders, const std::string &beside,
             const settings &s, std::FILE *out);

/* Whether a folder has a list of several objects, and not one mesh. */
bool is_of_objects(const std::string &folder);

/* Reads and measures such a folder. */
bool run_objects(const std::string &folder, const settings &s, std::FILE *out);

} // namespace peers

#endif /* PEERS_DRIVER_H */
