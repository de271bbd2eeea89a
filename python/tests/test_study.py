"""Studies: the files of the program, callbacks, executors, shards."""

import os
import pickle
import signal
from concurrent.futures import Future, ProcessPoolExecutor, ThreadPoolExecutor

import numpy as np
import pytest

import granulens as gl
from granulens.__main__ import main

from conftest import STUDY, call

FILES = ("study.json", "best.csv", "journal.jsonl")


def files(folder):
    return [open(f"{folder}/{name}").read() for name in FILES]


@pytest.fixture
def whole(desk):
    """What the program makes of the study."""
    call("study", "run", "study.toml", "--out", "program")
    return files("program")


def test_files_are_those_of_the_program(whole):
    for threads in (1, 2):
        result = gl.Study("study.toml").run(f"ours{threads}", threads=threads)
        assert files(f"ours{threads}") == whole
    assert result.evaluations == 400 and result.within_limits
    assert result.best.csv() == whole[1]
    assert result.history["loss"][-1] == result.report["best"]["loss"]
    # The front is in the order of the first measure, and no layout of it dominates another.
    front = result.front
    assert len(result.front_layouts) == len(front["contrast"]) > 1
    assert (np.diff(front["contrast"]) < 0).all() and (np.diff(front["half_mass_kg"]) < 0).all()
    # The program goes on with what the package began, and the other way round.
    assert "nothing was to be done" in call("study", "run", "study.toml", "--out", "ours1").stderr


def test_the_journal_is_a_table(whole):
    study = gl.Study("study.toml")
    table = study.journal("program")
    assert all(len(column) == 400 for column in table.values())
    assert table["letters"].shape == (400, len(study.free))
    best = study.layout(table["letters"][table["loss"].argmin()])
    assert best.csv() == whole[1]
    assert study.why("program")[0]["used"]


def test_a_callback_hears_and_may_end_it(whole):
    heard = []
    gl.Study("study.toml").run("ours", callback=heard.append)
    assert heard[-1]["evaluations"] == 400 and heard[-1]["best"]["contrast"] > 0
    assert [told["evaluations"] for told in heard] == sorted(told["evaluations"] for told in heard)

    class Enough(Exception):
        pass

    def stop(told):
        if told["evaluations"] > 150:
            raise Enough

    study = gl.Study("study.toml")
    with pytest.raises(Enough):
        study.run("stopped", callback=stop)
    study.run("stopped")
    assert files("stopped") == whole


def test_any_executor_gives_the_same_bits(whole):
    study = gl.Study("study.toml")
    with ThreadPoolExecutor(2) as executor:
        study.run("threads", executor=executor)
    with ProcessPoolExecutor(2) as executor:
        study.run("processes", executor=executor, shard=3)
    assert files("threads") == files("processes") == whole
    assert pickle.loads(pickle.dumps(study)).budget == study.budget


class Losing:
    """An executor whose tasks are lost now and then, as where machines go away."""

    def __init__(self, always=False):
        self.given, self.lost, self.always = 0, 0, always

    def submit(self, function, *arguments):
        self.given += 1
        future = Future()
        if self.always or self.given % 3 == 0:
            self.lost += 1
            future.set_exception(OSError("its machine is gone"))
        else:
            future.set_result(function(*arguments))
        return future


def test_lost_tasks_are_given_again_and_are_no_layouts_fault(whole):
    study, executor = gl.Study("study.toml"), Losing()
    study.run("ours", executor=executor)
    assert executor.lost > 3 and files("ours") == whole
    with pytest.raises(gl.LostError, match="lost 4 times.*its machine is gone") as raised:
        study.run("never", executor=Losing(always=True))
    assert "no layout's fault" in str(raised.value)
    # What was wrong from the begin is not tried again.
    executor = ThreadPoolExecutor(1)
    study.run("never", executor=executor)
    assert files("never") == whole


def test_a_pool_whose_process_is_killed_says_so_and_the_study_goes_on(whole):
    study = gl.Study("study.toml")
    with ProcessPoolExecutor(1) as executor:
        victim = executor.submit(os.getpid).result()

        def kill(told):
            if told["evaluations"] >= 150:
                os.kill(victim, signal.SIGKILL)

        with pytest.raises(gl.LostError):
            study.run("killed", executor=executor, callback=kill)
    kept = len(gl.Study("study.toml").journal("killed")["loss"])
    assert 150 <= kept < 400
    with ProcessPoolExecutor(1) as executor:
        study.run("killed", executor=executor)
    assert files("killed") == whole


def test_what_an_engine_answers_is_checked(whole):
    study = gl.Study("study.toml")

    class Wrong:
        def submit(self, function, packed, rung, layouts, threads):
            lines = function(packed, rung, layouts, threads)
            future = Future()
            future.set_result([line.replace('"C":', '"C": ') for line in lines])
            return future

    with pytest.raises(gl.InputError, match="checksum"):
        study.run("ours", executor=Wrong())


def test_shards_from_a_shell_end_as_one_machine_does(whole, capsys):
    rounds = 0
    while main(["ask", "study.toml", "--out", "ours"]) == 4:
        rounds += 1
        assert main(["merge", "study.toml", "--out", "ours"]) == 4
        for shard in ("2/2", "1/2"):
            assert main(["evaluate", "study.toml", "--out", "ours", "--shard", shard]) == 0
    assert rounds > 1 and files("ours") == whole
    assert main(["ask", "nowhere.toml"]) == 2
    assert "nowhere.toml" in capsys.readouterr().err


def test_another_study_in_the_folder_is_left_alone(whole, desk):
    (desk / "study.toml").write_text(STUDY.replace("seed = 1", "seed = 2"))
    with pytest.raises(gl.InputError, match="seed 1, and this is seed 2"):
        gl.Study("study.toml").run("program")
    assert files("program") == whole
