"""What is kept of tasks that fly: for whom it counts, and what becomes of a folder that is not as it was."""

import os
import pickle
import zlib
from dataclasses import dataclass, replace
from enum import Enum
from functools import partial
from pathlib import Path

import pytest

from sim.campaign import study_cache
from sim.campaign.claim import Claim, Study
from sim.campaign.consistency import consistency_figures
from sim.campaign.flight import Order, fly_order
from sim.campaign.runner import run
from sim.campaign.study_cache import KEPT_FOR_S, VARIABLE, cache_folder, task_digest, with_cache
from sim.errors import HarnessError

ORDER = Order("microsat", {"coils": {"backoff": "per_coil"}}, 3, 0.001)


@pytest.fixture
def folder(tmp_path):
    return tmp_path / "cache"


@pytest.fixture
def computed(monkeypatch):
    """The arguments of each task that was computed, not read; a task of the project stands for it."""
    found = []

    def compute(number):
        found.append(number)
        return [number, {"nan": float("nan"), "text": "a\nb"}]

    monkeypatch.setattr(study_cache, "task_digest", lambda task: f"{task.args[0]:032x}")
    return found, lambda *numbers, flies=True: Study(
        "a",
        tuple(partial(compute, number) for number in numbers),
        lambda results: [Claim("a", "", "", "1").judge(len(results))],
        flies,
    )


def results(study, folder):
    (done,) = run(with_cache([study], folder), 1, lambda done: None, lambda study: None)
    return done.results


def test_what_was_computed_is_read_and_what_was_not_is_computed(computed, folder, capsys):
    found, study = computed
    first = results(study(1, 2), folder)
    again = results(study(2, 1, 3), folder)
    assert found == [1, 2, 3]
    assert repr(again[:2]) == repr(first[::-1])
    assert capsys.readouterr().err.count(": 2 of 3 results known; TORQUER_CACHE= ") == 1


def test_a_study_without_flights_is_computed_each_time(computed, folder):
    found, study = computed
    for _ in range(2):
        results(study(1, flies=False), folder)
    assert found == [1, 1]


def test_a_task_that_fails_is_not_kept(folder, monkeypatch):
    def fail():
        raise HarnessError("no flight")

    monkeypatch.setattr(study_cache, "task_digest", lambda task: "f" * 32)
    study = Study("a", (fail,), lambda results: [], True)
    for _ in range(2):
        with pytest.raises(HarnessError, match="no flight"):
            results(study, folder)


@pytest.mark.parametrize("damage", [b"", b"\0" * 40, "half", zlib.compress(b"no pickle"), zlib.compress(b"")])
def test_what_is_damaged_is_computed_again(computed, folder, damage):
    found, study = computed
    results(study(1), folder)
    (path,) = folder.rglob("*.result")
    path.write_bytes(path.read_bytes()[:20] if damage == "half" else damage)
    results(study(1), folder)
    results(study(1), folder)
    assert found == [1, 1]


def test_the_folder_may_be_deleted_while_tasks_wait(computed, folder):
    found, study = computed
    (cached,) = with_cache([study(1)], folder)
    folder.rmdir()
    assert cached.tasks[0]() == [1, {"nan": pytest.approx(float("nan"), nan_ok=True), "text": "a\nb"}]
    assert found == [1]


def test_what_no_one_has_asked_for_is_deleted_and_what_was_read_is_not(computed, folder):
    found, study = computed
    results(study(1, 2), folder)
    for path in folder.rglob("*.result"):
        old = path.stat().st_mtime - KEPT_FOR_S - 60.0
        os.utime(path, (old, old + 120.0 * ("2.result" in path.name)))
    results(study(2), folder)
    assert [path.name[-8:] for path in folder.rglob("*.result")] == ["2.result"]
    (kept,) = folder.rglob("*.result")
    assert kept.stat().st_mtime > old + 3600.0
    assert found == [1, 2]


def test_a_named_folder_that_can_be_none_is_one_sentence(computed, tmp_path, monkeypatch):
    monkeypatch.setenv(VARIABLE, str(tmp_path))
    (tmp_path / "file").write_text("")
    with pytest.raises(HarnessError, match=r"_CACHE: .*file/cache keeps no results \(Not a directory\)"):
        with_cache([computed[1](1)], tmp_path / "file" / "cache")


