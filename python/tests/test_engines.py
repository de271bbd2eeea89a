"""Studies on existing engines, killed on the way: the bits of one machine, nothing lost, nothing counted twice."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

import granulens as gl
from granulens import engines

from conftest import STUDY, call, wait_for
from test_study import files

# Enough rounds that there is a middle to kill in.
LONG = STUDY.replace("budget = 400", "budget = 3000")


@pytest.fixture
def whole(desk):
    (desk / "study.toml").write_text(LONG)
    call("study", "run", "study.toml", "--out", "program")
    return files("program")


def start(*command, **options):
    return subprocess.Popen([sys.executable, *command], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, **options)


@pytest.fixture
def dask(desk):
    """A real scheduler and two worker processes on loopback, none of them a child of another."""
    pytest.importorskip("distributed")
    scheduler = start("-m", "distributed.cli.dask_scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard",
                      "--scheduler-file", "scheduler.json")  # fmt: skip
    wait_for("the scheduler", lambda: Path("scheduler.json").exists() and Path("scheduler.json").read_text().strip())
    address = json.loads(Path("scheduler.json").read_text())["address"]
    workers = [
        start("-m", "distributed.cli.dask_worker", address, "--no-nanny", "--nthreads", "1", "--no-dashboard", "--name", f"w{k}",
              "--local-directory", f"worker{k}")  # fmt: skip
        for k in range(2)
    ]
    from distributed import Client

    with Client(address) as client:
        client.wait_for_workers(2, timeout=60)
        yield client, address, workers
    for process in (*workers, scheduler):
        process.kill()
        process.wait()


def lines(folder) -> int:
    path = Path(folder) / "journal.jsonl"
    return path.read_bytes().count(b"\n") if path.exists() else 0


DRIVER = """
import sys
import granulens as gl
from granulens import engines
engines.dask(gl.Study("study.toml"), "ours", sys.argv[1])
"""


def test_dask_with_a_worker_and_then_the_driver_killed(whole, dask):
    client, address, workers = dask
    driver = start("-c", DRIVER, address)
    wait_for("a quarter of the study", lambda: lines("ours") > 700)
    workers[0].send_signal(signal.SIGKILL)
    wait_for("half of the study", lambda: lines("ours") > 1500)
    driver.kill()
    driver.wait()
    kept = lines("ours") - 1
    assert 1500 <= kept < 3000, kept
    result = gl.Study("study.toml").run("ours", executor=client)
    assert result.evaluations == 3000
    # Nothing lost, nothing counted twice: the journal is that of one machine, line by line.
    assert files("ours") == whole
    assert len(client.scheduler_info()["workers"]) == 1


def test_dask_from_a_shell(whole, dask):
    _, address, _ = dask
    done = subprocess.run(
        [sys.executable, "-m", "granulens", "run", "study.toml", "--out", "ours", "--dask", address], capture_output=True, text=True
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout)["evaluations"] == 3000
    assert files("ours") == whole


def test_hyperqueue_with_a_shard_lost(desk, monkeypatch):
    cluster = pytest.importorskip("hyperqueue.cluster")
    call("study", "run", "study.toml", "--out", "program")
    whole = files("program")
    study = gl.Study("study.toml")
    # The first task of the first generation is killed as it begins, as by a machine that goes away.
    command = engines.task

    def losing(study, folder, shard, threads):
        if shard == "1/2" and not Path("lost").exists():
            Path("lost").touch()
            return [sys.executable, "-c", "import os, signal; os.kill(os.getpid(), signal.SIGKILL)"]
        return command(study, folder, shard, threads)

    monkeypatch.setattr(engines, "task", losing)
    with cluster.LocalCluster() as local:
        local.start_worker(cluster.WorkerConfig(cores=2))
        told = engines.hyperqueue(study, "ours", local.client(), shards=2)
    assert told["failed"] == 1 and told["evaluations"] == 400 and told["tasks"] == 2 * told["generations"]
    assert files("ours")[:2] == whole[:2]
    assert sorted(files("ours")[2].splitlines()) == sorted(whole[2].splitlines())


def test_hyperqueue_that_brings_nothing_is_given_up(desk, monkeypatch):
    cluster = pytest.importorskip("hyperqueue.cluster")
    monkeypatch.setattr(engines, "task", lambda *_: [sys.executable, "-c", "raise SystemExit(9)"])
    with cluster.LocalCluster() as local:
        local.start_worker(cluster.WorkerConfig(cores=2))
        with pytest.raises(gl.LostError, match="no answer after 2 rounds"):
            engines.hyperqueue(gl.Study("study.toml"), "ours", local.client(), shards=2, rounds_without_answer=2)
    assert os.path.exists("ours/asked.jsonl")
