"""Studies are run by workers: results in order, and a failure ends the run at once."""

import multiprocessing
import os
import signal
import subprocess
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from functools import partial

import pytest

from sim.campaign.claim import Study
from sim.campaign.runner import run, worker_context
from sim.errors import HarnessError


class TestRunner:
    @pytest.mark.long
    @pytest.mark.parametrize("workers", [1, 2])
    def test_results_are_in_order_however_they_came(self, workers, study):
        studies = [study("one", [1, 2, 3]), study("none", []), study("two", [20])]
        seen, told = [], []
        finished = run(studies, workers, seen.append, lambda done: told.append(done.study.id))
        assert [done.results for done in finished] == [(1.0, 2.0, 3.0), (), (20.0,)]
        assert [done.outcomes[0].verdict.value for done in finished] == ["PASS", "PASS", "FAIL"]
        assert seen == [1, 2, 3, 4]
        assert sorted(told) == ["none", "one", "two"]

    def test_tasks_that_belong_to_this_process_stay_in_it_while_others_leave(self):
        here = Study("here", (os.getpid,), lambda results: [], here=True)
        there = [Study(name, (os.getpid,), lambda results: []) for name in ("a", "b")]
        mine, *theirs = run([here, *there], 2, lambda done: None, lambda done: None)
        assert mine.results == (os.getpid(),)
        assert os.getpid() not in {pid for done in theirs for pid in done.results}

    def test_what_a_task_refuses_ends_the_run(self):
        def refuse():
            raise HarnessError("no")

        with pytest.raises(HarnessError, match="no"):
            run([Study("x", (refuse,), lambda results: [])], 1, lambda done: None, lambda done: None)

    def test_one_that_fails_does_not_wait_for_the_others(self):
        tasks = (partial(time.sleep, 60.0), partial(int, "no number"))
        began = time.monotonic()
        with pytest.raises(ValueError, match="no number"):
            run([Study("x", tasks, lambda results: [])], 2, lambda done: None, lambda done: None)
        assert time.monotonic() - began < 30.0
        assert not multiprocessing.active_children()


class TestWorkers:
    SCRIPT = """
from concurrent.futures import ProcessPoolExecutor
from sim.campaign.runner import worker_context

if __name__ == "__main__":
    with ProcessPoolExecutor(1, worker_context()) as pool:
        print(pool.submit(abs, -1).result())
"""

    def test_have_what_a_flight_needs_when_they_start(self):
        with ProcessPoolExecutor(1, worker_context()) as pool:
            assert "sim.campaign.flight" in pool.submit(names_of_modules).result()

    @pytest.mark.long
    def test_do_not_look_for_packages_in_the_working_directory(self, tmp_path):
        script, here = tmp_path / "script" / "run.py", tmp_path / "here"
        for folder in (script.parent, here):
            folder.mkdir()
        script.write_text(self.SCRIPT)
        (here / "numpy.py").write_text("raise SystemExit('the package of the working directory')")
        done = subprocess.run([sys.executable, script], cwd=here, capture_output=True, text=True, check=False)
        assert (done.stdout, done.stderr) == ("1\n", "")

    def test_leave_the_environment_as_it_was(self, monkeypatch):
        for before in (None, "x"):
            monkeypatch.delenv("PYTHONSAFEPATH", raising=False)
            if before is not None:
                monkeypatch.setenv("PYTHONSAFEPATH", before)
            worker_context()
            assert os.environ.get("PYTHONSAFEPATH") == before


NO_SEMAPHORES = """
import _multiprocessing
from functools import partial

def refuse(*words):
    raise ERROR

class SemLock(_multiprocessing.SemLock):
    __new__ = refuse

_multiprocessing.SemLock = SemLock
from sim.campaign.claim import Study
from sim.campaign.runner import run

if __name__ == "__main__":
    tasks = (partial(abs, -1), partial(abs, -2))
    (done,) = run([Study("x", tasks, lambda results: [])], WORKERS, lambda done: None, lambda done: None)
    print(done.results)
"""


@pytest.mark.long
@pytest.mark.parametrize("error", ["OSError(38, 'Function not implemented')", "PermissionError(13, 'no')"])
@pytest.mark.parametrize("workers", [1, 2])
def test_a_machine_without_semaphores_runs_all_tasks_in_one_process_and_says_so(error, workers, tmp_path):
    script = tmp_path / "run.py"
    script.write_text(NO_SEMAPHORES.replace("ERROR", error).replace("WORKERS", str(workers)))
    done = subprocess.run([sys.executable, script], capture_output=True, text=True, check=False)
    assert done.stdout == "(1, 2)\n", done.stderr
    why = error.split("'")[1]
    told = f"no worker processes can be started ({why}): this process does all, one after the other\n"
    assert done.stderr == ("" if workers == 1 else told)


def names_of_modules():
    return set(sys.modules)


@pytest.mark.long
def test_a_process_that_a_study_did_not_start_outlives_one_that_fails():
    other = multiprocessing.get_context("spawn").Process(target=time.sleep, args=(60.0,))

    def start_another(done):
        other.start()

    tasks = (partial(int, 1), partial(time.sleep, 60.0), partial(int, "no number"))
    try:
        with pytest.raises(ValueError, match="no number"):
            run([Study("x", tasks, lambda results: [])], 2, start_another, lambda done: None)
        assert other.is_alive()
        assert multiprocessing.active_children() == [other]
    finally:
        other.terminate()
        other.join()


def ended_from_outside():
    os.kill(os.getpid(), signal.SIGKILL)


def test_a_worker_that_is_killed_is_one_sentence():
    others = multiprocessing.active_children()
    studies = [Study(f"s{number}", (ended_from_outside,), lambda results: []) for number in range(3)]
    with pytest.raises(HarnessError, match=r"a worker process was lost \(.*\): 0 of 3 ") as caught:
        run(studies, 2, lambda done: None, lambda done: None)
    assert caught.value.exit_code == 1
    assert multiprocessing.active_children() == others