def test_without_a_folder_of_the_user_all_is_computed(computed, tmp_path, monkeypatch, capsys):
    found, study = computed
    (tmp_path / "file").write_text("")
    monkeypatch.delenv(VARIABLE)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "file"))
    for _ in range(2):
        results(study(1), None)
    assert found == [1, 1]
    assert "file/torquer keeps no results (Not a directory): all is computed\n" in capsys.readouterr().err


@pytest.mark.skipif(os.name != "posix", reason="permissions are those of POSIX")
@pytest.mark.parametrize("mode", [0o777, 0o770, 0o702])
def test_a_folder_that_others_may_write_to_is_refused(computed, folder, monkeypatch, mode):
    folder.mkdir()
    folder.chmod(mode)
    monkeypatch.setenv(VARIABLE, str(folder))
    with pytest.raises(HarnessError, match=r"keeps no results \(others may write there"):
        with_cache([computed[1](1)])


def test_the_folder_is_the_users_own(computed, folder):
    with_cache([computed[1](1)], folder)
    assert folder.stat().st_mode & 0o077 == 0


@pytest.mark.parametrize(
    ("environment", "expected"),
    [
        ({VARIABLE: ""}, None),
        ({VARIABLE: "/here"}, Path("/here")),
        ({"XDG_CACHE_HOME": "/there"}, Path("/there/torquer")),
        ({}, Path.home() / ".cache" / "torquer"),
    ],
)
def test_the_folder_is_that_of_the_environment_or_of_the_user(monkeypatch, environment, expected):
    for name in (VARIABLE, "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    for name, value in environment.items():
        monkeypatch.setenv(name, value)
    assert cache_folder() == expected


def test_who_has_no_home_keeps_nothing(monkeypatch):
    for name in (VARIABLE, "XDG_CACHE_HOME", "HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)
    assert cache_folder() is None


class Level(Enum):
    LOW = "low"
    HIGH = "high"


@dataclass(frozen=True)
class Body:
    moments: tuple[float, ...]
    level: Level = Level.LOW


def of(*arguments):
    return task_digest(partial(fly_order, *arguments))


@pytest.mark.long
def test_equal_tasks_have_one_digest_whatever_the_order_of_their_keys():
    turned = {"coils": {"levels": 1, "backoff": "shared"}}
    assert of(turned) == of({"coils": {"backoff": "shared", "levels": 1}})
    assert of(ORDER) == of(pickle.loads(pickle.dumps(ORDER)))


DIFFERENT = (
    *(ORDER, replace(ORDER, seed=4), replace(ORDER, orbits=None), replace(ORDER, overrides={})),
    replace(ORDER, measure=consistency_figures),
    *(1, 1.0, True, "1", None, 0.0, -0.0, float("nan"), float("inf")),
    *((1, 2), [1, 2], (1, (2,)), {"a": 1}, {"b": 1}, {}),
    *(Body((1.0, 2.0)), Body((1.0, 2.5)), Body((1.0, 2.0), Level.HIGH), Level.LOW, "low"),
)


@pytest.mark.long
def test_other_tasks_have_others():
    digests = [of(value) for value in DIFFERENT] + [task_digest(partial(consistency_figures, ORDER))]
    assert None not in digests
    assert len(set(digests)) == len(digests)


def test_other_code_has_another(monkeypatch):
    before = of(ORDER), of(replace(ORDER, measure=consistency_figures))
    monkeypatch.setattr(
        study_cache,
        "code_digest",
        lambda module: "new" if module == consistency_figures.__module__ else "old",
    )
    first = of(ORDER), of(replace(ORDER, measure=consistency_figures))
    monkeypatch.setattr(study_cache, "code_digest", lambda module: "old")
    assert before[0] != first[0] == of(ORDER)
    assert before[1] != first[1] != of(replace(ORDER, measure=consistency_figures))


def other(order):
    """Of no package of the project."""


@pytest.mark.parametrize(
    "task",
    [
        partial(other, ORDER),
        partial(fly_order, object()),
        partial(fly_order, Path("pass.csv")),
        partial(fly_order, {1: 2}),
        lambda: 1,
    ],
)
def test_what_cannot_be_told_from_others_is_not_kept(task, folder):
    assert task_digest(task) is None
    (cached,) = with_cache([Study("a", (task,), lambda results: [], True)], folder)
    assert cached.tasks == (task,)
