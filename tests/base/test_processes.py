"""Work in several processes gives the same results and errors as work in one process."""

import os
import signal

import pytest
from threadpoolctl import threadpool_info, threadpool_limits

from calib.base.errors import BatchError
from calib.base.processes import one_blas_thread, parallel_map

PRELOAD = "calib.base.processes"


def process(_):
    return os.getpid()


def killed(_):
    os.kill(os.getpid(), signal.SIGKILL)


@pytest.mark.parametrize("count", [1, 2])
def test_results_come_in_the_order_of_the_items_and_one_is_this_process(count):
    with parallel_map(count, PRELOAD) as mapped:
        assert list(mapped(abs, range(-20, 0))) == list(range(20, 0, -1))
        assert list(mapped(abs, [])) == []
        assert (os.getpid() in set(mapped(process, range(9)))) == (count == 1)
        with pytest.raises(TypeError, match="bad operand"):
            list(mapped(abs, ["a"]))


def test_a_process_that_dies_is_told():
    with (
        pytest.raises(BatchError, match=r"a worker process died.*--workers 1"),
        parallel_map(2, PRELOAD) as mapped,
    ):
        list(mapped(killed, [0]))


def blas_threads():
    return {blas["num_threads"] for blas in threadpool_info() if blas["user_api"] == "blas"}


def test_linear_algebra_has_one_thread_meanwhile():
    with threadpool_limits(2, user_api="blas"):
        with one_blas_thread():
            assert blas_threads() == {1}
        assert blas_threads() == {2}
