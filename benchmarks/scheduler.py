"""What a cluster takes besides the designs themselves: `python benchmarks/scheduler.py [--tasks 800]`.

Tasks that do nothing go through a scheduler of Dask and two workers started by hand. Printed: processor time of the
scheduler and of the command for a task, bytes over the loopback, and the memory of all processes of one worker. What
`docs/batch.md` says of sizes is reckoned from these.
"""

from __future__ import annotations

import argparse

import psutil
from batch import cluster

from kinform.batch.crew import Crew
from kinform.batch.task import Limits, Task


def spent(process: psutil.Process) -> float:
    """Processor time (s)."""
    times = process.cpu_times()
    return float(times.user + times.system)


def tasks(name: str, count: int) -> list[Task]:
    """So many that do nothing."""
    return [Task(f"{name} {k}", "json:loads", {"s": "1"}, Limits()) for k in range(count)]


def main() -> None:
    """Print a line a figure."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--tasks", type=int, default=800)
    count = parser.parse_args().tasks
    me = psutil.Process()
    with cluster(2) as address, Crew(2, address) as crew:
        list(crew.answers(tasks("first", 8)))
        own = {child.pid: " ".join(child.cmdline()) for child in me.children()}
        scheduler = psutil.Process(next(pid for pid, words in own.items() if "dask_scheduler" in words))
        worker = psutil.Process(next(pid for pid, words in own.items() if "dask_worker" in words))
        before = spent(scheduler), spent(me), psutil.net_io_counters(pernic=True)["lo"].bytes_sent
        list(crew.answers(tasks("task", count)))
        sent = psutil.net_io_counters(pernic=True)["lo"].bytes_sent - before[2]
        print(f"scheduler            {(spent(scheduler) - before[0]) / count * 1e3:8.2f} ms of processor time a task")
        print(f"command              {(spent(me) - before[1]) / count * 1e3:8.2f} ms of processor time a task")
        print(f"over the loopback    {sent / count / 1e3:8.2f} kB a task, with what else was sent meanwhile")
        print(f"scheduler            {scheduler.memory_info().rss / 1e6:8.0f} MB")
        whole = [worker, *worker.children(recursive=True)]
        print(f"one worker           {sum(p.memory_info().rss for p in whole) / 1e6:8.0f} MB, {len(whole)} processes")


if __name__ == "__main__":
    main()
