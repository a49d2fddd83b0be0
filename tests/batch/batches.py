"""starcontour.batch by numpy alone, and by the engines that hand out batches: Dask and Ray Data, a
worker of which is killed in the middle.

    python3 batches.py numpy|dask|ray SCRATCH_FOLDER

The last line is the sum: "N passed, N failed".

SPDX-License-Identifier: MIT
"""

import os
import pickle
import signal
import sys
import threading

import numpy as np

import starcontour
from starcontour import batch

COUNT, PART, KILLED = 120, 10, 45
passed = failed = 0


def check(what, is_so):
    global passed, failed
    passed, failed = passed + bool(is_so), failed + (not is_so)
    if not is_so:
        print("failed:", what)


def raises(kind, call, words=""):
    try:
        call()
    except kind as error:
        return words in str(error)
    return False


def sheet(side):
    """A square sheet of so many vertices a side."""
    x, y = np.meshgrid(np.arange(side), np.arange(side), indexing="ij")
    first = (side * x + y)[:-1, :-1].reshape(-1, 1)
    corners = np.concatenate([first + [0, side, side + 1], first + [0, side + 1, 1]])
    return np.stack([x, y, 0 * x], -1).reshape(-1, 3).astype(np.float64), corners.astype(np.uint32)


def rolled(rest, time):
    """The sheet rolled up ever more tightly: from some time on it goes through itself."""
    angle = rest[:, 0] * 0.6 * time
    pose = rest.copy()
    pose[:, 0] = 3 * np.sin(angle) + 0.1 * rest[:, 1] * time
    pose[:, 2] = 3 * np.cos(angle) - 0.05 * rest[:, 0]
    return pose


REST, TRIANGLES = sheet(17)


def poses_of(ids):
    return np.stack([rolled(REST, (i + 1) / COUNT) for i in ids])


def same(one, other):
    return (one.offsets.dtype == other.offsets.dtype and np.array_equal(one.offsets, other.offsets)
            and one.pairs.dtype == other.pairs.dtype and np.array_equal(one.pairs, other.pairs))


def expected(model):
    """By one query a pose."""
    pairs = [model.query(pose) for pose in poses_of(range(COUNT))]
    offsets = np.cumsum([0] + [len(one) for one in pairs])
    check("some poses collide and some do not", 0 < sum(len(one) > 0 for one in pairs) < COUNT)
    return batch.Found(offsets.astype(np.int64), np.concatenate(pairs))


def die_once(folder, ids):
    """Ends this process the first time that it comes to one pose; notes who was here."""
    with open(os.path.join(folder, f"seen.{os.getpid()}"), "a", encoding="ascii") as file:
        file.write(f"{len(batch._models)}\n")
    mark = os.path.join(folder, "killed")
    if KILLED in ids and not os.path.exists(mark):
        with open(mark, "w", encoding="ascii"):
            pass
        os.kill(os.getpid(), signal.SIGKILL)


def check_workers(folder):
    seen = [name for name in os.listdir(folder) if name.startswith("seen.")]
    check("a worker was killed", os.path.exists(os.path.join(folder, "killed")))
    check("others went on", len(seen) > 1 and f"seen.{os.getpid()}" not in seen)
    counts = {line for name in seen for line in open(os.path.join(folder, name), encoding="ascii")}
    check("no process made more than one model", counts <= {"0\n", "1\n"} and "1\n" in counts)


