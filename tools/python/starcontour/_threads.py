"""Several threads for one query: sc_tasks on a pool of Python's.

The library calls back in the thread that called it. That is a thread of the pool here, never the
caller's: in the main thread Python runs signal handlers between any two lines, and an exception from
one would cost the library a part of its work. Parts themselves run without the global lock.

SPDX-License-Identifier: MIT
"""

import ctypes
import os
import threading
from concurrent.futures import ThreadPoolExecutor

from . import _binding

_pool = None


def _forget_pool():
    """Threads do not survive a fork."""
    global _pool
    _pool = None


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_forget_pool)


def _submit(*call):
    global _pool
    if _pool is None:
        _pool = ThreadPoolExecutor(_binding.SC_WORKERS_MAX, "starcontour")
    return _pool.submit(*call)


class _Job:
    """Parts of a query's work, and the threads that are at it."""

    def __init__(self, run, context, count):
        self._run, self._context, self._count = run, context, count
        self._parts = iter(range(count))
        self._done = [0]
        self._workers, self._closed = 0, False
        self._change = threading.Condition()

    def work(self, worker):
        """Does parts until none is left. Comes too late if the job is closed."""
        with self._change:
            if self._closed:
                return
            self._workers += 1
        done = 0
        try:
            for part in self._parts:  # next() of an iterator of a range is atomic
                self._run(self._context, part, worker)
                done += 1
        finally:
            with self._change:
                self._workers -= 1
                self._done.append(done)
                self._change.notify_all()

    def finish(self):
        """Waits until nobody is at it; whether all parts are done."""
        with self._change:
            self._closed = True
            while self._workers:
                self._change.wait()
        return sum(self._done) == self._count


class Tasks:
    """sc_tasks for so many workers; one query at a time."""

    def __init__(self, workers):
        self._job, self._jobs_left = None, 0
        self._enqueue_function = _binding.sc_tasks_enqueue(self._enqueue)
        self._finish_function = _binding.sc_tasks_finish(self._finish)
        self.structure = _binding.sc_tasks(
            struct_size=ctypes.sizeof(_binding.sc_tasks), workers=workers,
            enqueue=self._enqueue_function, finish=self._finish_function)

    def _enqueue(self, user, run, context, count):
        self._jobs_left += 1
        self._job = job = _Job(run, context, count)
        try:
            for worker in range(1, min(self.structure.workers, count)):
                _submit(job.work, worker)
        except RuntimeError:
            pass  # no thread can be started: those that there are will do it
        job.work(0)

    def _finish(self, user, task):
        self._jobs_left -= self._job.finish()

    def call(self, function, *arguments):
        """Calls a function of the library with these tasks. It runs to its end, also when an
        exception, such as KeyboardInterrupt, comes in the meantime: that is raised then."""
        self._jobs_left = 0
        one = _Call(function, arguments)
        try:
            _submit(one.run)
            one.wait()
        finally:
            one.close()
        if one.error is not None:
            raise one.error
        if self._jobs_left:
            raise RuntimeError("a thread could not do its part of a query")
        return one.status


class _Call:
    """A call in a thread of the pool, which is waited for whatever happens: it writes to arrays of
    the caller's."""

    def __init__(self, function, arguments):
        self._function, self._arguments = function, arguments
        self._change, self._state = threading.Condition(), "waiting"
        self.status = self.error = None

    def run(self):
        with self._change:
            if self._state == "closed":
                return
            self._state = "running"
        try:
            self.status = self._function(*self._arguments)
        except BaseException as error:
            self.error = error
        with self._change:
            self._state = "done"
            self._change.notify_all()

    def wait(self):
        with self._change:
            while self._state in ("waiting", "running"):
                self._change.wait()

    def close(self):
        """It does not begin any more, or is over."""
        with self._change:
            if self._state == "waiting":
                self._state = "closed"
        while self._state == "running":
            try:
                self.wait()
            except BaseException:
                pass  # the first one is on its way
