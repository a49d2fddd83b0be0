"""Many poses of one model, for engines that hand out batches: Ray Data, Dask, or a loop.

    data = model.tobytes()
    found = starcontour.batch.query(poses, data)      poses of shape (n, vertices, 3)
    found.of(i)                                       the pairs of pose i, as model.query returns them

An engine gives batches to processes on any machine. Each process makes a model of the bytes once
and keeps it, by their hash, so it does not matter how often they come; what matters is that they
are sent once, by the engine's store of objects. Of Ray:

    data = ray.put(model.tobytes())
    poses.map_batches(starcontour.batch.Query(data), batch_format="numpy")

and of Dask, with a scattered future or a delayed value for data:

    client.map(starcontour.batch.query, parts, data=client.scatter(model.tobytes(), broadcast=True))

The same poses give the same arrays, whatever process asks and however often: a batch whose worker
died is simply asked again.

SPDX-License-Identifier: MIT
"""

import hashlib
import threading
from collections import OrderedDict, namedtuple

import numpy as np

from . import Model

__all__ = ["Found", "Query", "query"]

# How many models a process keeps: those used last.
MODELS_KEPT = 4

_models = OrderedDict()
_lock = threading.Lock()


class Found(namedtuple("Found", "offsets pairs")):
    """What was found in n poses.

    offsets   int64 array of shape (n + 1,): the pairs of pose i are those from offsets[i] on up to
              offsets[i + 1]
    pairs     uint32 array of shape (offsets[n], 2): those of all poses, one after the other
    """

    __slots__ = ()

    def of(self, pose):
        """The pairs of one pose: a view of shape (k, 2)."""
        pose = range(len(self.offsets) - 1)[pose]
        return self.pairs[self.offsets[pose]:self.offsets[pose + 1]]


def model_of(data):
    """The Model that tobytes made `data` of: a Model itself, or bytes, of which one is made once in
    each process, as long as no more than MODELS_KEPT others are asked for meanwhile."""
    if isinstance(data, Model):
        return data
    with _lock:
        # The same object, which bytes never change, needs no look at all of it.
        for key, (model, kept) in _models.items():
            if kept is not None and kept is data:
                _models.move_to_end(key)
                return model
    view = memoryview(data).cast("B")
    key = hashlib.blake2b(view, digest_size=32).digest()
    with _lock:
        model = _models[key][0] if key in _models else Model.frombytes(view)
        _models[key] = model, data if isinstance(data, bytes) else None
        _models.move_to_end(key)
        while len(_models) > MODELS_KEPT:
            _models.popitem(last=False)
    return model


def query(poses, data, **options):
    """All pairs of each pose: a Found.

    poses     array of shape (n, vertices, 3)
    data      the model, as Model.tobytes made it: any bytes-like object; or a Model
    options   as of Model.query; a pose that budget or cancel ends raises Incomplete
    """
    poses = np.asarray(poses)
    if poses.dtype == object:
        poses = np.stack(list(poses)) if len(poses) else poses
    model = model_of(data)
    vertices = model.info.vertex_count
    if len(poses) == 0:
        return Found(np.zeros(1, np.int64), np.empty((0, 2), np.uint32))
    if poses.ndim != 3 or poses.shape[1:] != (vertices, 3):
        raise ValueError(f"poses must have the shape (n, {vertices}, 3), not {poses.shape}")
    found = [model.query(pose, **options) for pose in poses]
    offsets = np.zeros(len(found) + 1, np.int64)
    np.cumsum([len(pairs) for pairs in found], out=offsets[1:])
    return Found(offsets, np.concatenate(found))


class Query:
    """A function from a batch to a batch, as Ray Data's map_batches and Dask's map take it.

    data      the model's bytes, or a reference to them in Ray's store (ray.put), which is fetched
              once by each process that asks
    column    which column of a batch has the poses
    options   as of Model.query

    A batch is a dictionary of columns, arrays with a row for each pose. It comes back without the
    poses (keep=True: with them), and with "pair_count", the number of pairs of each pose, and
    "pairs", an array for each pose of shape (2 k,): a, b, a, b and so on. found() makes a Found of
    such columns.
    """

    def __init__(self, data, column="poses", keep=False, **options):
        self.data, self.column, self.keep, self.options = data, column, keep, options
        self._model = None

    def __getstate__(self):
        return {**self.__dict__, "_model": None}

    def __call__(self, batch):
        if self._model is None:
            data = self.data
            if type(data).__name__ == "ObjectRef":
                import ray

                data = ray.get(data)
            self._model = model_of(data)
        found = query(batch[self.column], self._model, **self.options)
        count = len(found.offsets) - 1
        pairs = np.empty(count, object)
        for pose in range(count):
            pairs[pose] = found.of(pose).reshape(-1)
        answer = {name: column for name, column in batch.items()
                  if self.keep or name != self.column}
        return {**answer, "pair_count": np.diff(found.offsets), "pairs": pairs}


def found(columns):
    """The Found of columns that Query made, in the order of their rows."""
    counts = np.asarray(columns["pair_count"], np.int64)
    offsets = np.zeros(len(counts) + 1, np.int64)
    np.cumsum(counts, out=offsets[1:])
    pairs = [np.asarray(row, np.uint32) for row in columns["pairs"]]
    pairs = np.concatenate(pairs) if pairs else np.empty(0, np.uint32)
    return Found(offsets, pairs.reshape(-1, 2))