def by_numpy(model, data, wanted, folder):
    poses = poses_of(range(COUNT))
    check("of bytes", same(batch.query(poses, data), wanted))
    check("of a model", same(batch.query(poses, model), wanted))
    check("of a list", same(batch.query(list(poses), data), wanted))
    check("of other bytes", same(batch.query(poses, bytearray(data)), wanted))
    check("of an array", same(batch.query(poses, np.frombuffer(data, np.uint8)), wanted))
    check("one model for all of these", len(batch._models) == 1)
    check("the last pose", np.array_equal(wanted.of(-1), model.query(poses[-1])))
    check("no such pose", raises(IndexError, lambda: wanted.of(COUNT)))
    halves = [batch.query(half, data) for half in np.split(poses, 2)]
    check("in two halves", np.array_equal(np.concatenate([h.pairs for h in halves]), wanted.pairs))
    none = batch.query(poses[:0], data)
    check("of no pose", same(none, batch.Found(np.zeros(1, np.int64), np.empty((0, 2), np.uint32))))
    single = batch.query(poses.astype(np.float32), data)
    check("of floats", np.array_equal(single.of(-1), model.query(poses[-1].astype(np.float32))))
    edges = batch.query(poses[-3:], data, pairs="edge")
    check("options", np.array_equal(edges.of(2), model.query(poses[-1], pairs="edge")))
    check("other shapes", raises(ValueError, lambda: batch.query(poses[:, 1:], data), "(n, 289, 3)"))
    check("one pose", raises(ValueError, lambda: batch.query(poses[0], data), "shape"))
    check("no model", raises(starcontour.Error, lambda: batch.query(poses, b"x" * 999)))
    for made in (starcontour.Error(3, "vertex 7"), starcontour.Incomplete(wanted.of(-1))):
        again = pickle.loads(pickle.dumps(made))
        check("errors reach other processes", type(again) is type(made)
              and again.status == made.status and str(again) == str(made))
    check("with what was found", np.array_equal(again.found, wanted.of(-1)))
    asks = pickle.loads(pickle.dumps(batch.Query(data)))
    columns = asks({"poses": poses, "id": np.arange(COUNT)})
    check("columns", sorted(columns) == ["id", "pair_count", "pairs"])
    check("put together", same(batch.found(columns), wanted))
    kept = batch.Query(data, column="p", keep=True)({"p": poses})
    check("columns that are kept", sorted(kept) == ["p", "pair_count", "pairs"])
    check("no columns", same(batch.found({"pair_count": [], "pairs": []}), none))
    for side in range(4, 4 + batch.MODELS_KEPT):
        batch.model_of(starcontour.Model(*sheet(side)).tobytes())
    check("so many models are kept", len(batch._models) == batch.MODELS_KEPT)
    check("those used last", same(batch.query(poses, data), wanted))
    results = [None] * 4

    def ask(k):
        results[k] = batch.query(poses, data)

    threads = [threading.Thread(target=ask, args=(k,)) for k in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    check("by threads", all(same(result, wanted) for result in results))


def dask_part(ids, data, folder):
    die_once(folder, ids)
    return batch.query(poses_of(ids), data)


def by_dask(model, data, wanted, folder):
    import dask
    from distributed import Client, LocalCluster

    dask.config.set({"distributed.worker.memory.terminate": False})
    parts = [list(range(i, i + PART)) for i in range(0, COUNT, PART)]
    with LocalCluster(n_workers=2, threads_per_worker=1, dashboard_address=None) as cluster:
        with Client(cluster) as client:
            held = client.scatter(data, broadcast=True)
            results = client.gather(client.map(dask_part, parts, data=held, folder=folder,
                                               pure=False))
    pairs = np.concatenate([result.pairs for result in results])
    counts = np.concatenate([np.diff(result.offsets) for result in results])
    offsets = np.concatenate([[0], np.cumsum(counts)])
    check("the same by Dask", same(batch.Found(offsets, pairs), wanted))
    check_workers(folder)


class Dying(batch.Query):
    """Ray's workers make one of these."""

    def __init__(self, data, folder):
        super().__init__(data)
        self.folder = folder

    def __call__(self, columns):
        die_once(self.folder, columns["id"])
        return super().__call__(columns)


def by_ray(model, data, wanted, folder):
    import logging

    import ray

    ray.init(num_cpus=4, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR,
             object_store_memory=100 << 20, _temp_dir=os.path.join(folder, "ray"))
    try:
        context = ray.data.DataContext.get_current()
        context.enable_progress_bars = False
        context.execution_options.preserve_order = True
        held = ray.put(data)

        def poses():
            return ray.data.range(COUNT, override_num_blocks=COUNT // PART).map_batches(
                lambda columns: {"id": columns["id"], "poses": poses_of(columns["id"])},
                batch_format="numpy")

        def gather(dataset):
            rows = sorted(dataset.take_all(), key=lambda row: row["id"])
            check("every pose", [row["id"] for row in rows] == list(range(COUNT)))
            return batch.found({name: [row[name] for row in rows] for name in rows[0]})

        actors = poses().map_batches(Dying, fn_constructor_args=(held, folder),
                                     compute=ray.data.ActorPoolStrategy(size=2),
                                     batch_size=PART, batch_format="numpy")
        check("the same by Ray's actors", same(gather(actors), wanted))
        check_workers(folder)
        for name in os.listdir(folder):
            if name.startswith("seen.") or name == "killed":
                os.remove(os.path.join(folder, name))
        tasks = poses().map_batches(Dying(held, folder), batch_size=PART, batch_format="numpy")
        check("and by its tasks", same(gather(tasks), wanted))
        check_workers(folder)
    finally:
        ray.shutdown()


if __name__ == "__main__":
    own = starcontour.Model(REST, TRIANGLES)
    engine = {"numpy": by_numpy, "dask": by_dask, "ray": by_ray}[sys.argv[1]]
    engine(own, own.tobytes(), expected(own), sys.argv[2])
    print(f"{sys.argv[1]}: {passed} passed, {failed} failed")
    sys.exit(failed > 0)
